"""Push the two halves of a case together with a hand at each. One hand alone only pushes the case
away.

One half is pushed over the neck of the other half, as in a travel case for a toothbrush. The
simulated user at the cap pushes, and the other simulated user holds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, pi, radians, sin
from typing import ClassVar

import numpy as np

from models.arithmetic import Array, length
from models.errors import SurfaceTooSmallError
from models.mechanism import Mechanism, Part
from models.message import Message
from models.objects import Box
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.simulated_user.grasp import Grasp, grasp_across, wrapped
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.simulated_user.user_hand import Hand
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import SeenObject, Sight, UserConfiguration, UserMaker

CASE = "case"
CAP = f"{CASE}/cap"
HALF_LENGTH, WIDTH, HEIGHT = 0.100, 0.028, 0.022
"""Dimensions (m) of each half of a travel case for a toothbrush, which is about 20 cm long."""
MASS = 0.020
"""Mass (kg) of each half, of thin plastic."""
FRICTION = 0.4
"""Friction coefficient of smooth plastic on a table and under a finger; assumed."""
TRAVEL = 0.020
"""Distance (m) by which the neck of one half goes into the other."""

_ARMATURE = 0.02
"""Armature (kg) of the slide. Without it, friction on such a light part would make the joint
numerically stiff."""
_NECK = 0.002
"""Distance (m) by which the neck is narrower than the case on each side."""
_BODY, _CAP, _INSIDE = ".90 .92 .94 1", ".20 .55 .78 1", ".70 .73 .77 1"


def case(position: tuple[float, float], yaw: float, grip: float) -> Mechanism:
    """The case, open and free on the table.

    Its frame is at the rim of the half with the neck, and x points towards the other half. The
    frame of the other half is at that half's rim.

    Args:
        position: (2,) m, position of the frame.
        yaw: Yaw (rad) about the vertical.
        grip: Friction (N) with which the cap slides on the neck.
    """
    half = f"{HALF_LENGTH / 2:g} {WIDTH / 2:g} {HEIGHT / 2:g}"
    neck = f"{TRAVEL / 2:g} {WIDTH / 2 - _NECK:g} {HEIGHT / 2 - _NECK:g}"
    solid = f'type="box" mass="{MASS:g}" friction="{FRICTION:g}"'
    mjcf = f"""<mujoco><worldbody><body pos="0 0 {HEIGHT / 2:g}"><freejoint/>
      <geom {solid} size="{half}" pos="{-HALF_LENGTH / 2:g} 0 0" rgba="{_BODY}"/>
      <geom type="box" mass="0" size="{neck}" pos="{TRAVEL / 2:g} 0 0" contype="0" conaffinity="0"
        rgba="{_INSIDE}"/>
      <body name="cap">
        <joint type="slide" axis="1 0 0" range="0 {TRAVEL:g}" frictionloss="{grip:.9g}"
          damping="1" armature="{_ARMATURE:g}"/>
        <geom {solid} size="{half}" pos="{HALF_LENGTH / 2:g} 0 0" rgba="{_CAP}"/>
      </body></body></worldbody></mujoco>"""
    return Mechanism(CASE, mjcf, (*position, HEIGHT / 2), yaw, {"cap": TRAVEL})


SHUT = 0.001
"""Distance (m) between the rims below which the user lets go."""
_HELD = 0.6
"""Distance from the rim at which a half is held, as a share of its length."""
_STEP, _FARTHER = 0.008, 0.002
"""Largest distance (m) that the user pushes before the next look, and distance (m) pushed beyond
the rim."""
_FIRST = 1.0
"""Time (s) for which the user waits for the other user to grasp. The user waits as long again after
the other half has given way."""
_YIELDS = 0.002
"""The other half has given way if a push moved it by more than this distance (m)."""
_SLIPPED = 0.015
"""Distance (m) by which a half may lag behind the fingers before it counts as slipped."""
_PATIENCE = 12.0
"""Time (s) for which the user holds a half before letting go to start again."""
_LOOK = 0.10
"""Interval (s) between two looks while waiting."""


class HalfHandling(BoxHandling):
    """Handling of half a case: grasped across, with the thumb on the more comfortable side."""

    enough = (SHUT, radians(90.0))

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp with the thumb on one long side and the fingers on the other."""
        assert isinstance(seen.shape, Box)
        along, across, _ = seen.shape.half_size
        sides = [seen.yaw + side for side in (pi / 2, -pi / 2)]
        axis = min(sides, key=lambda a: abs(wrapped(a - hand.natural_axis)))
        return grasp_across(axis, 2 * across, 2 * along, hand)


class CaseUser(SkilledUser):
    """A simulated user who takes the half of the case that is nearer to the middle of their tablet.

    The two users do not communicate. The pushing user sees whether the other half gives way.

    Args:
        configuration: Settings of the simulated user.
        surface: The user's tablet.
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._handling = HalfHandling()
        self._home = surface.to_world(surface.size / 2)[:2]
        self._mine = ""
        self._seen: tuple[SeenObject, SeenObject] | None = None
        self._since: float | None = None
        self._before: Array | None = None
        self._ready = 0.0

    def _act(self, sight: Sight, now: float) -> None:
        cap = sight.goals[0].object
        (first, second) = sight.objects.items()
        if not self._mine:
            far = [
                length(_place(a[1], b[1]) - self._home)
                for a, b in ((first, second), (second, first))
            ]
            self._mine = first[0] if far[0] < far[1] else second[0]
        mine, other = (first[1], second[1]) if self._mine == first[0] else (second[1], first[1])
        self._seen = mine, other
        super()._act(replace(sight, objects={cap: _as_box(mine, other)}), now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Shift (2,) m to the other half's rim, and a turn of 0."""
        assert self._seen is not None
        mine, other = self._seen
        return np.asarray(other.position[:2] - mine.position[:2]), 0.0

    def _reach(self, sight: Sight, box: SeenObject, now: float) -> None:
        self._since, self._before = None, None
        super()._reach(sight, box, now)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Holds the half, or pushes it towards the other half in steps."""
        assert self._grasp is not None and self._seen is not None
        off, _ = self._missing(sight, box)
        gap = length(off)
        if self._since is None:
            self._since = now
        held = self._grasp.middle(box) + self._drawn_offset(sight)
        slipped = length(held - self._middle(now)) > _SLIPPED
        tired = now - self._since > _PATIENCE
        if gap < SHUT or slipped or tired or not sight.solid:
            self._let_go(now)
            return
        goal, there = sight.goals[0], self._seen[1].position[:2]
        gives_way = self._before is not None and length(there - self._before) > _YIELDS
        self._before = np.array(there)
        if gives_way:
            self._ready = now + _FIRST
        if self._mine != goal.object or now < max(self._since + _FIRST, self._ready):
            self._wait(_LOOK, now)
            return
        ahead = min(gap + _FARTHER, _STEP) / gap
        self._watch(self._fingers.carry(ahead * off, 0.0, np.array(box.position[:2]), now))


def _place(mine: SeenObject, other: SeenObject) -> Array:
    """Position (2,) m at which a half is held: from its rim, in the direction away from the other
    half."""
    assert isinstance(mine.shape, Part)
    low, high = mine.shape.bounds
    away = np.asarray((mine.position - other.position)[:2])
    out = _HELD * float(high[0] - low[0]) / max(length(away), 1e-9)
    return np.asarray(mine.position[:2] + out * away)


def _as_box(mine: SeenObject, other: SeenObject) -> SeenObject:
    """A half, described as a box whose middle is where the half is held."""
    assert isinstance(mine.shape, Part)
    low, high = mine.shape.bounds
    x, y = _place(mine, other).tolist()
    z = float(mine.position[2])
    room = (1.0 - _HELD) * float(high[0] - low[0])
    box = Box("half", (room, float(high[1]), float(high[2])), mine.shape.mass, (x, y, z))
    return SeenObject(box, np.array([x, y, z]), mine.rotation)


GRIP = (1.5, 2.5)
"""Range of the friction (N) of the cap on the neck: 10 to 16 times the friction of the case on the
table."""
YAW = float(np.deg2rad(12.0))
"""Largest angle (rad) between the case and the surface's long axis."""
HELD = 0.6 * HALF_LENGTH
"""Distance (m) from the rim of a half to the point where it is held."""
BORDER, SEAM = 0.042, 0.030
"""Smallest distances (m) of a holding point from the surface's border, and from the middle line
between the hands. They are those of `carry-together`."""

CLOSED = 0.0015
"""Largest distance (m) between the rims of a closed case."""
SPEED_TOLERANCE = 0.010
"""Speed (m/s) below which the case is at rest."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class CloseCase(TaskDefaults):
    """Push the two halves of a case together, with a hand at either half.

    Scene: a travel case for a toothbrush lies on the table, open by 2 cm. Each of its two halves
    has 100 x 28 x 22 mm and 20 g. The cap slides on the neck of the other half with a friction of
    1.5 to 2.5 N. The friction coefficient between case and table, and case and fingers, is 0.4. So
    a push of 0.16 N moves the whole case, unless another hand holds it.
    Goal: the rims of the halves together.
    Success: the gap between the rims is at most 1.5 mm, the case is at rest, and no hand touches
    it, for 0.5 s without a break, within 40 s.
    Start: the place is uniform, the yaw is uniform within 12 degrees of the surface's axes, and the
    cap is at the right. Both are redrawn until both holding points are at least 42 mm from the
    border and, with the case closed, at least 30 mm from the middle line between the hands.
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
                "Give every hand its own surface: --device A --device B",
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
