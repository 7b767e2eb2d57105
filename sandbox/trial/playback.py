"""Playback of a replayed trial: at any speed, paused, or step by step in both directions.

A replay is many times faster than the trial was. It is simulated to its end first; playback then
shows its snapshots, so that going back needs no simulation.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from models.scene import CONTROL_PERIOD
from sandbox.session.messages import Snapshot


class Playback:
    """Position in a sequence of snapshots that moves with the clock.

    Args:
        snapshots: One for every control period; at least one.
        speed: Simulated seconds per second.
        clock: Returns the time, s.
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
        """True while playback is paused."""
        return self._paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._go()
        self._paused = paused

    @property
    def now(self) -> Snapshot:
        """The snapshot to show now."""
        self._go()
        return self._snapshots[int(self._place)]

    @property
    def at_end(self) -> bool:
        """True if the last snapshot is reached."""
        self._go()
        return int(self._place) == len(self._snapshots) - 1

    def move(self, steps: int) -> None:
        """Moves by a number of control periods, negative backwards; stops at either end.

        The place is then the beginning of a period; 0 leaves it where it is.
        """
        if not steps:
            return
        self._go()
        self._place = float(min(max(int(self._place) + steps, 0), len(self._snapshots) - 1))

    def restart(self) -> None:
        """Plays again from the beginning."""
        self.move(-len(self._snapshots))
        self.paused = False

    def _go(self) -> None:
        now = self._clock()
        passed, self._since = now - self._since, now
        if not self._paused:
            last = len(self._snapshots) - 1
            # Rounded, so that a whole number of periods is not slightly less.
            place = self._place + passed * self._speed / CONTROL_PERIOD
            self._place = min(round(place, 9), float(last))
