"""The program that made a recording: versions, fingerprint of the machine, states, source code.

A state depends on the recording, on MuJoCo's version, on the architecture and on the system's libm,
and on nothing else (`models/arithmetic.py`). These three are the fingerprint, each with a digest of
its computed values. All other versions are recorded for people.

With equal `STATES` and models a recording replays to the bit where the fingerprint is equal. With
other `STATES` it cannot be played again, only read: its recorded poses, its score, its header.
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
"""Versions that states depend on, and their names for people."""

SHARED_VERSIONS = (
    *("python", "hand-sandbox", "mujoco", "numpy", "scipy", "commit"),
    *("machine", "libm", "arithmetic", "fingerprint"),
)
"""Versions that `sandbox study share` includes."""


@cache
def versions() -> dict[str, str]:
    """Versions of the computing parts, a fingerprint of those on which states depend, and the
    commit if the program runs from a checkout."""
    known = {"python": platform.python_version()}
    for package in ("hand-sandbox", "mujoco", "numpy", "scipy"):
        try:
            known[package] = version(package)
        except PackageNotFoundError:
            # Running from a checkout that is not installed.
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
    """The decisive part of a version; for libm only the digest, without its own version."""
    return value.rpartition(", ")[2] if name in DECISIVE and isinstance(value, str) else value


def decisive_parts(known: Mapping[str, Any]) -> dict[str, str]:
    """The parts of the fingerprint, by the names of `DECISIVE`; empty where they are unknown."""
    return {name: str(decisive_part(name, known[name])) for name in DECISIVE if name in known}


def differing_parts(there: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """Parts of two fingerprints that differ, in words; both as of `decisive_parts`."""
    return [
        f"{words} ({there.get(name, 'unknown')} there, {here.get(name, 'unknown')} here)"
        for name, words in DECISIVE.items()
        if there.get(name) != here.get(name)
    ]


def decisive_differences(there: Mapping[str, str]) -> list[str]:
    """Differences from a recording's `versions` on which states depend, in words.

    Of libm the digest counts, not the version: another version with equal values is equal.
    """
    here = versions()
    if there.get("fingerprint") == here["fingerprint"]:
        return []
    different = [
        f"{words} ({there.get(name, 'unknown')} there, {here[name]} here)"
        for name, words in DECISIVE.items()
        if decisive_part(name, there.get(name)) != decisive_part(name, here[name])
    ]
    return different or ["the fingerprint, in a way that its parts do not show"]


def _processor() -> str:
    """Model of the processor, for people; states do not depend on it."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or "unknown"


SUFFIXES = (".py", ".xml")
"""Suffixes of files that count: modules, and the hand's model. Digests of encoders cover arrays."""


def program_root() -> Path:
    """Folder of the packages of the program."""
    return Path(__file__).resolve().parents[2]


def source_files(folder: Path, below: bool = False) -> list[Path]:
    """Source files of a folder, in order.

    Args:
        folder: The folder.
        below: True also takes those of all folders below it.
    """
    paths = folder.rglob("*") if below else folder.iterdir()
    return sorted(path for path in paths if path.suffix in SUFFIXES)


def source_digest(files: Iterable[Path], root: Path) -> str:
    """Digest of files, with their names relative to a folder."""
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
    """Digest of the outermost package of a loaded module, or of the module alone; empty without a
    file."""
    top = sys.modules.get(module.partition(".")[0])
    spec = top.__spec__ if top else None
    if spec is None or spec.origin is None or not spec.has_location:
        return ""
    file = Path(spec.origin)
    if file.stem != "__init__":
        return source_digest([file], file.parent)
    return source_digest(source_files(file.parent, below=True), file.parent)


STATES = 2
"""Generation of simulated states. Every commit that changes state hashes raises it, and updates
`tools/gate.json`. A header without this number is of the first generation."""


class DifferentStatesError(RecordingError):
    """A recording was made with other `STATES`, so it cannot be played again."""


def states_of(header: Mapping[str, Any]) -> int:
    """The generation of states that a recording's header names.

    Args:
        header: Header of the recording, checked (see `sandbox.recording.recording.read_header`).
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
    """A line on a recording of other `STATES`; empty for a recording of these."""
    if states_of(header) == STATES:
        return ""
    return f"made with {made_with(header)}; this program has states {STATES}"


def check_states(recording: Recording) -> None:
    """Refuses to play a recording of other `STATES` again.

    Raises:
        DifferentStatesError: It was made with other states.
    """
    if states_of(recording.header) != STATES:
        raise DifferentStatesError(
            "it cannot be played again",
            where=str(recording.path),
            got=f"made with {made_with(recording.header)}",
            expected=f"states {STATES}, which this program has",
            remedy="Play it with that version; `sandbox export` writes its recorded poses here, "
            "too, and its result can be read",
        )


def _program(states: int, known: Mapping[str, Any]) -> str:
    """A generation of states, with the version and the commit that had it."""
    commit = f", commit {known['commit']}" if known.get("commit") else ""
    return f"states {states} (hand-sandbox {known.get('hand-sandbox', 'unknown')}{commit})"


PATIENCE = 5.0
"""Longest time (s) for a call of git."""


def commit(root: Path) -> str:
    """Short name of the commit of a folder's files, `with changes` where files differ from it.

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
