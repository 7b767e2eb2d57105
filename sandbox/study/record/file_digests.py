"""Digests of the files of a study that its journals name: recordings and derived tables."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from sandbox.recording.recording import GZIP, read_stored, stored
from sandbox.study.record.chain import digest_of

DATA, PACKED = "data", "packed"
"""Digests of a recording: of its lines, and of its compressed file (None where it is plain)."""


def recording_digests(path: Path) -> dict[str, Any] | None:
    """Digests of a recording, compressed or not, as a record has them; None if it is missing.

    Args:
        path: Path of the recording without `.gz`.

    Raises:
        OSError: The file cannot be read.
    """
    try:
        raw = stored(path).read_bytes()
        data = read_stored(path).data
    except FileNotFoundError:
        return None
    return {
        DATA: digest_of(data),
        PACKED: digest_of(raw) if raw.startswith(GZIP) else None,
    }


def tables_of(folder: Path, stem: str) -> list[Path]:
    """Files that were derived from a recording, in order: 60 Hz tables and measures.

    Args:
        folder: Folder of the tables.
        stem: Name of the recording without suffix.
    """
    paths = (
        path
        for name in TABLES
        for path in folder.glob(f"{name}_{stem}.*")
        if path.name.split(f"_{stem}.", 1)[1] in SUFFIXES
    )
    return sorted(paths)


TABLES = ("frames", "touches", "measures")
SUFFIXES = ("csv.gz", "parquet", "json")


def file_digests(paths: Iterable[Path]) -> dict[str, str]:
    """Digests of files by name.

    Raises:
        OSError: A file cannot be read.
    """
    return {path.name: digest_of(path.read_bytes()) for path in paths}
