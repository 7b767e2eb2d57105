"""Resamples poses at uneven times to keys at an even rate.

Between two poses the wrist moves on a straight line, and joints rotate at a constant speed (slerp).
Poses are added in batches, and only the last pose is stored.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.motion.armature import Armature, Keys
from models.motion.output import checked_rate
from models.rotations import quaternion_to_matrix

MOST = 250_000
"""Largest number of keys between two poses: 70 minutes at 60 Hz. If a clock jumped by days, the
keys would exceed any memory."""

SLACK = 1e-6
"""Share of a period by which a key may lie after the last pose, because of rounded clocks."""


class Poses(NamedTuple):
    """Poses of H hands at n moments.

    Attributes:
        time: (n,) s, increasing.
        root: (n, H, 3) m, wrists in the world.
        turns: (n, H, 15, 4) unit quaternions w, x, y, z: the palm's in the world, the bones'
            relative to rest.
    """

    time: Array
    root: Array
    turns: Array


class Sampler:
    """Converts poses to keys.

    Args:
        armatures: The hands.
        rate: Rate (Hz) of the keys.
    """

    def __init__(self, armatures: tuple[Armature, ...], rate: float) -> None:
        self._armatures, self._rate = armatures, checked_rate(rate)
        self._last: Poses | None = None
        self._first = 0.0
        self._next = 0

    def add(self, poses: Poses) -> tuple[Keys, ...] | None:
        """Adds poses.

        Returns:
            The new keys of every hand up to the last pose; None if there is no new key.

        Raises:
            MotionError: The time of the poses does not increase, or pauses for too long.
        """
        if not len(poses.time):
            return None
        if self._last is None:
            self._first = float(poses.time[0])
        else:
            poses = Poses(*(np.concatenate(pair) for pair in zip(self._last, poses, strict=True)))
        if (np.diff(poses.time) <= 0).any() or not np.isfinite(poses.time).all():
            raise MotionError("the time of the poses does not increase")
        self._check_pauses(poses.time)
        self._last = Poses(*(part[-1:] for part in poses))
        time = poses.time - self._first
        end = int(np.floor(time[-1] * self._rate + SLACK))
        if end < self._next:
            return None
        at = np.arange(self._next, end + 1) / self._rate
        self._next = end + 1
        return self._between(time, poses, at)

    def _check_pauses(self, time: Array) -> None:
        pauses = np.diff(time)
        if not len(pauses) or (longest := float(pauses.max())) * self._rate <= MOST:
            return
        after = float(time[int(pauses.argmax())]) - self._first
        raise MotionError(
            "the motion pauses for too long, or its clock was set",
            got=f"{longest:.0f} s without a pose, {after:.2f} s after the first",
            expected=f"at most {MOST / self._rate:.0f} s at {self._rate:g} keys a second",
            remedy="Cut the recording in two at this pause",
        )

    def _between(self, time: Array, poses: Poses, at: Array) -> tuple[Keys, ...]:
        before = np.clip(np.searchsorted(time, at, side="right") - 1, 0, max(len(time) - 2, 0))
        after = np.minimum(before + 1, len(time) - 1)
        span = np.maximum(time[after] - time[before], 1e-12)
        share = np.clip((at - time[before]) / span, 0.0, 1.0)
        part = share[:, None, None]
        root = poses.root[before] + part * (poses.root[after] - poses.root[before])
        turns = slerp(poses.turns[before], poses.turns[after], part[..., None])
        matrices = quaternion_to_matrix(turns)
        return tuple(
            armature.of_turns(root[:, i], matrices[:, i])
            for i, armature in enumerate(self._armatures)
        )


def slerp(a: Array, b: Array, share: Array) -> Array:
    """Spherical interpolation of unit quaternions (..., 4) from a (share 0) to b (share 1), by the
    smaller rotation."""
    cosine = np.sum(a * b, axis=-1, keepdims=True)
    b = np.where(cosine < 0, -b, b)
    # The tangent of half the angle is accurate for small angles.
    angle = 2 * np.arctan2(
        np.linalg.norm(a - b, axis=-1, keepdims=True), np.linalg.norm(a + b, axis=-1, keepdims=True)
    )
    sine = np.sin(angle)
    small = sine < 1e-9
    safe = np.where(small, 1.0, sine)
    one = np.where(small, 1 - share, np.sin((1 - share) * angle) / safe)
    two = np.where(small, share, np.sin(share * angle) / safe)
    out = one * a + two * b
    return np.asarray(out / np.linalg.norm(out, axis=-1, keepdims=True))
