"""Atomic writes, durable writes and locks of files."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from models.errors import StudyError
from sandbox.system.files import BESIDE, OPEN, lock, sync_folder, this_program

TEMPORARY = ".tmp-"
"""Prefix of the names of unfinished files."""
LOCK_FILES = (".lock", f".lock{BESIDE}")
"""Names of lock files, which contain no data."""


def study_error(error: OSError, path: Path, what: str) -> StudyError:
    """Converts an error of the operating system to a `StudyError`."""
    return StudyError(
        what,
        where=str(path),
        got=error.strerror,
        remedy="Free disk space or give write permission; everything written before is safe",
    )


def write_atomically(path: Path, data: bytes, durable: bool = True) -> bool:
    """Replaces a file atomically: readers see either the old file or the new file.

    Args:
        path: Path of the file.
        data: The whole new content.
        durable: True returns only after the file is on the disk, safe from a power cut.

    Returns:
        True if the content changed.

    Raises:
        StudyError: The file cannot be written; the old file is unchanged.
    """
    temporary = path.with_name(f"{TEMPORARY}{os.getpid()}-{path.name}")
    try:
        if path.exists() and path.stat().st_size == len(data) and path.read_bytes() == data:
            return False
        with temporary.open("wb") as file:
            file.write(data)
            file.flush()
            if durable:
                os.fsync(file.fileno())
        temporary.replace(path)
        if durable:
            sync_folder(path.parent)
    except OSError as error:
        _remove(temporary)
        raise study_error(error, path, "the file cannot be written") from None
    return True


def write_new(path: Path, data: bytes) -> None:
    """Writes a new file.

    Raises:
        StudyError: The file exists or cannot be written.
    """
    try:
        with path.open("xb") as file:
            file.write(data)
    except FileExistsError:
        raise StudyError(
            "the file exists already", where=str(path), remedy="Choose another name"
        ) from None
    except OSError as error:
        raise StudyError(
            "the file cannot be written",
            where=str(path),
            got=error.strerror,
            remedy="Choose a name in a folder in which you may write",
        ) from None


def remove_locks(folder: Path) -> None:
    """Removes the lock files of a folder; no program may have the folder open."""
    for name in LOCK_FILES:
        _remove(folder / name)


def remove_unfinished(folder: Path) -> None:
    """Removes unfinished files of a killed program; the caller must hold the folder's lock."""
    for path in folder.glob(f"{TEMPORARY}*"):
        _remove(path)


def _remove(path: Path) -> None:
    # A file that remains is harmless: the next write uses another name, or overwrites it.
    with suppress(OSError):
        path.unlink(missing_ok=True)


def make_folder(path: Path) -> None:
    """Creates a folder and its parents durably; an existing folder is left as it is.

    Raises:
        StudyError: It cannot be created.
    """
    try:
        if path.is_dir():
            return
        new = [folder for folder in (path, *path.parents) if not folder.exists()]
        path.mkdir(parents=True, exist_ok=True)
        for folder in new:
            sync_folder(folder.parent)
    except OSError as error:
        raise study_error(error, path, "the folder cannot be created") from None


@contextmanager
def locked(path: Path, wait: bool, what: str = "") -> Iterator[None]:
    """Holds a lock, which the system releases if the program ends in any way.

    Args:
        path: Path of the lock file.
        wait: True waits until other programs release the lock; False raises an error.
        what: Name of the locked resource, for the error message.

    Raises:
        StudyError: Another program holds the lock, or the file cannot be created.
    """
    try:
        fd = os.open(path, os.O_RDWR | os.O_CREAT | OPEN, 0o666)
    except OSError as error:
        raise study_error(error, path, "the lock file cannot be created") from None
    release = None
    try:
        release = lock(fd, path, wait)
        if release is None:
            raise StudyError(
                f"{what} is in use by another program",
                where=str(path.parent),
                got=os.read(fd, 100).decode(errors="replace").strip() or None,
                remedy="End that program first",
            )
        _write_holder(fd)
        yield
    finally:
        if release is not None:
            release()
        os.close(fd)


def json_bytes(value: Any) -> bytes:
    """A JSON value as the content of a file."""
    return json.dumps(value, indent=1, ensure_ascii=False).encode() + b"\n"


def _write_holder(fd: int) -> None:
    """Writes process and host into the lock file, for the error of other programs.

    Errors are ignored.
    """
    with suppress(OSError):
        os.ftruncate(fd, 0)
        os.write(fd, f"{this_program()}\n".encode())
