"""Fits bone lengths and knuckle positions of a person to a capture of that person.

Given the joints' rotations, the position of a fingertip is linear in the position of its knuckle
and in the lengths of its bones. A capture holds rotations and, while a finger touches, the position
of its tip. So the bones of each finger are the solution of a small linear least-squares problem,
regularised towards a known skeleton where the data do not determine them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from encoders.capture import Capture
from encoders.correction import tip_targets
from models.arithmetic import Array
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp
from models.skeleton import Bone, Skeleton

KNUCKLE_SPREAD = 0.010
"""m, assumed standard deviation of people's knuckles about those of the known skeleton."""
LENGTH_SPREAD = 0.10
"""Share, assumed standard deviation of people's bone lengths. A few takes with a finger on the
surface outweigh both assumptions."""
_MISFIT = 0.004
"""m, assumed standard deviation of a touch about its fingertip: pads roll, and joint angles are
measured with errors."""
_INDEPENDENT = 200
"""Maximum number of touches of one finger that count as independent; the frames of a take are
nearly equal."""


def tip_misses(kinematics: Kinematics, capture: Capture) -> Array:
    """Offsets (M, 3) m from the skeleton's fingertips to the touches of all M captured contacts."""
    off = tip_targets(capture.xy) - kinematics.tips(capture.q)
    return off[capture.down]


def fitted_skeleton(capture: Capture, skeleton: Skeleton) -> Skeleton:
    """Fits a skeleton to a captured person.

    Args:
        capture: Poses and touches.
        skeleton: Known skeleton; its table of joints, ranges and rest frames is kept.
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
    """Changes bone lengths and knuckles of a skeleton at random, as those of another person.

    Args:
        skeleton: Skeleton to change.
        rng: Source of randomness.
        length: Standard deviation of the change of a bone's length, as a share of it.
        knuckle: m, standard deviation of every coordinate of a knuckle.
    """
    bones = list(skeleton.bones)
    for finger in range(len(FINGERS)):
        chain = [i for i, bone in enumerate(skeleton.bones) if bone.finger == finger]
        moved = rng.normal(0, knuckle, 3)
        lengths = [bones[i].length * (1 + rng.normal(0, length)) for i in chain]
        _set_finger(bones, chain, np.array([*(bones[chain[0]].anchor + moved), *lengths]))
    return replace(skeleton, name=f"{skeleton.name}, perturbed", bones=tuple(bones))


def _regularised_fit(A: Array, off: Array, spread: Array) -> Array:
    """Least-squares solution x (m,) of A (n, 3, m) x = off (n, 3), with prior deviations spread
    (m,)."""
    rows, right = A.reshape(-1, A.shape[-1]), off.ravel()
    weight = min(1.0, _INDEPENDENT / len(off)) / _MISFIT**2
    normal = weight * rows.T @ rows + np.diag(1 / spread**2)
    return np.asarray(np.linalg.solve(normal, weight * rows.T @ right), float)


def _set_finger(bones: list[Bone], chain: list[int], values: Array) -> None:
    """Writes a finger's knuckle (3) and lengths into the table; joints sit at the bones' ends."""
    anchor = (float(values[0]), float(values[1]), float(values[2]))
    for i, length in zip(chain, values[3:].tolist(), strict=True):
        bones[i] = replace(bones[i], anchor=anchor, length=length)
        anchor = (0.0, length, 0.0)
