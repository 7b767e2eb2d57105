"""Landmarks of hands in pictures as JSON: messages of the page, and files that can be played."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Hashable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from statistics import median
from typing import Any, Literal

import msgspec
import numpy as np

from encoders.air.camera import Camera
from encoders.air.landmark_fit import KNUCKLES
from models.errors import DeviceError, FrameError, InputError, RecordingError
from models.frames import LANDMARKS, LandmarkFrame, SeenHand
from models.json_input import (
    converted,
    decoded,
    loosely_decoded,
    numbered_lines,
    whole_json,
)
from models.plausible import (
    BEYOND,
    IN_PICTURE,
    JUMPED,
    ON_ANOTHER,
    PALM,
    PALM_AT_ONCE,
    STEP,
    Bounds,
    HandJumps,
    SideDoubt,
    Units,
    find_units,
    forget_beyond,
    lie_on,
    parse_units,
    steps_of,
    unit_size,
)
from models.reader_report import ReaderReport
from sandbox.devices.device import FilePlayer, LandmarkDevice

SOURCE = "webcam"
MOST_SEEN = 4
"""Largest number of hands in a message; the page detects up to three."""
_LARGEST = 1e5
"""Largest plausible coordinate or size of a picture, px."""

USUAL_SIZE = (640, 480)
"""Width and height of a picture whose size is not stated, px."""

Point = tuple[float, float]
Vector = tuple[float, float, float]
Trouble = Literal["absent", "in use", "refused", "engine", "hidden"]


class HandMessage(msgspec.Struct):
    """A hand in a picture (see `models.frames.SeenHand`); MediaPipe's names of sides begin with
    capitals."""

    side: Literal["right", "left", "Right", "Left"]
    score: float
    image: list[Point]
    world: list[Vector]


class PictureMessage(msgspec.Struct):
    """The hands in a picture (`models.frames.LandmarkFrame`), or the reason for a missing picture.

    Attributes:
        time: Time at which the page had found the hands, on the page's clock, s; None with
            `trouble` or `corners`.
        taken: Time at which the picture was taken, on the same clock, s; None: `time` is used.
        size: Width and height of the picture, px; None if it is not stated.
        seen: Hands in the picture.
        trouble: Reason for a missing picture; None with a picture.
        corners: Corners of a surface that the person marked, px: top left, top right, bottom right,
            bottom left; None in other messages.
        unread: Number of unreadable hands, which are not in `seen`.
    """

    time: float | None = None
    taken: float | None = None
    size: tuple[int, int] | None = None
    seen: list[HandMessage] = []
    trouble: Trouble | None = None
    corners: tuple[Point, Point, Point, Point] | None = None
    unread: int = 0

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height of the picture, px; `USUAL_SIZE` if they are not stated."""
        return self.size or USUAL_SIZE


def picture_message(text: bytes | str, where: str = SOURCE) -> PictureMessage:
    """Reads a message of the page, or a line of a file.

    Raises:
        DeviceError: The message has neither a picture, nor a reason for a missing picture, nor
            corners.
    """
    data = text.encode() if isinstance(text, str) else text
    try:
        message = decoded(
            data,
            PictureMessage,
            DeviceError,
            what="these are not landmarks",
            where=where,
            expected='{"time": s, "size": [px, px], "seen": [...]}',
        )
    except DeviceError:
        readable = _readable(data)
        if readable is None:
            raise
        message = readable
    if message.time is None and message.trouble is None and message.corners is None:
        raise DeviceError("the picture has no time", where=where)
    return message


def _readable(data: bytes) -> PictureMessage | None:
    """Reads a message without its unreadable hands; None if the rest cannot be read either."""
    loose = loosely_decoded(data)
    if not (isinstance(loose, dict) and isinstance(loose.get("seen"), list)):
        return None
    hands = [converted(hand, HandMessage) for hand in loose["seen"]]
    message = converted({**loose, "seen": []}, PictureMessage)
    if message is None:
        return None
    sound = [hand for hand in hands if hand is not None]
    return msgspec.structs.replace(message, seen=sound, unread=len(hands) - len(sound))


LANDMARK_UNITS: Units = {"length": "m", "time": "s", "image coordinate": "px"}
"""Units of messages and files."""


def quantities(message: PictureMessage) -> dict[Bounds, float]:
    """Returns sizes of a message's first hand, in the message's units; empty without a hand."""
    hand = next(iter(message.seen), None)
    if (
        hand is None
        or not len(hand.image) == len(hand.world) == LANDMARKS
        or min(message.pixels) < 1
    ):
        return {}
    usual = unit_size({"image coordinate": "0..1"}, "image coordinate")
    ends = [
        (min(axis) * usual / pixels, max(axis) * usual / pixels)
        for axis, pixels in zip(zip(*hand.image, strict=True), message.pixels, strict=True)
    ]
    return {
        PALM: math.dist(hand.world[0], hand.world[9]),
        IN_PICTURE: max(high - low for low, high in ends),
        BEYOND: max(max(-low, high - usual, 0.0) for low, high in ends),
    }


def in_units(message: PictureMessage, units: Units) -> PictureMessage:
    """Converts a message from other units to `LANDMARK_UNITS`."""
    if units == LANDMARK_UNITS or message.time is None:
        return message
    metre, second = unit_size(units, "length"), unit_size(units, "time")
    width, height = message.pixels if units["image coordinate"] == "0..1" else (1, 1)
    seen = [
        HandMessage(
            hand.side,
            hand.score,
            [(x * width, y * height) for x, y in hand.image],
            [(x * metre, y * metre, z * metre) for x, y, z in hand.world],
        )
        for hand in message.seen
    ]
    taken = None if message.taken is None else message.taken * second
    return msgspec.structs.replace(message, time=message.time * second, taken=taken, seen=seen)


def frame_of(message: PictureMessage, where: str = SOURCE) -> LandmarkFrame:
    """Returns the frame of a picture, without hands that have invalid numbers.

    Raises:
        FrameError: Numbers of the frame, or of all its hands, are invalid.
    """
    if message.time is None:
        raise FrameError("this is not a picture", where=where, got=message.trouble)
    if len(message.seen) > MOST_SEEN:
        raise FrameError("too many hands", where=where, got=len(message.seen))
    if max(message.pixels) > _LARGEST:
        raise FrameError("the picture is too large", where=where, got=message.pixels)
    taken = message.time if message.taken is None else message.taken
    if not math.isfinite(taken):
        raise FrameError("a picture's time must be finite", where=where, got=taken)
    hands: list[SeenHand] = []
    wrong = FrameError(UNREADABLE, where=where) if message.unread else None
    for hand in message.seen:
        try:
            hands.append(_seen(hand, where))
        except FrameError as error:
            wrong = error
    if wrong is not None and not hands:
        raise wrong
    return LandmarkFrame(message.time, tuple(hands), message.pixels, taken, SOURCE)


UNREADABLE = "hands that cannot be read"


def _seen(hand: HandMessage, where: str) -> SeenHand:
    """Returns a hand of a message.

    Raises:
        FrameError: Its numbers are not valid.
    """
    far = max((abs(c) for p in hand.image for c in p), default=0.0)
    if not far <= _LARGEST:
        raise FrameError("a landmark is too far away", where=where, got=far, expected="pixels")
    return SeenHand(hand.side.lower(), hand.score, tuple(hand.image), tuple(hand.world))


def left_hands(message: PictureMessage, frame: LandmarkFrame) -> int:
    """Returns the number of hands that are in a message and not in its frame."""
    return len(message.seen) + message.unread - len(frame.hands)


COLLAPSED = "hands whose points in space are of a size that no hand has"
OUTSIDE = "hands that are wholly beyond the picture"


_STAYS = 0.02
"""A hand hardly moves if wrist and knuckle together move by less than this share of the picture's
width."""
_MIDDLE = 9
"""Landmark of the middle finger's knuckle."""
_NOWHERE = (math.inf, math.inf)
_SHORTEST, _LONGEST = PALM_AT_ONCE.least, PALM_AT_ONCE.most


class PossibleHands:
    """Removes impossible hands from pictures.

    Attributes:
        side: Check of the hands' sides.
    """

    def __init__(self) -> None:
        self.side = SideDoubt()
        self._jumps = HandJumps()
        # Wrist and middle knuckle of the single hand in the previous picture, px.
        self._wrist, self._knuckle = _NOWHERE, _NOWHERE
        # The previous picture, if it was not checked for jumps.
        self._stayed: LandmarkFrame | None = None

    def only(self, frame: LandmarkFrame, left_out: Counter[str]) -> LandmarkFrame:
        """Returns a picture without its impossible hands.

        Args:
            frame: The picture, in `LANDMARK_UNITS`.
            left_out: The number of removed hands is added to it, by reason.
        """
        hands = frame.hands
        if len(hands) == 1:
            # Quick test for most pictures: a single hand, inside the picture and of a possible
            # size, that hardly moved.
            hand = hands[0]
            world, wrist, knuckle = hand.world, hand.image[0], hand.image[_MIDDLE]
            moved = math.dist(wrist, self._wrist) + math.dist(knuckle, self._knuckle)
            self._wrist, self._knuckle = wrist, knuckle
            width, height = frame.size
            stays = (
                moved < _STAYS * width
                and 0.0 <= wrist[0] <= width
                and 0.0 <= wrist[1] <= height
                and _SHORTEST <= math.dist(world[0], world[_MIDDLE]) <= _LONGEST
            )
        else:
            stays = False
        if stays:
            self._stayed = frame
        else:
            frame = self._examined(frame, left_out)
        if self.side.due():
            for hand in frame.hands:
                self.side.look(hand.side, [hand.world[k : k + 4] for k in KNUCKLES])
        return frame

    def _examined(self, frame: LandmarkFrame, left_out: Counter[str]) -> LandmarkFrame:
        if self._stayed is not None:
            self._jumps.find(self._stayed.taken, _places(self._stayed))
            self._stayed = None
        hands: list[SeenHand] = []
        # If the engine detects a hand twice, the detection with the higher score counts.
        for hand in sorted(frame.hands, key=lambda hand: -hand.score):
            reason = _impossible(hand, frame.size)
            if reason or any(_is_twice(hand, other) for other in hands):
                left_out[reason or ON_ANOTHER] += 1
            else:
                hands.append(hand)
        possible = _with(frame, hands)
        places = _places(possible)
        jumped = self._jumps.find(frame.taken, places)
        if jumped:
            left_out[JUMPED] += len(jumped)
            seen = zip(possible.hands, places, strict=True)
            possible = _with(possible, [hand for hand, who in seen if who not in jumped])
        if len(frame.hands) != 1 or possible is not frame:
            self._wrist = self._knuckle = _NOWHERE
        return possible


def _with(frame: LandmarkFrame, hands: Sequence[SeenHand]) -> LandmarkFrame:
    """Returns the frame with only some of its hands."""
    if len(hands) == len(frame.hands):
        return frame
    kept = {id(hand) for hand in hands}
    return replace(frame, hands=tuple(hand for hand in frame.hands if id(hand) in kept))


def _impossible(hand: SeenHand, size: tuple[int, int]) -> str:
    """Returns the reason why a hand is impossible; empty for a possible hand."""
    if not PALM_AT_ONCE.includes(math.dist(hand.world[0], hand.world[_MIDDLE])):
        return COLLAPSED
    x, y = hand.image[0]
    if 0.0 <= x <= size[0] and 0.0 <= y <= size[1]:
        return ""  # as for most hands
    for places, pixels in zip(zip(*hand.image, strict=True), size, strict=True):
        if min(places) > pixels or max(places) < 0.0:
            return OUTSIDE
    return ""


def _is_twice(hand: SeenHand, other: SeenHand) -> bool:
    long = max(math.dist(hand.image[0], tip) for tip in hand.image[4::4])
    return lie_on(hand.image, other.image, long)


_ACROSS = (0, 5, 17)
"""Landmarks of the palm: the wrist and two knuckles."""


def _rough_place(hand: SeenHand, size: tuple[int, int]) -> Vector:
    """Returns the rough position (m) of a hand, from its size in the picture of a usual camera."""
    wrist, index, little = (hand.image[n] for n in _ACROSS)
    a, b, c = (hand.world[n][:2] for n in _ACROSS)
    in_space = math.dist(b, a) + math.dist(c, a) + math.dist(c, b)
    in_picture = math.dist(index, wrist) + math.dist(little, wrist) + math.dist(little, index)
    # Metres per pixel. The focal length of a usual camera is about the picture's longer side, px.
    scale = in_space / max(in_picture, 1.0)
    x = (wrist[0] + index[0] + little[0]) / len(_ACROSS)
    y = (wrist[1] + index[1] + little[1]) / len(_ACROSS)
    return scale * x, scale * y, scale * max(size)


def _places(frame: LandmarkFrame) -> dict[Hashable, Vector]:
    """Returns the rough positions of the hands, by key.

    A single hand has the same key in all pictures, even if its reported side changes.
    """
    numbers: Counter[str] = Counter()
    places: dict[Hashable, Vector] = {}
    for hand in frame.hands:
        numbers[hand.side] += 1
        identity = (hand.side, numbers[hand.side]) if len(frame.hands) > 1 else "only"
        places[identity] = _rough_place(hand, frame.size)
    return places


def message_of(frame: LandmarkFrame) -> dict[str, Any]:
    """Returns a frame as JSON values, which `picture_message` and `frame_of` read back exactly."""
    return {
        "time": frame.time,
        "taken": frame.taken,
        "size": frame.size,
        "seen": [
            {"side": h.side, "score": h.score, "image": h.image, "world": h.world}
            for h in frame.hands
        ],
    }


VERSION = 1
LONGEST_LINE = 1 << 16
"""Largest length of a line, bytes; a line with four hands has about 5,000."""


class Header(msgspec.Struct):
    """The first line of a file.

    Attributes:
        landmarks: Version of the format.
        camera: The camera that took the pictures; None if it is not stated.
    """

    landmarks: int
    camera: Camera | None = None


@dataclass(frozen=True)
class LandmarkRecording:
    """The pictures of a file.

    Attributes:
        frames: Frames in order of time.
        camera: The camera that took the pictures; None if the file does not state it.
        damage: Error that ended the file early; None if it is undamaged.
        lines: Number of each frame's line.
        report: Report on left-out data and assumptions.
    """

    frames: tuple[LandmarkFrame, ...]
    camera: Camera | None
    damage: RecordingError | None = None
    lines: tuple[int, ...] = ()
    report: ReaderReport = field(default_factory=ReaderReport)


def header_record(camera: Camera) -> dict[str, Any]:
    """Returns the JSON values of a file's first line."""
    return {"landmarks": VERSION, "camera": asdict(camera)}


def is_landmark_file(path: Path) -> bool:
    """True if a file's first line is that of a file of landmarks; the rest may be damaged."""
    try:
        with path.open("rb") as file:
            line = file.readline(LONGEST_LINE)
    except OSError:
        return False
    try:
        values = msgspec.json.decode(line)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return False
    return isinstance(values, dict) and "landmarks" in values


def read_landmarks(path: Path, unit: str = "") -> LandmarkRecording:
    """Reads a file up to its end or to the first line that is not JSON.

    Pictures that cannot be used are left out and counted.

    Args:
        path: The file.
        unit: Units that a person gave, such as `cm,ms`. Missing ones are found from the hand's size
            and the frames' rate.

    Raises:
        RecordingError: The file cannot be read, has no usable picture, or has sizes that are
            impossible for a hand.
        InputError: A setting of the file's camera is impossible.
    """
    report = ReaderReport()
    header, messages, damage = _messages(path, report)
    sample = [message for _, message in messages[:_SAMPLE]]
    seen: dict[Bounds, list[float]] = {}
    for message in [m for m in sample if m.seen][::_APART]:
        for bounds, value in quantities(message).items():
            seen.setdefault(bounds, []).append(value)
    forget_beyond(seen)
    times = [m.time if m.taken is None else m.taken for m in sample]
    stamps = [t for t in times if t is not None]
    seen[STEP] = steps_of(stamps)
    units = find_units(
        seen,
        LANDMARK_UNITS,
        parse_units(unit),
        where=str(path),
        report=report,
        error=RecordingError,
    )
    if any(m.size is None for m in sample if m.seen):
        width, height = USUAL_SIZE
        report.assume(f"pictures do not state their size; {width} x {height} pixels are assumed")
    _doubt_pictures([in_units(m, units) for m in sample if m.seen][::_APART], report)
    lines: list[int] = []
    frames: list[LandmarkFrame] = []
    before: LandmarkFrame | None = None
    possible = PossibleHands()
    for number, message in messages:
        try:
            read = replace(frame_of(in_units(message, units)), source="file")
        except FrameError as error:
            report.leave_out(f"pictures: {error.what}")
            continue
        report.leave_out(UNREADABLE, left_hands(message, read))
        if frames and read.taken < frames[-1].taken:
            report.leave_out("pictures whose time ran backwards")
            continue
        if read == before:
            report.leave_out("pictures that are there twice")
            continue
        before = read
        lines.append(number)
        frames.append(possible.only(read, report.left_out))
    if possible.side.sentence:
        report.assume(possible.side.sentence)
    if not frames:
        raise damage or RecordingError(
            "the file contains no usable pictures",
            where=str(path),
            got=report.main_reason or None,
            expected='lines like {"time": s, "size": [px, px], "seen": [...]}',
        )
    return LandmarkRecording(
        tuple(frames), header.camera if header else None, damage, tuple(lines), report
    )


_SAMPLE, _APART = 96, 16
"""Units are found from the first `_SAMPLE` pictures, of which one in `_APART` is measured."""


_MIRRORED = -0.8
"""Below this correlation, the points in the picture are mirrored relative to those in space."""
_STRETCHED = 1.4
"""Largest plausible factor between the ratios width / height of a hand in the picture and in space.
If width and height of the picture are exchanged, the factor is at least 1.6: that of a 5:4 picture,
the format nearest to a square."""
_WIDE = 0.01
"""Axes are compared only if the standard deviation of points in space is larger than this, m."""


def _doubt_pictures(messages: Sequence[PictureMessage], report: ReaderReport) -> None:
    """Reports pictures that seem to be mirrored, or to have exchanged width and height.

    It compares the landmarks in the picture with those in space.
    """
    agreements: list[float] = []
    stretches: list[float] = []
    for message in messages:
        hand = message.seen[0]
        if not len(hand.image) == len(hand.world) == LANDMARKS:
            continue
        seen, real = np.array(hand.image), np.array(hand.world)[:, :2]
        seen, real = seen - seen.mean(axis=0), real - real.mean(axis=0)
        in_picture, in_space = (np.sqrt((x * x).mean(axis=0)) for x in (seen, real))
        wide = (in_space > _WIDE) & (in_picture > 0.0)
        if wide.any():
            together = (seen * real).mean(axis=0)[wide]
            agreements.append(float((together / (in_picture * in_space)[wide]).min()))
        if wide.all():
            across, up = in_picture / in_space
            stretches.append(float(across / up))
    if median(agreements or [1.0]) < _MIRRORED:
        report.assume(
            "points in the picture are mirrored compared with points in space: if the picture is "
            "mirrored, its hands are of the other side"
        )
    stretch = median(stretches or [1.0])
    if not 1.0 / _STRETCHED < stretch < _STRETCHED:
        report.assume(
            f"hands are {stretch:.2g} times as wide in the picture as in space: are its width and "
            "height exchanged?"
        )


def _messages(
    path: Path, report: ReaderReport
) -> tuple[Header | None, list[tuple[int, PictureMessage]], RecordingError | None]:
    """Returns the header, the pictures with the numbers of their lines, and the damage that ended
    the file early."""
    messages: list[tuple[int, PictureMessage]] = []
    header: Header | None = None
    try:
        for number, line in numbered_lines(path, LONGEST_LINE):
            where = f"{path}, line {number}"
            if header is None:
                header = _header(line, where)
                continue
            try:
                message = picture_message(line, where)
            except InputError as error:
                if whole_json(line):
                    report.leave_out(f"pictures: {error.what}, expected {error.expected}")
                    continue
                remedy = "The pictures before it are played" if messages else None
                return (
                    header,
                    messages,
                    RecordingError(
                        f"the recording is damaged: {error.what}",
                        where=where,
                        got=None if error.got is None else str(error.got)[:40],
                        expected=error.expected,
                        remedy=remedy,
                    ),
                )
            if message.time is None:
                report.leave_out("lines without a picture")
            else:
                messages.append((number, message))
    except OSError as error:
        raise RecordingError(
            "the file cannot be read", where=str(path), got=error.strerror
        ) from None
    return header, messages, None


def _header(line: bytes, where: str) -> Header:
    header = decoded(
        line,
        Header,
        RecordingError,
        what="this is not a file of landmarks",
        where=where,
        expected=f'{{"landmarks": {VERSION}, "camera": {{...}}}}',
    )
    if header.landmarks != VERSION:
        raise RecordingError(
            "the file has an unknown version of the format",
            where=where,
            got=header.landmarks,
            expected=str(VERSION),
        )
    return header


class LandmarkFileDevice(FilePlayer, LandmarkDevice):
    """Plays a recording of landmarks; its first picture plays at session time 0.

    Args:
        recording: A recording from `read_landmarks`.

    Attributes:
        camera: The camera that took the pictures; None if the recording does not state it.
    """

    name = "landmark recording"
    lift = True

    def __init__(self, recording: LandmarkRecording) -> None:
        start = recording.frames[0].taken
        frames = [replace(f, time=f.taken - start, taken=f.taken - start) for f in recording.frames]
        super().__init__(frames, recording.damage, recording.report)
        self.camera = recording.camera
