"""Checks of Python, its packages, MuJoCo, clocks, folders, this user's profile, and speed."""

from __future__ import annotations

import platform
import re
import shutil
import statistics
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, metadata, version
from pathlib import Path

from models.errors import HandSandboxError
from sandbox.doctor import Check, run_probe
from sandbox.recording.versions import versions
from sandbox.trial.profiles import default_path, find_profile

NAME = "hand-sandbox"
DEVELOPERS = ("test", "lint", "site", "release", "notebook", "training", "dev")
"""Extras for development only."""

USES = {
    "film": "films as mp4 (GIF and WebP need no extra)",
    "plots": "figures of evaluations and regression runs",
    "ray": "regression runs on a cluster",
    "gym": "tasks as Gymnasium environments",
    "datasets": "data sets of demonstrations for Minari and LeRobot",
    "robots": "robot hands in place of the human hand: Shadow, Adroit",
    "bullet": "comparison with Bullet",
    "evdev": "Linux touch screens and trackpads",
    "lsl": "streams to the Lab Streaming Layer",
    "study": "reports on user studies, and their tables for other programs",
}

_REQUIREMENT = re.compile(r"\s*([\w.-]+)\s*(?:\[[^\]]*\])?\s*\(?([^;)]*)\)?\s*(?:;(.*))?")
_BOUND = re.compile(r"\s*(>=|<=|==|<|>)\s*([\d.]+)\s*")


@dataclass(frozen=True)
class Requirement:
    """A package with its allowed versions.

    Attributes:
        package: Name in package indexes.
        bounds: Version bounds such as `>=4.0,<4.1`; empty allows any.
    """

    package: str
    bounds: str

    def unmet(self) -> str:
        """Reason why the requirement is not met; empty if it is met."""
        try:
            installed = version(self.package)
        except PackageNotFoundError:
            return f"{self.package} is not installed"
        return (
            ""
            if within(installed, self.bounds)
            else f"{self.package} {installed} is not {self.bounds}"
        )


def within(found: str, bounds: str) -> bool:
    """True if a version is within bounds; only its leading numbers count."""
    for sign, limit in _BOUND.findall(bounds):
        a, b = _numbers(found), _numbers(limit)
        length = max(len(a), len(b))
        a, b = a + (0,) * (length - len(a)), b + (0,) * (length - len(b))
        if not {">=": a >= b, "<=": a <= b, "==": a == b, "<": a < b, ">": a > b}[sign]:
            return False
    return True


def declared() -> dict[str, list[Requirement]]:
    """Declared requirements by extra; the key of mandatory requirements is empty.

    In a checkout, `pyproject.toml` is read, since the metadata of an installation may be outdated.
    """
    file = _checkout() / "pyproject.toml"
    if file.is_file():
        project = tomllib.loads(file.read_text(encoding="utf-8"))["project"]
        extras = {"": project["dependencies"], **project["optional-dependencies"]}
        return {extra: _parsed(lines) for extra, lines in extras.items()}
    declared_by_extra: dict[str, list[str]] = {"": []}
    about = metadata(NAME)
    for extra in about.get_all("Provides-Extra") or []:
        declared_by_extra[extra] = []
    for line in about.get_all("Requires-Dist") or []:
        named = re.search(r"""extra\s*==\s*["']([\w.-]+)["']""", line)
        declared_by_extra.setdefault(named[1] if named else "", []).append(line)
    return {extra: _parsed(lines) for extra, lines in declared_by_extra.items()}


def package_checks() -> list[Check]:
    """Checks of the mandatory packages and of each extra."""
    known = declared()
    wrong = list(filter(None, (r.unmet() for r in known[""])))
    line = _pip("")
    checks = [
        Check(
            "program",
            "packages",
            not wrong,
            "; ".join(wrong) or ", ".join(r.package for r in known[""]),
            "everything",
            line if wrong else "",
        )
    ]
    for extra, requirements in known.items():
        if not extra or extra in DEVELOPERS or not requirements:
            continue
        wrong = list(filter(None, (r.unmet() for r in requirements)))
        versions = ", ".join(f"{r.package} {version(r.package)}" for r in requirements if not wrong)
        checks.append(
            Check(
                "extras",
                extra,
                not wrong,
                "; ".join(wrong) or versions,
                USES.get(extra, ""),
                _pip(extra) if wrong else "",
            )
        )
    return checks


def _checkout() -> Path:
    return Path(__file__).resolve().parents[2]


def _pip(extra: str) -> str:
    """Returns the command that installs an extra into this Python."""
    brackets = f"[{extra}]" if extra else ""
    root = _checkout()
    if (root / "pyproject.toml").is_file():
        return f"{sys.executable} -m pip install -e '{root}{brackets}'"
    return f"{sys.executable} -m pip install '{NAME}{brackets}'"


def _parsed(lines: list[str]) -> list[Requirement]:
    requirements = []
    for line in lines:
        match = _REQUIREMENT.match(line)
        if match and _here(match[3] or "") and match[1] != NAME:
            requirements.append(Requirement(match[1], match[2].strip()))
    return requirements


def _here(marker: str) -> bool:
    """True if a requirement applies to this system."""
    named = re.search(r"""sys_platform\s*==\s*["'](\w+)["']""", marker)
    return named is None or named[1] == sys.platform


def _numbers(text: str) -> tuple[int, ...]:
    leading = re.match(r"\d+(\.\d+)*", text)
    return tuple(map(int, leading[0].split("."))) if leading else ()


PYTHON = (3, 11)
LATE = 0.005
"""Largest allowed delay of a sleep of 1 ms, s. A person would feel a longer delay of touches."""
WAITS = 20


def system_checks() -> list[Check]:
    """Checks of the system other than packages, graphics and devices."""
    return [
        _python(),
        _mujoco(),
        _versions(),
        _clock(),
        _ffmpeg(),
        folder_check(Path.cwd()),
        _profile_folder(),
        _profile(),
    ]


def _python() -> Check:
    ok = sys.version_info[:2] >= PYTHON
    return Check(
        "program",
        "Python",
        ok,
        f"{platform.python_version()} at {sys.executable}",
        "everything",
        "" if ok else "Install Python 3.11 or newer",
    )


def _mujoco() -> Check:
    try:
        installed = version("mujoco")
        import mujoco

        ok = mujoco.mj_versionString() is not None
        return Check("program", "MuJoCo", ok, installed, "everything")
    except (PackageNotFoundError, ImportError, OSError) as error:
        return Check(
            "program",
            "MuJoCo",
            False,
            str(error),
            "everything",
            f"{sys.executable} -m pip install mujoco",
        )


def _versions() -> Check:
    known = versions()
    return Check(
        "program",
        "fingerprint",
        True,
        f"{known['fingerprint']} (MuJoCo {known['mujoco']}, {known['machine']}, "
        f"libm {known['libm']})",
        "bit-identical replay, on machines with equal fingerprints",
    )


def _clock() -> Check:
    """Checks the accuracy of timers: median of several sleeps of 1 ms."""
    late = []
    for _ in range(WAITS):
        begun = time.monotonic()
        time.sleep(0.001)
        late.append(time.monotonic() - begun - 0.001)
    resolution = time.get_clock_info("monotonic").resolution
    median = statistics.median(late)
    ok = median <= LATE and resolution <= 0.001
    return Check(
        "program",
        "clock",
        ok,
        f"wakes up {1000 * median:.1f} ms late (median of {WAITS}), "
        f"resolution {1e9 * resolution:.0f} ns",
        "sessions in real time",
        "" if ok else "Close other programs, or use another machine",
    )


def _ffmpeg() -> Check:
    try:
        import imageio_ffmpeg

        path: str | None = imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        path = None
    other = shutil.which("ffmpeg")
    program = path or (f"only {other}, which is not used" if other else "none")
    return Check(
        "program",
        "ffmpeg",
        path is not None,
        program,
        "films as mp4",
        "" if path else "Install the extra film",
    )


def folder_check(
    folder: Path, name: str = "this folder", use: str = "films and recordings"
) -> Check:
    """Checks that a file can be written in a folder, or in its nearest existing parent."""
    there = folder
    while not there.exists() and there != there.parent:
        there = there.parent
    try:
        with tempfile.TemporaryFile(dir=there):
            pass
        return Check("files", name, True, str(folder), use)
    except OSError as error:
        return Check(
            "files",
            name,
            False,
            f"{folder}: {error.strerror}",
            use,
            "Choose another folder, or allow yourself to write there",
        )


def _profile_folder() -> Check:
    return folder_check(default_path().parent, "settings folder", "your profile")


def _profile() -> Check:
    path = default_path()
    if not path.exists():
        return Check(
            "files",
            "your profile",
            True,
            "no profile, so the trained hand's size is assumed; `sandbox hand measure` measures "
            "your hand",
        )
    try:
        return Check("files", "your profile", True, find_profile(str(path)).line)
    except HandSandboxError as error:
        return Check(
            "files",
            "your profile",
            False,
            str(error),
            "the size of your hand",
            f"Move {path} away, or measure again: `sandbox hand measure`",
        )


ENOUGH = 1.5
"""Smallest number of simulated seconds per second that leaves a session enough time for its views.
"""

_PROBE = """
import time
from sandbox.trial.assembly import build
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.trial.settings import Settings
session = build(Settings(), (lambda task, surface: MouseDevice(surface),))
surface = session.rigs[0].reconstructor.surface
session.rigs[0].device.hand(3, surface.to_surface(session.task.objects[0].position))
while session.time < 1.5:
    session.advance()
begun, since = time.perf_counter(), session.time
while session.time < since + 1.0:
    session.advance()
print((session.time - since) / (time.perf_counter() - begun))
"""


def speed_check() -> Check:
    """Simulates a hand with three fingers beside a box for one second, and measures the speed."""
    answer = run_probe(_PROBE, OMP_NUM_THREADS="1")
    use = "sessions in real time"
    if not answer.ok:
        return Check(
            "program", "speed", False, answer.text, use, "Run the tests: `python -m pytest`"
        )
    speed = float(answer.text)
    return Check(
        "program",
        "speed",
        speed >= ENOUGH,
        f"simulates {speed:.1f} times as fast as real time",
        use,
        "" if speed >= ENOUGH else "Close other programs; `s` in the window slows time down",
    )
