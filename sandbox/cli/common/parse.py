"""Command lines become dataclasses; their docstrings become the help."""

from __future__ import annotations

import contextlib
import functools
import inspect
import io
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

import tyro

from models.errors import InputError
from sandbox.cli.common.help_text import OPTIONS, Screen, typed_parameters

T = TypeVar("T")

_SIDES, _RULE = "│|╭╰╮╯+ ", set("─-+╭╰╮╯")
"""The box around what tyro says; where a terminal has only ASCII, it is of that."""
_REST = ("Argument helptext:", "For full helptext", "Descriptions of")
"""Where what is wrong ends, and help begins."""
_MEANT = "Perhaps you meant"


def parse(options: type[T], prog: str, argv: list[str], append: bool = True) -> T:
    """The options of a command.

    With `append`, an option that takes a list takes one value and may be repeated; otherwise it
    takes all values that follow it. What may be given for a second hand is (see `second_hand`).

    Raises:
        InputError: They do not parse.
    """
    if "second_device" in {f.name for f in _fields(options)}:
        # It knows scenes, which take long to load; commands without one need none.
        from sandbox.options.second_hand import named

        argv = named(argv)
    config = (tyro.conf.OmitArgPrefixes, *((tyro.conf.UseAppendAction,) if append else ()))
    return in_one_line(lambda: tyro.cli(options, prog=prog, args=argv, config=config), prog)


def in_one_line(call: Callable[[], T], prog: str) -> T:
    """Runs tyro's parser, and turns its errors, boxes of several lines, into one line.

    Raises:
        InputError: Instead of the box, and the exit with status 2.
    """
    said, screen = io.StringIO(), Screen(sys.stdout)
    try:
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(screen), OPTIONS:
            return call()
    except SystemExit as end:
        if not end.code:
            screen.show()
            sys.stderr.write(said.getvalue())
            raise
        wrong = _wrong(said.getvalue())
    raise InputError(wrong, remedy=f"`{prog} --help` tells all options")


def subcommand(
    commands: Mapping[str, Callable[..., int]], prog: str, description: str, argv: list[str]
) -> int:
    """Runs one of several functions, whose parameters are its options; returns its exit status.

    Raises:
        InputError: The options do not parse.
    """

    def later(function: Callable[..., int]) -> Callable[..., Callable[[], int]]:
        # What it says itself is not to be taken for what tyro says.
        @functools.wraps(function)
        def chosen(*args: Any, **options: Any) -> Callable[[], int]:
            return functools.partial(function, *args, **options)

        # Not what it wraps is asked for its parameters, but it.
        del chosen.__wrapped__
        chosen.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
        chosen.__annotations__ = typed_parameters(function)
        return chosen

    run: Callable[[], int] = in_one_line(
        lambda: tyro.extras.subcommand_cli_from_dict(
            {name: later(function) for name, function in commands.items()},
            prog=prog,
            description=description,
            args=argv,
        ),
        f"{prog} {argv[0]}" if argv and argv[0] in commands else prog,
    )
    return int(run())


def _wrong(box: str) -> str:
    """The error text from tyro's box."""
    errors: list[str] = []
    # The first line of the box is its title.
    for line in box.strip().splitlines()[1:]:
        text = line.strip(_SIDES)
        if set(text) <= _RULE:
            continue
        if text and errors and errors[-1].startswith(_MEANT):
            # Of what follows only the option's name; the rest is its help.
            errors[-1] = f"- perhaps {text.split()[0]}"
            break
        if text.startswith(_REST):
            break
        if text:
            errors.append(text)
        if len(errors) == 2 and errors[0].startswith("Missing from"):
            break
    words = re.sub(r"one of \(([^()]*'None'[^()]*)\)", _without_none, " ".join(errors))
    words = re.sub(r"no type matching .*Got errors:.* - <class '(int|float)'>: ", "", words)
    words = re.sub(
        r"invalid literal for int\(\) with base 10: ('.*')", r"\1 is no whole number", words
    )
    words = re.sub(r"could not convert string to float: ('.*')", r"\1 is no number", words)
    words = words.replace(" (required)", "").replace(" Available", "; available")
    words = words.replace(" Expected 1 values", "")
    return words[:1].lower() + words[1:].rstrip(".") or "these options make no sense"


def _without_none(choices: re.Match[str]) -> str:
    """An option that may be left out has no value of this name; tyro's order is by chance."""
    words = [w for w in choices[1].split(", ") if w != "'None'"]
    return f"one of ({', '.join(sorted(words, key=lambda w: (len(w), w)))})"


def _fields(options: Any) -> tuple[Any, ...]:
    return fields(options) if is_dataclass(options) else ()
