"""Simulated measurement of the second subject: touches by a screen, and the hand by markers.

Markers have errors of position, not of joint angle. Each marker is a little off its joint for the
whole day, and trembles with the skin. Measured bones go from marker to marker. So an error of one
marker rotates the two bones that meet there in opposite directions, and short bones more than long
bones.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.pose import BALL_JOINTS, JOINTS, ROOT_POSITION, ROOT_ROTATION
from models.surface import Surface
from training.second_subject.configuration import SecondConfiguration
from training.second_subject.hand import SecondHand

_LAST = np.array([1, 4, 7, 10, 13])
_FIRST = np.array([0, 2, 5, 8, 11])


def touches(
    rng: np.random.Generator,
    tips: Array,
    along: Array,
    takes: NDArray[np.int64],
    rate: float,
    surface: Surface,
    c: SecondConfiguration,
) -> Array:
    """Touches (n, 5, 2) m of the fingertips as a screen reports them, x right and y down.

    Args:
        rng: Source of jitter.
        tips: (n, 5, 3) m, 3-D surface frame.
        along: (n, 5, 3) directions of the last bones.
        takes: (n,) number of the take. Jitter is not correlated between takes.
        rate: Rate (Hz) of the frames.
        surface: The screen.
        c: Sizes of errors.
    """
    # A flat finger touches with its pad, behind the tip. An upright finger touches with the tip.
    steep = np.clip(-along[..., 2], 0.0, 1.0)
    flat = along[..., :2] / np.maximum(np.linalg.norm(along[..., :2], axis=-1, keepdims=True), 1e-6)
    seen = tips[..., :2] - c.pad * ((1 - steep) ** 0.75)[..., None] * flat
    memory = c.jitter_memory ** (30.0 / rate)
    noise = c.jitter * rng.laplace(0, np.sqrt(0.5), seen.shape)
    for i in range(1, len(noise)):
        if takes[i] == takes[i - 1]:
            noise[i] = memory * noise[i - 1] + np.sqrt(1 - memory**2) * noise[i]
    seen = (seen + noise) * np.array([1.0, -1.0])
    cells = np.floor(np.clip(seen, 0.0, surface.size - c.grid) / c.grid)
    return np.asarray((cells + 0.5) * c.grid)


class Markers:
    """The markers of one day, with their errors.

    Args:
        rng: Source of the markers' errors.
        hand: The hand that wears them.
        c: Sizes of errors.
    """

    def __init__(self, rng: np.random.Generator, hand: SecondHand, c: SecondConfiguration) -> None:
        self._hand, self._c = hand, c
        # Errors of markers at joints and fingertips, in the frames of their bones. They are uniform
        # in a box, with the standard deviation c.marker on each axis.
        self._joints = np.sqrt(3) * c.marker * rng.uniform(-1, 1, (BALL_JOINTS, 3))
        self._tips = np.sqrt(3) * c.marker * rng.uniform(-1, 1, (5, 3))
        self._palm = np.sqrt(3) * c.palm_marker * rng.uniform(-1, 1, (3, 3))

    def poses(self, rng: np.random.Generator, q: Array) -> Array:
        """Measured poses (n, 48) for true poses (n, 48), limited to the ranges of the joints."""
        from scipy.spatial.transform import Rotation

        hand, c, n = self._hand, self._c, len(q)

        def tremble(count: int) -> Array:
            return rng.laplace(0, c.tremble / np.sqrt(2), (n, count, 3))

        places, rotations, tips = hand.chain(q)
        places = places + (rotations @ self._joints[..., None])[..., 0] + tremble(BALL_JOINTS)
        tips = tips + (rotations[:, _LAST] @ self._tips[..., None])[..., 0] + tremble(5)
        ends = np.empty_like(places)
        ends[:, :-1] = places[:, 1:]
        ends[:, _LAST] = tips
        seen = _onto(rotations, ends - places)

        root = Rotation.from_rotvec(q[:, ROOT_ROTATION]).as_matrix()
        wrist, index, little = np.swapaxes(self._palm + tremble(3), 0, 1)
        # Small apparent rotations of the palm, caused by errors of its three markers.
        length, width = hand.knuckle[2, 1], hand.knuckle[4, 0] - hand.knuckle[1, 0]
        middle = 0.5 * (index + little)
        lean = np.stack(
            [
                (middle - wrist)[:, 2] / length,
                (index - little)[:, 2] / width,
                (wrist - middle)[:, 0] / length,
            ],
            axis=-1,
        )
        palm = root @ Rotation.from_rotvec(lean).as_matrix()
        out = q.copy()
        out[:, ROOT_POSITION] += (root @ wrist[..., None])[..., 0]
        out[:, ROOT_ROTATION] = Rotation.from_matrix(palm).as_rotvec()
        before = np.empty_like(seen)
        before[:, 1:] = seen[:, :-1]
        before[:, _FIRST] = palm[:, None]
        relative = _between(before, seen, hand)
        lower, upper = hand.joint_limits()
        vectors = Rotation.from_matrix(relative.reshape(-1, 3, 3)).as_rotvec().reshape(n, -1)
        out[:, JOINTS] = np.clip(vectors, lower, upper)
        return out


def _onto(rotations: Array, lines: Array) -> Array:
    """Rotates frames (..., 3, 3) by the smallest angle with which their y axes point along lines
    (..., 3)."""
    y = rotations[..., 1]
    goal = lines / np.linalg.norm(lines, axis=-1, keepdims=True)
    axis = np.cross(y, goal)
    share = 1 / (1 + (y * goal).sum(axis=-1))
    # R = I + K + K^2 / (1 + y.goal), applied to each column: K a = axis x a.
    columns = np.swapaxes(rotations, -1, -2)
    once = np.cross(axis[..., None, :], columns)
    twice = np.cross(axis[..., None, :], once)
    return np.swapaxes(columns + once + share[..., None, None] * twice, -1, -2)


def _between(before: Array, after: Array, hand: SecondHand) -> Array:
    """Joint rotations (n, 14, 3, 3) from the parent bones (n, 14, 3, 3) to their children."""
    rest = hand.rests()
    return np.swapaxes(before @ rest, -1, -2) @ after
