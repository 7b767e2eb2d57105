"""Looking at a trial that was replayed: at real time or slower, stopped, or step by step.

A replay is many times faster than the trial was. It is played to its end first, and what is looked
at are its snapshots, which know all that a view shows; so going back costs nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from models.scene import CONTROL_PERIOD
from sandbox.session.messages import Snapshot


class Playback:
    """A place in a row of snapshots that moves with the clock.

    Args:
        snapshots: One for every control period; one at least.
        speed: Simulated seconds per second.
        clock: Tells the time, s.
    """

    def __init__(
        self,
        snapshots: Sequence[Snapshot],
        speed: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._snapshots, self._clock = snapshots, clock
        self._speed, self._paused = speed, False
        self._place, self._since = 0.0, clock()

    @property
    def speed(self) -> float:
        """Simulated seconds per second."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._go()
        self._speed = speed

    @property
    def paused(self) -> bool:
        """Whether time stands still."""
        return self._paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._go()
        self._paused = paused

    @property
    def now(self) -> Snapshot:
        """What is to be seen now."""
        self._go()
        return self._snapshots[int(self._place)]

    @property
    def at_end(self) -> bool:
        """Whether the last snapshot is to be seen."""
        self._go()
        return int(self._place) == len(self._snapshots) - 1

    def move(self, steps: int) -> None:
        """Goes so many control periods on, or back; stops at either end."""
        self._go()
        self._place = float(min(max(int(self._place) + steps, 0), len(self._snapshots) - 1))

    def restart(self) -> None:
        """Goes back to the beginning, and on from there."""
        self.move(-len(self._snapshots))
        self.paused = False

    def _go(self) -> None:
        now = self._clock()
        passed, self._since = now - self._since, now
        if not self._paused:
            last = len(self._snapshots) - 1
            # A whole number of periods is that number, and not a hair less.
            place = self._place + passed * self._speed / CONTROL_PERIOD
            self._place = min(round(place, 9), float(last))
