"""What is printed may find no reader, or a full disk; what a command does must not depend on it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import TextIOWrapper


def prepare() -> None:
    """Makes standard output and error such that any text can be printed.

    A closed one takes everything and shows nothing. Where the encoding lacks a character, its
    number is printed; UTF-8 lacks halves of pairs, as of an emoji that was cut, and as in file
    names of other bytes.
    """
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - for the whole run
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - for the whole run
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


class HelpExit(SystemExit):
    """The end of a program that was asked for help, and showed it."""


@contextmanager
def printing() -> Iterator[None]:
    """Context that only prints: if nobody can read it, the command goes on all the same."""
    try:
        yield
        sys.stdout.flush()
    except SystemExit:
        # So ends `rich` a program whose reader has left, as `head` does.
        print_no_more()
    except OSError as error:
        print_no_more()
        if not isinstance(error, BrokenPipeError):
            print(f"sandbox: standard output: {error.strerror}", file=sys.stderr)


def print_no_more() -> None:
    """Sends what is printed from now on, and what is in the buffer, nowhere."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
