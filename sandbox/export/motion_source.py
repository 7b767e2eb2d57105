"""Motion that can be exported or streamed: poses of hands over time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from models.arithmetic import Array
from models.motion.armature import Armature
from models.motion.sampling import Poses
from models.pose import ROOT_POSITION, ROOT_ROTATION, joint_vectors
from models.reader_report import ReaderReport
from models.rotations import quaternion_exp

PoseCallback = Callable[[Poses], None]


@dataclass(frozen=True)
class MotionSource:
    """Poses of hands over time.

    Attributes:
        armatures: Armatures of the hands.
        names: Names of the hands, `right`, `left` or `right_too`.
        duration: s, if it is known beforehand; else 0.
        what: Description for people.
        play: Passes all poses, in batches, to a callback; returns an error text for the rest, or an
            empty text.
        remarks: What people must know of these poses, said before they are played.
        report: What the reader left out and assumed; complete once all is played.
    """

    armatures: tuple[Armature, ...]
    names: tuple[str, ...]
    duration: float
    what: str
    play: Callable[[PoseCallback], str]
    remarks: tuple[str, ...] = ()
    report: ReaderReport = field(default_factory=ReaderReport)


def poses_of(time: Array, q: Array) -> Poses:
    """Poses of one hand at times (n,), from world poses (n, 48)."""
    vectors = np.concatenate([q[:, None, ROOT_ROTATION], joint_vectors(q)], axis=1)
    return Poses(time, q[:, None, ROOT_POSITION], quaternion_exp(vectors)[:, None])


def together(hands: Sequence[Poses]) -> Poses:
    """Poses of several hands at the same times."""
    return Poses(
        hands[0].time,
        np.concatenate([h.root for h in hands], axis=1),
        np.concatenate([h.turns for h in hands], axis=1),
    )
