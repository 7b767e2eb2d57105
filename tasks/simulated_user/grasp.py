"""Where a person would put thumb and fingers on a box, or on a handle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.objects import Box, Wrench
from tasks.user import SeenObject, UserConfiguration

Array = NDArray[np.float64]

_TIP_RADIUS = 0.007
"""m, what a person takes a drawn fingertip to be."""

_COMFORT = float(np.deg2rad(95.0))
"""rad from the natural axis, as far as a wrist turns to carry something on."""
_FARTHEST = float(np.deg2rad(100.0))
"""rad from the natural axis, as far as a wrist turns at all."""
_OBLIQUE, _SIDESTEP = float(np.deg2rad(60.0)), 0.025
"""rad from the natural axis beyond which the thumb goes along the handle, and m by how much, so
that the hand is turned less than the handle asks for."""
_COUPLE = 0.018
"""m along a handle from the thumb to a single finger: two opposite forces turn nothing, but let it
slip about the line between them."""


@dataclass(frozen=True)
class Grasp:
    """A pinch across a box or a handle.

    Attributes:
        axis: rad, direction from thumb to fingers in the world.
        width: m, distance of the two faces.
        face: m, width of the face that the fingers share.
        grip: m along the object's x axis from its middle to the middle of the pinch.
        side: rad, the axis against the object's x axis.
        skew: m along the face by which the thumb is not opposite to the fingers' middle.
    """

    axis: float
    width: float
    face: float
    grip: float = 0.0
    side: float = 0.0
    skew: float = 0.0

    def axis_on(self, yaw: float) -> float:
        """rad, the axis of this grasp once the object has turned to a yaw."""
        return yaw + self.side

    def middle(self, seen: SeenObject) -> Array:
        """(2,) m, where the middle of the pinch belongs on an object as it is seen."""
        if not self.grip:
            return np.array(seen.position[:2])
        return np.asarray(seen.position[:2] + self.grip * seen.rotation[:2, 0])

    def places(self, centre: Array, gap: float, c: UserConfiguration) -> Array:
        """(n, 2) m, fingertips, thumb first, at `gap` outside the faces (inside if negative)."""
        along = np.array([np.cos(self.axis), np.sin(self.axis)])
        across = np.array([along[1], -along[0]])
        others = c.fingers - 1
        pitch = min(c.pitch, (self.face - 0.004) / max(others - 1, 1))
        # No wider than a real hand opens: the outermost finger is the farthest from the thumb.
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
    """The pair of faces that is most comfortable at the start and at the end of a turn.

    Args:
        box: As it is seen.
        turn: rad by which it is to be turned.
        c: Whose comfort.
    """
    assert isinstance(box.shape, Box)
    half = box.shape.half_size
    options = []
    for quarter in range(4):
        axis = box.yaw + quarter * np.pi / 2
        start, end = axis - c.natural_axis, axis + turn - c.natural_axis
        worst = max(abs(_wrapped(start)), abs(_wrapped(end)))
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        options.append((worst, quarter, Grasp(axis, 2 * width, 2 * face)))
    return min(options, key=lambda o: o[:2])[2]


def choose_handle_grasp(
    seen: SeenObject, turn: float, grip: float, c: UserConfiguration, failed: float | None = None
) -> Grasp:
    """The side of a handle for the thumb from which most of a turn can be made in comfort.

    Args:
        seen: The wrench, as it is seen.
        turn: rad by which it is to be turned.
        grip: m along the handle from the object's middle, where to close.
        c: Whose comfort.
        failed: rad, the side of a grasp that has just come to nothing: the other one is taken if a
            wrist goes there at all.
    """
    assert isinstance(seen.shape, Wrench)
    near, far = seen.shape.handle
    # What the fingers' middles may take up: the outermost is on the handle with its whole pad.
    room = max(far - near - 0.011, 0.0)
    options = []
    for number, side in enumerate((np.pi / 2, -np.pi / 2)):
        axis = seen.yaw + side
        start = abs(_wrapped(axis - c.natural_axis))
        made = within_comfort(axis, turn, c)
        end = abs(_wrapped(axis + made - c.natural_axis))
        # What is left needs another grasp, which is worth some discomfort.
        cost = max(start, end) + 2.0 * (abs(turn) - abs(made))
        if start > _FARTHEST:
            cost += 100.0
        if side == failed:
            cost += 50.0
        # With one finger against the thumb, what they close on begins to turn the way it should.
        skew = float(np.copysign(_COUPLE, turn)) if c.fingers == 2 else 0.0
        if c.fingers > 2 and start > _OBLIQUE:
            skew = -float(np.copysign(_SIDESTEP, _wrapped(axis - c.natural_axis)))
        # All of them stay on the handle; on a short one the thumb comes nearer to the fingers.
        others = min((c.fingers - 2) * c.pitch, room)
        skew = float(np.clip(skew, others - room, room - others))
        span = 0.5 * (others + abs(skew))
        at = float(np.clip(grip, near + 0.008 + span, far - 0.003 - span))
        face = 2 * min(at - near, far - at)
        options.append((cost, number, Grasp(axis, seen.shape.handle_width, face, at, side, skew)))
    return min(options, key=lambda o: o[:2])[2]


def within_comfort(axis: float, turn: float, c: UserConfiguration) -> float:
    """rad of a turn that a hand makes whose thumb and fingers are on an axis, without regrasping.

    A hand that is already turned too far may always turn back.
    """
    now = _wrapped(axis - c.natural_axis)
    low, high = min(-_COMFORT, now), max(_COMFORT, now)
    return float(np.clip(now + turn, low, high) - now)


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
