"""Cross-validation that never splits a trial, and its error measure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.errors import EncoderError
from models.pose import ROOT_POSITION, joint_vectors
from models.rotations import geodesic_angle

FOLDS = 10
"""Number of folds, as in the paper."""

_LARGEST_LENGTH = 4.0
"""Limit of one frame's error in the covariance, in robust standard deviations."""


def trial_folds(trial: NDArray[np.int64], folds: int = FOLDS) -> NDArray[np.int64]:
    """Fold (T,) of every frame. Frames of one trial share a fold; folds are about equally large.

    Folds of random frames would make the test too easy, since neighbouring frames are nearly equal.

    Raises:
        EncoderError: There is only one trial.
    """
    trials, counts = np.unique(trial, return_counts=True)
    if len(trials) < 2:
        raise EncoderError(
            "cross-validation needs several trials",
            got=len(trials),
            expected="2 trials or more",
            remedy="Use a capture with several takes",
        )
    loads = np.zeros(folds, int)
    fold_of = {}
    for i in np.argsort(-counts, kind="stable"):
        fold = int(np.argmin(loads))
        fold_of[int(trials[i])] = fold
        loads[fold] += counts[i]
    return np.array([fold_of[int(t)] for t in trial])


def error_product(q: Array, truth: Array) -> float:
    """Mean distance of the wrist times mean angle of the joints, the paper's two measures.

    A product needs no relative weight of metres and radians. (In a sum of standardised squares, the
    many numbers that touches cannot determine would outweigh the wrist.)

    Args:
        q: (T, 48) estimated poses.
        truth: (T, 48) captured poses.
    """
    wrist = np.linalg.norm((q - truth)[:, ROOT_POSITION], axis=1).mean()
    joints = geodesic_angle(joint_vectors(q), joint_vectors(truth)).mean()
    return float(wrist * joints)


def bounded_errors(residuals: Array) -> Array:
    """Errors (T, N) with the length of each frame's error limited.

    Without a limit, a few frames with extreme errors of plain least squares would dominate the
    covariance of all poses.
    """
    spread = np.median(np.abs(residuals), axis=0) * 1.4826 + 1e-9
    length = np.sqrt(np.mean((residuals / spread) ** 2, axis=1))
    bound = np.minimum(1.0, _LARGEST_LENGTH / np.maximum(length, 1e-9))
    return np.asarray(residuals * bound[:, None])


def robust_covariance(residuals: Array) -> Array:
    """Second moments (N, N) of errors (T, N), with the length of each frame's error limited."""
    bounded = bounded_errors(residuals)
    moments: Array = bounded.T @ bounded / len(bounded)
    return moments
