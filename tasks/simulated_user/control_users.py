"""Control users who do nothing or touch at random: their success rate is the task's chance
level."""

from __future__ import annotations

import numpy as np

from models.frames import TouchFrame
from models.surface import Surface
from tasks.simulated_user.fingers import Fingers
from tasks.user import Sight, UserConfiguration


class IdleUser:
    """Touches nothing."""

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        self.configuration = configuration

    def look(self, sight: Sight) -> None:
        """Ignores the screen."""

    def touch(self, now: float) -> TouchFrame:
        """No contact."""
        return TouchFrame(now, source="simulated user")


class RandomUser:
    """Touches at random: puts fingers down, drags and lifts them anywhere."""

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        self.configuration, self.surface = configuration, surface
        self._rng = np.random.default_rng([seed, 7_002])
        self._fingers = Fingers(configuration, self._rng)
        self._until = 0.0
        self._moves = 0

    def look(self, sight: Sight) -> None:
        """Ignores the screen."""

    def touch(self, now: float) -> TouchFrame:
        """Random touches."""
        if now >= self._until - 1e-9:
            self._act(now)
        return TouchFrame(now, self._fingers.touches(now, self.surface), source="simulated user")

    def _act(self, now: float) -> None:
        c = self.configuration
        if self._moves == 0:
            middle = self.surface.to_world(self._rng.uniform(0.0, 1.0, 2) * self.surface.size)[:2]
            spread = self._rng.uniform(-0.05, 0.05, (c.fingers, 2))
            self._fingers.land(middle + spread, now)
            self._until = now + 0.5
        elif self._moves < 4:
            shift = self._rng.uniform(-0.06, 0.06, 2)
            pivot = self._fingers.places(now).mean(axis=0)
            turn = float(self._rng.uniform(-0.8, 0.8))
            self._until = self._fingers.carry(shift, turn, pivot, now) + 0.1
        else:
            self._fingers.lift(now)
            self._until = now + 0.5
        self._moves = (self._moves + 1) % 5
