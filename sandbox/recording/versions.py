"""Versions of what computes, and what two machines must share for equal states.

A state depends on the recording, on MuJoCo's version, on the architecture and on the system's libm,
and on nothing else (`models/arithmetic`). These three are the fingerprint, each with a digest of
what it computes. All other versions are noted for people.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import cache
from hashlib import blake2b
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from models.arithmetic.probe import arithmetic_digest, libm_digest
from sandbox.recording.source_digest import program_root
from sandbox.system.checkout import commit

DECISIVE = {
    "mujoco": "MuJoCo's version",
    "machine": "the operating system or the architecture",
    "libm": "the system's libm",
    "arithmetic": "the order of sums and products",
}
"""Versions that states depend on, and their names for people."""


@cache
def versions() -> dict[str, str]:
    """Versions of what computes, a fingerprint of those that states depend on, and the commit
    where the program runs from a checkout."""
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
    """The part of a version that decides: of libm the digest, whatever its own version is."""
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
