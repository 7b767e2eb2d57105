"""The hand of a recording, many frames at a time, is the hand that PAALM has frame by frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from encoders.paalm import Paalm
from encoders.paalm.average import calibrate_on_recording
from encoders.reconstruction.hand_motion import Phase
from models.frames import HandFrame
from sandbox.export.leap_hands import straight_reconstructor
from sandbox.export.recorded_hand import RecordedHand
from tests.support.leap_hands import take

BATCHES = (0, 1, 250, 1)
"""Numbers of frames between two calls; the rest come in the last one."""
LATE = 3
"""Frames before the hand is seen."""


def with_gaps(frames: tuple[HandFrame, ...]) -> list[HandFrame]:
    """The frames, the hand being lost at first, for a moment, and for a second."""
    lost = {*range(LATE), *range(200, 210), *range(400, 520)}
    return [replace(f, hands=()) if i in lost else f for i, f in enumerate(frames)]


@pytest.mark.parametrize(("side", "dialect"), [("right", "v1"), ("left", "v1"), ("right", "v3")])
def test_poses_of_many_frames_are_those_of_one_after_another_to_the_bit(
    side: str, dialect: str
) -> None:
    frames = with_gaps(take(3, side=side, dialect=dialect).frames)
    paalm = Paalm()
    assert calibrate_on_recording(paalm, frames, "right" if side == "right" else "left") == ""
    calibration = paalm.calibration[side]
    one = straight_reconstructor(side, calibration)
    steps = [one.step(frame) for frame in frames]
    first = next(step.q for step in steps if step.phase is Phase.DOWN)
    many, poses, begin = RecordedHand(side, calibration, first), [], 0
    for count in (*BATCHES, len(frames)):
        for frame in frames[begin : begin + count]:
            many.add(frame)
        poses.append(many.poses())
        begin += count
    expected = [first] * LATE + [step.q for step in steps[LATE:]]
    assert np.array_equal(np.concatenate(poses), expected)
