"""Push a peg that lies on the table into a socket that is little wider."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, pi, sin
from typing import ClassVar

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.errors import SurfaceTooSmallError
from models.mechanisms.mechanism import Part
from models.message import Message
from models.objects import Box
from models.surface import Surface
from tasks.mechanisms.insert_user import InsertUser
from tasks.mechanisms.socket import DEPTH, PEG, peg, socket
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import UserMaker

CLEARANCE = 0.002
"""m, width of the socket less that of the peg; 4, 1 and 0.5 mm are rooms of 2, 0.5 and 0.25."""
BEFORE = (0.015, 0.035)
"""m from the front of the peg to the mouth of the socket, along the socket, at the start."""
ASIDE = 0.015
"""m off the axis of the socket at the start, to either side."""
SKEW = float(np.deg2rad(25.0))
"""rad between peg and socket at the start, to either side."""
LEAN = float(np.deg2rad(30.0))
"""rad between the socket and the screen's long axis, to either side."""
BORDER = 0.042
"""m from the surface's border to the places where the peg is held, as of a box in `box-to-goal`."""
HELD = DEPTH / 2
"""m behind the middle of the peg: the middle of what stays out of the socket."""

DEPTH_TOLERANCE = 0.002
"""m from the bottom, within which the peg is in."""
ASIDE_TOLERANCE = 0.005
"""m beside and above its place there, beyond which it is not between the walls."""
TILT_TOLERANCE = float(np.deg2rad(5.0))
SPEED_TOLERANCE = 0.010
"""rad and m/s within which it lies, and is at rest."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class Insert(TaskDefaults):
    """Push the peg into the socket, down to its bottom.

    Scene: a peg as a block of Jenga, 75 x 25 x 15 mm and 18 g, that lies flat, and a socket with
    walls as high as the peg, 25 mm deep and 2 mm wider than the peg, its mouth rounded by 3 mm.
    Friction of 0.4 counts everywhere, also between peg and fingers.
    Goal: the peg's ghost in the socket, its front at the bottom.
    Success: front within 2 mm of the bottom, between the walls, tilt under 5 degrees, slower than
    1 cm/s and touched by no hand, all for 0.5 s without a break, within 30 s.
    Start: the socket opens to the left or to the right, turned by up to 30 degrees; the front of
    the peg is 15 to 35 mm before its mouth, up to 15 mm off its axis and up to 25 degrees skew to
    it; redrawn until the places where the peg is held are 42 mm from the border.
    History: version 1.
    """

    name: ClassVar[str] = "insert"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 30.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.4
    touch_height: ClassVar[float] = 0.006
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    user: ClassVar[UserMaker | None] = InsertUser
    own_friction: ClassVar[bool] = True

    seed: int
    objects: tuple[Box | Part, ...]
    goals: tuple[Goal, ...]
    clearance: float = CLEARANCE

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Insert:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for a hand that brings a peg to a socket.
        """
        rng = np.random.default_rng([seed, cls.version, 43])
        size = surface.size
        for _ in range(_TRIES):
            seat = rng.uniform((0.0, 0.0), size)
            yaw = float(rng.uniform(-LEAN, LEAN)) + pi * float(rng.choice((0.0, 1.0)))
            before, aside = float(rng.uniform(*BEFORE)), float(rng.uniform(-ASIDE, ASIDE))
            skew = float(rng.uniform(-SKEW, SKEW))
            along = np.array([cos(yaw), sin(yaw)])
            # Surfaces may be turned: everything is placed in the world.
            middle = np.asarray(surface.to_world(seat))[:2]
            start = middle - (DEPTH + before) * along + aside * np.array([-along[1], along[0]])
            turned = np.array([cos(yaw + skew), sin(yaw + skew)])
            held = np.stack([middle - HELD * along, start - HELD * turned])
            if _within(held, surface):
                break
        else:
            raise SurfaceTooSmallError(
                cls.name,
                (surface.width_in, surface.height_in),
                "a peg on its way to a socket",
                (6.0, 4.0),
            )
        lying = peg((float(start[0]), float(start[1])), yaw + skew)
        at = (float(middle[0]), float(middle[1]))
        goal = Goal(PEG, (*at, lying.position[2]), yaw)
        return cls(seed, (lying, *socket(at, yaw, CLEARANCE).parts), (goal,))

    def shifted(self) -> tuple[str, ...]:
        """The peg: the socket stays where it is."""
        return (PEG,)

    def with_room(self, factor: float) -> Insert:
        """The same trial with so much more or less clearance."""
        clearance = factor * self.clearance
        goal = self.goals[0]
        wider = socket(goal.position[:2], goal.yaw, clearance)
        return replace(self, objects=(self.objects[0], *wider.parts), clearance=clearance)

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the peg is in its socket, at rest and let go of now."""
        lying, goal = sensing.object(PEG), self.goals[0]
        first = self.objects[0]
        assert isinstance(first, Box)
        c, s = cos(goal.yaw), sin(goal.yaw)
        x, y = (lying.position[:2] - np.array(goal.position[:2])).tolist()
        along, aside = c * x + s * y, c * y - s * x
        above = abs(float(lying.position[2]) - goal.position[2])
        reason: str = ""
        if abs(along) > DEPTH_TOLERANCE:
            mm = f"{1000 * abs(along):.0f}"
            reason = Message(
                "peg_from_bottom", "the peg is {mm} mm from the bottom of its socket", mm=mm
            )
        elif lying.tilt > TILT_TOLERANCE or max(above, abs(aside)) > ASIDE_TOLERANCE:
            reason = Message("peg_beside", "the peg does not lie in its socket")
        elif lying.held:
            reason = Message("peg_touched", "a hand still touches the peg")
        elif lying.speed > SPEED_TOLERANCE:
            reason = Message("peg_moves", "the peg is still moving")
        off = length(np.array([along, aside]))
        far = np.array(first.position[:2]) - np.array(goal.position[:2])
        way = max(length(far) - DEPTH_TOLERANCE, 1e-9)
        # Only success is 1.
        done = 1.0 - max(off - DEPTH_TOLERANCE, 0.0) / way
        progress = 1.0 if not reason else min(max(done, 0.0), 0.99)
        return Measure(not reason, progress, reason)


def _within(places: Array, surface: Surface) -> bool:
    """True if places (n, 2) m in the world are far enough from the surface's border."""
    at = np.column_stack([places, np.full(len(places), surface.origin[2])])
    on = surface.to_surface(at)
    return bool(np.all(on >= BORDER) and np.all(on <= surface.size - BORDER))
