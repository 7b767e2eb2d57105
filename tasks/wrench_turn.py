"""Turn a wrench that sits on a bolt."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import ClassVar

import numpy as np

from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.message import Message
from models.objects import BOLT_LIFT, HANDLE, JAW, THICKNESS
from models.surface import Surface
from tasks.sensing import ObjectState
from tasks.wrench_base import END_BORDER, Place, WrenchTask, wrapped

TURN = (np.deg2rad(40.0), np.deg2rad(90.0))
"""rad from start to goal, either way."""
FRICTION = (2.0, 2.5)
"""N m, dry friction about the bolt; 18 to 22 N at the handle's end."""
GRIP = 0.032
"""m along the wrench's x axis, a place near the handle's end that must stay within reach."""
GRIP_BORDER = 0.034
"""m from the surface's border to the path of that place, so that fingers have room beside the
handle."""

YAW_TOLERANCE = float(np.deg2rad(5.0))
"""rad within which the wrench counts as turned."""

TOO_FAR = float(np.deg2rad(15.0))
"""rad past the goal at which the nut is overtightened."""


@dataclass(frozen=True)
class WrenchTurn(WrenchTask):
    """Turn a wrench about its bolt onto its translucent twin.

    Scene: an open-ended wrench of 12 cm, 60 to 150 g, on a fixed bolt that is being tightened or
    loosened: dry friction of 2.0 to 2.5 N m, so that it stays wherever it is let go.
    Nothing stops it at the goal; more than 15 degrees past it the nut is overtightened and the
    trial fails. Goal: the wrench's ghost, turned by 40 to 90 degrees, either way.
    Success: yaw within 5 degrees of the goal, the wrench's middle slower than 1 cm/s and touched by
    no hand, all for 2 s without a break, within 20 s.
    Start: bolt uniform over the surface less a border of 18 mm, so that it can be seen; yaw uniform
    over the full circle, turn uniform over both ranges; redrawn until the place of the handle where
    fingers close stays 34 mm, and the handle's end 4 mm, away from the border all the way.
    Size, where it is varied (this does not change the version): all edges of the wrench and the
    width of its bolt, about the bolt, which stays where it is. Mass and friction stay, so that a
    shorter handle is harder to turn. A longer one ends beyond the border, and is gripped nearer to
    the bolt. History: version 3. Version 2, never registered, had a hold time of 0.5 s within 30 s
    and let the nut be turned past the goal: random touches left the wrench at its goal in 4 of 38
    trials, more than the allowed 5 %. Version 1, never registered either, had a bolt of 0.02 to
    0.10 N m, which turned at every brush: random touches succeeded in 3 of 25 trials.
    """

    name: ClassVar[str] = "wrench-turn"
    version: ClassVar[int] = 3
    stream: ClassVar[int] = 2
    time_limit: ClassVar[float] = 20.0
    hold_time: ClassVar[float] = 2.0
    border: ClassVar[float] = 0.018
    room: ClassVar[str] = "the way of a wrench's handle"
    room_in: ClassVar[tuple[float, float]] = (7.76, 5.82)

    @classmethod
    def _way(
        cls, rng: np.random.Generator, low: Array, high: Array, surface: Surface
    ) -> tuple[Place, float, Place, float] | None:
        """Draws bolt and turn; on the default surface, one draw in 43 fits."""
        bolt = rng.uniform(low, high)
        yaw = float(rng.uniform(-np.pi, np.pi))
        turn = float(rng.uniform(*TURN)) * float(rng.choice([-1.0, 1.0]))
        if not _in_reach(bolt, yaw + np.linspace(0.0, turn, 13), surface.size):
            return None
        place = surface.to_world(bolt)[:2]
        return _middle(place, yaw), yaw, _middle(place, yaw + turn), turn

    @classmethod
    def _bolt(cls, rng: np.random.Generator) -> float:
        return float(rng.uniform(*FRICTION))

    def _missing(self, wrench: ObjectState) -> str:
        off = self._turn_left(wrench)
        if self._lost(wrench):
            return Message("nut_overtightened", "the nut is overtightened")
        if off > YAW_TOLERANCE:
            return Message(
                "wrench_from_angle",
                "the wrench is {degrees} degrees from the goal",
                degrees=f"{np.rad2deg(off):.0f}",
            )
        return ""

    def _lost(self, wrench: ObjectState) -> bool:
        start, goal = self.objects[0].yaw, self.goals[0].yaw
        # Up to half a turn past the goal; beyond that, the angle counts the other way round.
        past = np.sign(wrapped(goal - start)) * wrapped(wrench.yaw - goal)
        return bool(past > TOO_FAR)

    def _progress(self, wrench: ObjectState) -> float:
        return self._turned(wrench, YAW_TOLERANCE)


def _in_reach(bolt: Array, yaws: Array, size: Array) -> bool:
    """True if grip and handle's end stay on the surface (in its frame, y down) at these yaws."""
    ways = np.stack([functions.cos(yaws), -functions.sin(yaws)], axis=1)
    for along, border in ((GRIP, GRIP_BORDER), (HANDLE[1], END_BORDER)):
        places = bolt + (along - JAW) * ways
        if np.any(places < border) or np.any(places > size - border):
            return False
    return True


def _middle(bolt: Array, yaw: float) -> Place:
    """World position (3,) of the middle of a wrench on a bolt (2,)."""
    x, y = bolt - JAW * np.array([cos(yaw), sin(yaw)])
    return float(x), float(y), BOLT_LIFT + THICKNESS / 2
