"""Fits bone lengths and knuckle positions of a person to a capture of that person.

For given rotations of the joints, the position of a fingertip is linear in the position of its
knuckle and in the lengths of its bones. A capture contains rotations and, while a finger touches,
the position of its tip. The bones of each finger are therefore the solution of a small linear
least-squares problem, regularised towards a known skeleton where the data do not determine them.

`encoders.regression.trained.PersonCorrection` corrects poses by touches, with a weight that depends
on how well the person's bones are known. `train_correction` chooses this weight by validation
blocked by trial. In the validation, the fits start from perturbed skeletons.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.correction import tip_targets
from encoders.regression.trained import PersonCorrection
from encoders.validation import error_product, trial_folds
from models.arithmetic import Array
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import ROOT_POSITION, ROOT_ROTATION, absolute_pose
from models.rotations import exp
from models.skeleton import Bone, Skeleton

KNUCKLE_SPREAD = 0.010
"""Assumed standard deviation (m) of people's knuckles about those of the known skeleton."""
LENGTH_SPREAD = 0.10
"""Assumed standard deviation of people's bone lengths, as a share of the length. A few takes with
touches of a finger outweigh both assumptions."""
_MISFIT = 0.004
"""Assumed standard deviation (m) of a touch about its fingertip: pads roll, and joint angles are
measured with errors."""
_INDEPENDENT = 200
"""Maximum number of touches of one finger that count as independent, since the frames of a take are
nearly equal."""


def tip_misses(kinematics: Kinematics, capture: Capture) -> Array:
    """Offsets (M, 3) m from the skeleton's fingertips to their targets over the touches, for all M
    contacts of a capture."""
    off = tip_targets(capture.xy) - kinematics.tips(capture.q)
    return off[capture.down]


def fitted_skeleton(capture: Capture, skeleton: Skeleton) -> Skeleton:
    """Fits a skeleton to a captured person.

    Args:
        capture: Poses and touches.
        skeleton: Known skeleton, whose table of joints, ranges and rest frames is used unchanged.
    """
    placement = Kinematics(skeleton).place(capture.q)
    root = exp(capture.q[:, ROOT_ROTATION])
    targets = tip_targets(capture.xy) - capture.q[:, None, ROOT_POSITION]
    bones = list(skeleton.bones)
    for finger in range(len(FINGERS)):
        chain = [i for i, bone in enumerate(skeleton.bones) if bone.finger == finger]
        down = capture.down[:, finger]
        if not down.any():
            continue
        # Columns: the palm's axes, then every bone's own direction.
        along = np.swapaxes(placement.rotations[down][..., 1][:, chain], 1, 2)
        A = np.concatenate([root[down], along], axis=-1)
        known = np.array([*bones[chain[0]].anchor, *(bones[i].length for i in chain)])
        spread = np.array([KNUCKLE_SPREAD] * 3 + [LENGTH_SPREAD * bones[i].length for i in chain])
        fitted = known + _regularised_fit(A, targets[down, finger] - A @ known, spread)
        _set_finger(bones, chain, fitted)
    return replace(skeleton, name=f"{skeleton.name}, fitted", bones=tuple(bones))


def perturbed_skeleton(
    skeleton: Skeleton, rng: np.random.Generator, length: float, knuckle: float
) -> Skeleton:
    """Changes bone lengths and knuckles of a skeleton at random, to those of another person.

    Args:
        skeleton: Skeleton to change.
        rng: Source of randomness.
        length: Standard deviation of the change of a bone's length, as a share of the length.
        knuckle: Standard deviation (m) of the change of every coordinate of a knuckle.
    """
    bones = list(skeleton.bones)
    for finger in range(len(FINGERS)):
        chain = [i for i, bone in enumerate(skeleton.bones) if bone.finger == finger]
        moved = rng.normal(0, knuckle, 3)
        lengths = [bones[i].length * (1 + rng.normal(0, length)) for i in chain]
        _set_finger(bones, chain, np.array([*(bones[chain[0]].anchor + moved), *lengths]))
    return replace(skeleton, name=f"{skeleton.name}, perturbed", bones=tuple(bones))


def _regularised_fit(A: Array, off: Array, spread: Array) -> Array:
    """Least-squares solution x (m,) of A (n, 3, m) x = off (n, 3), with a prior of mean 0 and
    standard deviations `spread` (m,)."""
    rows, right = A.reshape(-1, A.shape[-1]), off.ravel()
    weight = min(1.0, _INDEPENDENT / len(off)) / _MISFIT**2
    normal = weight * rows.T @ rows + np.diag(1 / spread**2)
    return np.asarray(np.linalg.solve(normal, weight * rows.T @ right), float)


def _set_finger(bones: list[Bone], chain: list[int], values: Array) -> None:
    """Writes a finger's knuckle (3 values) and bone lengths into the table. Every further joint is
    at the end of the previous bone."""
    anchor = (float(values[0]), float(values[1]), float(values[2]))
    for i, length in zip(chain, values[3:].tolist(), strict=True):
        bones[i] = replace(bones[i], anchor=anchor, length=length)
        anchor = (0.0, length, 0.0)


DISTRUSTS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)
"""Factors on the tips' variance from which validation chooses."""

WRONG_LENGTH, WRONG_KNUCKLE = 0.06, 0.004
"""Standard deviations of lengths (share) and knuckles (m) of perturbed skeletons in validation."""

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
        predicted: (T, 48) relative poses predicted by an encoder that was not trained on their
            trial.
        covariance: (48, 48) covariance of their errors.
        skeleton: Known skeleton before the fit.
        fit: True fits the bones to the capture. False makes a correction for people with unknown
            bones. The variance of touches is then measured about the tips of perturbed skeletons.
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
    # Other people have other bones, so the variance is that about perturbed skeletons.
    return PersonCorrection(skeleton, covariance, distrust * np.mean(variances, axis=0), distrust)


def blocked_variance(capture: Capture, known: Skeleton, fit: bool = True) -> Array:
    """Second moments (3,) m2 of touches about tips, on trials to which the bones were not fitted.

    The first two values, for directions along the surface, are equal, since no direction on the
    surface is special.
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
    """Error products (len(DISTRUSTS),) on held-out trials, for fits that start from the skeleton
    `known`."""
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
