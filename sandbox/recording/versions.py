"""The program that made a recording: versions, fingerprint of the machine, states, source code.

For a given program and models, replayed states depend only on the recording and on the fingerprint
of the machine. The fingerprint covers MuJoCo's version, the system and architecture, the values of
the system's libm, and the order of sums and products (`models/arithmetic.py`). All other versions
are recorded for people.

With equal `STATES`, models and fingerprint, a replay is bit-identical. A recording with other
`STATES` cannot be played again. Its recorded poses, its score and its header can be read.
"""

from __future__ import annotations

import platform
import subprocess
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from hashlib import blake2b
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from models.arithmetic import arithmetic_digest, libm_digest
from models.errors import RecordingError
from sandbox.recording.recording import Recording

DECISIVE = {
    "mujoco": "MuJoCo's version",
    "machine": "the operating system or the architecture",
    "libm": "the system's libm",
    "arithmetic": "the order of sums and products",
}
"""Names of the versions on which states depend -> their descriptions for people."""

SHARED_VERSIONS = (
    *("python", "hand-sandbox", "mujoco", "numpy", "scipy", "commit"),
    *("machine", "libm", "arithmetic", "fingerprint"),
)
"""Versions that `sandbox study share` includes."""


@cache
def versions() -> dict[str, str]:
    """Versions of the program and its libraries, a fingerprint of those on which states depend, and
    the commit if the program runs from a checkout."""
    known = {"python": platform.python_version()}
    for package in ("hand-sandbox", "mujoco", "numpy", "scipy"):
        try:
            known[package] = version(package)
        except PackageNotFoundError:
            # The program runs from a checkout that is not installed.
            known[package] = "checkout"
    if at := commit(program_root()):
        known["commit"] = at
    known["machine"] = f"{platform.system()} {platform.machine()}"
    known["processor"] = _processor()
    known["libm"] = f"{' '.join(platform.libc_ver()).strip() or platform.system()}, {libm_digest()}"
    known["arithmetic"] = arithmetic_digest()
    text = "\n".join(f"{name}={decisive_part(name, known[name])}" for name in DECISIVE)
    known["fingerprint"] = blake2b(text.encode(), digest_size=8).hexdigest()
    return known


def decisive_part(name: str, value: Any) -> Any:
    """The part of a version on which states depend. For libm, this is only its digest."""
    return value.rpartition(", ")[2] if name in DECISIVE and isinstance(value, str) else value


def decisive_parts(known: Mapping[str, Any]) -> dict[str, str]:
    """The parts of the fingerprint, by the names of `DECISIVE`; without unknown parts."""
    return {name: str(decisive_part(name, known[name])) for name in DECISIVE if name in known}


def differing_parts(there: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """Descriptions of the differing parts of two fingerprints; see `decisive_parts`."""
    return [
        f"{words} ({there.get(name, 'unknown')} there, {here.get(name, 'unknown')} here)"
        for name, words in DECISIVE.items()
        if there.get(name) != here.get(name)
    ]


def decisive_differences(there: Mapping[str, str]) -> list[str]:
    """Descriptions of the differences from a recording's `versions` on which states depend.

    For libm only the digest of its values counts: another version with equal values is equal.
    """
    here = versions()
    if there.get("fingerprint") == here["fingerprint"]:
        return []
    different = [
        f"{words} ({there.get(name, 'unknown')} there, {here[name]} here)"
        for name, words in DECISIVE.items()
        if decisive_part(name, there.get(name)) != decisive_part(name, here[name])
    ]
    return different or ["the fingerprint (its recorded parts are equal)"]


def _processor() -> str:
    """Model of the processor, for people; states do not depend on it."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or "unknown"


SUFFIXES = (".py", ".xml")
"""Suffixes of source files: modules, and MJCF files. Arrays are covered by digests of encoders."""


def program_root() -> Path:
    """Folder of the packages of the program."""
    return Path(__file__).resolve().parents[2]


def source_files(folder: Path, below: bool = False) -> list[Path]:
    """Source files of a folder, in order.

    Args:
        folder: The folder.
        below: True includes the files of all folders below it.
    """
    paths = folder.rglob("*") if below else folder.iterdir()
    return sorted(path for path in paths if path.suffix in SUFFIXES)


def source_digest(files: Iterable[Path], root: Path) -> str:
    """Digest of the contents of files and of their names relative to a folder."""
    digest = blake2b(digest_size=8)
    for path in files:
        name, data = path.relative_to(root).as_posix().encode(), path.read_bytes()
        digest.update(b"%s\0%d\0%s" % (name, len(data), data))
    return digest.hexdigest()


def bytes_digest(file: Path) -> str:
    """Digest of a file's content, without its name."""
    return blake2b(file.read_bytes(), digest_size=8).hexdigest()


@cache
def package_digest(module: str) -> str:
    """Digest of the top-level package of a loaded module, or of the module if it has no package.

    Empty if the module was not loaded from a file.
    """
    top = sys.modules.get(module.partition(".")[0])
    spec = top.__spec__ if top else None
    if spec is None or spec.origin is None or not spec.has_location:
        return ""
    file = Path(spec.origin)
    if file.stem != "__init__":
        return source_digest([file], file.parent)
    return source_digest(source_files(file.parent, below=True), file.parent)


STATES = 2
"""Version number of simulated states. Every commit that changes state hashes raises it, and updates
`tools/gate.json`. A header without this number has version 1."""


class DifferentStatesError(RecordingError):
    """A recording cannot be played again, since it was made with other `STATES`."""


def states_of(header: Mapping[str, Any]) -> int:
    """The `STATES` in a recording's header.

    Args:
        header: Header of the recording, from `sandbox.recording.recording.read_header`.
    """
    return int(header.get("states", 1))


def made_with(header: Mapping[str, Any]) -> str:
    """States, version and commit of the program that made a recording, in words."""
    there = header.get("versions")
    return _program(states_of(header), there if isinstance(there, dict) else {})


def this_program() -> str:
    """States, version and commit of this program, in words."""
    return _program(STATES, versions())


def states_difference(header: Mapping[str, Any]) -> str:
    """A line that names both programs if a recording has other `STATES`; empty otherwise."""
    if states_of(header) == STATES:
        return ""
    return f"made with {made_with(header)}; this program has states {STATES}"


def check_states(recording: Recording) -> None:
    """Checks that a recording can be played again by this program.

    Raises:
        DifferentStatesError: The recording was made with other `STATES`.
    """
    if states_of(recording.header) != STATES:
        raise DifferentStatesError(
            "the recording cannot be played again",
            where=str(recording.path),
            got=f"made with {made_with(recording.header)}",
            expected=f"states {STATES}, which this program has",
            remedy="Play it with the version that made it. With this version, `sandbox export` "
            "writes its recorded poses, and its result can be read",
        )


def _program(states: int, known: Mapping[str, Any]) -> str:
    """Text with `STATES`, version and commit of a program."""
    commit = f", commit {known['commit']}" if known.get("commit") else ""
    return f"states {states} (hand-sandbox {known.get('hand-sandbox', 'unknown')}{commit})"


PATIENCE = 5.0
"""Longest time (s) for a call of git."""


def commit(root: Path) -> str:
    """Short name of the commit of a checkout, followed by `with changes` if files were changed.

    Empty if the folder is not the root of a checkout, or if git fails.

    Args:
        root: Folder of the packages.
    """
    if not (root / ".git").exists():
        return ""
    name = _git(root, "rev-parse", "--short", "HEAD")
    if name and _git(root, "status", "--porcelain", "--untracked-files=no"):
        return f"{name} with changes"
    return name


def _git(root: Path, *words: str) -> str:
    """Output of git; empty if git fails or is missing."""
    command = ["git", "-C", str(root), *words]
    try:
        said = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=PATIENCE
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return said.stdout.strip() if said.returncode == 0 else ""
