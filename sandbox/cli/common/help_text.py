"""Layout of options in `--help`: reflowed text, and only values that can be typed.

tyro keeps the line breaks of the source in help texts, lists the value None for optional values,
and leaves long lines of a description to the terminal, which breaks them in the middle of words.
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
"""Rules for tyro on reading a dataclass of options."""

_in_progress: list[type] = []
"""Classes whose specification by tyro is being computed: our rule skips them."""


@OPTIONS.struct_rule
def reflowed_spec(info: StructTypeInfo) -> StructConstructorSpec | None:
    """Returns tyro's specification of a dataclass with reflowed help texts."""
    if not is_dataclass(info.type) or info.type in _in_progress:
        return None
    _in_progress.append(info.type)
    try:
        spec = ConstructorRegistry.get_struct_spec(info)
    finally:
        _in_progress.pop()
    if not isinstance(spec, StructConstructorSpec):
        return None
    return replace(
        spec,
        fields=tuple(
            replace(f, helptext=_reflowed(f.helptext), type=_without_none(f.type, f.default))
            for f in spec.fields
        ),
    )


class HelpBuffer(io.StringIO):
    """Collects help text for a stream; reports whether the stream is a terminal, for colours."""

    def __init__(self, stream: TextIO) -> None:
        super().__init__()
        self._stream = stream

    def isatty(self) -> bool:
        """True if the stream is a terminal."""
        return self._stream.isatty()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """Encoding of the stream, by which tyro decides whether to draw boxes."""
        return self._stream.encoding

    def show(self) -> None:
        """Writes the collected text to the stream, with prose wrapped and double empty lines
        removed."""
        width = shutil.get_terminal_size().columns
        for line in re.sub(r"\n\n\n+", "\n\n", self.getvalue()).splitlines():
            # Indented lines are commands to type, and boxes already fit the terminal.
            prose = len(line) > width and not line.startswith(" ") and "\x1b" not in line
            self._stream.write((textwrap.fill(line, width) if prose else line) + "\n")


def parameter_types(function: Callable[..., Any]) -> dict[str, Any]:
    """Returns the types of a function's parameters, which are options, for tyro: name -> type."""
    hints = get_type_hints(function, include_extras=True)
    parameters = inspect.signature(function).parameters
    return {
        name: _without_none(kind, parameters[name].default) if name in parameters else kind
        for name, kind in hints.items()
    }


def _reflowed(text: str | Callable[[], str | None] | None) -> Callable[[], str | None]:
    """Returns the text without the source's line breaks, except between paragraphs."""

    def reflow() -> str | None:
        source = text() if callable(text) else text
        return None if source is None else re.sub(r"(?<!\n)\n[ \t]*(?=[^\s*-])", " ", source)

    return reflow


def _without_none(kind: Any, default: Any) -> Any:
    """Returns the type with a placeholder that does not offer None, and without a None default."""
    if default not in (None, ""):
        return kind
    bare, *annotations = get_args(kind) if get_origin(kind) is Annotated else (kind,)
    placeholder = None
    for one in get_args(bare) if default is None else ():
        if get_origin(one) is Literal:
            placeholder = "{" + ",".join(map(str, get_args(one))) + "}"
        elif one in (int, float, str):
            placeholder = one.__name__.upper()
    # Annotations of the field itself come later, and override these.
    return Annotated[
        (bare, tyro.conf.arg(metavar=placeholder, help_behavior_hint=""), *annotations)
    ]
