"""Turn a knob by 270 degrees to a mark. This is farther than a wrist turns, so the knob has to be
grasped again.

The round knob is on a plate with a scale, as on a cooker, and turns between two end stops. The
simulated user grasps it around its rim, turns as far as the wrist goes, lets go, and grasps again.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, pi, radians, sin
from typing import ClassVar

import numpy as np

from models.arithmetic import Array
from models.errors import SurfaceTooSmallError
from models.mechanism import Mechanism, Part
from models.message import Message
from models.objects import SceneObject
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.simulated_user.grasp import Grasp, wrapped
from tasks.simulated_user.user import SkilledUser
from tasks.simulated_user.user_hand import Hand
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import SeenObject, Sight, UserMaker

NAME = "dial"
KNOB = f"{NAME}/knob"
RADIUS = 0.020
"""Radius (m) of the knob. The knob of a cooker is about 40 mm wide."""
SWEEP = radians(300.0)
"""Range (rad) from end stop to end stop, which is common for rotary potentiometers."""
ARMATURE = 1e-4
"""Inertia (kg m2) of the shaft. With less inertia, dry friction would make the joint numerically
stiff."""
MASS = 0.030
"""Mass (kg) of the knob."""

_LOW, _HIGH = 0.005, 0.025
"""Heights (m) of the knob's lower and upper end above the table."""
_PLATE = (0.036, 0.004)
"""Radius and thickness (m) of the plate."""
_TICKS = 11
"""Marks from end stop to end stop, 30 degrees apart."""
_STEEL, _DARK, _WHITE, _BLUE = ".62 .65 .70 1", ".14 .15 .17 1", ".93 .94 .95 1", ".20 .55 .78 1"


def dial(
    position: tuple[float, float], yaw: float, start: float, mark: float, torque: float
) -> Mechanism:
    """A knob on its plate, fixed on the table.

    At an angle of 0 the knob points along the plate's y axis. The gap of the scale is on the
    opposite side.

    Args:
        position: (2,) m, middle of the knob.
        yaw: Yaw (rad) of the plate about the vertical.
        start: Angle (rad) of the knob at the start.
        mark: Angle (rad) of the blue mark on the plate.
        torque: Dry friction (N m) of the knob.
    """
    ticks = [SWEEP * (i / (_TICKS - 1) - 0.5) for i in range(_TICKS)]
    scale = "".join(_tick(angle, 0.0270, 0.0015, 0.0006, _WHITE) for angle in ticks)
    scale += _tick(mark, 0.0295, 0.0045, 0.0016, _BLUE)
    middle, half = (_LOW + _HIGH) / 2, (_HIGH - _LOW) / 2
    half_sweep = SWEEP / 2
    mjcf = f"""<mujoco><compiler angle="radian"/><worldbody><body>
      <geom type="cylinder" size="{_PLATE[0]} {_PLATE[1] / 2}" pos="0 0 {_PLATE[1] / 2}"
        rgba="{_STEEL}"/>{scale}
      <body name="knob" pos="0 0 {middle:g}">
        <joint type="hinge" axis="0 0 1" range="{-half_sweep:.9g} {half_sweep:.9g}"
          frictionloss="{torque:.9g}" damping="1e-3" armature="{ARMATURE}"/>
        <geom type="cylinder" size="{RADIUS} {half:g}" mass="{MASS}" rgba="{_DARK}"/>
        <geom type="box" size=".0013 {RADIUS / 2} .0006" pos="0 {RADIUS / 2} {half + 0.0003:g}"
          mass="0" contype="0" conaffinity="0" rgba="{_WHITE}"/>
      </body></body></worldbody></mujoco>"""
    return Mechanism(NAME, mjcf, (*position, 0.0), yaw, {"knob": start})


def _tick(angle: float, out: float, half_length: float, half_width: float, rgba: str) -> str:
    """MJCF of a mark on the plate, at an angle (rad) from its y axis and a distance `out` (m)."""
    x, y = -out * sin(angle), out * cos(angle)
    size = f"{half_width} {half_length} .0003"
    return (
        f'<geom type="box" size="{size}" pos="{x:.6f} {y:.6f} {_PLATE[1] + 0.0002:g}"'
        f' euler="0 0 {angle:.6f}" contype="0" conaffinity="0" rgba="{rgba}"/>'
    )


WRIST = radians(60.0)
"""Limit (rad from the natural axis, to either side) of the hand's rotation: most of the range of
wrist and forearm with the fingers on a table; assumed."""
SPAN = radians(60.0)
"""Largest angle (rad) along the rim from the middle finger to the outermost finger."""

_TIP_RADIUS = 0.007
"""Radius (m) of a fingertip that the user assumes."""
_QUARTER = pi / 2


@dataclass(frozen=True)
class KnobGrasp(Grasp):
    """A grasp around a round object, with the thumb opposite the fingers and all on one circle."""

    def places(self, centre: Array, gap: float, hand: Hand) -> Array:
        """Positions (fingers, 2) m of the fingertips, thumb first; see `Grasp.places`."""
        radius = self.width / 2 + _TIP_RADIUS
        angles = [self.axis + pi]
        # The row begins with the index finger. It is the leftmost finger if the thumb is at the
        # lower left.
        angles += [self.axis - float(x) / radius for x in hand.row(self.fingers)[:, 0]]
        out = radius + gap
        return np.array(
            [[centre[0] + out * cos(angle), centre[1] + out * sin(angle)] for angle in angles]
        )


class KnobHandling:
    """Handling of a knob, which is turned about its fixed middle.

    Args:
        knob: The knob.
    """

    good = (0.003, radians(2.0))
    enough = (0.007, radians(3.5))
    patience = 8

    def __init__(self, knob: Part) -> None:
        low, high = knob.bounds
        self._width = float(high[0] - low[0])

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """A shift of 0, and the shorter turn (rad) to the goal, regardless of the end stops."""
        return np.zeros(2), wrapped(goal.yaw - seen.yaw)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp from which the wrist can make the whole turn, or as much of it as possible."""
        natural = hand.natural_axis
        axis = natural - float(np.clip(turn / 2, -WRIST, WRIST))
        radius = self._width / 2 + _TIP_RADIUS
        fingers = hand.within(2 * SPAN * radius)
        return KnobGrasp(axis, self._width, fingers, side=axis - seen.yaw)

    def pivot(self, seen: SeenObject) -> Array:
        """The middle of the knob."""
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, hand: Hand) -> float:
        """Part of the turn that the wrist allows."""
        now = wrapped(grasp.axis_on(seen.yaw) - hand.natural_axis)
        low, high = min(-WRIST, now), max(WRIST, now)
        return float(np.clip(now + turn, low, high) - now)


class DialUser(SkilledUser):
    """Turns the knob along its scale, with as many grasps as needed."""

    def _act(self, sight: Sight, now: float) -> None:
        shape = sight.objects[sight.goals[0].object].shape
        if self._handling is None and isinstance(shape, Part):
            self._handling = KnobHandling(shape)
        super()._act(sight, now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """A shift of 0, and the turn (rad) that does not cross the gap of the scale."""
        assert isinstance(box.shape, Part) and box.shape.carrier is not None
        plate = sight.objects[box.shape.carrier]
        # The pointer is the knob's y axis, and the middle of the scale is the plate's.
        middle = _direction(plate)
        pointer = wrapped(_direction(box) - middle)
        mark = wrapped(sight.goals[0].yaw + _QUARTER - middle)
        return np.zeros(2), mark - pointer


def _direction(seen: SeenObject) -> float:
    """Direction (rad) of an object's y axis, seen from above."""
    return atan2(seen.rotation[1, 1], seen.rotation[0, 1])


TURN = radians(270.0)
"""Turn (rad) from start to mark in either direction. Start and mark are each 15 degrees from an end
stop."""
TORQUE = (0.05, 0.15)
"""Range of the knob's dry friction (N m): 2.5 to 7.5 N at its rim."""
TOLERANCE = radians(5.0)
"""Largest angle (rad) between the pointer and the mark at the goal."""
SPEED = 0.1
"""Speed (rad/s) below which the knob is at rest."""
BORDER = 0.050
"""Least distance (m) of the knob's middle from the surface's border, for fingers around it."""


@dataclass(frozen=True)
class Dial(TaskDefaults):
    """Turn the knob along its scale, three quarters of a turn, to the blue mark.

    Scene: a knob like that of a cooker, 40 mm in diameter and 20 mm high, on a plate with a scale.
    It turns by 300 degrees from end stop to end stop, with a dry friction of 0.05 to 0.15 N m.
    Goal: the pointer of the knob at the blue mark, 270 degrees away along the scale. In the other
    direction, the end stops block the knob.
    Success: the pointer is within 5 degrees of the mark, the knob is slower than 0.1 rad/s, and no
    hand touches it, for 0.5 s without a break, within 40 s.
    Start: the middle is uniform, at least 5 cm from the surface's border. The yaw of the plate is
    uniform. The pointer is 15 degrees from one of the end stops, with equal probability.
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
            degrees = f"{np.rad2deg(off):.0f}"
            # Seen from above, a positive turn is anticlockwise.
            if knob.position > self.mark:
                words = "turn the knob {degrees} degrees clockwise"
                reason = Message("knob_clockwise", words, degrees=degrees)
            else:
                words = "turn the knob {degrees} degrees anticlockwise"
                reason = Message("knob_anticlockwise", words, degrees=degrees)
        elif sensing.object(KNOB).held:
            reason = Message("knob_touched", "a hand still touches the knob")
        elif abs(knob.speed) > SPEED:
            reason = Message("knob_moves", "the knob is still moving")
        # Only success is 1.
        turned = 1.0 - max(off - TOLERANCE, 0.0) / (TURN - TOLERANCE)
        progress = 1.0 if not reason else min(max(turned, 0.0), 0.99)
        return Measure(not reason, progress, reason)
