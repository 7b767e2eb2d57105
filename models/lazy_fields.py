"""Dataclass fields that are computed on first access."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Self


class LazyFields:
    """Base class for dataclasses with lazy fields: a function computes them on first access.

    The function must hold all data that it needs, and none that changes: it may be called at any
    time, from any thread, even twice. It must not refer to an owner of the result: such a cycle of
    references would keep both alive until Python's garbage collector runs.
    """

    @classmethod
    def deferred(cls, compute: Callable[[], Mapping[str, Any]], **known: Any) -> Self:
        """Creates an object with some known fields; the others are computed on demand.

        Args:
            compute: Returns the other fields by name.
            known: Known fields by name. A field in neither keeps its default value.
        """
        made = cls.__new__(cls)
        made.__dict__.update(known, _compute=compute)
        return made

    if not TYPE_CHECKING:
        # Hidden from type checkers, which then accept only the fields that a class declares.

        def __getattr__(self, name: str) -> Any:
            """Computes the missing fields and returns the requested one."""
            own = self.__dict__
            if name in type(self).__dataclass_fields__ and "_compute" in own:
                own.update(own["_compute"]())
                if name in own:
                    return own[name]
            raise AttributeError(f"{type(self).__name__} has no {name}", name=name, obj=self)
