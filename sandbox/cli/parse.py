"""Command lines become dataclasses; their docstrings become the help."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

import tyro

from sandbox.cli.second_hand import named

T = TypeVar("T")


def parse(options: type[T], prog: str, argv: list[str], append: bool = True) -> T:
    """The options of a command; exits with status 2 and a message where they do not parse.

    With `append`, an option that takes a list takes one value and may be repeated; otherwise it
    takes all values that follow it. What may be given for a second hand is (see `second_hand`).
    """
    if "second_device" in {f.name for f in _fields(options)}:
        argv = named(argv)
    config = (tyro.conf.OmitArgPrefixes, *((tyro.conf.UseAppendAction,) if append else ()))
    return tyro.cli(options, prog=prog, args=argv, config=config)


def _fields(options: Any) -> tuple[Any, ...]:
    return fields(options) if is_dataclass(options) else ()
