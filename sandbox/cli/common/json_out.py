"""Results as JSON, in a file or on the terminal; a place that cannot be had is refused first."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from models.errors import InputError

TERMINAL = Path("-")


def check_output(path: Path | None, option: str = "--json") -> None:
    """Refuses, before anything is computed, a file that could not be written at the end.

    Args:
        path: Path of the file; None and `-` can always be written.
        option: That named it, for the message.

    Raises:
        InputError: Its folder is missing, or it is a folder itself.
    """
    if path is None or path == TERMINAL:
        return
    if not path.absolute().parent.is_dir():
        raise InputError("no such folder", where=f"{option} {path}")
    if path.is_dir():
        raise InputError("this is a folder", where=f"{option} {path}", expected="a file")


def write_json(path: Path | None, values: dict[str, Any], sort_keys: bool = False) -> None:
    """Writes the values of `--json`; `-` is the terminal, and None nowhere.

    Raises:
        InputError: The file cannot be written, or a number is not finite: JSON knows none such.
    """
    if path is None:
        return
    try:
        text = json.dumps(values, indent=1, allow_nan=False, sort_keys=sort_keys)
    except ValueError as error:
        raise InputError("the result is no JSON", where=f"--json {path}", got=str(error)) from None
    if path == TERMINAL:
        print(text)
        return
    try:
        path.write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        # What was computed is over and was printed; only the file is missing.
        raise InputError(
            "the result cannot be written", where=f"--json {path}", got=error.strerror
        ) from None
