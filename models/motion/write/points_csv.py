"""Writes points as a CSV table, key by key: `time` (s), then x, y, z of each point (m, world, z
up)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from models.motion.armature import Keys
from models.motion.output import MotionWriter, checked_rate, rows
from models.motion.points import HandPoints

DECIMALS = 9
"""Decimals: nanometres and nanoseconds."""


class PointsCsvWriter(MotionWriter):
    """Points of any number of hands as CSV.

    Args:
        path: Path of the file.
        points: The points to write.
        rate: Hz of the keys.
    """

    def __init__(self, path: Path, points: HandPoints, rate: float) -> None:
        self._points, self._rate = points, checked_rate(rate)
        super().__init__(path)
        columns = ["time", *(f"{name}_{axis}" for name in points.labels for axis in "xyz")]
        self._outputs[0].write((",".join(columns) + "\n").encode("ascii"))
        self._line = ",".join([f"%.{DECIMALS}f"] * len(columns)) + "\n"

    def write(self, *hands: Keys) -> None:
        """Appends keys of all hands at the same moments."""
        places = self._points.place(hands)
        time = np.arange(self.frames, self.frames + len(places)) / self._rate
        values = np.concatenate([time[:, None], places.reshape(len(places), -1)], axis=1)
        self._outputs[0].write(rows(values, self._line, DECIMALS))
        self.frames += len(places)
