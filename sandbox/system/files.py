"""Files on every operating system: locks, flushes, atomic replacement, and the home folder.

If Python has `fcntl`, the file itself is locked. Otherwise an SQLite database in the same folder is
locked, since SQLite can lock files on every system. Both kinds of lock end with the program that
holds them, even if it is killed.

`write_whole` writes a temporary file and renames it, so that readers never get an incomplete file.
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
"""Function that ends a lock. If the file itself is locked, closing it also ends the lock."""

BESIDE = ".held"
"""Suffix of the SQLite database that is locked in place of a file."""
LONGEST_WAIT = 3600.0
"""Longest wait (s) for another program's lock on an SQLite database. The wait for a lock on a file
itself has no limit."""
OPEN = getattr(os, "O_BINARY", 0)
"""Flag for `os.open` that prevents the conversion of line breaks; only Windows needs it."""


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
        wait: True waits until another program ends its lock.

    Returns:
        Function that ends the lock; None if another program holds the lock.

    Raises:
        OSError: The file cannot be locked.
    """
    if _FCNTL is None:
        return _lock_database(path, wait)
    try:
        _FCNTL.flock(fd, _FCNTL.LOCK_EX | (0 if wait else _FCNTL.LOCK_NB))
    except BlockingIOError:
        return None
    return _nothing


def _lock_database(path: Path, wait: bool) -> Release | None:
    """Locks the SQLite database beside a file."""
    database = f"{path}{BESIDE}"
    held = sqlite3.connect(
        database,
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
        raise OSError(errno.EIO, str(error), database) from None
    return held.close


def _nothing() -> None:
    """Does nothing: the lock ends when the file is closed."""


def flush(fd: int) -> None:
    """Flushes the content of an open file to the disk."""
    getattr(os, "fdatasync", os.fsync)(fd)


def sync_file(path: Path) -> None:
    """Flushes a file to the disk, so that its content survives a power cut."""
    # Windows can flush only files that are open for writing.
    fd = os.open(path, (os.O_RDWR if os.name == "nt" else os.O_RDONLY) | OPEN)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


def sync_folder(folder: Path) -> None:
    """Flushes new names in a folder to the disk, so that they survive a power cut."""
    if os.name == "nt":
        # Windows cannot open folders. NTFS writes new names to its own journal.
        return
    fd = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


def this_program() -> str:
    """Process and machine, for the message of another program that waits for a lock."""
    return f"process {os.getpid()} on {platform.node()}"


def why(error: OSError | RuntimeError) -> str:
    """The reason of an error with a path.

    Before Python 3.13, `Path.resolve` raises a `RuntimeError` for a loop of links.
    """
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)


def resolved(path: Path, option: str) -> Path:
    """The absolute path with all links resolved.

    Args:
        path: A path; it need not exist.
        option: Name of the option, for the message.

    Raises:
        InputError: Links lead in a circle, or the current folder was deleted.
    """
    try:
        return path.resolve()
    except (OSError, RuntimeError) as error:
        raise InputError(
            "this path cannot be resolved", where=f"{option} {path}", got=why(error)
        ) from None


def write_whole(path: Path, text: str, option: str) -> None:
    """Writes a temporary file and renames it, so that incomplete content is never read.

    If the path is a link, the link stays and its target is replaced. A pipe or a device is written
    directly.

    Raises:
        InputError: The file cannot be written.
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
        raise InputError(
            "the file cannot be written", where=f"{option} {path}", got=why(error)
        ) from None


def check_whole(path: Path | None, option: str) -> None:
    """Checks, before a long run, that `write_whole` can create its temporary file.

    Args:
        path: The file; None needs no check.
        option: Name of the option, for the message.

    Raises:
        InputError: No file can be created in the folder of the file.
    """
    if path is None or (path.exists() and not path.is_file()):
        return
    new = _temporary(path.resolve())
    try:
        new.touch(exist_ok=False)
        new.unlink()
    except (OSError, RuntimeError) as error:
        raise InputError(
            "no file can be created in the folder of this file",
            where=f"{option} {path}",
            got=why(error),
            remedy="Name a file in a folder in which you can write",
        ) from None


def _temporary(path: Path) -> Path:
    """Path of a temporary file with a random name."""
    return path.with_name(f"{path.name}.{token_hex(4)}.new")


def home() -> Path:
    """The home folder.

    Raises:
        InputError: The home folder is unknown, as for a user without an account in a container.
    """
    try:
        return Path.home()
    except RuntimeError as error:
        raise InputError(
            "no home folder is known", got=str(error), remedy="Set HOME to a folder of your own"
        ) from None
