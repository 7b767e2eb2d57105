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
        names: Names of the hands, such as `right`, `left` or `right_too`.
        duration: Duration, s; 0 if it is not known beforehand.
        what: Description for people.
        play: Function that passes all poses, in batches, to a callback. It returns an error text if
            some poses are missing, otherwise an empty text.
        remarks: Remarks on the poses for people, to be shown before the poses are played.
        report: Data that the reader left out, and its assumptions; complete after playing.
    """

    armatures: tuple[Armature, ...]
    names: tuple[str, ...]
    duration: float
    what: str
    play: Callable[[PoseCallback], str]
    remarks: tuple[str, ...] = ()
    report: ReaderReport = field(default_factory=ReaderReport)


def poses_of(time: Array, q: Array) -> Poses:
    """Poses of one hand at times (n,), s, from poses (n, 48) in one frame."""
    vectors = np.concatenate([q[:, None, ROOT_ROTATION], joint_vectors(q)], axis=1)
    return Poses(time, q[:, None, ROOT_POSITION], quaternion_exp(vectors)[:, None])


def together(hands: Sequence[Poses]) -> Poses:
    """Poses of several hands at the same times."""
    return Poses(
        hands[0].time,
        np.concatenate([h.root for h in hands], axis=1),
        np.concatenate([h.turns for h in hands], axis=1),
    )
