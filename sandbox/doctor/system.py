"""Checks of Python, MuJoCo, clocks, folders, this user's profile, and speed."""

from __future__ import annotations

import platform
import shutil
import statistics
import sys
import tempfile
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from models.errors import HandSandboxError
from sandbox.doctor.check import Check, run_probe
from sandbox.hand.profiles import default_path, find_profile
from sandbox.recording.versions import versions

PYTHON = (3, 11)
LATE = 0.005
"""s by which a sleep of 1 ms may be late; a longer delay would be felt in touches."""
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
        "replay to the bit, where two machines have the same",
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
            "none: the trained hand size is assumed; `sandbox hand measure` measures yours",
        )
    try:
        return Check("files", "your profile", True, find_profile(str(path)).line)
    except HandSandboxError as error:
        return Check(
            "files",
            "your profile",
            False,
            str(error),
            "your own hand's size",
            f"Move {path} away, or measure again: `sandbox hand measure`",
        )


ENOUGH = 1.5
"""Simulated seconds per second that leave a session enough time for its views."""

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
