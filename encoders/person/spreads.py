"""Finds the moments at which five fingers rest on a screen, with one layout for each."""

from __future__ import annotations

import numpy as np

from models.arithmetic import Array
from models.frames import FINGERS, TouchFrame

REST = 0.5
"""s that all five fingers must rest."""
STILL = 0.004
"""m, largest movement of a resting finger from its first position."""


class SpreadCollector:
    """Processes touch frames, and stores the layout of every rest of five fingers.

    Between two rests at least one finger must leave the screen: if a hand slid from one spread to
    the next, the moment of its arrival would be unknown.

    Attributes:
        layouts: (5, 2) m each, mean positions of a rest, in order of contact id.
        down: Number of contacts on the screen now.
    """

    def __init__(self) -> None:
        self.layouts: list[Array] = []
        self.down = 0
        self._ids: list[int] = []
        self._since = 0.0
        self._seen: list[Array] = []
        self._taken = False

    def step(self, frame: TouchFrame) -> bool:
        """Processes a frame; returns true if it completes a layout."""
        contacts = sorted(frame.contacts, key=lambda c: c.id)
        self.down = len(contacts)
        ids = [c.id for c in contacts]
        if len(contacts) != len(FINGERS):
            self._begin([], frame.time)
            return False
        xy = np.array([(c.x, c.y) for c in contacts])
        if ids != self._ids:
            self._begin(ids, frame.time)
        elif float(np.abs(xy - self._seen[0]).max()) > STILL:
            self._begin(ids, frame.time, self._taken)
        self._seen.append(xy)
        if self._taken or frame.time - self._since < REST - 1e-9:
            return False
        self.layouts.append(np.mean(self._seen, axis=0))
        self._taken = True
        return True

    def _begin(self, ids: list[int], time: float, taken: bool = False) -> None:
        self._ids, self._since, self._seen, self._taken = ids, time, [], taken
