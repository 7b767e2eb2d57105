"""Drop-outs: a bad screen loses a touch for a moment and reports it again under another id."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.frames import TouchFrame

LENGTH = 0.1
"""s, duration of a drop-out."""

_FIRST_ID = 1_000_000
"""First id of touches that come back on a simulated screen."""


class DropOuts:
    """Loses touches at random.

    Args:
        rate: 1/s, drop-outs of every touch.
        seed: Seed of the random drop-outs.
        first: First id of touches that come back; no other touches may have such ids.

    Attributes:
        given: The device's own id of every touch that came back, by the id that it then got.
    """

    def __init__(self, rate: float, seed: int, first: int = _FIRST_ID) -> None:
        self._rate = rate
        self._rng = np.random.default_rng([seed, 7_003])
        self._alias: dict[int, int] = {}
        self._back_at: dict[int, float] = {}
        self.given: dict[int, int] = {}
        self._next = first
        self._time = 0.0

    @property
    def loses(self) -> bool:
        """True if it loses touches; otherwise a touch keeps its id."""
        return self._rate > 0.0

    def degrade(self, frame: TouchFrame) -> TouchFrame:
        """The frame as the bad screen reports it."""
        dt, self._time = frame.time - self._time, frame.time
        if self._rate <= 0.0:
            return frame
        contacts = []
        for contact in frame.contacts:
            own = contact.id
            if own in self._back_at:
                if frame.time < self._back_at[own]:
                    continue
                del self._back_at[own]
                self._alias[own] = self._next
                self.given[self._next] = own
                self._next += 1
            elif self._rng.random() < self._rate * dt:
                self._back_at[own] = frame.time + LENGTH
                continue
            contacts.append(replace(contact, id=self._alias.get(own, own)))
        cancelled = frozenset(self._alias.get(own, own) for own in frame.cancelled)
        return replace(frame, contacts=tuple(contacts), cancelled=cancelled)

    def own_id(self, reported: int) -> int:
        """The device's own id of a reported id."""
        return self.given.get(reported, reported)
