"""Identity of the program and encoders to which a study is locked."""

from __future__ import annotations

from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any

from sandbox.study.design.conditions import combinations, run_settings, values_of
from sandbox.study.design.design import Design

COMPUTES = ("models", "encoders", "tasks", "sandbox", "sandbox/devices", "sandbox/study")
"""Folders whose modules take part in a trial; views, servers and commands do not."""
SHALLOW = ("sandbox", "sandbox/devices", "sandbox/study")
"""Folders of which only the direct files count, without subfolders."""
LIBRARIES = ("hand-sandbox", "mujoco", "numpy", "scipy", "python")


@cache
def code_digest() -> str:
    """Digest of the modules that take part in a trial, independent of version numbers."""
    root = Path(__file__).resolve().parents[3]
    digest = blake2b(digest_size=8)
    for folder in COMPUTES:
        paths = (root / folder).glob("*.py" if folder in SHALLOW else "**/*.py")
        for path in sorted(paths):
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def build_of(design: Design) -> dict[str, Any]:
    """Versions of libraries, and digests of the program, of all encoders of a design, and of it."""
    from sandbox.recording.versions import versions
    from sandbox.trial.assembly import digests

    here = versions()
    learned: dict[str, dict[str, str]] = {}
    for levels in combinations(design):
        settings = run_settings(values_of(design, levels), 0)
        learned.setdefault(f"{settings.encoder}, labels {settings.labels}", digests(settings))
    return {
        **{name: here[name] for name in LIBRARIES},
        "program": code_digest(),
        "encoders": learned,
        "design": design.digest,
    }


def changes(locked: dict[str, Any], here: dict[str, Any]) -> list[str]:
    """Names of the parts that differ between two builds, with their values."""
    differences = []
    for name in sorted(set(locked) | set(here)):
        if locked.get(name) != here.get(name):
            values = "" if name == "encoders" else f" ({locked.get(name)} -> {here.get(name)})"
            differences.append(f"{name}{values}")
    return differences
