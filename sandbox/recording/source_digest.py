"""Digest of the program's source: which files count depends on what is to be kept equal."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from functools import cache
from hashlib import blake2b
from pathlib import Path

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
    """Digest of what is in a file, whatever its name."""
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
