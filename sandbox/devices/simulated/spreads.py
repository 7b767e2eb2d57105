"""A simulated person who puts down five fingers in three spreads, for `sandbox hand measure`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from math import cos, sin

import numpy as np

from models.arithmetic import Array, small_product, solve_positive, stacked_applied, stacked_product
from models.frames import Contact, TouchFrame
from models.kinematics import Kinematics
from models.person import Person, PersonFrame
from models.pose import POSE_SIZE
from models.skeleton import ADULT, Skeleton
from models.surface import Surface
from sandbox.devices.device import Device

_SPREADS = ((0.0, 0.0, 0.0), (-22.0, -7.0, 25.0), (20.0, 9.0, -10.0))
"""For a relaxed, a closed and a wide hand: extension of the fingers, their spreading about the
middle finger, and rotation of the thumb towards them, in degrees from the middle of each range."""

_TIP_HEIGHT = 0.006
"""Height (m) above the screen of the centre of a touching fingertip, for a hand of size 1."""
_LOOSE = (0.1, np.deg2rad(15.0), np.deg2rad(8.0))
"""Scales of the changes by which the hand adapts to the screen: height (m), tilt (rad), joints
(rad)."""
_ROUNDS = 15

_REST, _PAUSE, _FIRST = 1.0, 0.8, 0.3
"""Durations (s): rest of the fingers, pause off the screen, and wait before the first spread."""
_NOISE = 0.0004
"""Noise (m) of each touch in every frame."""


def spread_layout(skeleton: Skeleton, extension: float, spreading: float, thumb: float) -> Array:
    """Returns the fingertips (5, 2) m of a right hand on a screen, relative to their mean.

    x is right and y up.

    Args:
        skeleton: The hand's skeleton.
        extension, spreading, thumb: rad (see `_SPREADS`).
    """
    wanted = np.zeros(POSE_SIZE)
    joints = wanted[6:].reshape(-1, 3)
    for i, bone in enumerate(skeleton.bones):
        if bone.finger == 0:
            joints[i] = (0.0, 0.0, 0.5 * thumb)
            continue
        first = i == skeleton.first_bone[bone.finger]
        # Spreading from the middle finger: index to one side, ring and little to the other.
        side = (2 - bone.finger) * spreading if first else 0.0
        joints[i] = (extension, 0.0, side)
    kinematics = Kinematics(skeleton)
    loose = np.full(POSE_SIZE, _LOOSE[2])
    loose[:6] = (0.0, 0.0, _LOOSE[0], _LOOSE[1], _LOOSE[1], 0.0)
    q = wanted.copy()
    for _ in range(_ROUNDS):
        tips, jacobian = kinematics.tips_and_jacobian(q)
        J = jacobian[:, 2] * loose
        off = _TIP_HEIGHT - tips[:, 2] + small_product(jacobian[:, 2], q - wanted)
        normal = stacked_product(J, J.T) + 1e-10 * np.eye(5)
        q = wanted + loose * stacked_applied(J.T, solve_positive(normal, off))
    tips = kinematics.tips(q)[:, :2]
    return np.asarray(tips - tips.mean(axis=0))


class SpreadingPerson:
    """Touches of the three spreads, one after another, as a device would report them.

    Args:
        person: Hand, hand size and seat.
        surface: The screen.
        seed: Seed of position, rotation and noise.
    """

    def __init__(self, person: Person, surface: Surface, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 7_003])
        frame = PersonFrame(person, surface)
        middle = frame.surface.size / 2
        self._layouts = []
        for spread in _SPREADS:
            layout = spread_layout(ADULT, *np.deg2rad(spread))
            turn = self._rng.normal(0.0, np.deg2rad(8.0))
            c, s = cos(turn), sin(turn)
            layout = small_product(layout, np.array([[c, s], [-s, c]])) * [1.0, -1.0]
            place = middle + self._rng.normal(0.0, 0.004, 2)
            self._layouts.append(frame.outwards(place + layout))
        self._size = surface.size

    @property
    def ends(self) -> float:
        """Time (s) at which the last finger has left the screen."""
        return _FIRST + len(_SPREADS) * (_REST + _PAUSE)

    def touch(self, now: float) -> TouchFrame:
        """Returns the touches on the screen at the time `now`, s."""
        number, since = divmod(now - _FIRST, _REST + _PAUSE)
        if not (0 <= number < len(self._layouts) and since < _REST):
            return TouchFrame(now, (), source="simulated person")
        xy = self._layouts[int(number)] + self._rng.normal(0.0, _NOISE, (5, 2))
        xy = np.clip(xy, 0.0, self._size)
        contacts = tuple(
            Contact(5 * int(number) + i, float(x), float(y)) for i, (x, y) in enumerate(xy)
        )
        return TouchFrame(now, contacts, source="simulated person")


class SimulatedSpreads(Device):
    """A tablet under the fingers of a simulated person who makes three spreads.

    Args:
        person: Side and size of the hand, and where the person sits.
        surface: The tablet's touch surface.
        seed: Seed of position, turn and noise.
    """

    name = "simulated"

    def __init__(self, person: Person, surface: Surface, seed: int) -> None:
        self._fingers = SpreadingPerson(person, surface, seed)
        self._now = 0.0

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns the touches at the time `now`."""
        if self.finished:
            return []
        self._now = now
        return [self._fingers.touch(now)]

    @property
    def finished(self) -> bool:
        """True once the last finger has left."""
        return self._now > self._fingers.ends

    def close(self) -> None:
        """Ends the device; there is nothing to release."""
        self._now = math.inf
