"""Turn a wrench that sits on a bolt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.objects import BOLT_LIFT, HANDLE, JAW, THICKNESS, Wrench
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.task import Goal, Measure

Array = NDArray[np.float64]

TURN = (np.deg2rad(40.0), np.deg2rad(90.0))
"""rad from start to goal, either way."""
MASS = (0.060, 0.150)
"""kg."""
FRICTION = (0.02, 0.10)
"""N m, dry friction about the bolt; at the handle's end a quarter to one newton."""
GRIP = 0.032
"""m along the wrench's x axis, a place near the handle's end that must stay within reach."""
BORDER = 0.034
"""m from the surface's border to the nearest way of that place, so that fingers have room beside
the handle."""
BOLT_BORDER = 0.018
"""m from the surface's border to the nearest place for a bolt, so that it can be seen."""
END_BORDER = 0.004
"""m from the surface's border to the nearest way of the handle's end."""

YAW_TOLERANCE = np.deg2rad(5.0)
SPEED_TOLERANCE = 0.010
"""rad and m/s (of the wrench's middle) within which the wrench counts as turned."""

_TRIES = 4_000
"""Draws before a surface is said to be too small; on the default one, one in 43 fits."""


@dataclass(frozen=True)
class WrenchTurn:
    """Turn a wrench about its bolt onto its translucent twin.

    Scene: an open-ended wrench of 12 cm, 60 to 150 g, on a bolt that stands still; dry friction of
    0.02 to 0.10 N m about the bolt, at which it stays wherever it is let go.
    Goal: the wrench's ghost, turned by 40 to 90 degrees, either way.
    Success: yaw within 5 degrees of the goal, the wrench's middle slower than 1 cm/s and touched by
    no hand, all for 0.5 s without a break, within 30 s.
    Start: bolt uniform over the surface less a border of 18 mm, yaw uniform over the full circle,
    turn uniform over both ranges; redrawn until the place of the handle where fingers close stays
    34 mm, and the handle's end 4 mm, away from the border all the way.
    History: version 1, not in the registry: of 25 trials with random touches 3 succeed, where fewer
    than 5 % may. What can only turn is left at the goal by chance, and a longer hold time does not
    tell chance from skill.
    """

    name: ClassVar[str] = "wrench-turn"
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
    def draw(cls, seed: int, surface: Surface) -> WrenchTurn:
        """The trial of a seed; same seed and surface, same trial.

        Raises:
            InputError: The surface has no room for the way of a handle.
        """
        rng = np.random.default_rng([seed, cls.version, 2])
        low, high = np.full(2, BOLT_BORDER), surface.size - BOLT_BORDER
        for _ in range(_TRIES if np.all(high > low) else 0):
            bolt = rng.uniform(low, high)
            yaw = float(rng.uniform(-np.pi, np.pi))
            turn = float(rng.uniform(*TURN)) * float(rng.choice([-1.0, 1.0]))
            if _in_reach(bolt, yaw + np.linspace(0.0, turn, 13), surface.size):
                break
        else:
            raise InputError(
                "the surface is too small for this task",
                where=cls.name,
                got=f"{surface.width_in:g}x{surface.height_in:g}in",
                expected="room for the way of a wrench's handle, as on 7.76x5.82in",
            )
        mass, friction = float(rng.uniform(*MASS)), float(rng.uniform(*FRICTION))
        place = surface.to_world(bolt)[:2]
        start, end = (_middle(place, y) for y in (yaw, yaw + turn))
        wrench = Wrench("wrench", mass, start, yaw, friction)
        return cls(seed, (wrench,), (Goal("wrench", end, yaw + turn),))

    def measure(self, sensing: Sensing) -> Measure:
        """Whether the wrench is turned as it should be now."""
        wrench, goal = sensing.object("wrench"), self.goals[0]
        off = abs(_wrapped(wrench.yaw - goal.yaw))
        reason = ""
        if off > YAW_TOLERANCE:
            reason = f"the wrench is {np.rad2deg(off):.0f} degrees from the goal"
        elif wrench.held:
            reason = "a hand still touches the wrench"
        elif wrench.speed > SPEED_TOLERANCE:
            reason = "the wrench is still turning"
        way = abs(_wrapped(self.objects[0].yaw - goal.yaw)) - YAW_TOLERANCE
        turned = 1.0 - max(off - YAW_TOLERANCE, 0.0) / way
        # Nothing but success is 1.
        progress = 1.0 if not reason else float(np.clip(turned, 0.0, 0.99))
        return Measure(not reason, progress, reason)


def _in_reach(bolt: Array, yaws: Array, size: Array) -> bool:
    """Whether grip and handle's end stay on the surface (its frame: y down) at these yaws."""
    ways = np.stack([np.cos(yaws), -np.sin(yaws)], axis=1)
    for along, border in ((GRIP, BORDER), (HANDLE[1], END_BORDER)):
        places = bolt + (along - JAW) * ways
        if np.any(places < border) or np.any(places > size - border):
            return False
    return True


def _middle(bolt: Array, yaw: float) -> tuple[float, float, float]:
    """World position (3,) of the middle of a wrench on a bolt (2,)."""
    x, y = bolt - JAW * np.array([np.cos(yaw), np.sin(yaw)])
    return float(x), float(y), BOLT_LIFT + THICKNESS / 2


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
