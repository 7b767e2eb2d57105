"""Validation that never splits a trial, and the one number by which it chooses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.pose import ROOT_POSITION, joint_vectors
from models.rotations import geodesic_angle

FOLDS = 10
"""The paper validates tenfold, too."""

_LARGEST_LENGTH = 4.0
"""Robust standard deviations that one frame's error may count in the covariance."""


def trial_folds(trial: NDArray[np.int64], folds: int = FOLDS) -> NDArray[np.int64]:
    """(T,) fold of every frame; frames of one trial share a fold, folds are about equally large.

    Random frames would leak: neighbours in time are nearly equal.

    Raises:
        EncoderError: There is one trial only.
    """
    trials, counts = np.unique(trial, return_counts=True)
    if len(trials) < 2:
        raise EncoderError("one trial alone cannot be validated", expected="2 trials or more")
    loads = np.zeros(folds, int)
    fold_of = {}
    for i in np.argsort(-counts, kind="stable"):
        fold = int(np.argmin(loads))
        fold_of[int(trials[i])] = fold
        loads[fold] += counts[i]
    return np.array([fold_of[int(t)] for t in trial])


def badness(q: Array, truth: Array) -> float:
    """Mean distance of the wrist times mean angle of the joints, the paper's two measures.

    A product needs no rate of exchange between metres and radians. (Standardised squares of all 48
    numbers would: most of them cannot be told from touches, and they would drown the wrist.)

    Args:
        q: (T, 48) estimated poses.
        truth: (T, 48) captured ones.
    """
    wrist = np.linalg.norm((q - truth)[:, ROOT_POSITION], axis=1).mean()
    joints = geodesic_angle(joint_vectors(q), joint_vectors(truth)).mean()
    return float(wrist * joints)


def robust_covariance(residuals: Array) -> Array:
    """(N, N) second moments of errors (T, N), each frame's length bounded.

    A few frames on which plain least squares explodes would otherwise make it seem that nothing is
    known about the pose anywhere.
    """
    spread = np.median(np.abs(residuals), axis=0) * 1.4826 + 1e-9
    length = np.sqrt(np.mean((residuals / spread) ** 2, axis=1))
    bound = np.minimum(1.0, _LARGEST_LENGTH / np.maximum(length, 1e-9))
    bounded = residuals * bound[:, None]
    moments: Array = bounded.T @ bounded / len(bounded)
    return moments
