"""A simulated person's five fingers in three spreads, as a device: for trying the calibration."""

from __future__ import annotations

import math
from collections.abc import Sequence

from models.frames import TouchFrame
from models.person import Person
from models.surface import Surface
from sandbox.session.device import Device
from tasks.simulated_user.spreads import SpreadingPerson


class SimulatedSpreads(Device):
    """A tablet under the fingers of somebody who is asked for three spreads.

    Args:
        person: Which hand, how large, and from where.
        surface: The tablet.
        seed: Of place, turn and noise.
    """

    name = "simulated"

    def __init__(self, person: Person, surface: Surface, seed: int) -> None:
        self._fingers = SpreadingPerson(person, surface, seed)
        self._now = 0.0

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """What is touched now."""
        if self._now == math.inf:
            return []
        self._now = now
        return [self._fingers.touch(now)]

    @property
    def finished(self) -> bool:
        """Whether the last finger has left."""
        return self._now > self._fingers.ends

    def close(self) -> None:
        """The person leaves; there is nothing to give back."""
        self._now = math.inf
