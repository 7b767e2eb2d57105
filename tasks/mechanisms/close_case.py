"""Push the two halves of a case together, a hand at each: one hand alone only pushes it away."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import ClassVar

import numpy as np

from models.errors import SurfaceTooSmallError
from models.mechanisms.mechanism import Part
from models.message import Message
from models.surface import Surface
from tasks.mechanisms.case import CAP, CASE, HALF_LENGTH, TRAVEL, case
from tasks.mechanisms.close_case_user import CaseUser
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import UserMaker

GRIP = (1.5, 2.5)
"""N with which the cap slides on the neck: 10 to 16 times the friction of the case on the table."""
YAW = float(np.deg2rad(12.0))
"""rad between the case and the surface's long axis, to either side."""
HELD = 0.6 * HALF_LENGTH
"""m from the rim of a half to where it is held."""
BORDER, SEAM = 0.042, 0.030
"""m from the border of the surface, and from the middle between the hands, to the nearest place
where a half is held, as in `carry-together`."""

CLOSED = 0.0015
"""m between the rims, up to which the case is closed."""
SPEED_TOLERANCE = 0.010
"""m/s below which it is at rest."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class CloseCase(TaskDefaults):
    """Push the two halves of a case together, with a hand at either half.

    Scene: a travel case for a toothbrush, of two halves of 100 x 28 x 22 mm and 20 g, that lies on
    the table and is open by 2 cm. The cap slides on the neck of the other half with a friction of
    1.5 to 2.5 N. Friction of 0.4 counts against table and fingers, so that the whole case slides
    away under a push of 0.16 N, unless another hand holds it.
    Goal: the halves' rims together.
    Success: less than 1.5 mm between the rims, at rest and touched by no hand, for 0.5 s without a
    break, within 40 s.
    Start: place uniform, yaw uniform within 12 degrees of the surface's axes, the cap to the right;
    redrawn until both places where the case is held are 42 mm from the border and 30 mm from the
    middle between the hands.
    History: version 1.
    """

    name: ClassVar[str] = "close-case"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 40.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.4
    touch_height: ClassVar[float] = 0.009
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    hands: ClassVar[int] = 2
    user: ClassVar[UserMaker | None] = CaseUser
    own_friction: ClassVar[bool] = True

    seed: int
    objects: tuple[Part, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> CloseCase:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Args:
            seed: Seed of everything that is drawn.
            surface: The surface of both hands together.

        Raises:
            SurfaceTooSmallError: The surface has no room for a case between two hands.
        """
        rng = np.random.default_rng([seed, cls.version, 47])
        width, height = surface.size.tolist()
        for _ in range(_TRIES):
            rim = rng.uniform((0.0, 0.0), (width, height))
            yaw = float(rng.uniform(-YAW, YAW))
            # On the surface y points down.
            along = np.array([cos(yaw), -sin(yaw)])
            left, right = rim - HELD * along, rim + (TRAVEL + HELD) * along
            closed = rim + HELD * along
            apart = left[0] <= width / 2 - SEAM and closed[0] >= width / 2 + SEAM
            held = np.stack([left, right])
            if apart and np.all(held >= BORDER) and np.all(held <= surface.size - BORDER):
                break
        else:
            raise SurfaceTooSmallError(
                cls.name,
                (surface.width_in, surface.height_in),
                "a case between two hands",
                (9.0, 4.0),
                "Give every hand a surface of its own: --device A --device B",
            )
        x, y, _ = surface.to_world(rim).tolist()
        lying = case((x, y), yaw, float(rng.uniform(*GRIP)))
        position, turned = lying.part("cap").placed(0.0)
        return cls(seed, lying.parts, (Goal(CAP, position, turned),))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the case is closed, at rest and let go of now."""
        cap = sensing.joint(CAP)
        reason: str = ""
        if cap.position > CLOSED:
            mm = f"{1000 * cap.position:.0f}"
            reason = Message("case_open", "the case is open by {mm} mm", mm=mm)
        elif sensing.object(CASE).held or sensing.object(CAP).held:
            reason = Message("case_touched", "a hand still touches the case")
        elif max(sensing.object(CASE).speed, abs(cap.speed)) > SPEED_TOLERANCE:
            reason = Message("case_moves", "the case is still moving")
        first = next(part.joint for part in self.objects if part.joint)
        shut = 1.0 - max(cap.position - CLOSED, 0.0) / max(first.start - CLOSED, 1e-9)
        # Only success is 1.
        return Measure(not reason, 1.0 if not reason else min(max(shut, 0.0), 0.99), reason)
