"""Command lines become dataclasses; their docstrings become the help."""

from __future__ import annotations

from typing import TypeVar

import tyro

T = TypeVar("T")


def parse(options: type[T], prog: str, argv: list[str], append: bool = True) -> T:
    """The options of a command; exits with status 2 and a message where they do not parse.

    With `append`, an option that takes a list takes one value and may be repeated; otherwise it
    takes all values that follow it.
    """
    config = (tyro.conf.OmitArgPrefixes, *((tyro.conf.UseAppendAction,) if append else ()))
    return tyro.cli(options, prog=prog, args=argv, config=config)
