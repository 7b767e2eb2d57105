"""Files that are written beside their place and then renamed, so that nobody reads half of one."""

from __future__ import annotations

from pathlib import Path
from secrets import token_hex

from models.errors import InputError


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
        new = _beside(target)
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
    new = _beside(path.resolve())
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


def _beside(path: Path) -> Path:
    """A temporary file that no other run takes."""
    return path.with_name(f"{path.name}.{token_hex(4)}.new")
