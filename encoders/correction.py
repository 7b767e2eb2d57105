"""Fingertip correction: the likeliest pose whose fingertips are where the touches are.

The encoder's pose is taken as a Gaussian guess: its mean is the prediction, its covariance that of
the encoder's own errors in cross-validation. The touches are measurements of the fingertips. A few
Gauss-Newton steps of this Kalman-like update carry the error of the wrist and of the lifted fingers
into directions that the touches do not see, and leave the fingertips exact. This is the corrective
inverse kinematics that the paper of 2015 suggested for later.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.kinematics import Kinematics
from models.pose import JOINTS

Array = NDArray[np.float64]

_JOINT_OFFSET = JOINTS.start


class Corrected(NamedTuple):
    """A corrected pose (48,), its largest tip error in metres, and the steps it took."""

    q: Array
    error: float
    iterations: int


@dataclass(frozen=True)
class CorrectionSettings:
    """How the correction works.

    Attributes:
        tip_sigma: m, how exactly the tips are to meet the touches.
        tolerance: m, largest tip error at which the steps stop.
        iterations: Most steps; five fingers far from the guess need five.
        floor_position: m, smallest trusted error of the encoder in a position.
        floor_angle: rad, smallest trusted error of the encoder in an angle.
    """

    tip_sigma: float = 0.0003
    tolerance: float = 0.0003
    iterations: int = 12
    floor_position: float = 0.002
    floor_angle: float = 0.02


class FingertipCorrection:
    """Moves poses so that labelled fingertips meet their touches, within the joints' ranges.

    Args:
        kinematics: Of the hand whose fingertips are to meet the touches.
        covariance: (48, 48) of the guess's error, m and rad.
        settings: See there.
    """

    def __init__(
        self,
        kinematics: Kinematics,
        covariance: ArrayLike,
        settings: CorrectionSettings | None = None,
    ) -> None:
        self._kinematics = kinematics
        self.settings = settings or CorrectionSettings()
        floor = np.full(48, self.settings.floor_angle**2)
        floor[:3] = self.settings.floor_position**2
        self._covariance = np.asarray(covariance, float) + np.diag(floor)
        skeleton = kinematics.skeleton
        self._lower, self._upper = skeleton.lower, skeleton.upper

    def correct(
        self,
        guess: ArrayLike,
        labels: ArrayLike,
        targets: ArrayLike,
        start: ArrayLike | None = None,
    ) -> Corrected:
        """The likeliest pose near a guess whose tips are at their targets.

        A joint that reaches the end of its range is held there, as a further exact measurement,
        and the other joints make up for it.

        Args:
            guess: (48,) pose from the encoder, in the frame of the targets.
            labels: (k,) fingers that touch.
            targets: (k, 3) m, where the centres of their fingertips belong.
            start: (48,) pose near which the result is expected, the last frame's; it saves steps
                and does not pull the result towards itself.
        """
        s = self.settings
        guess = np.array(guess, float)
        labels, targets = np.asarray(labels, int), np.asarray(targets, float)
        # The guess itself must be legal, or the first linearisation is taken at no hand at all.
        guess[JOINTS] = np.clip(guess[JOINTS], self._lower, self._upper)
        q = guess.copy() if start is None else np.array(start, float)
        held = np.zeros(len(self._lower), bool)
        best = Corrected(q, np.inf, 0)
        for iteration in range(s.iterations + 1):
            tips, jacobian = self._kinematics.tips_and_jacobian(q)
            off = targets - tips[labels]
            error = float(np.sqrt(np.max(np.einsum("ij,ij->i", off, off))))
            # The start is where the last frame ended: exact perhaps, but not yet near the guess.
            fresh = start is None or iteration > 0
            if fresh and error < best.error:
                best = Corrected(q, error, iteration)
            if fresh and (error < s.tolerance or iteration == s.iterations):
                break
            J = jacobian[labels].reshape(-1, 48)
            q, held = self._step(q, guess, off.ravel(), J, held)
        return best

    def _step(
        self, q: Array, guess: Array, off: Array, J: Array, held: NDArray[np.bool_]
    ) -> tuple[Array, NDArray[np.bool_]]:
        """One Gauss-Newton step; joints that leave their range are caught and the step redone."""
        C, variance = self._covariance, self.settings.tip_sigma**2
        r = off + J @ (q - guess)
        bound = np.clip(q[JOINTS], self._lower, self._upper)
        for _ in range(4):
            rows = np.flatnonzero(held) + _JOINT_OFFSET
            # Exact measurements of held joints beside the measurements of the tips.
            A = np.concatenate([J @ C, C[rows]]) if len(rows) else J @ C
            S = np.empty((len(A), len(A)))
            k = len(J)
            S[:, :k] = A @ J.T
            S[:, k:] = A[:, rows]
            S[range(k), range(k)] += variance
            S[range(k, len(A)), range(k, len(A))] += 1e-10
            residual = np.concatenate([r, bound[held] - guess[rows]]) if len(rows) else r
            new = guess + A.T @ np.linalg.solve(S, residual)
            joints = new[JOINTS]
            beyond = (joints < self._lower - 1e-6) | (joints > self._upper + 1e-6)
            newly = beyond & ~held
            if not newly.any():
                break
            bound = np.where(newly, np.clip(joints, self._lower, self._upper), bound)
            held = held | newly
        new[JOINTS] = np.clip(new[JOINTS], self._lower, self._upper)
        return new, held
