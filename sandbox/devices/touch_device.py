"""Base class of touch devices that are opened with a surface and an argument."""

from __future__ import annotations

from models.surface import Surface
from sandbox.session.device import Device


class TouchDevice(Device):
    """A touch device that the command line opens; a subclass has to define only `poll`.

    It runs until it is closed. A device that ends by itself sets `self.finished = True`, or
    overrides `finished` as a property. `Device` declares the other members that it may override.

    Args:
        surface: The touch surface.
        argument: Text after the colon that follows the device's name on the command line; empty
            without one.
    """

    finished: bool = False

    def __init__(self, surface: Surface, argument: str = "") -> None:
        self.surface, self.argument = surface, argument

    def close(self) -> None:
        """Ends the device and releases its resources; may be called twice."""
        super().close()
        if not isinstance(getattr(type(self), "finished", None), property):
            self.finished = True
