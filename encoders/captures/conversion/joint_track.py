"""Poses of a hand over time, interpolated at any moment."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.errors import CaptureError
from models.kinematics import Kinematics
from models.pose import POSE_SIZE, ROOT_ROTATION
from models.rotations import unwrap_near
from models.skeleton import Skeleton


@dataclass(frozen=True)
class JointTrack:
    """A track of J poses of a right hand (a left hand is mirrored first).

    Attributes:
        time: (J,) s on the recorder's clock, increasing.
        q: (J, 48) in the 3-D surface frame.
        skeleton: The hand's skeleton.
    """

    time: Array
    q: Array
    skeleton: Skeleton

    def __post_init__(self) -> None:
        if self.time.ndim != 1 or self.q.shape != (len(self.time), POSE_SIZE):
            raise CaptureError(
                "times and poses disagree",
                where="joints",
                got=(self.time.shape, self.q.shape),
                expected=f"(J,) and (J, {POSE_SIZE})",
            )
        if len(self.time) < 2:
            raise CaptureError(
                "too few poses", where="joints", got=len(self.time), expected="at least two"
            )
        if not (np.isfinite(self.time).all() and np.isfinite(self.q).all()):
            raise CaptureError("times and poses must be finite", where="joints")
        if (np.diff(self.time) <= 0).any():
            raise CaptureError(
                "the time runs backwards or stands still",
                where="joints",
                expected="increasing times",
            )

    @cached_property
    def kinematics(self) -> Kinematics:
        """Kinematics of the skeleton."""
        return Kinematics(self.skeleton)

    @cached_property
    def period(self) -> float:
        """Median time (s) between two poses."""
        return float(np.median(np.diff(self.time)))

    @cached_property
    def tips(self) -> Array:
        """Centres (J, 5, 3) m of the fingertips."""
        return self.kinematics.tips(self.q)

    def at(self, times: Array, gap: float) -> tuple[Array, NDArray[np.bool_]]:
        """Interpolates poses (m, 48) at times (m,) s.

        Also returns booleans (m,): True where the pose is known. It is unknown outside the track,
        and between two poses that are farther apart than `gap` (s) and 1.5 periods.
        """
        before, share, known = self._between(times, gap)
        a, b = self.q[before], self.q[before + 1].copy()
        # Rotation vectors of successive poses may differ by a whole turn.
        b[:, ROOT_ROTATION] = unwrap_near(b[:, ROOT_ROTATION], a[:, ROOT_ROTATION])
        return a + share[:, None] * (b - a), known

    def tips_at(self, times: Array, gap: float) -> tuple[Array, NDArray[np.bool_]]:
        """Interpolates fingertips at times (m,) s.

        Returns:
            Positions (m, 5, 3) m, and booleans (m,): True where they are known.
        """
        before, share, known = self._between(times, gap)
        a, b = self.tips[before], self.tips[before + 1]
        return a + share[:, None, None] * (b - a), known

    def tip_at(self, finger: int, times: Array, gap: float) -> tuple[Array, NDArray[np.bool_]]:
        """Interpolates one fingertip at times (m,) s.

        Returns:
            Positions (m, 3) m, and booleans (m,): True where they are known.
        """
        tips, known = self.tips_at(times, gap)
        return tips[:, finger], known

    def _between(
        self, times: Array, gap: float
    ) -> tuple[NDArray[np.int64], Array, NDArray[np.bool_]]:
        after = np.searchsorted(self.time, times, side="right")
        before = np.clip(after - 1, 0, len(self.time) - 2)
        span = self.time[before + 1] - self.time[before]
        share = (times - self.time[before]) / span
        slack = 1e-6 / span  # tolerance for rounded times
        met = (np.abs(share) <= slack) | (np.abs(share - 1) <= slack)
        bridged = (share > 0) & (share < 1) & (span <= max(gap, 1.5 * self.period))
        known = met | bridged
        return before.astype(np.int64), np.clip(share, 0, 1), known
