"""How a hand arrives and leaves: hover above its place, come down, rise again.

What decides whether a task succeeds is less where the hand is than how it gets there (measured with
the simulated user: without these rules, a box is knocked over before it is touched). The hand
hovers as a ghost over its place, comes down from above once it is there and the touches rest, and
rises when they leave.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Phase(StrEnum):
    """Where the hand is on its way."""

    AWAY = "away"
    """No contact: the hand holds its pose up in the air."""
    WAITING = "waiting"
    """Contacts have come, and it is not yet settled which fingers they are."""
    ABOVE = "above"
    """The hand moves to its place, still up."""
    COMING_DOWN = "coming down"
    DOWN = "down"


@dataclass(frozen=True)
class ArrivalSettings:
    """How the hand comes and goes.

    Attributes:
        hover: m above its place at which the hand waits; 0 switches these rules off.
        settle: s for which the set of contacts must be unchanged before fingers are named.
        dwell: s for which the touches must rest before the hand comes down.
        rest: m/s below which touches count as resting.
        patience: s after which the hand comes down although the touches do not rest.
        place: m, how near to its place the hand must be to come down.
        down: m/s.
        up: m/s.
    """

    hover: float = 0.09
    settle: float = 0.10
    dwell: float = 0.10
    rest: float = 0.05
    patience: float = 1.0
    place: float = 0.006
    down: float = 0.40
    up: float = 0.60


class Arrival:
    """The height of a hand above its place, step by step."""

    def __init__(self, settings: ArrivalSettings) -> None:
        self.settings = settings
        self.reset()

    def reset(self) -> None:
        """Back into the air, as at the start."""
        self.phase = Phase.AWAY if self.settings.hover > 0 else Phase.DOWN
        self.height = self.settings.hover
        self._still = 0.0
        self._waited = 0.0

    def step(self, dt: float, *, touched: bool, named: bool, speed: float, off: float) -> None:
        """One step of time.

        Args:
            dt: s.
            touched: Some contact lives; for a hand that is down: one whose finger is known.
            named: The fingers of all contacts are known. One that comes while the hand is down may
                wait for its name without sending the others up again.
            speed: m/s of the fastest contact.
            off: m, how far the hand, seen along the surface's normal, still is from its place.
        """
        s = self.settings
        if s.hover <= 0:
            self.phase = Phase.DOWN if touched and named else Phase.AWAY
            return
        low = self.phase in (Phase.COMING_DOWN, Phase.DOWN)
        if not touched:
            self.phase = Phase.AWAY
        elif not named and not low:
            self.phase = Phase.WAITING
        elif self.phase in (Phase.AWAY, Phase.WAITING):
            self.phase, self._still, self._waited = Phase.ABOVE, 0.0, 0.0
        if self.phase is Phase.ABOVE:
            self._waited += dt
            self._still = self._still + dt if speed < s.rest else 0.0
            ready = self._still >= s.dwell or self._waited >= s.patience
            if ready and off <= s.place:
                self.phase = Phase.COMING_DOWN
        if self.phase is Phase.COMING_DOWN:
            self.height = max(self.height - s.down * dt, 0.0)
            if self.height == 0.0:
                self.phase = Phase.DOWN
        elif self.phase is not Phase.DOWN:
            self.height = min(self.height + s.up * dt, s.hover)
