"""Layout of options in `--help`: whole sentences, and only values that can be typed.

tyro takes what is said of an option out of its class with the indentation of the source, so that
lines end in odd places, offers the value None for what may be left out, and leaves it to the
terminal to break the lines of a description, in the middle of words.
"""

from __future__ import annotations

import inspect
import io
import re
import shutil
import textwrap
from collections.abc import Callable
from dataclasses import is_dataclass, replace
from typing import Annotated, Any, Literal, TextIO, get_args, get_origin, get_type_hints

import tyro
from tyro.constructors import ConstructorRegistry, StructConstructorSpec, StructTypeInfo

OPTIONS = ConstructorRegistry()
"""Given to tyro: how it reads a dataclass of options."""

_asking: list[type] = []
"""Classes that tyro is being asked about: its own rule comes after ours."""


@OPTIONS.struct_rule
def tidy(info: StructTypeInfo) -> StructConstructorSpec | None:
    """Tyro's specification of a dataclass, with its texts in order."""
    if not is_dataclass(info.type) or info.type in _asking:
        return None
    _asking.append(info.type)
    try:
        spec = ConstructorRegistry.get_struct_spec(info)
    finally:
        _asking.pop()
    if not isinstance(spec, StructConstructorSpec):
        return None
    return replace(
        spec,
        fields=tuple(
            replace(f, helptext=_flowing(f.helptext), type=_typed(f.type, f.default))
            for f in spec.fields
        ),
    )


class Screen(io.StringIO):
    """Takes help in the place of a stream; what is a terminal stays one, for the colours."""

    def __init__(self, stream: TextIO) -> None:
        super().__init__()
        self._stream = stream

    def isatty(self) -> bool:
        """True if the stream is a terminal."""
        return self._stream.isatty()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """Encoding of the stream, from which tyro decides whether to draw boxes."""
        return self._stream.encoding

    def show(self) -> None:
        """Writes the collected text to the stream: prose as wide as the terminal, without double
        empty lines."""
        width = shutil.get_terminal_size().columns
        for line in re.sub(r"\n\n\n+", "\n\n", self.getvalue()).splitlines():
            # What is indented is to be typed, and boxes are as wide as the terminal.
            prose = len(line) > width and not line.startswith(" ") and "\x1b" not in line
            self._stream.write((textwrap.fill(line, width) if prose else line) + "\n")


def typed_parameters(function: Callable[..., Any]) -> dict[str, Any]:
    """The same for a function, whose parameters are its options: parameter -> type."""
    hints = get_type_hints(function, include_extras=True)
    parameters = inspect.signature(function).parameters
    return {
        name: _typed(kind, parameters[name].default) if name in parameters else kind
        for name, kind in hints.items()
    }


def _flowing(text: str | Callable[[], str | None] | None) -> Callable[[], str | None]:
    """The same without the source's line breaks, save between paragraphs."""

    def told() -> str | None:
        words = text() if callable(text) else text
        return None if words is None else re.sub(r"(?<!\n)\n[ \t]*(?=[^\s*-])", " ", words)

    return told


def _typed(kind: Any, default: Any) -> Any:
    """The type, with None not among its values, and told to be nothing where it is by itself."""
    if default not in (None, ""):
        return kind
    bare, *said = get_args(kind) if get_origin(kind) is Annotated else (kind,)
    shown = None
    for one in get_args(bare) if default is None else ():
        if get_origin(one) is Literal:
            shown = "{" + ",".join(map(str, get_args(one))) + "}"
        elif one in (int, float, str):
            shown = one.__name__.upper()
    # What a field says of itself comes later, and counts.
    return Annotated[(bare, tyro.conf.arg(metavar=shown, help_behavior_hint=""), *said)]
