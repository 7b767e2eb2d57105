"""Dataclass fields that are computed on first access."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Self


class Later:
    """Base class for dataclasses with lazy fields: a function computes them on first access.

    The function must hold all data that it needs, and none that changes: it may be called at any
    time, from any thread, even twice. It must not refer to an owner of the result: the two would
    keep each other alive until Python's garbage collector runs.
    """

    @classmethod
    def later(cls, work_out: Callable[[], Mapping[str, Any]], **known: Any) -> Self:
        """Creates an object of which only some fields are known already.

        Args:
            work_out: Returns the other fields by name.
            known: Fields by name. A field in neither keeps its default value.
        """
        made = cls.__new__(cls)
        made.__dict__.update(known, _work_out=work_out)
        return made

    if not TYPE_CHECKING:
        # Hidden from type checkers, which then accept only the fields that a class declares.

        def __getattr__(self, name: str) -> Any:
            """Computes the missing fields and returns the one asked for."""
            own = self.__dict__
            if name in type(self).__dataclass_fields__ and "_work_out" in own:
                own.update(own["_work_out"]())
                if name in own:
                    return own[name]
            raise AttributeError(f"{type(self).__name__} has no {name}", name=name, obj=self)
