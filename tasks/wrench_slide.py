"""Turn and slide a wrench that lies free on the table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.objects import HANDLE, JAW, THICKNESS, Wrench
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.task import Goal, Measure

Array = NDArray[np.float64]

TURN = (np.deg2rad(40.0), np.deg2rad(80.0))
"""rad from start to goal, either way."""
DISTANCE = (0.050, 0.100)
"""m, of the wrench's middle from start to goal."""
MASS = (0.060, 0.150)
"""kg."""
BORDER = 0.036
"""m from the surface's border to the nearest place for a wrench's middle, so that fingers have room
beside the handle."""
END_BORDER = 0.004
"""m from the surface's border to the nearest place for either end of the wrench."""

POSITION_TOLERANCE = 0.010
YAW_TOLERANCE = np.deg2rad(8.0)
TILT_TOLERANCE = np.deg2rad(5.0)
SPEED_TOLERANCE = 0.010
"""m, rad, rad and m/s within which the wrench counts as arrived."""

_TRIES = 4_000
"""Draws before a surface is said to be too small."""


@dataclass(frozen=True)
class WrenchSlide:
    """Turn and slide a free wrench onto its translucent twin.

    Scene: an open-ended wrench of 12 cm, 60 to 150 g, flat on a table; friction 0.3 between them.
    Goal: the wrench's ghost, 5 to 10 cm away and turned by 40 to 80 degrees, either way.
    Success: middle within 1 cm of the goal (horizontally and in height), yaw within 8 degrees, tilt
    under 5 degrees, supported by the table, slower than 1 cm/s and touched by no hand, all for
    0.5 s without a break, within 30 s.
    Start: middles uniform over the surface less a border of 36 mm, yaw uniform over the full
    circle, turn uniform over both ranges; redrawn until the distance is in range and both ends of
    the wrench are 4 mm away from the border, at the start and at the goal.
    History: version 1.
    """

    name: ClassVar[str] = "wrench-slide"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 30.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.3
    touch_height: ClassVar[float] = 0.006
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"

    seed: int
    objects: tuple[Wrench, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> WrenchSlide:
        """The trial of a seed; same seed and surface, same trial.

        Raises:
            InputError: The surface has no room for a start and a goal.
        """
        rng = np.random.default_rng([seed, cls.version, 3])
        low, high = np.full(2, BORDER), surface.size - BORDER
        for _ in range(_TRIES if np.all(high > low) else 0):
            start, end = rng.uniform(low, high), rng.uniform(low, high)
            yaw = float(rng.uniform(-np.pi, np.pi))
            turn = float(rng.uniform(*TURN)) * float(rng.choice([-1.0, 1.0]))
            fits = _on_surface(start, yaw, surface.size)
            fits = fits and _on_surface(end, yaw + turn, surface.size)
            if fits and DISTANCE[0] <= np.linalg.norm(end - start) <= DISTANCE[1]:
                break
        else:
            raise InputError(
                "the surface is too small for this task",
                where=cls.name,
                got=f"{surface.width_in:g}x{surface.height_in:g}in",
                expected="room for two places of a wrench, as on 7.06x4.65in",
            )
        mass = float(rng.uniform(*MASS))
        places = surface.to_world(np.stack([start, end]))[:, :2].tolist()
        half = THICKNESS / 2
        wrench = Wrench("wrench", mass, (*places[0], half), yaw)
        return cls(seed, (wrench,), (Goal("wrench", (*places[1], half), yaw + turn),))

    def measure(self, sensing: Sensing) -> Measure:
        """Whether the wrench is at its goal now."""
        wrench, goal = sensing.object("wrench"), self.goals[0]
        target = np.asarray(goal.position)
        off = float(np.linalg.norm(wrench.position - target))
        turn = _apart(wrench.yaw, goal.yaw)
        reason = ""
        if off > POSITION_TOLERANCE:
            reason = f"the wrench is {1000 * off:.0f} mm from the goal"
        elif wrench.tilt > TILT_TOLERANCE:
            reason = f"the wrench is tilted by {np.rad2deg(wrench.tilt):.0f} degrees"
        elif turn > YAW_TOLERANCE:
            reason = f"the wrench is turned by {np.rad2deg(turn):.0f} degrees against the goal"
        elif not wrench.on_table:
            reason = "the wrench does not lie on the table"
        elif wrench.held:
            reason = "a hand still touches the wrench"
        elif wrench.speed > SPEED_TOLERANCE:
            reason = "the wrench is still moving"
        began = self.objects[0]
        way = float(np.linalg.norm(target - began.position)) - POSITION_TOLERANCE
        arc = _apart(began.yaw, goal.yaw) - YAW_TOLERANCE
        # Half for the slide, half for the turn; nothing but success is 1.
        slid = np.clip(1.0 - max(off - POSITION_TOLERANCE, 0.0) / way, 0.0, 1.0)
        turned = np.clip(1.0 - max(turn - YAW_TOLERANCE, 0.0) / arc, 0.0, 1.0)
        progress = 1.0 if not reason else float(min(0.5 * (slid + turned), 0.99))
        return Measure(not reason, progress, reason)


def _on_surface(middle: Array, yaw: float, size: Array) -> bool:
    """Whether both ends of a wrench are on the surface (its frame: y down)."""
    way = np.array([np.cos(yaw), -np.sin(yaw)])
    ends = middle + np.outer([JAW - 0.012, HANDLE[1]], way)
    return bool(np.all(ends >= END_BORDER) and np.all(ends <= size - END_BORDER))


def _apart(a: float, b: float) -> float:
    """rad between two yaws."""
    return abs(float((a - b + np.pi) % (2 * np.pi) - np.pi))
