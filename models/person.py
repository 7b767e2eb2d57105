"""The person at the screen: the hand, its size, and the side of the screen at which they sit.

All models are trained for a right hand of one size at the lower edge of a screen. `PersonFrame`
serves all other people: it rotates, mirrors and scales their touches to those that the trained hand
would have made, and transforms the pose back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.errors import InputError
from models.pose import ROOT_POSITION, ROOT_ROTATION, mirrored
from models.rotations import exp, log
from models.skeleton import Skeleton
from models.surface import Surface

HANDS = ("right", "left")
TURNS = (0, 90, 180, 270)
SIZES = (0.6, 1.6)
"""Least and greatest length of a hand relative to the trained hand: from the hand of a small child
to more than that of any adult. A value outside this range was probably mistyped."""


@dataclass(frozen=True)
class Person:
    """Hand, hand size and seat of a person.

    Attributes:
        hand: One of `HANDS`.
        hand_size: Length of the hand relative to the hand that encoders were trained on.
        turn: Edge of the screen at which the person sits, in degrees counterclockwise: 0 for the
            lower edge, 90 for the right, 180 for the upper, 270 for the left edge.
    """

    hand: str = HANDS[0]
    hand_size: float = 1.0
    turn: int = 0

    def __post_init__(self) -> None:
        if self.hand not in HANDS:
            raise InputError(
                "no such hand", where="--hand", got=self.hand, expected=" or ".join(HANDS)
            )
        if not (np.isfinite(self.hand_size) and SIZES[0] <= self.hand_size <= SIZES[1]):
            raise InputError(
                "the hand size is out of range",
                where="--hand-size",
                got=self.hand_size,
                expected=f"{SIZES[0]:g} to {SIZES[1]:g} times the length of the trained hand",
                remedy="`sandbox hand measure` measures it",
            )
        if self.turn not in TURNS:
            raise InputError(
                "unknown side of the screen",
                where="--turn",
                got=self.turn,
                expected=", ".join(map(str, TURNS)),
            )

    @property
    def left(self) -> bool:
        """True for a left hand."""
        return self.hand == "left"

    def skeleton(self, trained: Skeleton) -> Skeleton:
        """Skeleton of this person's hand, derived from the trained skeleton. If both are equal, the
        result is the same object."""
        sized = trained if self.hand_size == 1.0 else trained.scaled(self.hand_size)
        return sized.mirrored() if self.left else sized


@dataclass(frozen=True)
class RestSample:
    """Touches and pose of a person's hand at one moment; JSON values only.

    Both are as seen from the lower edge of the screen and in the person's own size. Those of a left
    hand are mirrored to a right hand. `encoders.person.rest_posture` uses them.

    Attributes:
        touches: Position (x right, y down) m of each finger, thumb first; None for a lifted finger.
        pose: The 48 numbers of `models.pose`, m and rad.
    """

    touches: tuple[tuple[float, float] | None, ...]
    pose: tuple[float, ...]


RestSamples = tuple[RestSample, ...]


class PersonFrame:
    """Transforms between a screen and the frame in which every hand is the trained right hand.

    The transform inwards rotates the screen by the person's seat, mirrors it for a left hand, and
    scales it to the trained hand's size. Both frames are surface frames: origin top left, x right,
    y down, m.

    Args:
        person: The person who touches.
        surface: The screen, anywhere in the world.

    Attributes:
        person: The person who touches.
        surface: The screen in the trained hand's frame, rotated and scaled with the touches. It is
            at the world's origin, so that world poses are poses in its 3-D surface frame.
        matrix: (2, 2) orthogonal matrix from differences of positions on the screen to differences
            in the trained hand's frame, before they are scaled.
    """

    def __init__(self, person: Person, surface: Surface) -> None:
        self.person = person
        size = surface.size
        quarter = person.turn // 90
        step = np.linalg.matrix_power(np.array([[0.0, -1.0], [1.0, 0.0]]), quarter)
        if person.left:
            step = np.diag([-1.0, 1.0]) @ step
        corner = step @ size
        self.matrix: Array = step
        self._shift = np.maximum(-corner, 0.0)
        width, height = (surface.width_in, surface.height_in)[:: -1 if quarter % 2 else 1]
        scale = person.hand_size
        self.surface = Surface(width / scale, height / scale, calibrated=surface.calibrated)

    @property
    def trivial(self) -> bool:
        """True if the transform is the identity."""
        return self.person == Person()

    def inwards(self, xy: ArrayLike) -> Array:
        """Transforms points (..., 2) of the screen to the trained hand's frame."""
        return (np.asarray(xy, float) @ self.matrix.T + self._shift) / self.person.hand_size

    def outwards(self, xy: ArrayLike) -> Array:
        """Inverse of `inwards`."""
        return (np.asarray(xy, float) * self.person.hand_size - self._shift) @ self.matrix

    def outward_steps(self, steps: ArrayLike) -> Array:
        """Transforms differences (..., 2) between points outwards, without the frames' origins."""
        return np.asarray(steps, float) * self.person.hand_size @ self.matrix

    def inward_steps(self, steps: ArrayLike) -> Array:
        """Inverse of `outward_steps`."""
        return np.asarray(steps, float) @ self.matrix.T / self.person.hand_size

    def outward_pose(self, q: ArrayLike) -> Array:
        """The person's pose (..., 48) in the screen's 3-D surface frame.

        Args:
            q: (..., 48) pose of the trained right hand in its 3-D surface frame.
        """
        q = np.array(q, float)
        q[..., ROOT_POSITION] *= self.person.hand_size
        if self.person.left:
            q = mirrored(q)
        # The touch frame has y down, the 3-D frame y up.
        flip = np.diag([1.0, -1.0])
        shift = np.array([1.0, -1.0]) * (self._shift @ self.matrix)
        if self.person.turn == 0:
            q[..., :2] -= shift
            return q
        unmirrored = np.diag([-1.0, 1.0]) @ self.matrix if self.person.left else self.matrix
        rotation = np.eye(3)
        rotation[:2, :2] = flip @ unmirrored.T @ flip
        q[..., ROOT_POSITION] = q[..., ROOT_POSITION] @ rotation.T
        q[..., :2] -= shift
        q[..., ROOT_ROTATION] = log(rotation @ exp(q[..., ROOT_ROTATION]))
        return q
