"""Values that are worked out when somebody looks at them, and never if nobody does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Self


class Later:
    """A base for dataclasses of which some fields may be given as a way to work them out.

    What works them out must hold all that it needs and nothing that changes: it may be called at
    any time, from any thread, and even twice. Nor may it hold who keeps what is made: each would
    keep the other until Python looks for garbage.
    """

    @classmethod
    def later(cls, work_out: Callable[[], Mapping[str, Any]], **known: Any) -> Self:
        """An object of which some fields are known already.

        Args:
            work_out: Gives the others by name.
            known: Fields by name. Those with a default value that are in neither have it.
        """
        made = cls.__new__(cls)
        made.__dict__.update(known, _work_out=work_out)
        return made

    if not TYPE_CHECKING:
        # Type checkers are to know the fields of a class, and no others.

        def __getattr__(self, name: str) -> Any:
            """A field that is not there yet."""
            own = self.__dict__
            if name in type(self).__dataclass_fields__ and "_work_out" in own:
                own.update(own["_work_out"]())
                if name in own:
                    return own[name]
            raise AttributeError(f"{type(self).__name__} has no {name}", name=name, obj=self)
