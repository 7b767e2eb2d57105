"""Files that are never half there: locks, atomic writes, and what else must not go wrong."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from models.errors import StudyError

TEMPORARY = ".tmp-"
"""Prefix of the names of unfinished files."""


def study_error(error: OSError, path: Path, what: str) -> StudyError:
    """An error of the system as one of ours."""
    return StudyError(
        what,
        where=str(path),
        got=error.strerror,
        remedy="Make room, or allow writing; everything written before is safe",
    )


def write_atomically(path: Path, data: bytes, durable: bool = True) -> bool:
    """Replaces a file atomically: readers see either the old or the new one.

    Args:
        path: Path of the file.
        data: Its whole content.
        durable: True ensures that it is on the disk when this returns, safe from a power cut.

    Returns:
        True if the content changed.

    Raises:
        StudyError: It cannot be written; the older file is still there.
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


def sync_folder(folder: Path) -> None:
    """Makes new names in a folder survive a power cut."""
    fd = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


def sync_file(path: Path) -> None:
    """Makes what was written to a file survive a power cut."""
    fd = os.open(path, os.O_RDONLY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


def remove_unfinished(folder: Path) -> None:
    """Removes what a killed program left unfinished; to be called under the folder's lock."""
    for path in folder.glob(f"{TEMPORARY}*"):
        _remove(path)


def _remove(path: Path) -> None:
    # One that stays is in nobody's way: the next write takes another name, or writes over it.
    with suppress(OSError):
        path.unlink(missing_ok=True)


def make_folder(path: Path) -> None:
    """A folder, with those above it.

    Raises:
        StudyError: It cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise study_error(error, path, "the folder cannot be made") from None


@contextmanager
def locked(path: Path, wait: bool, what: str = "") -> Iterator[None]:
    """Holds a lock that ends with the program, however that ends.

    Args:
        path: Path of the lock's file.
        wait: True waits until others release it; False raises an error.
        what: Name of the locked resource, for the message.

    Raises:
        StudyError: Another program holds it, or the file cannot be made.
    """
    try:
        fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    except OSError as error:
        raise study_error(error, path, "the lock cannot be made") from None
    try:
        try:
            fcntl.flock(fd, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            holder = os.pread(fd, 100, 0).decode(errors="replace").strip()
            raise StudyError(
                f"{what} is in use by another program",
                where=str(path.parent),
                got=holder or None,
                remedy="End that one first",
            ) from None
        _sign(fd)
        yield
    finally:
        os.close(fd)


def _sign(fd: int) -> None:
    """Says who holds a lock, for the message that others get; a full disk does not matter here."""
    with suppress(OSError):
        os.ftruncate(fd, 0)
        os.pwrite(fd, f"process {os.getpid()} on {os.uname().nodename}\n".encode(), 0)
