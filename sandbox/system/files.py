"""Files on every operating system: locks, flushes, whole replacements, and the home folder.

Where Python has `fcntl`, a file is locked itself. Elsewhere a database of SQLite in the same folder
is locked, since SQLite locks files in the way of each system. Either lock ends with the program
that holds it, however that ends.

`write_whole` writes a temporary file and renames it, so that nobody reads half of one.
"""

from __future__ import annotations

import errno
import os
import platform
import sqlite3
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from secrets import token_hex
from types import ModuleType

from models.errors import InputError

Release = Callable[[], None]
"""Ends a lock; closing the file does so, too, where the file itself is locked."""

BESIDE = ".held"
"""What is appended to the name of a file for the database that is locked in its place."""
LONGEST_WAIT = 3600.0
"""s after which waiting for another program's lock is given up, where a database is locked; a file
is waited for as long as it takes."""
OPEN = getattr(os, "O_BINARY", 0)
"""Flag for `os.open` that leaves line breaks as they are; only Windows needs it."""


def _system_locks() -> ModuleType | None:
    """The module `fcntl`, or None on a system without it."""
    try:
        return import_module("fcntl")
    except ImportError:
        return None


_FCNTL = _system_locks()


def lock(fd: int, path: Path, wait: bool) -> Release | None:
    """Locks an open file for this program alone.

    Args:
        fd: The open file.
        path: Its path.
        wait: True waits until others end their lock.

    Returns:
        What ends the lock; None if another program holds it.

    Raises:
        OSError: The file cannot be locked.
    """
    if _FCNTL is None:
        return _lock_beside(path, wait)
    try:
        _FCNTL.flock(fd, _FCNTL.LOCK_EX | (0 if wait else _FCNTL.LOCK_NB))
    except BlockingIOError:
        return None
    return _nothing


def _lock_beside(path: Path, wait: bool) -> Release | None:
    """Locks the database beside a file."""
    beside = f"{path}{BESIDE}"
    held = sqlite3.connect(
        beside,
        timeout=LONGEST_WAIT if wait else 0.0,
        isolation_level=None,
        check_same_thread=False,
    )
    try:
        held.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError as error:
        held.close()
        if error.sqlite_errorcode == sqlite3.SQLITE_BUSY:
            return None
        raise OSError(errno.EIO, str(error), beside) from None
    return held.close


def _nothing() -> None:
    """The lock ends when the file is closed."""


def flush(fd: int) -> None:
    """Flushes the content of an open file to the disk."""
    getattr(os, "fdatasync", os.fsync)(fd)


def sync_file(path: Path) -> None:
    """Flushes a file to the disk, so that its content survives a power cut."""
    # Windows flushes only files that may be written.
    fd = os.open(path, (os.O_RDWR if os.name == "nt" else os.O_RDONLY) | OPEN)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


def sync_folder(folder: Path) -> None:
    """Flushes new names in a folder to the disk, so that they survive a power cut."""
    if os.name == "nt":
        # Windows opens no folders; NTFS keeps its names in a journal of its own.
        return
    fd = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


def this_program() -> str:
    """Process and machine, for the message of another program that wants a lock."""
    return f"process {os.getpid()} on {platform.node()}"


def why(error: OSError | RuntimeError) -> str:
    """The reason of an error of a path; `Path.resolve` raises a `RuntimeError` for a loop of links
    in Python before 3.13."""
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)


def resolved(path: Path, option: str) -> Path:
    """The absolute path behind all links.

    Args:
        path: A path that need not exist.
        option: Name of its option, for the message.

    Raises:
        InputError: Links lead in a circle, or the current folder was deleted.
    """
    try:
        return path.resolve()
    except (OSError, RuntimeError) as error:
        raise InputError(
            "this path leads nowhere", where=f"{option} {path}", got=why(error)
        ) from None


def write_whole(path: Path, text: str, option: str) -> None:
    """Writes a temporary file and renames it, so that incomplete content is never read.

    A link stays, and its target is replaced. A pipe or a device is written itself.

    Raises:
        InputError: It cannot be written.
    """
    try:
        if path.exists() and not path.is_file():
            path.write_text(text, encoding="utf-8")
            return
        target = path.resolve()
        new = _temporary(target)
        try:
            new.write_text(text, encoding="utf-8")
            new.replace(target)
        finally:
            new.unlink(missing_ok=True)
    except (OSError, RuntimeError) as error:
        raise InputError("it cannot be written", where=f"{option} {path}", got=why(error)) from None


def check_whole(path: Path | None, option: str) -> None:
    """Checks, before anything is run, that `write_whole` will find room for its temporary file.

    Args:
        path: The file; None needs none.
        option: Name of the option, for the message.

    Raises:
        InputError: No file can be made in its folder.
    """
    if path is None or (path.exists() and not path.is_file()):
        return
    new = _temporary(path.resolve())
    try:
        new.touch(exist_ok=False)
        new.unlink()
    except (OSError, RuntimeError) as error:
        raise InputError(
            "nothing can be made in the folder of this file, which is written beside it first",
            where=f"{option} {path}",
            got=why(error),
            remedy="Name a file in a folder of yours",
        ) from None


def _temporary(path: Path) -> Path:
    """A temporary file that no other run takes."""
    return path.with_name(f"{path.name}.{token_hex(4)}.new")


def home() -> Path:
    """The home folder.

    Raises:
        InputError: None is known, as of a user without an account in a container.
    """
    try:
        return Path.home()
    except RuntimeError as error:
        raise InputError(
            "no home folder is known", got=str(error), remedy="Set HOME to a folder of yours"
        ) from None
