"""Output of results as JSON, in a file or on the terminal."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from models.errors import InputError

TERMINAL = Path("-")


def check_output(path: Path | None, option: str = "--json") -> None:
    """Checks before a computation that its result can be written to a file.

    Args:
        path: Path of the file; None and `-` can always be written.
        option: Name of the option, for the message.

    Raises:
        InputError: The folder is missing, the path is a folder, or the file cannot be written.
    """
    if path is None or path == TERMINAL:
        return
    try:
        if not path.absolute().parent.is_dir():
            raise InputError(
                "no such folder", where=f"{option} {path}", remedy="Make it, or name another"
            )
        if path.is_dir():
            raise InputError("this is a folder", where=f"{option} {path}", expected="a file")
        # What is made to try it is removed again, and never a link to it.
        target = path.resolve()
        there = target.exists()
        # Opening a pipe would wait for its reader.
        if there and not target.is_file():
            return
        target.open("ab").close()
        if not there:
            target.unlink()
    except OSError as error:
        raise InputError(
            "this file cannot be written",
            where=f"{option} {path}",
            got=error.strerror,
            remedy="Name a file in a folder of yours",
        ) from None


def write_json(path: Path | None, values: dict[str, Any], sort_keys: bool = False) -> None:
    """Writes values to the file of `--json`; `-` is the terminal, None writes nothing.

    Raises:
        InputError: The file cannot be written, or a number is not finite, which JSON forbids.
    """
    if path is None:
        return
    try:
        text = json.dumps(values, indent=1, allow_nan=False, sort_keys=sort_keys)
    except ValueError as error:
        raise InputError(
            "the result cannot be written as JSON", where=f"--json {path}", got=str(error)
        ) from None
    if path == TERMINAL:
        print(text)
        return
    try:
        path.write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        # The result was printed already; only the file is missing.
        raise InputError(
            "the result cannot be written", where=f"--json {path}", got=error.strerror
        ) from None
