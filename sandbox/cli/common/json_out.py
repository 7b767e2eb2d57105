"""Output of results: JSON to a file or the terminal, and text to a pipe that may be closed."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from io import TextIOWrapper
from pathlib import Path
from typing import Any

from models.errors import InputError
from sandbox.system.files import check_whole, resolved, why, write_whole


def prepare() -> None:
    """Prepares standard output and standard error so that any text can be printed.

    A closed stream is replaced by the null device. A character that the encoding cannot represent
    is printed as an escape sequence. In UTF-8, these are lone surrogates, as in a cut emoji or in
    file names of invalid bytes.
    """
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - for the whole run
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - for the whole run
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


class HelpExit(SystemExit):
    """Exit of the program after it has shown its help."""


@contextmanager
def printing() -> Iterator[None]:
    """Context for printing: if the output cannot be written, the command continues."""
    try:
        yield
        sys.stdout.flush()
    except SystemExit:
        # `rich` exits this way if the reader, such as `head`, has closed the pipe.
        print_no_more()
    except OSError as error:
        print_no_more()
        if not isinstance(error, BrokenPipeError):
            print(f"sandbox: standard output: {error.strerror}", file=sys.stderr)


def print_no_more() -> None:
    """Discards the output buffer and all further output."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


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
                "no such folder", where=f"{option} {path}", remedy="Create it, or name another"
            )
        if path.is_dir():
            raise InputError("this is a folder", where=f"{option} {path}", expected="a file")
        # A file made for this check is removed again. A symbolic link at the path stays.
        target = path.resolve()
        there = target.exists()
        # Opening a pipe would block until a reader opens it.
        if there and not target.is_file():
            return
        target.open("ab").close()
        if not there:
            target.unlink()
    except (OSError, RuntimeError) as error:
        raise InputError(
            "this file cannot be written",
            where=f"{option} {path}",
            got=why(error),
            remedy="Name a file in a folder in which you can write",
        ) from None
    # Results are first written to a temporary file beside their file.
    check_whole(path, option)


def refuse_same(outputs: Mapping[str, Path | None]) -> None:
    """Checks that two results of a command are written to different files.

    Args:
        outputs: Result files by option; None for no file.

    Raises:
        InputError: Two options name one file.
    """
    named: dict[Path, str] = {}
    for option, path in outputs.items():
        if path is None or path == TERMINAL:
            continue
        other = named.setdefault(resolved(path, option), option)
        if other != option:
            raise InputError(
                "two results would be in one file",
                where=f"{option} {path}",
                got=f"the same file for {other}",
                remedy="Name another file",
            )


def refuse_replacing(
    path: Path | None, sources: Mapping[str, Path | None], option: str = "--out"
) -> None:
    """Checks that a result does not overwrite the files from which it is made.

    Args:
        path: Path of the result; None and `-` overwrite nothing.
        sources: Files and folders that are read, by option; None for no file.
        option: Name of the result's option, for the message.

    Raises:
        InputError: The result is one of these files, or an existing file in one of these folders.
    """
    if path is None or path == TERMINAL:
        return
    target = resolved(path, option)
    for name, source in sources.items():
        if source is None:
            continue
        # A new file in a source folder overwrites nothing.
        inside = source.is_dir() and target.exists() and resolved(source, name) == target.parent
        if inside or resolved(source, name) == target:
            raise InputError(
                "the result would replace a file from which it is made",
                where=f"{option} {path}",
                got=f"the same place as {name}",
                remedy="Name another file",
            )


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
            "the result cannot be written as JSON",
            where=f"--json {path}",
            got=str(error),
            expected="finite numbers",
        ) from None
    if path == TERMINAL:
        print(text)
        return
    # The result has been printed; if writing fails, only the file is missing.
    write_whole(path, text + "\n", "--json")
