"""Calibration of hands that were not held open for a measurement.

The calibration uses an average hand, the bones that a device reports, or those frames of a
recording in which the hand is open.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from encoders.paalm.angles import joints_of_angles
from encoders.paalm.calibration import (
    ENOUGH,
    HandCalibration,
    calibrated,
    coupling_of_joints,
    dialect_of_bones,
    longest_calibration,
)
from encoders.paalm.hand_pose import PALM_CENTRE
from encoders.paalm.identity import HandSides
from encoders.paalm.joint_angles import Paalm, stacked_hands
from encoders.paalm.options import Hands, PaalmOptions
from encoders.paalm.rig import bone_lengths, with_palm_shift
from encoders.paalm.seen_palm import FIRST_SHIFT
from models.arithmetic import Array, squared_lengths
from models.errors import EncoderError
from models.frames import FINGERS, SIDES, HandFrame, TrackedHand
from models.skeleton import ADULT

OPEN_SPREAD = (10.0, 6.0, 1.0, -5.0, -14.0)
"""Spread (degrees) of the fingers of an open hand."""


def average_calibration(
    frames: Sequence[HandFrame], side: str, options: PaalmOptions | None = None
) -> HandCalibration:
    """Calibration for a hand that was not measured; angles are less accurate with it.

    If the device reports joints, a finger's standard length is that of its stretched bones.
    Otherwise it is the length that the device would measure for an average open hand. If fingers
    are then solved by their tips, the palm is shifted to the place at which the first software
    reports it (`encoders.paalm.seen_palm`).

    Args:
        frames: Frames of the hand; only its joints and the dialect are read.
        side: `right` or `left`.
        options: Options of PAALM.
    """
    options = options or PaalmOptions()
    lengths = np.array(bone_lengths())
    dialect = next((f.dialect for f in frames if f.dialect is not None), None)
    joints = _joints(frames, side)
    bones = None
    hidden = np.array([options.thumb_hidden, *[options.hidden] * (len(FINGERS) - 1)])
    if joints is not None:
        dialect = dialect_of_bones(dialect, joints)
        bones = np.sqrt(squared_lengths(np.diff(joints, axis=2))).mean(axis=0)
        lengths, hidden = bones, np.zeros(len(FINGERS))
    angles = np.zeros((len(FINGERS), 4))
    angles[:, 1] = OPEN_SPREAD
    angles[:, 2] = 0.0 if bones is not None else options.open_bend
    coupling = options.coupling_for(dialect)
    angles[:, 3] = coupling.slope * angles[:, 2] + coupling.offset
    knuckles = np.array([ADULT.bones[i].anchor for i in ADULT.first_bone]) - PALM_CENTRE
    joints = joints_of_angles(angles, knuckles, lengths)
    base = joints[:, 0] + hidden[:, None] * (joints[:, 1] - joints[:, 0])
    line = joints[:, 3] - base
    standard = np.sqrt(squared_lengths(line))
    by_tip = bones is None and options.solve == "tips"
    return HandCalibration(
        side,
        standard,
        np.zeros(len(FINGERS)),
        joints[:, 3] + (FIRST_SHIFT if by_tip else 0.0),
        line / standard[:, None],
        bones,
        0,
        0.0,
        {f"not measured: {'an average hand' if bones is None else 'the bones of the device'}": 1},
        dialect,
        by_tip=by_tip,
        palm_shift=FIRST_SHIFT if by_tip else None,
    )


def knows_bones(frames: Sequence[HandFrame], side: str) -> bool:
    """True if the device reports all joints of a hand in some frame. The hand need not be held open
    then."""
    return _joints(frames, side) is not None


def with_reported_coupling(
    calibration: HandCalibration, frames: Sequence[HandFrame]
) -> HandCalibration:
    """The calibration, with the coupling fitted to the joints that the device reports.

    The coupling of a person's joints, and of a device's model of them, differs from the coupling of
    the dialect. If the fingers hardly bend, the calibration has no fitted coupling. If the device
    reports no joints, the calibration is returned unchanged.
    """
    joints = _joints(frames, calibration.side)
    return (
        calibration if joints is None else replace(calibration, coupling=coupling_of_joints(joints))
    )


def _joints(frames: Sequence[HandFrame], side: str) -> Array | None:
    """Joints (n, 5, 4, 3) m that the device reports; None if it reports no joints."""
    found = []
    for frame in frames:
        for hand in frame.hands:
            named = {f.finger: f.joints for f in hand.fingers if f.joints is not None}
            if hand.side == side and len(named) == len(FINGERS):
                found.append([named[i] for i in range(len(FINGERS))])
    return np.array(found) if found else None


OPEN_FRAMES = 100
"""Number of frames of an open hand that are used."""


def calibrate_on_recording(paalm: Paalm, frames: Sequence[HandFrame], hands: Hands) -> str:
    """Calibrates PAALM on a recording: by reported bones, by an open hand, or as an average hand.

    Args:
        paalm: Receives the calibration.
        frames: All frames of the recording.
        hands: Sides of the hands.

    Returns:
        Reason why an average hand replaces the recorded hand; empty if the recorded hand is used.
    """
    sides = SIDES if hands == "both" else (hands,)
    if all(knows_bones(frames, side) for side in sides):
        average = (average_calibration(frames, side, paalm.options) for side in sides)
        paalm.use({c.side: with_reported_coupling(c, frames) for c in average})
        return ""
    try:
        chooser = HandSides(sides)
        chosen = [(f.time, {} if stacked_hands(f) else chooser.choose(f)) for f in frames]
        measured = [
            measured_in([(t, c.get(side)) for t, c in chosen], side, paalm.options)
            for side in sides
        ]
        paalm.use({c.side: c for c in measured})
    except EncoderError as error:
        paalm.use({side: average_calibration(frames, side, paalm.options) for side in sides})
        got = "" if error.got is None else f" ({error.got})"
        return f"an average hand stands in for the recorded one: {error.what}{got}"
    return ""


def measured_in(
    samples: Sequence[tuple[float, TrackedHand | None]], side: str, options: PaalmOptions
) -> HandCalibration:
    """Measures a hand in a recording.

    A hand that is solved by its tips is measured in all frames with five fingers, a hand that is
    solved by lengths at the beginning of the recording.

    Args:
        samples: (time in s, the hand or None where it is not seen), one for each frame.
        side: `right` or `left`.
        options: Options of PAALM.

    Raises:
        EncoderError: The hand is open in too few frames.
    """
    if options.solve == "lengths":
        return calibrated(samples, side, OPEN_FRAMES, ENOUGH)
    return with_palm_shift(longest_calibration(samples, side, ENOUGH), options)
