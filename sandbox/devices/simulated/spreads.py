"""A simulated person's five fingers in three spreads, as a device for testing the calibration."""

from __future__ import annotations

import math
from collections.abc import Sequence

from models.frames import TouchFrame
from models.person import Person
from models.surface import Surface
from sandbox.devices.device import Device
from tasks.simulated_user.spreads import SpreadingPerson


class SimulatedSpreads(Device):
    """A tablet under the fingers of a simulated person who makes three spreads.

    Args:
        person: Side and size of the hand, and where the person sits.
        surface: The tablet's touch surface.
        seed: Seed of position, turn and noise.
    """

    name = "simulated"

    def __init__(self, person: Person, surface: Surface, seed: int) -> None:
        self._fingers = SpreadingPerson(person, surface, seed)
        self._now = 0.0

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The touches now."""
        if self.finished:
            return []
        self._now = now
        return [self._fingers.touch(now)]

    @property
    def finished(self) -> bool:
        """True once the last finger has left."""
        return self._now > self._fingers.ends

    def close(self) -> None:
        """Ends the device; there is nothing to release."""
        self._now = math.inf
