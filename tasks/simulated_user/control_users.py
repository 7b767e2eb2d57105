"""Control users who do nothing or touch at random: their success rate is the task's chance level.

`Slider` is the lift control in the other hand of a user, slow to start and inexact.
"""

from __future__ import annotations

import numpy as np

from models.frames import TouchFrame
from models.surface import Surface
from tasks.simulated_user.hand import Fingers, minimum_jerk
from tasks.user import Sight, UserConfiguration


class IdleUser:
    """Touches nothing."""

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        self.configuration = configuration

    def observe(self, sight: Sight) -> None:
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

    def observe(self, sight: Sight) -> None:
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


NOISE = 0.03
"""Share of the slider's travel: standard deviation of each reading, unless it rests at its lower
end."""
_MISS = 0.03
"""Share of a movement's length by which it misses (standard deviation)."""
_BASE, _RATE = 0.30, 0.8
"""s for a short movement, and shares of the slider's travel per second in a long one."""
_STOP = 0.004
"""Share of the slider's travel: nearer to its lower end it rests there."""


class Slider:
    """A lift control in the user's other hand.

    Args:
        reach: m by which the simulated hand rises over the slider's full travel; the user knows it
            from trying.
        rng: The user's source of randomness.
    """

    def __init__(self, reach: float, rng: np.random.Generator) -> None:
        self._reach, self._rng = reach, rng
        self._start = self._end = 0.0
        self._begin, self._duration = 0.0, 1e-9

    def height(self, now: float) -> float:
        """Intended height of the hand, m."""
        return self._reach * self._at(now)

    def move(self, height: float, now: float) -> float:
        """Moves towards a height, m; returns the time of arrival."""
        start = self._at(now)
        end = float(np.clip(height / self._reach, 0.0, 1.0))
        if end > _STOP:
            end += float(self._rng.normal(0.0, _MISS * abs(end - start)))
        self._start, self._end = start, float(np.clip(end, 0.0, 1.0))
        self._begin, self._duration = now, _BASE + abs(self._end - start) / _RATE
        return now + self._duration

    def control(self, now: float) -> float:
        """Reading of the device, 0 to 1."""
        share = self._at(now)
        if share <= _STOP:
            return 0.0
        return min(max(share + float(self._rng.normal(0.0, NOISE)), 0.0), 1.0)

    def _at(self, now: float) -> float:
        share = minimum_jerk((now - self._begin) / self._duration)
        return self._start + share * (self._end - self._start)


class IdleLiftUser(IdleUser):
    """Control user that does not touch, and leaves the slider where it is.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
        reach: See `Slider`.
    """

    def __init__(
        self, configuration: UserConfiguration, surface: Surface, seed: int, reach: float
    ) -> None:
        super().__init__(configuration, surface, seed)


class RandomLiftUser(RandomUser):
    """Control user that touches and moves the slider at random.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
        reach: See `Slider`.
    """

    def __init__(
        self, configuration: UserConfiguration, surface: Surface, seed: int, reach: float
    ) -> None:
        super().__init__(configuration, surface, seed)
        self._other = np.random.default_rng([seed, 7_004])
        self._slider = Slider(reach, self._other)
        self._reach = reach
        self._moved = 0.0

    def touch(self, now: float) -> TouchFrame:
        """Random touches and a random position of the slider."""
        if now >= self._moved:
            height = float(self._other.uniform(-0.5, 1.0)) * self._reach
            arrival = self._slider.move(max(height, 0.0), now)
            self._moved = arrival + float(self._other.uniform(0.0, 1.0))
        frame = super().touch(now)
        return TouchFrame(now, frame.contacts, self._slider.control(now), source=frame.source)
