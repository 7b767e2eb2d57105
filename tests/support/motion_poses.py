"""Legal poses of hands, and where all of a hand is then: what motion files are held against."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from models.arithmetic import Array
from models.kinematics import Kinematics
from models.motion.armature import Armature, chunks
from models.motion.output import MotionWriter
from models.skeleton import ADULT, Skeleton

HANDS = {"right": ADULT, "large left": ADULT.scaled(1.3).mirrored(), "small": ADULT.scaled(0.7)}


def legal(skeleton: Skeleton, count: int, seed: int, corners: bool = True) -> Array:
    """(count, 48) poses anywhere and turned in any way, joints in their ranges, many at an end."""
    rng = np.random.default_rng(seed)
    q = np.empty((count, 48))
    q[:, :3] = rng.uniform(-0.5, 0.5, (count, 3))
    q[:, 3:6] = rng.normal(size=(count, 3)) * rng.uniform(0, 2, (count, 1))
    q[:, 6:] = rng.uniform(skeleton.lower, skeleton.upper, (count, 42))
    if corners:
        ends = np.where(rng.random((count, 42)) < 0.5, skeleton.lower, skeleton.upper)
        q[:, 6:] = np.where(rng.random((count, 42)) < 0.3, ends, q[:, 6:])
    return q


def moving(skeleton: Skeleton, count: int, seed: int, rate: float = 60.0) -> Array:
    """(count, 48) poses of a lively hand: every joint swings through its whole range, the wrist
    turns round and round."""
    rng = np.random.default_rng(seed)
    t = np.arange(count)[:, None] / rate
    wave = np.sin(2 * np.pi * rng.uniform(0.2, 1.5, 48) * t + rng.uniform(0, 6, 48))
    q = 0.3 * wave
    # The root turns about the vertical, beyond a whole turn, and tilts a little meanwhile.
    q[:, 3:5] *= 0.5
    q[:, 5] = 2.0 * t[:, 0]
    middle, half = (skeleton.upper + skeleton.lower) / 2, (skeleton.upper - skeleton.lower) / 2
    q[:, 6:] = middle + half * wave[:, 6:]
    return q


motions = st.tuples(
    st.sampled_from(sorted(HANDS)), st.integers(1, 40), st.integers(0, 2**31), st.booleans()
).map(
    lambda drawn: (
        HANDS[drawn[0]],
        (legal if drawn[3] else moving)(HANDS[drawn[0]], drawn[1], drawn[2]),
    )
)
"""A skeleton and legal poses (n, 48) of it, wild ones or smooth ones."""


def written(make: Callable[[Armature], MotionWriter], skeleton: Skeleton, q: Array) -> list[Path]:
    """The files that a writer makes of world poses (n, 48)."""
    armature = Armature(skeleton)
    with make(armature) as writer:
        for keys in chunks(armature, q):
            writer.write(keys)
    return writer.paths


def points_of(skeleton: Skeleton, q: Array) -> tuple[Array, Array]:
    """Wrist and joints (n, 15, 3), and fingertips (n, 5, 3), m in the world."""
    placed = Kinematics(skeleton).place(q)
    return np.concatenate([q[:, None, :3], placed.joints], axis=1), placed.tips


def last_joints(armature: Armature) -> list[int]:
    """Joints that carry fingertips, thumb to little."""
    return [j for j, below in enumerate(armature.children) if not below]
