"""Grasp planning of the simulated user: places for thumb and fingers on a box or a handle."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.objects import Box, Wrench
from tasks.user import SeenObject, UserConfiguration

_TIP_RADIUS = 0.007
"""m, radius of a fingertip as the user assumes it."""

_COMFORT = float(np.deg2rad(95.0))
"""rad from the natural axis, limit of the wrist's rotation while carrying."""
_FARTHEST = float(np.deg2rad(100.0))
"""rad from the natural axis, limit of the wrist's rotation."""
_OBLIQUE, _SIDESTEP = float(np.deg2rad(60.0)), 0.025
"""rad from the natural axis beyond which the thumb is shifted along the handle, and m of this
shift, so that the hand is rotated less than the handle requires."""
_COUPLE = 0.018
"""m along a handle from the thumb to a single finger: two directly opposite fingers could not turn
the handle, which would slip about the line between them."""


@dataclass(frozen=True)
class Grasp:
    """A pinch across a box or a handle.

    Attributes:
        axis: rad, direction from thumb to fingers in the world.
        width: m, distance between the two faces.
        face: m, width of the face that the fingers share.
        grip: m along the object's x axis from its middle to the middle of the pinch.
        side: rad, the axis relative to the object's x axis.
        skew: m along the face, shift of the thumb from the point opposite the fingers' middle.
    """

    axis: float
    width: float
    face: float
    grip: float = 0.0
    side: float = 0.0
    skew: float = 0.0

    def axis_on(self, yaw: float) -> float:
        """Axis of this grasp, in rad, once the object has turned to a yaw."""
        return yaw + self.side

    def middle(self, seen: SeenObject) -> Array:
        """Position (2,) m of the middle of the pinch on an object as seen."""
        if not self.grip:
            return np.array(seen.position[:2])
        return np.asarray(seen.position[:2] + self.grip * seen.rotation[:2, 0])

    def places(self, centre: Array, gap: float, c: UserConfiguration) -> Array:
        """Positions (n, 2) m of the fingertips, thumb first, at `gap` outside the faces (inside if
        negative)."""
        along = np.array([cos(self.axis), sin(self.axis)])
        across = np.array([along[1], -along[0]])
        others = c.fingers - 1
        pitch = min(c.pitch, (self.face - 0.004) / max(others - 1, 1))
        # At most the span of a real hand: the outermost finger is the farthest from the thumb.
        widest = 0.5 * np.sqrt(c.longest_span**2 - (0.5 * (others - 1) * pitch) ** 2)
        reach = min(self.width / 2 + _TIP_RADIUS + gap, widest)
        # Index first: with the thumb to the lower left, the index is the leftmost finger.
        offsets = (np.arange(others) - (others - 1) / 2) * pitch
        fingers = centre + reach * along + offsets[:, None] * across
        if self.skew:
            fingers = fingers - 0.5 * self.skew * across
            centre = centre + 0.5 * self.skew * across
        return np.vstack([centre - reach * along, fingers])


def choose_grasp(box: SeenObject, turn: float, c: UserConfiguration) -> Grasp:
    """Chooses the pair of faces that is most comfortable at the start and the end of a turn.

    Args:
        box: The box as seen.
        turn: rad by which it is to be turned.
        c: The user whose comfort counts.
    """
    assert isinstance(box.shape, Box)
    half = box.shape.half_size
    options = []
    for quarter in range(4):
        axis = box.yaw + quarter * np.pi / 2
        start, end = axis - c.natural_axis, axis + turn - c.natural_axis
        worst = max(abs(wrapped(start)), abs(wrapped(end)))
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        options.append((worst, quarter, Grasp(axis, 2 * width, 2 * face)))
    return min(options, key=lambda o: o[:2])[2]


def choose_handle_grasp(
    seen: SeenObject, turn: float, grip: float, c: UserConfiguration, failed: float | None = None
) -> Grasp:
    """Chooses the side of a handle for the thumb that allows the largest comfortable turn.

    Args:
        seen: The wrench as seen.
        turn: rad by which it is to be turned.
        grip: m along the handle from the object's middle, where the fingers close.
        c: The user whose comfort counts.
        failed: rad, the side of a grasp that has just failed: the other one is chosen if the wrist
            can reach it.
    """
    assert isinstance(seen.shape, Wrench)
    near, far = seen.shape.handle
    # Available width for the fingers' middles: the outermost has its whole pad on the handle.
    room = max(far - near - 0.011, 0.0)
    options = []
    for number, side in enumerate((np.pi / 2, -np.pi / 2)):
        axis = seen.yaw + side
        start = abs(wrapped(axis - c.natural_axis))
        made = within_comfort(axis, turn, c)
        end = abs(wrapped(axis + made - c.natural_axis))
        # The rest of the turn needs another grasp, which is worth some discomfort.
        cost = max(start, end) + 2.0 * (abs(turn) - abs(made))
        if start > _FARTHEST:
            cost += 100.0
        if side == failed:
            cost += 50.0
        # With one finger against the thumb, the handle begins to turn in the intended direction.
        skew = float(np.copysign(_COUPLE, turn)) if c.fingers == 2 else 0.0
        if c.fingers > 2 and start > _OBLIQUE:
            skew = -float(np.copysign(_SIDESTEP, wrapped(axis - c.natural_axis)))
        # All fingers stay on the handle; on a short one the thumb comes nearer to the fingers.
        others = min((c.fingers - 2) * c.pitch, room)
        skew = float(np.clip(skew, others - room, room - others))
        span = 0.5 * (others + abs(skew))
        at = float(np.clip(grip, near + 0.008 + span, far - 0.003 - span))
        face = 2 * min(at - near, far - at)
        options.append((cost, number, Grasp(axis, seen.shape.handle_width, face, at, side, skew)))
    return min(options, key=lambda o: o[:2])[2]


def within_comfort(axis: float, turn: float, c: UserConfiguration) -> float:
    """Part in rad of a turn that a hand on an axis can make without regrasping.

    A hand that is already rotated too far may always turn back.
    """
    now = wrapped(axis - c.natural_axis)
    low, high = min(-_COMFORT, now), max(_COMFORT, now)
    return float(np.clip(now + turn, low, high) - now)


def wrapped(angle: float) -> float:
    """Wraps an angle, rad, to -pi to pi."""
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
