"""Options of one command made from those of another."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, ClassVar, Protocol, TypeVar


class DataclassInstance(Protocol):
    """An object of any dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]


T = TypeVar("T", bound=DataclassInstance)


def picked(kind: type[T], options: DataclassInstance, **changes: Any) -> T:
    """Returns options with the values of those of other options that have the same names.

    Args:
        kind: Class to make.
        options: The other options.
        changes: Values that are not theirs.
    """
    given = {field.name: getattr(options, field.name) for field in fields(options)}
    names = {field.name for field in fields(kind)}
    return kind(**{name: value for name, value in given.items() if name in names} | changes)
