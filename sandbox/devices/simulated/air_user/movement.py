"""Movements of a simulated hand through the air: minimum jerk, with end-point errors and tremor."""

from __future__ import annotations

from math import exp, log2

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from sandbox.devices.simulated.air_user.body import Pinch
from tasks.user import UserConfiguration

_ARM = 0.10
"""m, radius that converts a turn of the wrist to a length of movement."""
_PEAK = 1.875
"""Ratio of peak to mean speed in a minimum-jerk movement."""


class HandMovement:
    """Wanted and actual pose of a hand over time.

    Args:
        start: Initial pose.
        configuration: Speed and precision of the user.
        rng: Random numbers of end-point errors and tremor.
    """

    def __init__(
        self, start: Pinch, configuration: UserConfiguration, rng: np.random.Generator
    ) -> None:
        self._c, self._rng = configuration, rng
        self._from = self._to = start.vector
        self._begin = self._end = 0.0
        self._tremor = np.zeros(3)
        self._last: float | None = None

    @property
    def aim(self) -> Pinch:
        """End of the current or last movement."""
        return Pinch.of(self._to.copy())

    def go(self, aim: Pinch, now: float, slowness: float = 1.0) -> float:
        """Begins a movement; returns the time of its end, s."""
        self._from = self._at(now)
        to = aim.vector
        way = to - self._from
        far = float(length(way[:3]) + _ARM * abs(way[3]) + abs(way[4]) / 2 + np.abs(way[5:]).max())
        # A movement misses its aim by an error in proportion to its length.
        to[:3] += self._c.end_noise * length(way[:3]) * self._rng.standard_normal(3) / 1.7
        to[3] += self._c.end_noise * way[3] * self._rng.standard_normal()
        time = self._c.movement_base + self._c.movement_slope * log2(max(far / 0.002, 1.0))
        time = slowness * max(time, _PEAK * far / self._c.peak_speed)
        self._to, self._begin, self._end = to, now, now + time
        return self._end

    def at(self, now: float) -> Pinch:
        """Actual pose with tremor; must be called in order of time."""
        c = self._c
        step = 0.0 if self._last is None else max(now - self._last, 0.0)
        self._last = now
        keep = exp(-step / c.tremor_time)
        self._tremor = keep * self._tremor + c.tremor * np.sqrt(
            1.0 - keep * keep
        ) * self._rng.standard_normal(3)
        vector = self._at(now)
        vector[:3] += self._tremor
        return Pinch.of(vector)

    def _at(self, now: float) -> Array:
        if now >= self._end:
            return self._to.copy()
        s = max((now - self._begin) / (self._end - self._begin), 0.0)
        return self._from + s * s * s * (10.0 - 15.0 * s + 6.0 * s * s) * (self._to - self._from)
