"""The other hand, at a slider that lifts: slow to start, never quite where it should be."""

from __future__ import annotations

import numpy as np

from models.frames import TouchFrame
from models.surface import Surface
from tasks.simulated_user.control_arms import IdleUser, RandomUser
from tasks.simulated_user.fingers import minimum_jerk
from tasks.user import UserConfiguration

NOISE = 0.03
"""Of the slider's way: standard deviation of each reading, unless it rests at its lower end."""
_MISS = 0.03
"""Of a movement's length by which it misses (standard deviation)."""
_BASE, _RATE = 0.30, 0.8
"""s for a short movement, and shares of the slider's way per second on a long one."""
_STOP = 0.004
"""Of the slider's way: nearer to its lower end it rests there."""


class Slider:
    """A lift control in the user's other hand.

    Args:
        reach: m by which the hand on the screen rises over the slider's whole way; a person has
            moved it up and down before, and knows.
        rng: The user's own randomness.
    """

    def __init__(self, reach: float, rng: np.random.Generator) -> None:
        self._reach, self._rng = reach, rng
        self._start = self._end = 0.0
        self._begin, self._duration = 0.0, 1e-9

    def height(self, now: float) -> float:
        """m, how high the slider is meant to hold the hand."""
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
        """0 to 1, what the device reads."""
        share = self._at(now)
        if share <= _STOP:
            return 0.0
        return min(max(share + float(self._rng.normal(0.0, NOISE)), 0.0), 1.0)

    def _at(self, now: float) -> float:
        share = minimum_jerk((now - self._begin) / self._duration)
        return self._start + share * (self._end - self._start)


class IdleLiftUser(IdleUser):
    """Touches nothing, and leaves the slider where it is.

    Args:
        configuration: What kind of person.
        surface: The tablet.
        seed: Of what is left to chance.
        reach: See `Slider`.
    """

    def __init__(
        self, configuration: UserConfiguration, surface: Surface, seed: int, reach: float
    ) -> None:
        super().__init__(configuration, surface, seed)


class RandomLiftUser(RandomUser):
    """Touches at random, and moves the slider at random.

    Args:
        configuration: What kind of person.
        surface: The tablet.
        seed: Of what is left to chance.
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
        """Random touches, and the slider somewhere."""
        if now >= self._moved:
            height = float(self._other.uniform(-0.5, 1.0)) * self._reach
            arrival = self._slider.move(max(height, 0.0), now)
            self._moved = arrival + float(self._other.uniform(0.0, 1.0))
        frame = super().touch(now)
        return TouchFrame(now, frame.contacts, self._slider.control(now), source=frame.source)
