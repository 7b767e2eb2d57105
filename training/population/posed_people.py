"""People by kinematics alone: random hands in random postures with their fingertips on a plane.

These people have none of the habits, movements and grips of the two generators. Joint angles are
random, with parts that several joints share. The hand is put over the surface, and each touching
finger is bent until its tip meets the surface. If a tip cannot reach the surface, the posture is
left out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.captures.subject.gestures import SETS
from models.arithmetic import Array
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import POSE_SIZE, ROOT_ROTATION, within_limits
from models.rotations import exp, log
from models.surface import Surface
from training.population.hands import drawn_size, drawn_skeleton

_ROUNDS = 8
"""Number of steps in which the bend of the fingers is adapted to the surface."""

_NEAR = 0.003
"""Largest distance (m) of a touching fingertip from the surface."""

_CLEAR = 0.003
"""Least height (m) of a lifted fingertip above the surface."""

_APART = 0.012
"""Least distance (m) between two fingertips."""

_WIDEST = np.array([0.115, 0.062, 0.056, 0.066])
"""Largest distances (m) between neighbouring fingertips, thumb and index first: 1.5 times the usual
largest distances of five fingers on a surface."""

_TIP_HEIGHT = 0.006
"""Height (m) of the centre of a touching fingertip above the surface."""

_SETS = np.array([[f in fingers for f in range(len(FINGERS))] for fingers in SETS])

_TRIES = np.array([0, 0, 1, 1, 2, 8])
"""Factor on the number of tried postures, by number of fingers. About a third of the postures with
two fingers are possible, a quarter with three, a quarter with four and a sixth with five."""


def capture_person(seed: list[int], postures: int) -> Capture:
    """Draws a person's postures; each is a trial of one frame.

    Args:
        seed: Seed of the person.
        postures: Number of postures that are tried for each set of two or three fingers. For sets
            with more fingers, the number is larger (`_TRIES`), so that all numbers of fingers are
            about equally frequent.
    """
    rng = np.random.default_rng(seed)
    size = drawn_size(rng)
    skeleton = drawn_skeleton(rng, size, f"drawn {size:.3f}")
    hand = Kinematics(skeleton)
    down = np.repeat(_SETS, postures * _TRIES[_SETS.sum(axis=1)], axis=0)
    q = within_limits(_postures(rng, len(down), _lean(rng)), skeleton)
    q, off = _put_down(q, down, hand, rng)
    placement = hand.place(q)
    tips = placement.tips
    good = (np.abs(np.where(down, off, 0.0)) < _NEAR).all(axis=1)
    good &= (np.where(down, 1.0, off) > _CLEAR).all(axis=1) & _possible(tips, size)
    last = [*(skeleton.first_bone[1:] - 1), len(skeleton.bones) - 1]
    along = placement.rotations[:, last][..., 1]
    pad = rng.uniform(0.002, 0.006)
    seen = (tips - pad * along)[..., :2] + rng.normal(0, 0.0004, (*down.shape, 2))
    middle = np.stack([np.where(down, seen[..., k], np.nan) for k in (0, 1)], axis=-1)
    width, height = Surface().size
    shift = np.array([width / 2, -height / 2]) - np.nanmean(middle, axis=1)
    q[:, :2] += shift
    xy = (seen + shift[:, None]) * [1.0, -1.0]
    kept = np.flatnonzero(good)
    touching = down[kept]
    ids = np.where(touching, np.arange(len(kept))[:, None] * 5 + np.arange(5), -1)
    xy = np.where(touching[..., None], xy[kept], np.nan)
    meta = {"simulated": True, "subject": "posed", "side": "right", "skeleton": skeleton.name}
    number = np.arange(len(kept))
    trial, meta = number.astype(np.int64), meta | {"rate_hz": 1.0, "size": size}
    return Capture(number.astype(float), trial, ids.astype(np.int64), xy, q[kept], meta)


def _lean(rng: np.random.Generator) -> dict[str, Array]:
    """Constants of a person, rad: mean pitch, roll and yaw of the hand, and mean bend of the
    fingers."""
    return {
        "attitude": rng.normal(0, 1, 3) * [0.12, 0.10, 0.25],
        "bend": rng.normal(0, 0.12, (4, 2)) + rng.normal(0, 0.15, 2),
        "thumb": rng.normal(0, 0.12, 5),
    }


def _postures(rng: np.random.Generator, n: int, lean: dict[str, Array]) -> Array:
    """Poses (n, 48) before the fingers are adapted to the surface. Flexion is a negative rotation
    about x."""
    q = np.zeros((n, POSE_SIZE))
    attitude = lean["attitude"] + rng.normal(0, 1, (n, 3)) * [0.22, 0.22, 0.35]
    turned = rng.random(n) < 0.15
    attitude[turned, 2] += rng.uniform(-1.0, 1.0, turned.sum())
    pitch, roll, yaw = attitude.T
    x, y, z = np.eye(3)
    # The front of the palm hangs a little: knuckles above the fingertips, wrist low.
    turn = exp(yaw[:, None] * z) @ exp((pitch - 0.1)[:, None] * x) @ exp(roll[:, None] * y)
    q[:, ROOT_ROTATION] = log(turn)
    common = rng.normal(0, 1, (n, 1, 2)) * [0.35, 0.45]
    bend = common + rng.normal(0, 1, (n, 4, 2)) * [0.16, 0.22] + lean["bend"]
    spread = rng.normal(0.0, 0.06, (n, 1)) * np.array([1.0, 0.3, -0.4, -1.0])
    spread = spread + rng.normal(0, 0.035, (n, 4)) + rng.normal(0, 0.05, (n, 1))
    for finger in range(4):
        start = 12 + 9 * finger
        q[:, start] = -bend[:, finger, 0]
        q[:, start + 2] = spread[:, finger]
        q[:, start + 3] = -bend[:, finger, 1]
        q[:, start + 6] = -0.6 * bend[:, finger, 1] + rng.normal(0, 0.08, n)
    thumb = lean["thumb"] + rng.normal(0, 1, (n, 5)) * [0.22, 0.28, 0.18, 0.3, 0.05]
    q[:, 6:9] = thumb[:, [0, 2, 1]]
    q[:, 9], q[:, 11] = thumb[:, 3], thumb[:, 4]
    return q


def _put_down(
    q: Array, down: NDArray[np.bool_], hand: Kinematics, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Adapts poses (n, 48) so that the touching fingertips meet the surface.

    First the hand is moved so that the mean height of the touching fingertips is that of a touch.
    Then each finger is bent separately.

    Returns:
        The poses (n, 48), and the heights (n, 5) m of all fingertips above that of a touch.
    """
    q = q.copy()
    tips = hand.tips(q)
    count = down.sum(axis=1)
    q[:, 2] += _TIP_HEIGHT - (tips[..., 2] * down).sum(axis=1) / count
    bend = np.zeros((len(FINGERS), POSE_SIZE))
    bend[0, [6, 9]] = -0.6, -0.8
    for finger in range(1, 5):
        start = 12 + 9 * (finger - 1)
        bend[finger, [start, start + 3, start + 6]] = -0.8, -0.5, -0.3
    # The thumb also goes down by opposition, a rotation about the length of the palm.
    bend[0, 8] = -0.5
    lower, upper = hand.skeleton.lower, hand.skeleton.upper
    for _ in range(_ROUNDS):
        tips, by_pose = hand.tips_and_jacobian(q)
        off = tips[..., 2] - _TIP_HEIGHT
        slope = np.einsum("nfp,fp->nf", by_pose[:, :, 2], bend)
        slope = np.where(np.abs(slope) < 0.01, np.copysign(0.01, slope), slope)
        lifted = np.where(off < _CLEAR, off - 2.5 * _CLEAR, 0.0)
        step = np.clip(-np.where(down, off, lifted) / slope, -0.3, 0.3)
        q[:, 6:] = np.clip(q[:, 6:] + (step @ bend)[:, 6:], lower, upper)
    return q, hand.tips(q)[..., 2] - _TIP_HEIGHT


def _possible(tips: Array, size: float) -> NDArray[np.bool_]:
    """True (n,) if no two fingertips overlap, and neighbouring fingertips are not too far apart."""
    between = np.linalg.norm(tips[:, :, None] - tips[:, None], axis=-1)
    between[:, range(5), range(5)] = np.inf
    good = (between > _APART * size).all(axis=(1, 2))
    neighbours = between[:, range(4), range(1, 5)]
    return np.asarray(good & (neighbours < _WIDEST * size).all(axis=1))
