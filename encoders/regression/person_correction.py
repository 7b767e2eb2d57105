"""Trains the correction of estimates of a *person's* pose by the touches.

`encoders.regression.trained.PersonCorrection` weighs the touches by how well the person's bones are
known. Therefore bones are first fitted to the person's capture (`encoders.regression.bone_fit`),
and the weight of the touches is chosen by validation blocked by trial, on skeletons that were
perturbed before their bones were fitted.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.regression.bone_fit import fitted_skeleton, perturbed_skeleton, tip_misses
from encoders.regression.trained import PersonCorrection
from encoders.validation import error_product, trial_folds
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import absolute_pose
from models.skeleton import Skeleton

DISTRUSTS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)
"""Candidate factors on the tips' variance for validation."""

WRONG_LENGTH, WRONG_KNUCKLE = 0.06, 0.004
"""Share and m, standard deviations of lengths and knuckles of perturbed skeletons in validation."""

WRONG_SKELETONS = 3
FOLDS = 5
JUDGED_FRAMES = 1500
"""Number of held-out frames, evenly spaced, on which a factor is evaluated; neighbouring frames are
nearly equal."""


def train_correction(
    capture: Capture, predicted: Array, covariance: Array, skeleton: Skeleton, fit: bool = True
) -> PersonCorrection:
    """Trains a correction for the person of a capture.

    Args:
        capture: Poses and touches.
        predicted: (T, 48) relative poses predicted by an encoder that had not seen their trial.
        covariance: (48, 48) covariance of their errors.
        skeleton: Known skeleton before the fit.
        fit: True fits the bones to the capture. False makes a correction for people with unknown
            bones; the touches' variance is then that about perturbed skeletons.
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
    # The fit of these bones to this person does not carry over to other people.
    return PersonCorrection(skeleton, covariance, distrust * np.mean(variances, axis=0), distrust)


def blocked_variance(capture: Capture, known: Skeleton, fit: bool = True) -> Array:
    """Second moments (3,) m2 of touches about tips, on trials to which the bones were not fitted.

    Both directions along the surface share one value, since no direction on it is special.
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
    """Error products (len(DISTRUSTS),) on held-out trials, starting from a perturbed skeleton."""
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
            scores[i] += error_product(corrected, part.q) * len(held) / len(judged)
    return scores
