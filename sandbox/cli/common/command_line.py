"""Parses command lines into dataclasses, or into the parameters of functions, by cyclopts.

The docstrings under the fields of a dataclass are the help of its options.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from types import MappingProxyType, UnionType
from typing import (
    Annotated,
    Any,
    ClassVar,
    NoReturn,
    Protocol,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

from cyclopts import App, Argument, ArgumentCollection, CycloptsError, Group, Parameter
from cyclopts.exceptions import (
    CoercionError,
    MissingArgumentError,
    UnknownCommandError,
    UnknownOptionError,
    UnusedCliTokensError,
)

from models.errors import InputError, unknown_name
from sandbox.cli.common.json_out import HelpExit, print_no_more
from sandbox.trial.trial_options import COMMON, COMMON_SETTINGS, OF_SETTINGS, device_heading


class DataclassInstance(Protocol):
    """An object of any dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]


T = TypeVar("T", bound=DataclassInstance)

FLAT = Parameter(name="*")
"""Options of a dataclass are named by its fields alone."""

SEVERAL = Parameter(consume_multiple=True)
"""An option with a list takes all words up to the next option, and may be repeated."""


def _default_text(default: Any) -> str | None:
    """Returns an option's default as text for the help; None for False, 0 and empty values."""
    if isinstance(default, tuple):
        default = " ".join(map(str, default))
    return str(default) if default else None


_DEFAULTS = Parameter(negative=(), show_default=_default_text, allow_repeating=True)
"""A flag has a `--no-...` form only if it declares one. The last value of a repeated option counts.
"""


DEVICES = "sandbox.devices."
"""Prefix of the modules of devices. The rest of a module's name is the name of the device."""

_NONE: Mapping[type[Any], str] = MappingProxyType({})


def flat(options: type[T], of_devices: Mapping[type[Any], str] = _NONE) -> type[T]:
    """Decorates a dataclass of options, so that an option has the name of its field alone.

    It resolves the type of each field in the module of the class that declares the field. Cyclopts
    would look up all types in the module of `options`, where types of inherited fields may be
    missing.

    Args:
        options: The dataclass.
        of_devices: Option classes of devices, with the headings of their options in the help.
    """
    headings = {base: heading for kind, heading in of_devices.items() for base in kind.__mro__}
    hints = get_type_hints(options, include_extras=True)
    own = inspect.get_annotations(options)
    for name in hints:
        # The first class in order of inheritance that declares the field decides.
        owner = next(kind for kind in options.__mro__ if name in inspect.get_annotations(kind))
        if owner.__name__ in OF_SETTINGS:
            heading = COMMON if name in COMMON_SETTINGS else OF_SETTINGS[owner.__name__]
        elif owner in headings or owner.__module__.startswith(DEVICES):
            heading = device_heading(headings.get(owner, owner.__module__.rpartition(".")[2]))
        else:
            continue
        own[name] = hints[name] = Annotated[hints[name], _of_setting(owner, name, heading)]
    init: Any = options.__init__
    init.__annotations__.update(hints)
    options.__annotations__ = own
    return FLAT(options)


def _of_setting(group: type[Any], name: str, heading: Group) -> Parameter:
    """Returns the option for a field of a group of settings or of a device's options."""
    # A flag that is on by default has only its `--no-...` form.
    negative = f"--no-{name.replace('_', '-')}" if getattr(group, name) is True else ()
    is_text = get_type_hints(group)[name] is str
    metavar = name.rpartition("_")[2].upper() if is_text else None
    field = next(each for each in fields(group) if each.name == name)
    return Parameter(
        group=heading,
        negative=negative,
        metavar=field.metadata.get("metavar", metavar),
        # A position may begin with a negative number.
        allow_leading_hyphen=field.metadata.get("metavar") == "X,Y,Z",
    )


def picked(kind: type[T], options: DataclassInstance, **changes: Any) -> T:
    """Makes options of class `kind` from the fields of other options with the same names.

    Args:
        kind: Class of the result.
        options: Options whose values are copied.
        changes: Values that replace copied ones.
    """
    given = {field.name: getattr(options, field.name) for field in fields(options)}
    names = {field.name for field in fields(kind)}
    return kind(**{name: value for name, value in given.items() if name in names} | changes)


def parse(options: type[T], prog: str, argv: Sequence[str]) -> T:
    """Parses the options of a command.

    Options repeated for a second hand are accepted (see `with_second_names`). A class with a field
    `device_options` takes the options of the devices that the command line names.

    Args:
        options: Dataclass of the options.
        prog: The command, such as `sandbox run`.
        argv: Words of the command line after the command.

    Raises:
        InputError: The options are invalid.
        HelpExit: Help was printed.
    """
    names = {field.name for field in fields(options)}
    if "second_device" in names:
        # This import loads scenes, which is slow; other commands do not need it.
        from sandbox.trial.trial_options import with_second_names

        argv = with_second_names(argv)
    of_devices: dict[type[Any], str] = {}
    if "device_options" in names:
        from sandbox.cli.common.device_options import named_options, with_options

        of_devices = named_options(options, argv)
        extended = with_options(options, of_devices)
    else:
        extended = options
    given: set[str] = set()

    def collect(app: App, commands: tuple[str, ...], arguments: ArgumentCollection) -> None:
        given.update(each.keys[-1] for each in arguments if each.tokens and each.keys)

    def parsed(given: Any) -> Any:
        return given

    parsed.__annotations__ = {"given": flat(extended, of_devices)}
    if all(f.default is not MISSING or f.default_factory is not MISSING for f in fields(options)):
        parsed.__defaults__ = (extended(),)
    app = application(prog, options.__doc__ or "")
    app.default(parsed)
    app.config = (_check_whole_numbers, collect)
    try:
        result = run(app, argv, of_devices.values())
    except HelpExit:
        if "device_options" in names:
            from sandbox.cli.common.device_options import show_hidden_devices

            show_hidden_devices(of_devices.values())
        raise
    more: dict[str, Any] = {}
    if "given" in names:
        more["given"] = frozenset(given & names)
    if "device_options" in names:
        more["device_options"] = {name: getattr(result, name) for name in given - names}
    if not more:
        return cast(T, result)
    return picked(options, result, **more)


def application(name: str, about: str, *functions: Callable[..., int]) -> App:
    """Returns a command with subcommands.

    Args:
        name: Words before a subcommand on the command line, such as `sandbox hand`.
        about: Help of the command, in Markdown.
        functions: The subcommands. A subcommand has the name of its function and the function's
            parameters as options; the function returns an exit status.
    """
    app = App(
        name=name,
        help=inspect.cleandoc(about),
        help_format="markdown",
        version_flags=(),
        default_parameter=_DEFAULTS,
        config=_check_whole_numbers,
        exit_on_error=False,
        print_error=False,
        result_action="return_value",
    )
    app["--help"].show = False
    for function in functions:
        app.command(function)
    return app


def run(app: App, argv: Sequence[str], devices: Iterable[str] = ()) -> Any:
    """Parses a command line and runs its function; returns the function's result.

    Args:
        app: The command.
        argv: Words of the command line after the command.
        devices: Headings of the devices whose options the help shows.

    Raises:
        InputError: The command line is invalid.
        HelpExit: Help was printed.
    """
    try:
        command, bound, _ = app.parse_args(_with_terminal(argv))
    except CycloptsError as error:
        _refuse(error, app.name[0], argv)
    if command == app.help_print:
        # This import loads modules that only the help needs.
        from sandbox.cli.common.help_layout import HelpLayout

        # Cyclopts parses `--help` as a command; its tokens are the words without it.
        _, apps, _ = app.parse_commands(bound.arguments["tokens"])
        options = apps[-1].assemble_argument_collection() if apps[-1].default_command else ()
        defaults = [str(argument.field_info.default) for argument in options]
        app.help_formatter = HelpLayout([*argv, *defaults, *devices])
        try:
            command(*bound.args, **bound.kwargs)
            sys.stdout.flush()
        except SystemExit:
            # `rich` exits this way if the reader, such as `head`, has closed the pipe.
            print_no_more()
        raise HelpExit(0)
    return command(*bound.args, **bound.kwargs)


def _with_terminal(argv: Sequence[str]) -> list[str]:
    """Returns the words with `--json -` (output to the terminal) written as `--json=-`.

    Cyclopts would take the single hyphen for an option.
    """
    words: list[str] = []
    for word in argv:
        if word == "-" and words and words[-1].startswith("--"):
            words[-1] += "=-"
        else:
            words.append(word)
    return words


def _check_whole_numbers(
    app: App, commands: tuple[str, ...], arguments: ArgumentCollection
) -> None:
    """Refuses fractions where whole numbers are expected; cyclopts would round them."""
    for argument in arguments:
        if int in _kinds(argument.hint) and float not in _kinds(argument.hint):
            for token in argument.tokens:
                if "." in token.value:
                    raise CoercionError(argument=argument, token=token, target_type=int)


def _refuse(error: CycloptsError, prog: str, argv: Sequence[str]) -> NoReturn:
    """Raises an `InputError` for an error of cyclopts, with the most similar valid word.

    Raises:
        InputError: Always.
    """
    path = " ".join([prog, *(error.command_chain or ())])
    help_line = f"`{path} --help` lists all options"
    match error:
        case UnknownOptionError():
            word = error.token.keyword or error.token.value
            raise _no_option(word, error.argument_collection, argv, help_line) from None
        case CoercionError(argument=Argument() as argument, token=token) if token is not None:
            where = token.keyword or _label(argument)
            if names := list(argument.get_choices() or ()):
                what = "no such value"
                raise unknown_name(
                    what, token.value, names, where=where, remedy=help_line
                ) from None
            kinds = _kinds(argument.hint)
            what = "not a number" if float in kinds else "no such value"
            what = "not a whole number" if int in kinds else what
            raise InputError(what, where=where, got=token.value, remedy=help_line) from None
        case MissingArgumentError(argument=Argument() as argument):
            if error.keyword is None and not argument.tokens:
                # The missing option may have been misspelt: name the unknown option instead.
                for word in error.unused_tokens or ():
                    if word.startswith("-") and error.app is not None:
                        known = error.app.assemble_argument_collection()
                        raise _no_option(word, known, argv, help_line) from None
                where = _label(argument)
                raise InputError("this is missing", where=where, remedy=help_line) from None
            raise InputError(
                "its value is missing",
                where=error.keyword or argument.name,
                expected=_placeholder(argument),
                remedy=help_line,
            ) from None
        case UnknownCommandError() if error.app is not None:
            word = (error.unused_tokens or argv)[0]
            names = [name for name in error.app if not name.startswith("-")]
            raise unknown_name("no such command", word, names, where=path) from None
        case UnusedCliTokensError():
            words = " ".join(error.unused_tokens or ())
            raise InputError("too many words", where=path, got=words, remedy=help_line) from None
    error.verbose = False
    raise InputError(" ".join(str(error).split()), remedy=help_line) from None


def _no_option(
    word: str, known: ArgumentCollection, argv: Sequence[str], help_line: str
) -> InputError:
    """Returns the error for an unknown option, with the most similar known option."""
    word = word.partition("=")[0]
    if "--device" in (name for argument in known for name in argument.names):
        from sandbox.devices.registry import devices_with_option

        if devices := devices_with_option(word.removeprefix("--").replace("-", "_")):
            if any(each.removeprefix("--device=") in devices for each in argv):
                return InputError(
                    "this command does not accept options of devices",
                    where=word,
                    remedy=help_line,
                )
            return InputError(
                "this option belongs to another device",
                where=word,
                expected=f"--device {' or '.join(devices)}",
                remedy=help_line.replace("--help", f"--device {devices[0]} --help"),
            )
    names = [name for argument in known if argument.parse for name in argument.names]
    near = unknown_name("no such option", word, names)
    return near if near.remedy else InputError(near.what, got=word, remedy=help_line)


def _kinds(hint: Any) -> set[Any]:
    """Returns the types of a hint without None; for tuples and lists, those of their elements."""
    if get_origin(hint) in (Union, UnionType, tuple, list):
        return set().union(*(_kinds(part) for part in get_args(hint) if part is not type(None)))
    if get_origin(hint) is Annotated:
        return _kinds(get_args(hint)[0])
    return {hint}


def _label(argument: Argument) -> str:
    """Returns the name of a required argument: an option, or capitals if it is positional."""
    return argument.name.lstrip("-").upper() if argument.index is not None else argument.name


def _placeholder(argument: Argument) -> str:
    """Returns the placeholder for an option's value, such as HOST:PORT."""
    if argument.parameter.metavar:
        return argument.parameter.metavar
    if choices := argument.get_choices():
        return f"one of {', '.join(choices)}"
    names = {int: "INT", float: "FLOAT", Path: "PATH"}
    return next((names[kind] for kind in _kinds(argument.hint) if kind in names), "TEXT")
