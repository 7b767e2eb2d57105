"""Fingertip correction: the most likely pose whose fingertips are at the touches.

The encoder's pose is a Gaussian prior. Its mean is the prediction, and its covariance is that of
the encoder's errors in cross-validation. The touches are measurements of the fingertips. A few
Gauss-Newton steps of this Kalman-like update make the fingertips exact. Errors of the wrist and of
the lifted fingers remain only in directions that the touches do not determine. This is the
corrective inverse kinematics that the paper of 2015 suggested as future work.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import (
    Array,
    matrix_product,
    matrix_vector,
    solve_positive,
    times_transposed,
    vector_matrix,
)
from models.errors import EncoderError
from models.frames import FINGERS
from models.pose import JOINTS
from models.single_pose import SinglePose
from models.skeleton import Skeleton

PAD_HEIGHT = 0.006
"""Height (m) of the centre of a touching fingertip's end sphere above the surface: its radius minus
the compression of the flesh, as in the captures."""

_JOINT_OFFSET = JOINTS.start

_ACTIVE_SET_ROUNDS = 10
"""Largest number of rounds of fixing joints at the ends of their ranges and releasing them; two or
three usually suffice."""
_EXACT = 1e-10
"""Variance (rad2) of the measurement that fixes a joint."""
_SLACK = 1e-6
"""Angle (rad) by which a joint may leave its range before it is fixed; the result is clipped."""


class Corrected(NamedTuple):
    """A corrected pose (48,), its largest tip error in metres, and the steps it took."""

    q: Array
    error: float
    iterations: int


class _Seen:
    """Touching fingertips at a pose, and their Jacobian, which is computed on first use.

    Until the Jacobian is computed, the kinematics must not place another pose.

    Args:
        kinematics: Kinematics of the touching fingers.
        q: (48,) the pose.
        tips: (k, 3) m, its touching fingertips.
    """

    def __init__(
        self, kinematics: SinglePose, q: Array, tips: Array, jacobian: Array | None = None
    ) -> None:
        self.kinematics, self.q, self.tips = kinematics, q, tips
        self._jacobian = jacobian

    def jacobian(self) -> Array:
        """(3 k, 48) derivative of the fingertips by the pose."""
        if self._jacobian is None:
            self._jacobian = self.kinematics.jacobian(self.q).reshape(-1, 48)
        return self._jacobian

    def shifted(self, q: Array) -> _Seen:
        """The fingertips at a pose (48,) that differs only in the root's position."""
        return _Seen(self.kinematics, q, self.tips + (q[:3] - self.q[:3]), self.jacobian())


@dataclass(frozen=True)
class CorrectionSettings:
    """Settings of the correction.

    Attributes:
        tip_sigma: Standard deviation (m) of the fingertips about their touches.
        tolerance: Largest tip error (m) at which the steps stop.
        settled: Largest change (rad and m) in a step after which the posture counts as converged.
        iterations: Largest number of steps; five fingers far from the guess need five.
        floor_position: Standard deviation (m) that is added to the encoder's errors of the root's
            position, as a variance.
        floor_angle: Standard deviation (rad) that is added, as a variance, to the encoder's errors
            of angles.
    """

    tip_sigma: float = 0.0003
    tolerance: float = 0.0003
    settled: float = 0.003
    iterations: int = 12
    floor_position: float = 0.002
    floor_angle: float = 0.02


class FingertipCorrection:
    """Moves poses so that labelled fingertips meet their touches, within the joints' ranges.

    Args:
        skeleton: The hand whose fingertips should meet the touches.
        covariance: (48, 48) covariance of the guess's errors (m and rad).
        settings: See `CorrectionSettings`.
    """

    def __init__(
        self,
        skeleton: Skeleton,
        covariance: ArrayLike,
        settings: CorrectionSettings | None = None,
    ) -> None:
        self._skeleton = skeleton
        # Kinematics by the fingers that touch, in the order of their contacts.
        self._kinematics: dict[tuple[int, ...], SinglePose] = {}
        self.settings = settings or CorrectionSettings()
        floor = np.full(48, self.settings.floor_angle**2)
        floor[:3] = self.settings.floor_position**2
        self._covariance = np.asarray(covariance, float) + np.diag(floor)
        self._lower, self._upper = skeleton.lower, skeleton.upper
        # Covariance of the measurements, by number of touches.
        self._noise = [self.settings.tip_sigma**2 * np.eye(3 * k) for k in range(len(FINGERS) + 1)]
        self._last: _Seen | None = None

    def correct(
        self,
        guess: ArrayLike,
        labels: Sequence[int] | NDArray[np.int64],
        targets: ArrayLike,
        start: ArrayLike | None = None,
        settled: float | None = None,
    ) -> Corrected:
        """The pose that is most likely, given a guess, among those with tips at their targets.

        A joint that reaches the end of its range is fixed there, as a further exact measurement,
        and the other joints compensate.

        Args:
            guess: (48,) pose from the encoder, in the frame of the targets.
            labels: (k,) fingers that touch.
            targets: (k, 3) m, where the centres of their fingertips belong.
            start: (48,) pose at which the search starts, such as that of the last frame. It saves
                steps and does not influence the result.
            settled: Replaces `settled` of the settings; None takes the settings.
        """
        s = self.settings
        settled = s.settled if settled is None else settled
        guess = np.array(guess, float)
        targets = np.asarray(targets, float)
        kinematics = self._kinematics_of(tuple(labels))
        # The guess must be within the joints' ranges, or the first linearisation would be at an
        # impossible hand.
        joints = guess[JOINTS]
        np.minimum(np.maximum(joints, self._lower), self._upper, out=joints)
        q = guess.copy() if start is None else np.array(start, float)
        best = Corrected(q, np.inf, 0)
        # A guess whose tips are at their targets is already the most likely pose.
        moved = 0.0 if start is None else np.inf
        for iteration in range(s.iterations + 1):
            seen = self._carried(kinematics, q) if iteration == 0 else self._seen(kinematics, q)
            tips = seen.tips
            off = targets - tips
            error = max([x * x + y * y + z * z for x, y, z in off.tolist()]) ** 0.5
            # The start may have exact tips, but it is not yet the most likely pose.
            if error < max(best.error, s.tolerance) and (start is None or iteration > 0):
                best = Corrected(q, error, iteration)
            if (error < s.tolerance and moved < settled) or iteration == s.iterations:
                break
            known = start is not None or iteration > 0
            J = seen.jacobian()
            r = off.ravel() + matrix_vector(J, q - guess)
            new = self._step(guess, r, J, q[JOINTS] if known else None)
            moved = _largest(new - q)
            q = new
        return best

    def _kinematics_of(self, labels: tuple[int, ...]) -> SinglePose:
        kinematics = self._kinematics.get(labels)
        if kinematics is None:
            kinematics = self._kinematics[labels] = SinglePose(self._skeleton, labels)
        return kinematics

    def _carried(self, kinematics: SinglePose, q: Array) -> _Seen:
        """Touching fingertips and their Jacobian at the pose with which a frame begins.

        This pose is mostly the last frame's result, shifted with the touches. Such a shift moves
        all tips alike and does not change the Jacobian.
        """
        last = self._last
        if (
            last is not None
            and last.kinematics is kinematics
            and last.q[3:].tobytes() == q[3:].tobytes()
        ):
            return last.shifted(q)
        return self._seen(kinematics, q)

    def _seen(self, kinematics: SinglePose, q: Array) -> _Seen:
        """Touching fingertips and their Jacobian at a pose."""
        self._last = _Seen(kinematics, q.copy(), kinematics.tips(q))
        return self._last

    def _step(self, guess: Array, r: Array, J: Array, near: Array | None) -> Array:
        """One Gauss-Newton step within the ranges, by an active-set search.

        A joint that would leave its range is fixed at the end of the range. A fixed joint is
        released if it would move back into its range.

        Args:
            guess: (48,) guess with all joints in their ranges.
            r: (3 k,) m, from the guess's fingertips to their targets, linearised at the current
                pose.
            J: (3 k, 48) derivative of the fingertips at the current pose.
            near: (42,) rad, joints of the current pose; those at the end of their range start as
                fixed. None: no joint starts as fixed.
        """
        C, lower, upper = self._covariance, self._lower, self._upper
        k = len(J)
        JC = matrix_product(J, C)
        free = times_transposed(JC, J)
        free += self._noise[k // 3]
        side = np.zeros(len(lower), np.int64)
        if near is not None:
            above, below = near >= upper, near <= lower
            if (above | below).nonzero()[0].size:
                side = np.subtract(above, below, dtype=np.int64)
        new = guess
        for _ in range(_ACTIVE_SET_ROUNDS):
            held = side.nonzero()[0]
            if not len(held):
                weights = _solved(free.copy(), r)
                new = guess + vector_matrix(weights, JC)
            else:
                rows = held + _JOINT_OFFSET
                bound = np.where(side[held] > 0, upper[held], lower[held])
                # Exact measurements of fixed joints are added to the measurements of the tips.
                A = np.concatenate([JC, C.take(rows, 0)])
                S = np.empty((len(A), len(A)))
                # Only the lower triangle is read.
                S[:k, :k] = free
                S[k:] = A[:, rows].T
                S.reshape(-1)[k * (len(A) + 1) :: len(A) + 1] += _EXACT
                weights = _solved(S, np.concatenate([r, bound - guess[rows]]))
                new = guess + vector_matrix(weights, A)
                new[rows] = bound
            joints = new[JOINTS]
            legal = np.minimum(np.maximum(joints, lower), upper)
            beyond = joints - legal
            inside = not _largest(beyond) > _SLACK
            if not len(held):
                if inside:
                    break
            else:
                wrong = np.sign(weights[k:]) == side[held]
                if inside and True not in wrong.tolist():
                    break
                side[held[wrong]] = 0
            side += (beyond > _SLACK).astype(np.int64) - (beyond < -_SLACK)
        new[JOINTS] = legal
        return new


def _largest(x: Array) -> float:
    """The greatest absolute value of numbers (n,); NaN if any of them is NaN."""
    sizes = np.abs(x)
    return float(sizes[sizes.argmax()])


def _solved(S: Array, r: Array) -> Array:
    """Solution x of S x = r for a covariance S (n, n), which is overwritten."""
    try:
        return solve_positive(S, r)
    except ArithmeticError as trouble:
        raise EncoderError(
            "the guess's covariance cannot be used", expected="a positive definite matrix"
        ) from trouble


def tip_targets(xy: Array) -> Array:
    """Fingertip positions (..., 3) m for touches (..., 2) m; 3-D surface frame."""
    return np.stack([xy[..., 0], -xy[..., 1], np.full(xy.shape[:-1], PAD_HEIGHT)], axis=-1)
