"""Source of poses: a Leap recording, straight from PAALM."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
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
from encoders.paalm.paalm import Paalm
from encoders.reconstruction.hand_motion import Phase
from models.arithmetic import Array
from models.errors import EncoderError, InputError, RecordingError
from models.frames import SIDES, HandFrame
from models.message import counted
from models.motion.armature import CHUNK
from models.reader_report import ReaderReport
from sandbox.devices.leap.leap_file import no_finger, no_frame
from sandbox.devices.leap.leap_json import canonical, side_named
from sandbox.export.leap_frames import LeapFrames, Outline
from sandbox.export.leap_hands import (
    HandSplitter,
    described,
    leap_armatures,
    straight_reconstructors,
)
from sandbox.export.motion_source import MotionSource, PoseCallback, poses_of, together
from sandbox.export.recorded_hand import RecordedHand

FEW = 0.01
"""Share of the frames with a hand below which a hand of another side is the device's mistake."""
_MEASURED_FRAMES = 20_000
"""Frames in which a hand is measured where the device reports no bones."""
_BONES_FRAMES = 1000
"""Frames in which the device's own bones, and their coupling, are looked up."""

Hand = Literal["right", "left", "both"]


@dataclass(frozen=True)
class LeapSurvey:
    """Content of a recording, before its frames are used.

    Attributes:
        duration: s by the device's clock; 0 if the messages have no times.
        sides: Numbers of messages with a hand of each side that the device names; under None those
            with a hand of no side.
        pairs: Number of messages with two hands or more of no side.
        both: Number of messages with hands of both sides.
        same: Numbers of messages with several hands of one side.
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
        """Looks through the messages of a recording, which may hold anything, or their outlines.

        Args:
            messages: The messages.
            second: s, unit of their times.
        """
        sides: Counter[str | None] = Counter()
        same: Counter[str] = Counter()
        begin = end = None
        pairs = both = hands = frames = 0
        for message in messages:
            time: Any
            if isinstance(message, Outline):
                if message.hands is None:
                    continue
                time, kinds = message.timestamp, [hand.type for hand in message.hands]
            else:
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
        hand: Whose hand; None: all hands that are there.
        calibration: File with the measured hands. None: the open hand in the recording, the bones
            that the device reports, or an average hand.
        unit: Units that a person gave, such as `cm,ms`.

    Raises:
        RecordingError: The file is damaged, of another program, or has no hand or no finger.
        InputError: That hand is not in the recording.
        EncoderError: The calibration is damaged, or of the other hand.
    """
    frames = LeapFrames(path, unit)
    survey = LeapSurvey.of(frames.messages(outlines=True), frames.second)
    if not survey.frames:
        deque(frames, maxlen=0)
        raise no_frame(str(path), frames.report)
    sides, remarks = _sides(survey, frames.metadata, hand, str(path))
    recording = _SplitRecording(frames, sides, survey.pairs > FEW * survey.hands)
    usable = False
    for parts in recording.beginning():
        usable = True
        if any(hand.fingers for part in parts for hand in part.hands):
            break
    else:
        raise (no_finger if usable else no_frame)(str(path), frames.report)
    calibrations = {}
    for i, side in enumerate(sides):
        if calibration is not None:
            calibrations[side] = read_hand(calibration, side)
            continue
        calibrations[side], remark = _calibration(recording, i)
        remarks += [remark] if remark else []

    report = ReaderReport()

    def run(take: PoseCallback) -> str:
        first = _first_poses(recording, calibrations, str(path))
        hands = [
            RecordedHand(side, calibrations[side], q) for side, q in zip(sides, first, strict=True)
        ]
        for time, q in _poses(recording, hands):
            take(together([poses_of(time, q[:, i]) for i in range(len(sides))]))
        report.add(frames.report)
        for counts in (recording.counts, *(hand.counts for hand in hands)):
            report.add_counts(counts)
        return "" if frames.damage is None else str(frames.damage)

    return MotionSource(
        leap_armatures(sides), sides, survey.duration, described(sides), run, tuple(remarks), report
    )


class _SplitRecording:
    """Frames of a recording, split by side.

    Args:
        frames: All frames.
        sides: Sides of the wanted hands.
        pairs: True if frames show two hands.

    Attributes:
        counts: Numbers of hands that the latest iteration left out or mended, by reason.
    """

    def __init__(self, frames: LeapFrames, sides: tuple[str, ...], pairs: bool) -> None:
        self.sides = sides
        self._frames, self._pairs = frames, pairs
        self._kept: list[tuple[HandFrame, ...]] = []
        self._rest: Iterator[tuple[HandFrame, ...]] = iter(())
        self._begun = False
        self.counts: Counter[str] = Counter()

    def __iter__(self) -> Iterator[tuple[HandFrame, ...]]:
        kept = deque(self._kept)
        rest = self._rest if self._begun else self._anew()
        self._kept, self._begun = [], False
        while kept:
            yield kept.popleft()
        yield from rest

    def beginning(self) -> Iterator[tuple[HandFrame, ...]]:
        """Yields the frames; the first `_MEASURED_FRAMES` are kept for whoever reads them next."""
        if not self._begun:
            self._kept, self._rest, self._begun = [], self._anew(), True
        for number in range(_MEASURED_FRAMES):
            if number == len(self._kept):
                self._kept += islice(self._rest, 1)
            if number == len(self._kept):
                return
            yield self._kept[number]
        yield from islice(self._anew(), _MEASURED_FRAMES, None)

    def of_hand(self, index: int) -> Iterator[HandFrame]:
        """The frames of one hand."""
        return (parts[index] for parts in self.beginning())

    def _anew(self) -> Iterator[tuple[HandFrame, ...]]:
        splitter = HandSplitter(self.sides, self._pairs)
        self.counts = splitter.counts
        return map(splitter, self._frames)


def _sides(
    survey: LeapSurvey, metadata: dict[str, Any], hand: Hand | None, where: str
) -> tuple[tuple[str, ...], list[str]]:
    """Sides of the hands to be taken, and remarks on them."""
    if not survey.hands:
        raise RecordingError(
            "no hand is seen in this recording",
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
            return SIDES, ["this Leap does not say whose hands they are: thumbs and places tell"]
        told = metadata.get("side")
        if told in SIDES:
            return (str(told),), []
        return ("right",), ["this Leap does not say whose hand it is: --hand left, if it is left"]
    most = max(named, key=named.__getitem__)
    # A hand counts beside another only where both were seen at once.
    sides = tuple(s for s in named if s == most or survey.both > enough)
    remarks = [
        f"the {side} hand is not exported: {counted(count, 'frame')} of {survey.hands} name it, "
        f"and {survey.both} show both hands; --hand both exports it"
        for side, count in named.items()
        if side not in sides
    ]
    remarks += [
        f"{counted(survey.same[side], 'frame')} of {survey.hands} show two {side} hands: the one "
        "that is seen first is taken, and the other is left out"
        for side in sides
        if survey.same[side]
    ]
    return sides, remarks


def _calibration(recording: _SplitRecording, index: int) -> tuple[HandCalibration, str]:
    """Calibration of a hand in a recording, and a remark if it was not measured."""
    side, paalm = recording.sides[index], Paalm()
    shown = (frame for frame in recording.of_hand(index) if frame.hands)
    some = list(islice(shown, _BONES_FRAMES))
    if knows_bones(some, side):
        return with_reported_coupling(average_calibration(some, side, paalm.options), some), ""
    try:
        own = islice(recording.of_hand(index), _MEASURED_FRAMES)
        samples = [(f.time, f.hands[0] if f.hands else None) for f in own]
        return measured_in(samples, side, paalm.options), ""
    except EncoderError as error:
        return average_calibration(some, side, paalm.options), (
            f"an average {side} hand is assumed, because {error.what} ({error.got}); "
            "--calibration FILE takes yours"
        )


def _first_poses(
    recording: _SplitRecording, calibrations: dict[str, HandCalibration], where: str
) -> list[Array]:
    """The pose (48,) of each hand when it is first seen."""
    hands = straight_reconstructors(recording.sides, calibrations)
    first: list[Array | None] = [None] * len(hands)
    for parts in recording.beginning():
        for i, part in enumerate(parts):
            if first[i] is None:
                step = hands[i].step(part)
                first[i] = step.q if step.phase is Phase.DOWN else None
        poses = [q for q in first if q is not None]
        if len(poses) == len(hands):
            return poses
    unseen = [side for side, q in zip(recording.sides, first, strict=True) if q is None]
    raise RecordingError(
        f"no frame can be used of the {' and '.join(unseen)} hand",
        where=where,
        expected="hands apart, with five fingers at most",
    )


def _poses(
    recording: _SplitRecording, hands: Sequence[RecordedHand]
) -> Iterator[tuple[Array, Array]]:
    """Times (n,) s from the first frame, and poses (n, H, 48), in batches."""
    times: list[float] = []
    begin: float | None = None
    for parts in recording:
        begin = parts[0].time if begin is None else begin
        for hand, part in zip(hands, parts, strict=True):
            hand.add(part)
        times.append(parts[0].time - begin)
        if len(times) == CHUNK:
            yield np.array(times), np.stack([hand.poses() for hand in hands], axis=1)
            times = []
    if times:
        yield np.array(times), np.stack([hand.poses() for hand in hands], axis=1)
