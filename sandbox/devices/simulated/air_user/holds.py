"""Holds of objects for a hand in the air, and the movements that bring an object to its goal."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from models.arithmetic import Array, length, small_product, total
from models.errors import InputError
from models.objects import Box, SceneObject, Tray, Wrench
from tasks.task import Goal, flat_yaw
from tasks.user import SeenObject

_STEP = float(np.deg2rad(25.0))
"""Largest rotation (rad) in one movement of an object that turns about a bolt."""
_GRIP = 0.040
"""Distance (m) from the origin, along the handle, at which a wrench of size 1 is held. It is large,
so that the lever is long."""


@dataclass(frozen=True)
class Hold:
    """The block of an object that the fingers pinch.

    Attributes:
        position: (3,) m, centre of the block.
        yaw: rad, direction along which thumb and fingers close on the block.
        width: m, distance between the pinched faces.
        top: m, height of the block's upper side.
        quarter: True if any two opposite faces can be pinched.
    """

    position: Array
    yaw: float
    width: float
    top: float
    quarter: bool

    @property
    def half(self) -> float:
        """Distance (m) from its centre to its upper side."""
        return self.top - float(self.position[2])

    def half_above(self, low: float) -> float:
        """Height (m) of its centre above `low`."""
        return float(self.position[2]) - low


def check_holdable(thing: SceneObject) -> None:
    """Checks that the simulated user in the air can hold an object.

    Raises:
        InputError: The object is not a box, wrench or tray.
    """
    if not isinstance(thing, Box | Wrench | Tray):
        raise InputError(
            "the simulated user in the air cannot hold this object",
            got=thing.name,
            expected="boxes, wrenches and trays",
            remedy="Use --device leap, with your own hand",
        )


def hold_of(seen: SeenObject, near: Array) -> Hold:
    """Returns the hold of an object.

    Args:
        seen: The object.
        near: (2,) m; a tray is held by the handle that is nearer to this point.
    """
    shape, position, yaw = seen.shape, seen.position, flat_yaw(seen.rotation)
    if isinstance(shape, Box):
        half = shape.half_size[2]
        return Hold(position, yaw, 2.0 * shape.half_size[0], float(position[2]) + half, True)
    along = np.array([cos(seen.yaw), sin(seen.yaw), 0.0])
    across = seen.yaw + np.pi / 2
    if isinstance(shape, Tray):
        along = seen.rotation[:, 0]
        ends = [position + side * shape.grip * along for side in (1.0, -1.0)]
        place = min(ends, key=lambda e: length(e[:2] - near))
        _, half_width, half_height = shape.handle
        return Hold(place, across, 2.0 * half_width, float(place[2]) + half_height, False)
    assert isinstance(shape, Wrench)
    out = shape.size * _GRIP if shape.bolt is not None else total(shape.handle) / 2.0
    place = position + out * along
    top = float(place[2]) + shape.thickness / 2.0
    return Hold(place, across, shape.handle_width, top, False)


def remaining_motion(seen: SeenObject, goal: Goal) -> tuple[Array, float]:
    """Returns shift (2,) m and rotation (rad) from an object's pose to its goal."""
    off = np.asarray(goal.position[:2]) - seen.position[:2]
    if isinstance(seen.shape, Box):
        return off, quarter_turn(goal.yaw - flat_yaw(seen.rotation))
    return off, float((goal.yaw - seen.yaw + np.pi) % (2 * np.pi) - np.pi)


def pinch_motion(seen: SeenObject, goal: Goal, pinch: Array) -> tuple[Array, float]:
    """Returns shift (2,) m and rotation (rad) of a pinch that bring the held object to its goal.

    Args:
        seen: The object.
        goal: Its goal.
        pinch: (2,) m, position of the pinch.
    """
    off, turn = remaining_motion(seen, goal)
    pivot, shape = seen.position[:2], seen.shape
    if isinstance(shape, Wrench) and shape.bolt is not None:
        pivot, off = np.array(shape.bolt_place(pivot, seen.yaw)), np.zeros(2)
        turn = float(np.clip(turn, -_STEP, _STEP))
    arm, (c, s) = pinch - pivot, (cos(turn), sin(turn))
    return off + small_product(np.array([[c, -s], [s, c]]), arm) - arm, turn


def stays_down(shape: SceneObject) -> bool:
    """True if the object is pulled or turned on the table instead of being lifted."""
    return isinstance(shape, Wrench)


def at_goal(seen: SeenObject, goal: Goal) -> bool:
    """True if an object is at its goal, within the precision of the user's sight."""
    off, turn = remaining_motion(seen, goal)
    if isinstance(seen.shape, Wrench):
        near = seen.shape.bolt is not None or length(off) < 0.006
        return near and abs(turn) < np.deg2rad(4.0)
    height = abs(float(seen.position[2]) - goal.position[2])
    if goal.on is not None:
        assert isinstance(seen.shape, Box)
        return bool(length(off) < 0.4 * seen.shape.half_size[0] and height < 0.004)
    return bool(length(off) < 0.008 and height < 0.004 and abs(turn) < np.deg2rad(8.0))


def quarter_turn(angle: float) -> float:
    """Returns the smallest angle (rad) that differs from an angle by whole quarter turns."""
    return float((angle + np.pi / 4) % (np.pi / 2) - np.pi / 4)
