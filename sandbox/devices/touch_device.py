"""Base class of touch devices that are opened with a surface and an argument."""

from __future__ import annotations

from models.surface import Surface
from sandbox.session.device import Device


class TouchDevice(Device):
    """A touch device that the command line opens; a subclass has to write only `poll`.

    It goes on until it is closed; one that ends by itself sets `finished`. `Device` declares what
    else it may override.

    Args:
        surface: Its size is in metres.
        argument: What stands after the device's name on the command line; empty without one.
    """

    finished: bool = False

    def __init__(self, surface: Surface, argument: str = "") -> None:
        self.surface, self.argument = surface, argument

    def close(self) -> None:
        """Gives back what it holds; may be called twice. Nothing comes any more."""
        self.finished = True
