"""A person's bones, from a capture of that person: lengths and knuckles that explain the touches.

Given the joints' rotations, a fingertip's place is linear in the knuckle's place and the bones'
lengths. A capture holds rotations and, while a finger touches, the place of its tip. So the bones
are the solution of a small linear least-squares problem for every finger, drawn towards a known
skeleton as far as the data leave them open.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from encoders.capture import Capture
from encoders.correction import PAD_HEIGHT
from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp
from models.skeleton import Bone, Skeleton

KNUCKLE_SPREAD = 0.010
"""m, by which people's knuckles lie elsewhere than the known skeleton's; draws the fit."""
LENGTH_SPREAD = 0.10
"""Share by which people's bones are longer or shorter. Both spreads are assumptions; a few takes
with a finger on the surface outweigh them."""
_MISFIT = 0.004
"""m, by which one touch may miss its tip: pads roll, and joint angles are measured with errors."""
_INDEPENDENT = 200
"""Touches of one finger that count; the frames of a take say nearly the same."""


def tip_targets(xy: Array) -> Array:
    """(..., 3) m, where fingertips belong for touches (..., 2) m; 3-D surface frame."""
    return np.stack([xy[..., 0], -xy[..., 1], np.full(xy.shape[:-1], PAD_HEIGHT)], axis=-1)


def tip_misses(kinematics: Kinematics, capture: Capture) -> Array:
    """(M, 3) m, from the skeleton's fingertips to the captured touches, of all touching fingers."""
    off = tip_targets(capture.xy) - kinematics.tips(capture.q)
    return off[capture.down]


def fitted_skeleton(capture: Capture, skeleton: Skeleton) -> Skeleton:
    """The skeleton of a captured person.

    Args:
        capture: Poses and touches.
        skeleton: What is known beforehand; its table of joints, ranges and rest frames is kept.
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
        found = known + _drawn(A, targets[down, finger] - A @ known, spread)
        _set(bones, chain, found)
    return replace(skeleton, name=f"{skeleton.name}, fitted", bones=tuple(bones))


def perturbed_skeleton(
    skeleton: Skeleton, rng: np.random.Generator, length: float, knuckle: float
) -> Skeleton:
    """Another person's: bones longer or shorter by a share, knuckles elsewhere by so many metres.

    Args:
        skeleton: Whose bones are changed.
        rng: Source of the changes.
        length: Standard deviation of the share.
        knuckle: m, standard deviation of every coordinate of a knuckle.
    """
    bones = list(skeleton.bones)
    for finger in range(len(FINGERS)):
        chain = [i for i, bone in enumerate(skeleton.bones) if bone.finger == finger]
        moved = rng.normal(0, knuckle, 3)
        lengths = [bones[i].length * (1 + rng.normal(0, length)) for i in chain]
        _set(bones, chain, np.array([*(bones[chain[0]].anchor + moved), *lengths]))
    return replace(skeleton, name=f"{skeleton.name}, perturbed", bones=tuple(bones))


def _drawn(A: Array, off: Array, spread: Array) -> Array:
    """Least squares of off (n, 3) = A (n, 3, m) x, with x near 0 by its spread (m,)."""
    rows, right = A.reshape(-1, A.shape[-1]), off.ravel()
    weight = min(1.0, _INDEPENDENT / len(off)) / _MISFIT**2
    normal = weight * rows.T @ rows + np.diag(1 / spread**2)
    return np.asarray(np.linalg.solve(normal, weight * rows.T @ right), float)


def _set(bones: list[Bone], chain: list[int], found: Array) -> None:
    """Writes a finger's knuckle (3) and lengths into the table; joints sit at the bones' ends."""
    anchor = (float(found[0]), float(found[1]), float(found[2]))
    for i, length in zip(chain, found[3:].tolist(), strict=True):
        bones[i] = replace(bones[i], anchor=anchor, length=length)
        anchor = (0.0, length, 0.0)
