"""Push a peg that lies on the table into a slightly wider socket.

The socket has two walls and a bottom, and is open above. The simulated user brings the peg in front
of the socket, aligns it, and pushes it in.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, pi, radians, sin
from typing import ClassVar, NamedTuple

import numpy as np

from models.arithmetic import Array, length, small_product
from models.errors import SurfaceTooSmallError
from models.mechanism import Mechanism, Part
from models.message import Message
from models.objects import Box
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.simulated_user.grasp import Grasp, wrapped
from tasks.simulated_user.user import SkilledUser
from tasks.simulated_user.user_hand import Hand
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import SeenObject, Sight, UserConfiguration, UserMaker

PEG, SOCKET = "peg", "socket"
LENGTH, WIDTH, HEIGHT = 0.075, 0.025, 0.015
"""Edges (m) of a block of the game Jenga, 7.5 x 2.5 x 1.5 cm."""
MASS = 0.018
"""Mass (kg) of such a block: 28 cm3 of wood of 0.64 g/cm3, such as alder."""
FRICTION = 0.4
"""Friction coefficient of smooth dry wood on wood; 0.25 to 0.5 in tables."""
DEPTH = 0.025
"""Distance (m) by which the peg goes into the socket: a third of its length."""

_WALL = 0.010
"""Thickness (m) of walls and bottom."""
_ROUND = 0.003
"""Radius (m) of the rounded edges at the mouth."""
_SKIN = 0.0005
"""Thickness (m) of the skin (MuJoCo's margin) around walls and posts. Their cores are set back by
this thickness, so that faces have their nominal positions. Without the skin, the peg penetrates the
cores where two faces meet in a corner, and MuJoCo may push along the normal of the wrong face."""
_POST = _ROUND - _SKIN
"""Radius (m) of the cores of the posts that round the edges."""
_SOLID = f'friction="{FRICTION:g}" margin="{_SKIN:g}"'
_WOOD, _DARK = ".80 .62 .40 1", ".36 .30 .26 1"


def peg(position: tuple[float, float], yaw: float) -> Box:
    """The peg, lying flat.

    Args:
        position: (2,) m, middle of the peg.
        yaw: Yaw (rad) about the vertical of the peg's long axis.
    """
    half = (LENGTH / 2, WIDTH / 2, HEIGHT / 2)
    return Box(PEG, half, MASS, (*position, half[2]), yaw, (0.86, 0.30, 0.24), FRICTION)


def socket(position: tuple[float, float], yaw: float, clearance: float) -> Mechanism:
    """The socket, fixed on the table.

    Its frame is at the middle of an inserted peg, with x pointing into the socket.

    Args:
        position: (2,) m, position of the frame.
        yaw: Yaw (rad) about the vertical.
        clearance: Width (m) of the socket minus that of the peg.
    """
    bottom, mouth = LENGTH / 2 + _SKIN, LENGTH / 2 - DEPTH + _SKIN
    inner, middle = (WIDTH + clearance) / 2 + _SKIN, HEIGHT / 2
    # The corner between mouth and wall is a round post, so that the peg slides into it.
    begin, outer, radius = mouth + _POST, inner + _WALL, _POST
    geoms = _box((bottom, bottom + _WALL), (-outer, outer), _DARK)
    for side in (1.0, -1.0):
        geoms += _box((begin, bottom), (side * inner, side * outer))
        geoms += _box((mouth, begin), (side * (inner + radius), side * outer))
        geoms += (
            f'<geom type="cylinder" size="{radius:.9g} {middle:g}" {_SOLID} rgba="{_WOOD}"'
            f' pos="{begin:.9g} {side * (inner + radius):.9g} {middle:g}"/>'
        )
    mjcf = f"<mujoco><worldbody><body>{geoms}</body></worldbody></mujoco>"
    return Mechanism(SOCKET, mjcf, (*position, 0.0), yaw)


def _box(x: tuple[float, float], y: tuple[float, float], rgba: str = _WOOD) -> str:
    """MJCF of a block as high as the peg, over ranges (m) in x and y."""
    half = HEIGHT / 2
    size = f"{abs(x[1] - x[0]) / 2:.9g} {abs(y[1] - y[0]) / 2:.9g} {half:g}"
    pos = f"{(x[0] + x[1]) / 2:.9g} {(y[0] + y[1]) / 2:.9g} {half:g}"
    return f'<geom type="box" size="{size}" pos="{pos}" {_SOLID} rgba="{rgba}"/>'


STAGE = 0.006
"""Distance (m) before the mouth at which the peg is aligned."""
ALIGNED = (0.0012, radians(2.0))
"""Largest offset (m) and angle (rad) from the socket's axis at which the user pushes."""
STEP = 0.012
"""Distance (m) that the user pushes before the next look."""
FARTHER = 0.0015
"""Distance (m) by which the user pushes beyond the bottom, to reach it safely."""
_FINGER = 0.010
"""Least distance (m) along the peg from the middle of a fingertip to the mouth, or to the peg's
end."""
_CLEAR = 0.0086
"""Clearance (m per side) by which the hand comes down wider than the peg."""


class Lie(NamedTuple):
    """Pose of a peg relative to its socket.

    Attributes:
        along: Position (m) of the peg's middle along the socket's axis, relative to its goal;
            negative before the goal.
        aside: Offset (m) from the socket's axis to its left.
        skew: Angle (rad) to the socket's axis.
        before: Distance (m) from the peg's front to the mouth, negative in the socket.
    """

    along: float
    aside: float
    skew: float
    before: float


def lie_of(peg: SeenObject, socket: SeenObject, goal: Goal, along: Array) -> Lie:
    """Pose of a peg relative to its socket.

    Args:
        peg: The peg as seen.
        socket: The socket.
        goal: The goal of the peg.
        along: (2,) unit vector into the socket.
    """
    assert isinstance(peg.shape, Box) and isinstance(socket.shape, Part)
    x, y = (np.asarray(peg.position[:2]) - np.array(goal.position[:2])).tolist()
    c, s = along.tolist()
    deep, aside = c * x + s * y, c * y - s * x
    mouth = float(socket.shape.bounds[0][0])
    before = mouth - deep - peg.shape.half_size[0]
    return Lie(deep, aside, _half_wrapped(peg.yaw - goal.yaw), before)


class PegHandling:
    """Handling of a peg, which is held at the part that stays outside the socket.

    The peg looks the same after half a turn.

    Attributes:
        along: (2,) unit vector into the socket.
        inside: Length (m) of the peg that is in the socket at the goal.
    """

    good = (0.0012, radians(2.0))
    enough = (0.0018, radians(20.0))
    patience = 8

    def __init__(self) -> None:
        self.along: Array = np.zeros(2)
        self.inside = 0.0

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """Remaining movement to the nearer of the two equivalent poses."""
        off = np.asarray(goal.position[:2]) - seen.position[:2]
        return off, _half_wrapped(goal.yaw - seen.yaw)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp across the peg, behind the part that goes into the socket."""
        assert isinstance(seen.shape, Box)
        half, half_width, _ = seen.shape.half_size
        # The end of the peg that is in front.
        front = 1.0 if float(small_product(seen.rotation[:2, 0], self.along)) > 0.0 else -1.0
        out = 2 * half - self.inside
        fingers = hand.within(out - 2 * _FINGER)
        options = []
        for number, side in enumerate((pi / 2, -pi / 2)):
            axis = seen.yaw + side
            worst = max(abs(wrapped(a - hand.natural_axis)) for a in (axis, axis + turn)) + (
                10.0 if failed and side == failed.side else 0.0
            )
            grip = -front * self.inside / 2
            options.append(
                (worst, number, Grasp(axis, 2 * half_width, fingers, grip, side, 0.0, _CLEAR))
            )
        return min(options, key=lambda o: o[:2])[2]

    def pivot(self, seen: SeenObject) -> Array:
        """The middle of the peg."""
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, hand: Hand) -> float:
        """The whole turn; it is always small."""
        return turn


class InsertUser(SkilledUser):
    """Pushes a peg into its socket in steps, with a look at the peg after each step.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    drags = 24

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._peg = PegHandling()
        self._handling = self._peg

    def _act(self, sight: Sight, now: float) -> None:
        goal = sight.goals[0]
        shape, socket = sight.objects[goal.object].shape, _socket(sight)
        assert isinstance(shape, Box) and isinstance(socket.shape, Part)
        if not length(self._peg.along):
            # The peg lies in front of the mouth, also in the mirror image that left-handed users
            # see.
            axis = np.array([cos(goal.yaw), sin(goal.yaw)])
            way = np.array(goal.position[:2]) - sight.objects[goal.object].position[:2]
            self._peg.along = axis if float(small_product(way, axis)) > 0.0 else -axis
        self._peg.inside = shape.half_size[0] - float(socket.shape.bounds[0][0])
        super()._act(sight, now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Remaining shift (2,) m and turn (rad). Between the walls only the depth is missing."""
        off, turn = super()._missing(sight, box)
        goal = sight.goals[0]
        lie = lie_of(box, _socket(sight), goal, self._peg.along)
        if lie.before < 0.0 and abs(lie.aside) < ALIGNED[0] + 0.002:
            return -lie.along * self._peg.along, 0.0
        return off, turn

    def _leg(self, sight: Sight, box: SeenObject, off: Array, turn: float) -> tuple[Array, float]:
        """Shift (2,) m and turn (rad) of the next movement: to a position before the mouth, or a
        step into the socket."""
        goal = sight.goals[0]
        along = self._peg.along
        lie = lie_of(box, _socket(sight), goal, along)
        across = np.array([-along[1], along[0]])
        aligned = abs(lie.aside) < ALIGNED[0] and abs(lie.skew) < ALIGNED[1]
        if lie.before < -0.002:
            ahead = min(FARTHER - lie.along, STEP)
        elif aligned and lie.before < 2 * STAGE:
            ahead = max(lie.before, 0.0) + STEP / 2
        else:
            ahead = lie.before - STAGE
        return ahead * along - lie.aside * across, -lie.skew


def _socket(sight: Sight) -> SeenObject:
    """The socket as seen."""
    goal = sight.goals[0].object
    (other,) = (o for name, o in sight.objects.items() if name != goal)
    return other


def _half_wrapped(angle: float) -> float:
    """Wraps an angle (rad) to -pi/2 to pi/2."""
    return float((angle + pi / 2) % pi - pi / 2)


CLEARANCE = 0.002
"""Width (m) of the socket minus that of the peg. Variations `room` of 2, 0.5 and 0.25 give 4, 1 and
0.5 mm."""
BEFORE = (0.015, 0.035)
"""Range of the distance (m) from the peg's front to the mouth, along the socket, at the start."""
ASIDE = 0.015
"""Largest offset (m) from the socket's axis at the start."""
SKEW = float(np.deg2rad(25.0))
"""Largest angle (rad) between peg and socket at the start."""
LEAN = float(np.deg2rad(30.0))
"""Largest angle (rad) between the socket and the screen's long axis."""
BORDER = 0.042
"""Smallest distance (m) of the peg's holding points from the surface's border. It is that of the
box in `box-to-goal`."""
HELD = DEPTH / 2
"""Distance (m) from the middle of the peg back to the middle of the part outside the socket, where
the peg is held."""

DEPTH_TOLERANCE = 0.002
"""Largest distance (m) from the bottom at which the peg counts as inserted."""
ASIDE_TOLERANCE = 0.005
"""A peg that is farther than this distance (m) beside or above its goal is not between the
walls."""
TILT_TOLERANCE = float(np.deg2rad(5.0))
SPEED_TOLERANCE = 0.010
"""Largest tilt (rad) and speed (m/s) of a peg that lies flat and is at rest."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class Insert(TaskDefaults):
    """Push the peg into the socket, down to its bottom.

    Scene: a peg lies flat on the table. It has the size of a Jenga block, 75 x 25 x 15 mm, and a
    mass of 18 g. The socket has walls as high as the peg, is 25 mm deep and 2 mm wider than the
    peg, and its mouth is rounded by 3 mm. All friction coefficients are 0.4, also between peg and
    fingers.
    Goal: the peg's ghost in the socket, with its front at the bottom.
    Success: for 0.5 s without a break, within 30 s, all of these hold: the front is within 2 mm of
    the bottom, the peg is between the walls, its tilt is under 5 degrees, it is slower than 1 cm/s,
    and no hand touches it.
    Start: the socket opens to the left or to the right, turned by up to 30 degrees. The peg's front
    would be 15 to 35 mm from the mouth if the peg were parallel to the socket. The peg is up to 15
    mm off the socket's axis and turned by up to 25 degrees against it. All are redrawn until the
    holding points of the peg, at the start and at the goal, are at least 42 mm from the border.
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
            # Everything is placed in the world, since surfaces may be turned.
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
        """Only the peg; the socket stays where it is."""
        return (PEG,)

    def with_room(self, factor: float) -> Insert:
        """The same trial with the clearance multiplied by a factor."""
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
    """True if positions (n, 2) m in the world are far enough from the surface's border."""
    at = np.column_stack([places, np.full(len(places), surface.origin[2])])
    on = surface.to_surface(at)
    return bool(np.all(on >= BORDER) and np.all(on <= surface.size - BORDER))
