"""Source of poses: hands over a Leap, recorded or live, with poses computed by PAALM.

The poses are in the device's frame, without a task or table. `HandReconstructor` also drives a hand
in a task. In a task the hand must not sink into the table, outrun its servos or hide objects while
it is lost. These limits do not apply here.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any, Literal

import numpy as np

from encoders.paalm.average import (
    average_calibration,
    knows_bones,
    measured_in,
    with_reported_coupling,
)
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import read_hand
from encoders.paalm.hand_reconstructor import HandReconstructor, HandReconstructorSettings
from encoders.paalm.joint_angles import Paalm
from encoders.reconstruction.hand_motion import Phase, RateLimit
from models.arithmetic import Array
from models.errors import EncoderError, InputError, RecordingError
from models.frames import SIDES, HandFrame
from models.message import counted
from models.motion.armature import CHUNK, Armature
from models.person import Person
from models.plausible import unit_size
from models.pose import POSE_SIZE
from models.reader_report import ReaderReport
from models.skeleton import ADULT
from sandbox.devices.device import AnyDevice
from sandbox.devices.leap.leap_file import no_finger, read_leap
from sandbox.devices.leap.leap_json import canonical, side_named
from sandbox.devices.leap.two_hands import SplitBySide
from sandbox.devices.wrappers.shared import SharedDevice
from sandbox.export.motion_source import MotionSource, PoseCallback, poses_of, together

FEW = 0.01
"""Share of the frames with a hand. If a hand of another side is seen in a smaller share, it counts
as a mistake of the device."""
_MEASURED_FRAMES = 20_000
"""Number of frames from which a hand is measured if the device reports no bones."""
_BONES_FRAMES = 1000
"""Number of frames from which the device's bones and their coupling are read."""

Hand = Literal["right", "left", "both"]


@dataclass(frozen=True)
class LeapSurvey:
    """Content of a recording, before its frames are used.

    Attributes:
        duration: s by the device's clock; 0 if the messages have no times.
        sides: Number of messages with a hand of each side that the device reports; under None, the
            number of messages with a hand without a side.
        pairs: Number of messages with two or more hands without a side.
        both: Number of messages with hands of both sides.
        same: Number of messages with several hands of one side, by side.
        hands: Number of messages with a hand.
        frames: Number of messages that are frames.
    """

    duration: float
    sides: Counter[str | None]
    pairs: int
    both: int
    same: Counter[str]
    hands: int
    frames: int

    @classmethod
    def of(cls, messages: Iterable[Any], second: float = 1e-6) -> LeapSurvey:
        """Examines the messages of a recording, which may have any content.

        Args:
            messages: The messages.
            second: Unit of their times, s.
        """
        sides: Counter[str | None] = Counter()
        same: Counter[str] = Counter()
        begin = end = None
        pairs = both = hands = frames = 0
        for message in messages:
            message = canonical(message) if isinstance(message, dict) else {}
            records = message.get("hands")
            if not isinstance(records, list):
                continue
            time = message.get("timestamp")
            kinds = [r.get("type") for r in records if isinstance(r, dict)]
            frames += 1
            if isinstance(time, (int, float)):
                begin, end = time if begin is None else begin, time
            named = [side_named(kind) for kind in kinds]
            sides.update(set(named))
            pairs += named.count(None) >= 2
            both += set(SIDES) <= set(named)
            same.update(side for side in SIDES if named.count(side) >= 2)
            hands += bool(named)
        duration = 0.0 if begin is None or end is None else max(0.0, second * (end - begin))
        return cls(duration, sides, pairs, both, same, hands, frames)


def open_leap(
    path: Path,
    hand: Hand | None = None,
    calibration: Path | None = None,
    unit: str = "",
) -> MotionSource:
    """Opens a Leap recording; poses are in the frame of the device, at the recording's times.

    Args:
        path: The recording.
        hand: Side of the hand; None takes all hands in the recording.
        calibration: File with the measured hands. None uses the bones that the device reports, else
            an open hand in the recording, else an average hand.
        unit: Units that the user gave, such as `cm,ms`.

    Raises:
        RecordingError: The file is damaged, is of another program, or has no hand or no finger.
        InputError: The hand is not in the recording.
        EncoderError: The calibration is damaged, or is of the other hand.
    """
    recording = read_leap(path, unit)
    survey = LeapSurvey.of(recording.messages, unit_size(recording.units, "time"))
    sides, remarks = _sides(survey, recording.metadata, hand, str(path))
    splitter = HandSplitter(sides, survey.pairs > FEW * survey.hands)
    frames = [splitter(frame) for frame in recording.frames]
    if not any(hand.fingers for parts in frames for part in parts for hand in part.hands):
        raise no_finger(str(path), recording.report)
    calibrations = {}
    for i, side in enumerate(sides):
        if calibration is not None:
            calibrations[side] = read_hand(calibration, side)
            continue
        calibrations[side], remark = _calibration([parts[i] for parts in frames], side)
        remarks += [remark] if remark else []

    report = ReaderReport()

    def run(take: PoseCallback) -> str:
        hands = straight_reconstructors(sides, calibrations)
        q = _poses(frames, hands, sides, str(path))
        time = np.array([parts[0].time for parts in frames])
        time -= time[0]
        for i in range(0, len(frames), CHUNK):
            some = slice(i, i + CHUNK)
            take(together([poses_of(time[some], q[some, j]) for j in range(len(sides))]))
        report.add(recording.report)
        report.add_counts(splitter.counts)
        for hand in hands:
            report.add_counts({why: n for why, n in hand.counts.items() if why != "frames"})
        return "" if recording.damage is None else str(recording.damage)

    return MotionSource(
        leap_armatures(sides), sides, survey.duration, described(sides), run, tuple(remarks), report
    )


def _sides(
    survey: LeapSurvey, metadata: dict[str, Any], hand: Hand | None, where: str
) -> tuple[tuple[str, ...], list[str]]:
    """Sides of the hands to export, and remarks on them."""
    if not survey.hands:
        raise RecordingError(
            "this recording has no hand",
            where=where,
            expected="frames with a hand over the Leap",
        )
    named = {side: survey.sides[side] for side in SIDES if survey.sides[side]}
    unnamed = survey.sides[None]
    if hand is not None:
        wanted = SIDES if hand == "both" else (hand,)
        missing = [side for side in wanted if side not in named]
        if missing and not unnamed:
            raise InputError(
                "this hand is not in the recording",
                where=where,
                got=" and ".join(missing),
                expected=" and ".join(named),
                remedy=f"--hand {next(iter(named))}",
            )
        if hand == "both" and not named and not survey.pairs:
            raise InputError(
                "the recording never shows two hands at once",
                where=where,
                got="--hand both",
                expected="--hand right or --hand left",
            )
        return wanted, []
    enough = FEW * survey.hands
    if not named:
        if survey.pairs > enough:
            return SIDES, [
                "this Leap does not say whose hands they are: sides follow from thumbs and places"
            ]
        told = metadata.get("side")
        if told in SIDES:
            return (str(told),), []
        return ("right",), ["this Leap does not say whose hand it is: --hand left, if it is left"]
    most = max(named, key=named.__getitem__)
    # A second hand is exported only if both hands were often seen at the same time.
    sides = tuple(s for s in named if s == most or survey.both > enough)
    remarks = [
        f"the {side} hand is not exported: {counted(count, 'frame')} of {survey.hands} name it, "
        f"and {survey.both} show both hands; --hand both exports it"
        for side, count in named.items()
        if side not in sides
    ]
    remarks += [
        f"{counted(survey.same[side], 'frame')} of {survey.hands} show two {side} hands: the hand "
        "that was seen first is exported, and the other hand is left out"
        for side in sides
        if survey.same[side]
    ]
    return sides, remarks


def _calibration(frames: Sequence[HandFrame], side: str) -> tuple[HandCalibration, str]:
    """Calibration of a recorded hand, and a remark if it was not measured."""
    paalm = Paalm()
    some = [frame for frame in frames if frame.hands][:_BONES_FRAMES]
    if knows_bones(some, side):
        return with_reported_coupling(average_calibration(some, side, paalm.options), some), ""
    try:
        samples = [(f.time, f.hands[0] if f.hands else None) for f in frames[:_MEASURED_FRAMES]]
        return measured_in(samples, side, paalm.options), ""
    except EncoderError as error:
        return average_calibration(some, side, paalm.options), (
            f"an average {side} hand is assumed, because {error.what} ({error.got}); "
            "--calibration FILE uses your calibration"
        )


def _poses(
    frames: Sequence[tuple[HandFrame, ...]],
    hands: Sequence[HandReconstructor],
    sides: Sequence[str],
    where: str,
) -> Array:
    """Poses (n, H, 48) of the hands in the device's frame.

    Frames before a hand is first seen have its first pose.

    Raises:
        RecordingError: A hand cannot be reconstructed in any frame.
    """
    poses = np.empty((len(frames), len(hands), POSE_SIZE))
    first: list[int | None] = [None] * len(hands)
    for i, parts in enumerate(frames):
        for j, (hand, part) in enumerate(zip(hands, parts, strict=True)):
            step = hand.step(part)
            poses[i, j] = step.q
            if first[j] is None and step.phase is Phase.DOWN:
                first[j] = i
    unseen = [side for side, i in zip(sides, first, strict=True) if i is None]
    if unseen:
        raise RecordingError(
            f"the {' and '.join(unseen)} hand cannot be reconstructed in any frame",
            where=where,
            expected="separate hands with at most five fingers",
        )
    for j, begin in enumerate(first):
        poses[:begin, j] = poses[begin, j]
    return poses


STRAIGHT = HandReconstructorSettings(
    device=(0.0, 0.0, 0.0), rate=RateLimit(inf, inf), rise=0.0, rise_speed=0.0, floor=-inf
)
"""Settings without limits, in the device's frame. A lost hand keeps its last pose."""


def straight_reconstructor(side: str, calibration: HandCalibration | None) -> HandReconstructor:
    """The reconstructor of one hand.

    Args:
        side: `right` or `left`.
        calibration: Calibration of the hand. None uses the bones that the device reports when it
            first sees the hand, or an average hand.
    """
    paalm = Paalm()
    if calibration is not None:
        paalm.use({side: calibration})
    return HandReconstructor(paalm, side, STRAIGHT, assume=calibration is None)


def straight_reconstructors(
    sides: Sequence[str], calibrations: Mapping[str, HandCalibration]
) -> list[HandReconstructor]:
    """The reconstructors of several hands; hands may lack a calibration."""
    return [straight_reconstructor(side, calibrations.get(side)) for side in sides]


def leap_armatures(sides: Sequence[str]) -> tuple[Armature, ...]:
    """Armatures of the average hand. PAALM computes poses for this hand."""
    return tuple(Armature(Person(side).skeleton(ADULT)) for side in sides)


def described(sides: Sequence[str]) -> str:
    """Description of the hands for people."""
    hands = "hand" if len(sides) == 1 else "hands"
    return f"the {' and '.join(sides)} {hands} over a Leap, by PAALM, in the frame of the device"


def devices_by_side(device: AnyDevice, sides: Sequence[str]) -> tuple[AnyDevice, ...]:
    """One device for each hand, all from one live device."""
    if len(sides) == 1:
        return (device,)
    return SharedDevice(device, SplitBySide(sides)).parts


class HandSplitter:
    """Splits frames by side, as for two hands of a task over one Leap.

    Args:
        sides: Sides of the wanted hands.
        pairs: True if frames show two hands. For a single wanted hand and False, frames are not
            split, and PAALM finds the hand in them.

    Attributes:
        counts: Numbers of hands that were left out or corrected, by reason.
    """

    def __init__(self, sides: Sequence[str], pairs: bool) -> None:
        self._split = SplitBySide(SIDES) if pairs or len(sides) == 2 else None
        self._wanted = [SIDES.index(side) for side in sides]
        self.counts: Counter[str] = Counter() if self._split is None else self._split.counts

    def __call__(self, frame: HandFrame) -> tuple[HandFrame, ...]:
        """A frame for each side."""
        if self._split is None:
            return (frame,)
        both = self._split.divide(frame, frame.time)
        return tuple(both[i] for i in self._wanted)
