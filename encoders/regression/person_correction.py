"""Fingertip correction as an estimate of the *person's* pose.

`encoders.correction` makes the tips of our own hand meet the touches, whatever it takes. Here the
question is another: where is the person's hand? The person has other bones, so a touch tells where
a fingertip of theirs is only as well as their bones are known. Two things follow. Bones are fitted
to the person's capture first (`encoders.regression.bone_fit`). And how far the touches are trusted
is neither assumed nor typed in: it is found by validation blocked by trial, on skeletons that were
made wrong on purpose before their bones were fitted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.regression.bone_fit import (
    fitted_skeleton,
    perturbed_skeleton,
    tip_misses,
    tip_targets,
)
from encoders.validation import badness, trial_folds
from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.limits import within_limits
from models.pose import POSE_SIZE, absolute_pose
from models.skeleton import Skeleton

STEPS = 3
"""Gauss-Newton steps; the tips are then as exact as the trust in the touches wants them."""

DISTRUSTS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)
"""Factors on the tips' variance that validation chooses from."""

WRONG_LENGTH, WRONG_KNUCKLE = 0.06, 0.004
"""Share and m, standard deviations by which validation's skeletons are wrong."""

WRONG_SKELETONS = 3
FOLDS = 5
JUDGED_FRAMES = 1500
"""Held-out frames that judge a trust, spread evenly; neighbours say nearly the same."""

_LIFTED_VARIANCE = 1e6
"""m2, of fingertips that do not touch: nothing is known of them."""


@dataclass(frozen=True)
class PersonCorrection:
    """A Kalman-like update of predicted poses by the touches.

    Attributes:
        skeleton: The person's, as well as it is known.
        covariance: (48, 48) of the predictions' errors on trials not seen, m and rad.
        tip_variance: (3,) m2, of touches about the skeleton's fingertips, times the distrust.
        distrust: What validation chose; 1 if the bones explain all that the touches say.
    """

    skeleton: Skeleton
    covariance: Array
    tip_variance: Array
    distrust: float = 1.0

    def correct(self, q: Array, xy: Array) -> Array:
        """The likeliest poses (T, 48), given predicted ones and touches.

        Args:
            q: (T, 48) predictions, 3-D surface frame.
            xy: (T, 5, 2) m on the surface by label, NaN where lifted.
        """
        kinematics = Kinematics(self.skeleton)
        down = np.repeat(~np.isnan(xy[..., 0]), 3, axis=1)
        targets = np.nan_to_num(tip_targets(xy)).reshape(len(q), -1)
        noise = np.where(down, np.tile(self.tip_variance, len(FINGERS)), _LIFTED_VARIANCE)
        rows = np.arange(down.shape[1])
        out = q
        for _ in range(STEPS):
            tips, J = kinematics.tips_and_jacobian(out)
            J = J.reshape(len(q), -1, POSE_SIZE) * down[..., None]
            off = (targets - tips.reshape(len(q), -1)) * down
            off = off + (J @ (out - q)[..., None])[..., 0]
            spread = J @ self.covariance
            S = spread @ np.swapaxes(J, 1, 2)
            S[:, rows, rows] += noise
            gain = np.linalg.solve(S, off[..., None])
            out = q + (np.swapaxes(spread, 1, 2) @ gain)[..., 0]
        return within_limits(out, self.skeleton)


def train_correction(
    capture: Capture, predicted: Array, covariance: Array, skeleton: Skeleton, fit: bool = True
) -> PersonCorrection:
    """A correction for the person of a capture.

    Args:
        capture: Poses and touches.
        predicted: (T, 48) relative poses predicted by an encoder that had not seen their trial.
        covariance: (48, 48) of their errors.
        skeleton: What is known of the person's bones beforehand.
        fit: Whether bones are fitted to the capture. Without it, the correction is one for people
            whose bones nobody knows, and the touches' variance is that about wrong skeletons.
    """
    fold = trial_folds(capture.trial, FOLDS)
    rng = np.random.default_rng(0)
    wrong = [
        perturbed_skeleton(skeleton, rng, WRONG_LENGTH, WRONG_KNUCKLE)
        for _ in range(WRONG_SKELETONS)
    ]
    variances = [blocked_variance(capture, known, fit) for known in wrong]
    scores = np.zeros(len(DISTRUSTS))
    for known, variance in zip(wrong, variances, strict=True):
        scores += _scores(capture, predicted, covariance, known, variance, fold, fit)
    distrust = DISTRUSTS[int(np.argmin(scores))]
    if fit:
        variance = blocked_variance(capture, skeleton)
        return PersonCorrection(
            fitted_skeleton(capture, skeleton), covariance, distrust * variance, distrust
        )
    # How well these bones happen to fit this person says nothing about the next one.
    return PersonCorrection(skeleton, covariance, distrust * np.mean(variances, axis=0), distrust)


def blocked_variance(capture: Capture, known: Skeleton, fit: bool = True) -> Array:
    """(3,) m2, second moments of touches about tips, on trials that the bones were not fitted to.

    The two directions along the surface share one number: no direction on it is special.
    """
    fold = trial_folds(capture.trial, FOLDS)
    misses = []
    for k in np.unique(fold):
        out = fold == k
        bones = fitted_skeleton(capture.select(~out), known) if fit else known
        misses.append(tip_misses(Kinematics(bones), capture.select(out)))
    x, y, z = np.mean(np.concatenate(misses) ** 2, axis=0)
    return np.array([0.5 * (x + y), 0.5 * (x + y), z])


def _scores(
    capture: Capture,
    predicted: Array,
    covariance: Array,
    known: Skeleton,
    variance: Array,
    fold: NDArray[np.int64],
    fit: bool,
) -> Array:
    """(len(DISTRUSTS),) badness on held-out trials, starting from a wrong skeleton."""
    judged = np.linspace(0, len(capture) - 1, min(len(capture), JUDGED_FRAMES)).astype(int)
    scores = np.zeros(len(DISTRUSTS))
    for k in np.unique(fold):
        bones = fitted_skeleton(capture.select(fold != k), known) if fit else known
        held = judged[fold[judged] == k]
        part = capture.select(held)
        q = absolute_pose(predicted[held], part.leftmost)
        for i, distrust in enumerate(DISTRUSTS):
            correction = PersonCorrection(bones, covariance, distrust * variance)
            corrected = correction.correct(q, part.xy)
            scores[i] += badness(corrected, part.q) * len(held) / len(judged)
    return scores
