"""Parses command lines into dataclasses, whose docstrings become the help."""

from __future__ import annotations

import contextlib
import functools
import inspect
import io
import re
import sys
from collections.abc import Callable, Container, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

import tyro

from models.errors import InputError
from sandbox.cli.common.help_text import OPTIONS, HelpBuffer, parameter_types
from sandbox.cli.common.printing import HelpShown

T = TypeVar("T")

_SIDES, _RULE = "│|╭╰╮╯+ ", set("─-+╭╰╮╯")
"""Characters of the box around tyro's errors, in Unicode and in ASCII."""
_HELP_STARTS = ("Argument helptext:", "For full helptext", "Descriptions of")
"""Beginnings of lines at which the error ends and help follows."""
_MEANT = "Perhaps you meant"
_LACKING = re.compile(r"missing value for argument '(--[\w-]+)'")
"""The error of an option at the end of the line, or before another one."""


def parse(options: type[T], prog: str, argv: list[str], append: bool = True) -> T:
    """Parses the options of a command.

    With `append`, an option with a list takes one value and may be repeated; otherwise it takes all
    values that follow it. Options repeated for a second hand are accepted (see `second_hand`).

    Raises:
        InputError: The options are invalid.
    """
    if "second_device" in {f.name for f in _fields(options)}:
        # This import loads scenes, which is slow; other commands do not need it.
        from sandbox.options.second_hand import with_second_names

        argv = with_second_names(argv)
    config = (tyro.conf.OmitArgPrefixes, *((tyro.conf.UseAppendAction,) if append else ()))
    return with_one_line_errors(
        lambda words: tyro.cli(options, prog=prog, args=words, config=config), argv, prog
    )


def with_one_line_errors(
    call: Callable[[list[str]], T], argv: list[str], prog: str, commands: Container[str] = ()
) -> T:
    """Runs tyro's parser and turns its errors, which are boxes of several lines, into one line.

    Args:
        call: Parses the words of a command line.
        argv: The words.
        prog: What stands before them.
        commands: Names of commands, of which the first word is one.

    Raises:
        InputError: The options are invalid.
        HelpShown: Help was asked for.
    """
    errors, screen = io.StringIO(), HelpBuffer(sys.stdout)
    try:
        with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(screen), OPTIONS:
            return call(argv)
    except SystemExit as end:
        if not end.code:
            screen.show()
            sys.stderr.write(errors.getvalue())
            raise HelpShown(0) from None
        error = _error_text(errors.getvalue())
    command = argv[:1] if argv and argv[0] in commands else []
    if lacking := _LACKING.fullmatch(error):
        value = _value_of(lacking[1], lambda: call([*command, "--help"]))
        error = f"{lacking[1]}: its value is missing" + (f" (expected {value})" if value else "")
    remedy = f"`{' '.join([prog, *command])} --help` lists all options"
    raise InputError(error, remedy=remedy)


def _value_of(option: str, show_help: Callable[[], object]) -> str:
    """What stands behind an option in the help, such as HOST:PORT; empty if nothing does."""
    screen = io.StringIO()
    with contextlib.redirect_stdout(screen), OPTIONS, contextlib.suppress(SystemExit):
        show_help()
    # The list of options has two columns before each; the text above it names some without.
    found = re.search(rf"^[│| ] (?:-\w, )?{re.escape(option)} (\S+)", screen.getvalue(), re.M)
    return found[1] if found else ""


def subcommand(
    commands: Mapping[str, Callable[..., int]], prog: str, description: str, argv: list[str]
) -> int:
    """Runs one of several functions, with options as parameters, and returns its exit status.

    Raises:
        InputError: The options do not parse.
    """

    def deferred(function: Callable[..., int]) -> Callable[..., Callable[[], int]]:
        # The function runs after the parser, so that its output is not taken for the parser's.
        @functools.wraps(function)
        def wrapper(*args: Any, **options: Any) -> Callable[[], int]:
            return functools.partial(function, *args, **options)

        # tyro must inspect this wrapper, not the wrapped function.
        del wrapper.__wrapped__
        wrapper.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
        wrapper.__annotations__ = parameter_types(function)
        return wrapper

    run: Callable[[], int] = with_one_line_errors(
        lambda words: tyro.extras.subcommand_cli_from_dict(
            {name: deferred(function) for name, function in commands.items()},
            prog=prog,
            description=description,
            args=words,
        ),
        argv,
        prog,
        commands,
    )
    return int(run())


def _error_text(box: str) -> str:
    """Returns the error text in tyro's box."""
    errors: list[str] = []
    # The first line of the box is its title.
    for line in box.strip().splitlines()[1:]:
        text = line.strip(_SIDES)
        if set(text) <= _RULE:
            continue
        if text and errors and errors[-1].startswith(_MEANT):
            # The next line begins with the option's name; the rest is its help.
            errors[-1] = f"- perhaps {text.split()[0]}"
            break
        if text.startswith(_HELP_STARTS):
            break
        if text:
            errors.append(text)
        if len(errors) == 2 and errors[0].startswith("Missing from"):
            break
    words = re.sub(r"one of \(([^()]*'None'[^()]*)\)", _without_none, " ".join(errors))
    words = re.sub(r"no type matching .*Got errors:.* - <class '(int|float)'>: ", "", words)
    words = re.sub(
        r"invalid literal for int\(\) with base 10: ('.*')", r"\1 is not a whole number", words
    )
    words = re.sub(r"could not convert string to float: ('.*')", r"\1 is not a number", words)
    words = words.replace(" (required)", "").replace(" Available", "; available")
    words = words.replace(" Expected 1 values", "")
    return words[:1].lower() + words[1:].rstrip(".") or "invalid options"


def _without_none(choices: re.Match[str]) -> str:
    """Returns the choices of an option without None, sorted, since tyro's order varies."""
    words = [w for w in choices[1].split(", ") if w != "'None'"]
    return f"one of ({', '.join(sorted(words, key=lambda w: (len(w), w)))})"


def _fields(options: Any) -> tuple[Any, ...]:
    return fields(options) if is_dataclass(options) else ()
