"""Turn and slide a wrench that lies free on the table."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import ClassVar

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.message import Message
from models.objects import HANDLE, JAW, THICKNESS
from models.surface import Surface
from tasks.sensing import ObjectState
from tasks.wrench_base import END_BORDER, Place, WrenchTask, share

TURN = (np.deg2rad(40.0), np.deg2rad(80.0))
"""rad from start to goal, either way."""
DISTANCE = (0.050, 0.100)
"""m, of the wrench's middle from start to goal."""

POSITION_TOLERANCE = 0.010
YAW_TOLERANCE = float(np.deg2rad(8.0))
TILT_TOLERANCE = float(np.deg2rad(5.0))
"""m, rad and rad within which the wrench counts as arrived."""


@dataclass(frozen=True)
class WrenchSlide(WrenchTask):
    """Turn and slide a free wrench onto its translucent twin.

    Scene: an open-ended wrench of 12 cm, 60 to 150 g, flat on a table; friction 0.3 between them.
    Goal: the wrench's ghost, 5 to 10 cm away and turned by 40 to 80 degrees, either way.
    Success: middle within 1 cm of the goal (horizontally and in height), yaw within 8 degrees, tilt
    under 5 degrees, supported by the table, slower than 1 cm/s and touched by no hand, all for
    0.5 s without a break, within 30 s.
    Start: middles uniform over the surface less a border of 36 mm, so that fingers have room beside
    the handle; yaw uniform over the full circle, turn uniform over both ranges; redrawn until the
    distance is in range and both ends of the wrench are 4 mm away from the border, at the start and
    at the goal.
    Size, where it is varied (this does not change the version): all edges of the wrench, about the
    place under its middle. Mass stays. The ends of a larger one may be beyond the border.
    History: version 1.
    """

    name: ClassVar[str] = "wrench-slide"
    version: ClassVar[int] = 1
    stream: ClassVar[int] = 3
    border: ClassVar[float] = 0.036
    room: ClassVar[str] = "two places of a wrench"
    room_in: ClassVar[tuple[float, float]] = (7.06, 4.65)

    @classmethod
    def _way(
        cls, rng: np.random.Generator, low: Array, high: Array, surface: Surface
    ) -> tuple[Place, float, Place, float] | None:
        start, end = rng.uniform(low, high), rng.uniform(low, high)
        yaw = float(rng.uniform(-np.pi, np.pi))
        turn = float(rng.uniform(*TURN)) * float(rng.choice([-1.0, 1.0]))
        fits = _on_surface(start, yaw, surface.size) and _on_surface(end, yaw + turn, surface.size)
        if not fits or not DISTANCE[0] <= length(end - start) <= DISTANCE[1]:
            return None
        (x, y), (u, v) = surface.to_world(np.stack([start, end]))[:, :2].tolist()
        return (x, y, THICKNESS / 2), yaw, (u, v, THICKNESS / 2), turn

    def _missing(self, wrench: ObjectState) -> str:
        off, turn = self._off(wrench), self._turn_left(wrench)
        if off > POSITION_TOLERANCE:
            return Message(
                "wrench_from_goal", "the wrench is {mm} mm from the goal", mm=f"{1000 * off:.0f}"
            )
        if wrench.tilt > TILT_TOLERANCE:
            return Message(
                "wrench_tilted",
                "the wrench is tilted by {degrees} degrees",
                degrees=f"{np.rad2deg(wrench.tilt):.0f}",
            )
        if turn > YAW_TOLERANCE:
            return Message(
                "wrench_turned",
                "the wrench is turned by {degrees} degrees against the goal",
                degrees=f"{np.rad2deg(turn):.0f}",
            )
        if not wrench.on_table:
            return Message("wrench_off_table", "the wrench does not lie on the table")
        return ""

    def _progress(self, wrench: ObjectState) -> float:
        """Progress: half for the slide, half for the turn."""
        way = np.subtract(self.goals[0].position, self.objects[0].position)
        slid = share(self._off(wrench), length(way), POSITION_TOLERANCE)
        return 0.5 * (slid + self._turned(wrench, YAW_TOLERANCE))

    def _off(self, wrench: ObjectState) -> float:
        """Distance in m from the wrench's middle to the goal."""
        return length(wrench.position - self.goals[0].position)


def _on_surface(middle: Array, yaw: float, size: Array) -> bool:
    """True if both ends of a wrench are on the surface (in its frame, y down)."""
    way = np.array([cos(yaw), -sin(yaw)])
    ends = middle + np.outer([JAW - 0.012, HANDLE[1]], way)
    return bool(np.all(ends >= END_BORDER) and np.all(ends <= size - END_BORDER))
