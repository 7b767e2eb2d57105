"""Turn a knob by 270 degrees to a mark: farther than a wrist turns, so that it is grasped again."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, radians
from typing import ClassVar

import numpy as np

from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import SceneObject
from models.surface import Surface
from tasks.mechanisms.dial_user import DialUser
from tasks.mechanisms.knob import KNOB, dial
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import UserMaker

TURN = radians(270.0)
"""rad from start to mark, either way: 15 degrees from one end stop to as much from the other."""
TORQUE = (0.05, 0.15)
"""N m, dry friction of the knob: 2.5 to 7.5 N at its rim."""
TOLERANCE = radians(5.0)
"""rad within which the knob is at its mark."""
SPEED = 0.1
"""rad/s below which it is at rest."""
BORDER = 0.050
"""m from the surface's border to the middle of the knob, for fingers around it."""


@dataclass(frozen=True)
class Dial(TaskDefaults):
    """Turn the knob by three quarters of a turn, to the blue mark.

    Scene: a knob of 40 mm diameter and 20 mm height on a plate with a scale, which turns by 300
    degrees from end stop to end stop with a dry friction of 0.05 to 0.15 N m, as one of a cooker.
    Goal: its pointer at the blue mark, 270 degrees away, as the scale goes: the other way there is
    an end stop.
    Success: the pointer within 5 degrees of the mark, slower than 0.1 rad/s and let go of, for
    0.5 s without a break, within 40 s.
    Start: middle uniform at least 5 cm from the surface's border, the plate turned uniformly, the
    pointer 15 degrees from either end stop.
    History: version 1.
    """

    name: ClassVar[str] = "dial"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 40.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.009
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    user: ClassVar[UserMaker | None] = DialUser

    seed: int
    objects: tuple[SceneObject, ...]
    goals: tuple[Goal, ...]
    mark: float

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Dial:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for a hand around a knob.
        """
        rng = np.random.default_rng([seed, cls.version, 41])
        low, high = np.full(2, BORDER), surface.size - BORDER
        if np.any(high < low):
            raise SurfaceTooSmallError(
                cls.name, (surface.width_in, surface.height_in), "a hand around a knob", (4.5, 4.5)
            )
        x, y, _ = surface.to_world(rng.uniform(low, high)).tolist()
        yaw = float(rng.uniform(-pi, pi))
        mark = TURN / 2 * float(rng.choice([-1.0, 1.0]))
        knob = dial((x, y), yaw, -mark, mark, float(rng.uniform(*TORQUE)))
        position, turned = knob.part("knob").placed(mark)
        return cls(seed, knob.parts, (Goal(KNOB, position, turned),), mark)

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the knob is at its mark, at rest and let go of now."""
        knob = sensing.joint(KNOB)
        off = abs(knob.position - self.mark)
        reason: str = ""
        if off > TOLERANCE:
            reason = Message(
                "knob_from_mark",
                "the knob is {degrees} degrees from the mark",
                degrees=f"{np.rad2deg(off):.0f}",
            )
        elif sensing.object(KNOB).held:
            reason = Message("knob_touched", "a hand still touches the knob")
        elif abs(knob.speed) > SPEED:
            reason = Message("knob_moves", "the knob is still moving")
        # Only success is 1.
        turned = 1.0 - max(off - TOLERANCE, 0.0) / (TURN - TOLERANCE)
        progress = 1.0 if not reason else min(max(turned, 0.0), 0.99)
        return Measure(not reason, progress, reason)
