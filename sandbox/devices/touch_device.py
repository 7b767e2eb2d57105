"""What a touch device of one's own need not write: a name, an end, and being closed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

from models.frames import TouchFrame
from models.surface import Surface


class TouchDevice(ABC):
    """A device that goes on until it is closed; what it is made from has to say only `poll`.

    Args:
        surface: Its size is in metres.
        argument: What stands after the device's name on the command line; empty without one.

    Attributes:
        name: In messages and logs; the class's own, unless said otherwise.
        finished: Whether it has been closed; a device that ends by itself sets it.
    """

    name: str = ""
    finished: bool = False

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.name = cls.__dict__.get("name") or cls.__name__

    def __init__(self, surface: Surface, argument: str = "") -> None:
        self.surface, self.argument = surface, argument

    @abstractmethod
    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Frames since the last call, oldest first; returns at once.

        Args:
            now: Session time, s; a live device ignores it.
        """

    def close(self) -> None:
        """Gives back what it holds; may be called twice. Nothing comes any more."""
        self.finished = True
