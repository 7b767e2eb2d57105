"""A calibration without an open hand: from an average hand, or from the device's own bones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from encoders.paalm.angles import joints_of_angles
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.hand_pose import PALM_CENTRE
from encoders.paalm.options import PaalmOptions
from encoders.paalm.rig import bone_lengths
from models.arithmetic.products import squared_lengths
from models.frames import FINGERS, HandFrame
from models.skeleton import ADULT

OPEN_SPREAD = (10.0, 6.0, 1.0, -5.0, -14.0)
"""Degrees, spread of an open hand's fingers."""


def average_calibration(
    frames: Sequence[HandFrame], side: str, options: PaalmOptions | None = None
) -> HandCalibration:
    """Calibration for a hand that was not measured; its angles are less accurate.

    Where the device knows the hand's joints, standard lengths are those of its stretched bones;
    otherwise they are those that the device would see of an average open hand.

    Args:
        frames: Frames of the hand; only its joints are read.
        side: `right` or `left`.
        options: Options with the share of the first bones that the device hides.
    """
    options = options or PaalmOptions()
    lengths = np.array(bone_lengths())
    bones = _bones(frames, side)
    hidden = np.array([options.thumb_hidden, *[options.hidden] * (len(FINGERS) - 1)])
    if bones is not None:
        lengths, hidden = bones, np.zeros(len(FINGERS))
    angles = np.zeros((len(FINGERS), 4))
    angles[:, 1] = OPEN_SPREAD
    angles[:, 2] = 0.0 if bones is not None else options.open_bend
    angles[:, 3] = options.coupling.slope * angles[:, 2] + options.coupling.offset
    knuckles = np.array([ADULT.bones[i].anchor for i in ADULT.first_bone]) - PALM_CENTRE
    joints = joints_of_angles(angles, knuckles, lengths)
    base = joints[:, 0] + hidden[:, None] * (joints[:, 1] - joints[:, 0])
    line = joints[:, 3] - base
    standard = np.sqrt(squared_lengths(line))
    return HandCalibration(
        side,
        standard,
        np.zeros(len(FINGERS)),
        joints[:, 3],
        line / standard[:, None],
        bones,
        0,
        0.0,
        {"not measured: an average hand": 1},
    )


def _bones(frames: Sequence[HandFrame], side: str) -> np.ndarray | None:
    """Mean (5, 3) m of the device's own bones; None where it has none."""
    bones = []
    for frame in frames:
        for hand in frame.hands:
            named = {f.finger: f.joints for f in hand.fingers if f.joints is not None}
            if hand.side == side and len(named) == len(FINGERS):
                joints = np.array([named[i] for i in range(len(FINGERS))])
                bones.append(np.sqrt(squared_lengths(np.diff(joints, axis=1))))
    return np.mean(bones, axis=0) if bones else None
