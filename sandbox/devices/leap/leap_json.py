"""Decoder of Leap JSON frames to `HandFrame`, in all four existing dialects.

leapd and its successors send JSON over a WebSocket. The dialects differ in a pointable's fields:

    v1      2013: unordered, `length` is the visible length; no bones, no side
    v2      2014: five named fingers with joints; their lengths are fixed
    v3      Orion: v2 with carpals, `bases` of every bone and an arm
    bridge  UltraleapTrackingWebSocket: v3 without palm sphere, and `length` is a width by mistake

Leap: millimetres, microseconds, x right, y up, z towards the person. HandFrame: metres, seconds, x
right, y away from the person, z up. Both are right-handed, so the conversion does not mirror. If
joints are given, a finger's length is the sum of its bones, as v2 and v3 define it; the `length`
that the bridge sends is not used.

The last bone ends at `btipPosition`. `tipPosition` is the centre of a sphere at the fingertip: in
33,262 real v3 hands, the two positions are 6.5 mm apart on average. Software before 2.0 sends no
`btipPosition`; its bones end at `tipPosition`.

Other programs store the same values in other shapes: fingers inside their hands, and frames inside
an envelope. `canonical` converts these. Units other than the Leap's follow from the size of the
hand and the time between frames (`models.plausible`).

Fields are checked one by one, not by a `msgspec.Struct`: a struct would refuse a whole finger for
one wrong optional field.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any, TypeGuard

from models.errors import DeviceError, FrameError, RecordingError
from models.frames import SIDES, HandFrame, TrackedFinger, TrackedHand, Vector
from models.plausible import (
    DISTANCE,
    FINGER,
    JUMPED,
    ON_ANOTHER,
    REACH,
    STEP,
    Bounds,
    HandJumps,
    LiveUnits,
    SideDoubt,
    Units,
    find_units,
    lie_on,
    steps_of,
    unit_size,
)
from models.reader_report import ReaderReport

LEAP_UNITS: Units = {"length": "mm", "time": "us"}
"""Units of a Leap."""
USUAL_RATE = 100.0
"""Frame rate (Hz) that is assumed for recordings without times and without a rate."""
NORMAL_COUNTS = ("frames", "handshakes", "events", "connections")
"""Counts of a decoder or a device that are no losses."""

RESTART = 1.0
"""Largest step back in time (s) of a late frame. A larger step means a restart of the service."""
LEAP = 2.0
"""Largest step ahead in time (s) that is accepted at once. A larger step, or the step back of a
restart, is accepted only if the time of the next frame continues from it. A single wrong time would
otherwise lengthen a recording."""

_JOINTS = ("mcpPosition", "pipPosition", "dipPosition")
_END = "btipPosition"
_TOO_LARGE = 2**53
"""Integers from this value on are not exact as floats."""
_LATEST = 1e-6 * _TOO_LARGE
"""Upper bound of valid times (s). Clocks that count from 1970 are below 2e9 s."""
_FARTHEST = DISTANCE.most
"""Largest coordinate (m) of a valid position; the device's range is about one metre."""
_MOST_HANDS = 8
_PALM = 0.1
"""Approximate size of a palm (m)."""
_FARTHEST_TIP = 1.4 * REACH.most
"""Largest distance (m) from a palm to a fingertip in a single frame. It is larger than `REACH`,
because single frames are less exact."""
_OUT_OF_REACH = "fingers skipped: the tip is beyond a hand's reach of the palm"
_NO_HAND = "none of its hands can be used"
_FINGER_WORDS = {"thumb": 0, "index": 1, "middle": 2, "ring": 3, "pinky": 4, "little": 4}
"""Words in the names of fingers, for files with names instead of numbers."""


def canonical(message: Mapping[str, Any]) -> Mapping[str, Any]:
    """Converts a frame to the form that leapd sends.

    Frames of other programs may be inside an envelope, or have their fingers inside their hands.
    Any other message is returned unchanged.
    """
    if "hands" not in message and "pointables" not in message:
        inner = [canonical(v) for v in message.values() if isinstance(v, dict)]
        inner = [v for v in inner if "hands" in v]
        if len(inner) != 1:
            return message
        outer = {k: message[k] for k in ("id", "timestamp") if k in message}
        message = {**outer, **inner[0]}
    hands = message.get("hands")
    if isinstance(hands, dict):
        hands = [{"type": name, **h} for name, h in hands.items() if isinstance(h, dict)]
        message = {**message, "hands": hands}
    if message.get("pointables"):
        return message
    found = _inner(message.get("fingers"))
    for hand in hands if isinstance(hands, list) else ():
        if isinstance(hand, dict):
            inside = _inner(hand.get("fingers")) or _inner(hand.get("pointables"))
            found += [{"handId": hand.get("id"), **finger} for finger in inside]
    return {**message, "pointables": [_with_joints(finger) for finger in found]}


def _inner(items: Any) -> list[dict[str, Any]]:
    """Returns the objects in a list, or the objects that are values of an object."""
    values = items.values() if isinstance(items, dict) else items
    return [i for i in values if isinstance(i, dict)] if isinstance(values, Iterable) else []


def _with_joints(finger: dict[str, Any]) -> dict[str, Any]:
    """Returns a finger with the joints of its four bones, if it has bones and no joints."""
    bones = _inner(finger.get("bones"))
    if len(bones) != 4 or _JOINTS[0] in finger:
        return finger
    joints = zip((*_JOINTS, _END), (bone.get("nextJoint") for bone in bones), strict=True)
    return {"tipPosition": bones[-1].get("nextJoint"), **finger, **dict(joints)}


def quantities(message: Mapping[str, Any]) -> dict[Bounds, float]:
    """Returns sizes of the first hand of a canonical message, in the message's units.

    Returns an empty dictionary for a message without a hand.
    """
    try:
        hand = message["hands"][0]
        palm = hand["palmPosition"]
        own = [p for p in message["pointables"] if p.get("handId") == hand["id"]]
        found = {DISTANCE: math.hypot(*palm)}
        tips = [p["tipPosition"] for p in own]
        if tips:
            found[REACH] = max(math.dist(palm, tip) for tip in tips)
        chains = [
            [p[name] for name in (*_JOINTS, _END if _END in p else "tipPosition")]
            for p in own
            if _JOINTS[0] in p
        ]
        if chains:
            found[FINGER] = max(sum(math.dist(a, b) for a, b in pairwise(c)) for c in chains)
    except (AttributeError, IndexError, KeyError, TypeError, ValueError, OverflowError):
        return {}
    return found


_SAMPLE = 48
"""Number of frames from which the unit of time is found, and number of frames with a hand from
which the unit of length is found."""
_APART = 8
"""One in this number of frames with a hand is measured."""
_REGULAR = 0.8
"""Frames count as numbered if this share of the differences between their numbers is equal."""


def find_leap_units(
    messages: Iterable[Any], given: Units | None, where: str, report: ReaderReport
) -> tuple[Units, int]:
    """Finds the units of a recording, and the difference between successive frame numbers.

    Args:
        messages: All messages; only as many as needed are taken.
        given: Units that a person gave.
        where: The file, for the error.
        report: Assumptions are added to it.

    Returns:
        The units, and the difference; 0 if frames are not numbered.

    Raises:
        RecordingError: The hand's sizes are impossible in any unit, or times do not increase.
    """
    seen: dict[Bounds, list[float]] = {}
    stamps: list[float] = []
    numbers: list[int] = []
    frames = hands = 0
    for message in messages:
        if frames >= _SAMPLE <= hands:
            break
        if not isinstance(message, Mapping):
            continue
        frame = canonical(message)
        if frame.get("hands"):
            for bounds, value in quantities(frame).items() if hands % _APART == 0 else ():
                seen.setdefault(bounds, []).append(value)
            hands += 1
        if frames < _SAMPLE:
            stamp, number = frame.get("timestamp"), _frame_number(frame)
            stamps += [stamp] if _is_time(stamp) else []
            numbers += [number] if number is not None else []
            frames += 1
    seen[STEP] = steps_of(stamps)
    steps = Counter(b - a for a, b in pairwise(numbers))
    stride, count = steps.most_common(1)[0] if steps else (0, 0)
    units = find_units(seen, LEAP_UNITS, given, where=where, report=report, error=RecordingError)
    return units, stride if stride > 0 and count >= _REGULAR * steps.total() else 0


def _frame_number(message: Mapping[str, Any]) -> int | None:
    number = message.get("id", message.get("frameId"))
    return number if _is_identity(number) else None


class LeapDecoder:
    """Turns the messages of one connection or file into frames; invalid parts are counted.

    Args:
        source: Name written into the frames.
        rate: Hz, frame rate for messages without times and rate. With None, `USUAL_RATE` is
            assumed, and reported.
        units: Units of the messages.
        stride: Difference between successive frame numbers of a recording; 0 without numbers.
        live: Units of a running device, which are found from its first frames; None for a file.
    """

    def __init__(
        self,
        source: str = "leap",
        rate: float | None = None,
        units: Units = LEAP_UNITS,
        stride: int = 0,
        live: LiveUnits | None = None,
    ) -> None:
        self.counts: Counter[str] = Counter()
        self.assumed: list[str] = []
        self.dialect: str | None = None
        self.version: str | None = None
        self._source, self._stride, self._live = source, stride, live
        self._no_rate, self._rate = rate is None, rate or USUAL_RATE
        self._time: float | None = None
        # Time stamp and number of the last frame, as sent by the device.
        self._stamp: float | None = None
        self._number: int | None = None
        # Time (s) of the previous frame, if it was refused for its step in time.
        self._leapt: float | None = None
        # Time stamp of the last message, as sent by the device, whether used or not.
        self._latest: float | None = None
        self._offset, self._stamped = 0.0, False
        self._jumps, self._doubt = HandJumps(), SideDoubt()
        self._use(units)

    def _use(self, units: Units) -> None:
        self._metre, self._second = unit_size(units, "length"), unit_size(units, "time")
        self._jumps.forget()

    @property
    def report(self) -> ReaderReport:
        """Report on the parts left out so far, and on assumptions."""
        left_out = Counter({k: n for k, n in self.counts.items() if n and k not in NORMAL_COUNTS})
        doubts = filter(None, (self.side_doubt, self._jumps.doubt))
        return ReaderReport(left_out, [*self.assumed, *doubts])

    @property
    def side_doubt(self) -> str:
        """Warning that the reported sides of hands may be wrong; empty without doubt."""
        return self._doubt.sentence

    def feed(self, message: Any) -> HandFrame | None:
        """Converts a decoded JSON message; returns None if it contains no usable frame."""
        if not isinstance(message, Mapping):
            self.counts["messages that are not JSON objects"] += 1
            return None
        message = canonical(message)
        if "hands" not in message and "pointables" not in message:
            if "version" in message:
                self.version = str(message.get("serviceVersion", message["version"]))[:64]
                self.counts["handshakes"] += 1
            elif "event" in message:
                self.counts["events"] += 1
            else:
                self.counts["messages of another program"] += 1
            return None
        if self._live is not None and not self._live.decided:
            self._measure(message)
        if self._stride:
            self._count(_frame_number(message))
        try:
            hands = self._hands(message)
            time = self._moment(message)
            if time is None:
                return None
            if jumped := self._jumps.find(time, {hand.id: hand.palm for hand in hands}):
                self.counts[f"hands skipped: {JUMPED}"] += len(jumped)
                hands = tuple(hand for hand in hands if hand.id not in jumped)
                if not hands:
                    raise DeviceError(_NO_HAND)
            if self._doubt.due():
                for hand in hands:
                    self._doubt.look_at(hand)
            frame = HandFrame(time, hands, self._source, self.dialect)
        except (DeviceError, FrameError) as error:
            self.counts[f"frames refused: {error.what}"] += 1
            return None
        self._time, stamp = time, message.get("timestamp")
        self._stamp = stamp if _is_time(stamp) else None
        self.counts["frames"] += 1
        return frame

    def _count(self, number: int | None) -> None:
        """Counts frames that are missing before the frame of this number."""
        before = self._number
        if number is not None and (before is None or number > before):
            if before is not None:
                missing = (number - before - 1) // self._stride
                self.counts["frames missing by their numbers"] += missing
            self._number = number

    def _measure(self, message: Mapping[str, Any]) -> None:
        """Measures a frame of a running device; units found from it apply from this frame on."""
        assert self._live is not None
        seen, stamp = quantities(message), message.get("timestamp")
        if _is_time(stamp):
            if self._latest is not None and stamp > self._latest:
                seen[STEP] = stamp - self._latest
            self._latest = stamp
        self._live.look(seen)
        if self._live.decided and self._live.units != LEAP_UNITS:
            self._use(self._live.units)
            if self._time is not None and self._stamp is not None:
                # In the new units, times continue from the last frame.
                self._offset = self._time - self._stamp * self._second

    def _moment(self, message: Mapping[str, Any]) -> float | None:
        """Returns the time (s) of a message on a clock that never runs backwards.

        Returns None for a late frame, and for a single frame whose time is far behind or ahead;
        both are counted.
        """
        stamp = message.get("timestamp")
        if stamp is None and not self._stamped:
            rate = message.get("currentFrameRate")
            if not (_is_number(rate) and 1.0 <= rate <= 1000.0):
                rate = self._rate
                if self._no_rate and not self.assumed:
                    self.assumed.append(f"frames have no times: {rate:g} a second are assumed")
            return 0.0 if self._time is None else self._time + 1.0 / rate
        if stamp is None:
            raise DeviceError("no time, unlike other frames")
        if not _is_time(stamp):
            raise DeviceError("timestamp is not a finite number", got=str(stamp)[:40])
        if abs(stamp) * self._second >= _LATEST:
            raise DeviceError("timestamp is out of range", got=f"{stamp:g}")
        self._stamped = True
        time = stamp * self._second + self._offset
        before, self._leapt = self._leapt, None
        if self._time is None or self._time < time <= self._time + LEAP:
            return time
        if self._time - RESTART < time <= self._time:
            self.counts["frames whose time ran backwards"] += 1
            return None
        if before is None or not 0.0 < time - before <= LEAP:
            self.counts["frames whose time leapt"] += 1
            self._leapt = time
            return None
        if time < self._time or self.counts["frames"] == 1:
            # A step ahead after only one frame: the time of that first frame was wrong.
            self.counts["restarts of the device's clock"] += 1
            self._jumps.forget()
            self._offset += self._time + 1.0 / self._rate - time
            time = self._time + 1.0 / self._rate
        return time

    def _hands(self, message: Mapping[str, Any]) -> tuple[TrackedHand, ...]:
        fingers: dict[Any, list[TrackedFinger]] = {}
        for pointable in _items(message, "pointables"):
            try:
                if pointable.get("tool") is True:
                    self.counts["tools"] += 1
                    continue
                finger = _finger(pointable, self._metre)
            except (DeviceError, FrameError) as error:
                self.counts[f"fingers skipped: {error.what}"] += 1
                continue
            hand = pointable.get("handId")
            fingers.setdefault(hand if _is_number(hand) else None, []).append(finger)
            self._learn(pointable)
        hands: list[TrackedHand] = []
        for record in _items(message, "hands")[:_MOST_HANDS]:
            try:
                own = fingers.pop(_identity(record), [])
                hand = _hand(record, tuple(own), self._metre)
                near = tuple(f for f in own if math.dist(hand.palm, f.tip) <= _FARTHEST_TIP)
                if own and not near:
                    raise DeviceError("no fingertip is within a hand's reach of the palm")
                if len(near) < len(own):
                    self.counts[_OUT_OF_REACH] += len(own) - len(near)
                    hand = replace(hand, fingers=near)
                hands.append(hand)
            except (DeviceError, FrameError) as error:
                self.counts[f"hands skipped: {error.what}"] += 1
        for n in range(len(hands) - 1, 0, -1):
            if any(lie_on([hands[n].palm], [other.palm], _PALM) for other in hands[:n]):
                self.counts[ON_ANOTHER] += 1
                del hands[n]
        self.counts["fingers without a hand"] += sum(map(len, fingers.values()))
        if len({hand.id for hand in hands}) != len(hands):
            raise DeviceError("two hands share an id")
        if message.get("hands") and not hands:
            raise DeviceError(_NO_HAND)
        return tuple(hands)

    def _learn(self, pointable: Mapping[str, Any]) -> None:
        """Detects the dialect from the fields of the first finger."""
        if self.dialect is not None:
            return
        if "mcpPosition" not in pointable:
            self.dialect = "v1"
        elif "bases" not in pointable:
            self.dialect = "v2"
        elif "stabilizedTipPosition" not in pointable:
            self.dialect = "bridge"
        else:
            # Packed recordings of v2 contain the bases, but not the touch zone.
            self.dialect = "v3" if "touchDistance" in pointable else "v2"


def _finger(record: Mapping[str, Any], metre: float) -> TrackedFinger:
    tip = _place(record, "tipPosition", metre)
    joints = None
    if _JOINTS[0] in record:
        mcp, pip, dip = (_place(record, name, metre) for name in _JOINTS)
        end = _place(record, _END, metre) if _END in record else tip
        joints = (mcp, pip, dip, end)
        length = math.dist(mcp, pip) + math.dist(pip, dip) + math.dist(dip, end)
    else:
        length = _number(record.get("length"), "length") * metre
    kind = record.get("type")
    extended = record.get("extended")
    return TrackedFinger(
        id=_identity(record),
        tip=tip,
        direction=_direction(record, "direction"),
        length=length,
        finger=_name(record, kind) if joints else None,
        joints=joints,
        extended=extended if isinstance(extended, bool) else None,
    )


def _name(record: Mapping[str, Any], kind: Any) -> int | None:
    """Returns the label of a finger. Without `type`, the finger's id is 10 x hand's id + label."""
    if kind is None and _is_identity(record.get("handId")):
        kind = record["id"] - 10 * record["handId"]
    if isinstance(kind, str):
        kind = next((n for word, n in _FINGER_WORDS.items() if word in kind.lower()), None)
    return kind if isinstance(kind, int) and not isinstance(kind, bool) else None


def _hand(
    record: Mapping[str, Any], fingers: tuple[TrackedFinger, ...], metre: float
) -> TrackedHand:
    radius, confidence = record.get("sphereRadius"), record.get("confidence")
    return TrackedHand(
        id=_identity(record),
        palm=_place(record, "palmPosition", metre),
        normal=_direction(record, "palmNormal"),
        direction=_direction(record, "direction"),
        fingers=fingers,
        side=side_named(record.get("type")),
        confidence=min(max(float(confidence), 0.0), 1.0) if _is_number(confidence) else 1.0,
        sphere_radius=radius * metre if _is_number(radius) and radius > 0 else None,
        wrist=_place(record, "wrist", metre) if "wrist" in record else None,
    )


def side_named(name: Any) -> str | None:
    """Returns the side that a device names, in upper or lower case; None for other values."""
    side = name.lower() if isinstance(name, str) else None
    return side if side in SIDES else None


def _items(message: Mapping[str, Any], name: str) -> list[Mapping[str, Any]]:
    items = message.get(name, [])
    if not isinstance(items, list) or not all(
        type(i) is dict or isinstance(i, Mapping) for i in items
    ):
        raise DeviceError(f"`{name}` is not a list of objects")
    return items


def _identity(record: Mapping[str, Any]) -> int:
    value = record.get("id")
    if not _is_identity(value):
        raise DeviceError("`id` is not an integer below 2^53", got=str(value)[:40])
    return value


def _is_identity(value: Any) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) < _TOO_LARGE


def _is_time(value: Any) -> TypeGuard[float]:
    """True for a number; also for larger integers, such as nanoseconds since 1970."""
    return _is_number(value) or (type(value) is int and abs(value) < 2**63)


def _is_number(value: Any) -> TypeGuard[float]:
    if type(value) is float:
        return math.isfinite(value)
    # Python's integers may be larger than any float.
    return _is_identity(value)


def _number(value: Any, name: str) -> float:
    if not _is_number(value):
        raise DeviceError(f"{name} is not a finite number", got=str(value)[:40])
    return float(value)


def _vector(record: Mapping[str, Any], name: str) -> Vector:
    value = record.get(name)
    if type(value) is list and len(value) == 3:
        x, y, z = value
        # Fast path for nearly all vectors: a sum is finite only if all its parts are.
        if type(x) is type(y) is type(z) is float and math.isfinite(x + y + z):
            return x, -z, y
    if isinstance(value, Mapping) and value.keys() >= {"x", "y", "z"}:
        value = [value["x"], value["y"], value["z"]]
    if not (isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))):
        raise DeviceError(f"{name} is not three finite numbers", got=str(value)[:60])
    x, y, z = value
    return float(x), -float(z), float(y)


def _place(record: Mapping[str, Any], name: str, metre: float) -> Vector:
    x, y, z = _vector(record, name)
    x, y, z = x * metre, y * metre, z * metre
    if x == y == z == 0.0:
        raise DeviceError(f"{name} is zero")
    if not (
        -_FARTHEST <= x <= _FARTHEST
        and -_FARTHEST <= y <= _FARTHEST
        and -_FARTHEST <= z <= _FARTHEST
    ):
        raise DeviceError(f"{name} is farther away than the device can see")
    return x, y, z


def _direction(record: Mapping[str, Any], name: str) -> Vector:
    x, y, z = _vector(record, name)
    length = math.hypot(x, y, z)
    if not 0.5 <= length <= 2.0:
        raise DeviceError(f"{name} has no direction: its length is not 1")
    return x / length, y / length, z / length
