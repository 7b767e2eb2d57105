"""Decoder of Leap JSON frames to `HandFrame`, in all four existing dialects.

leapd and its successors send JSON over a WebSocket. The dialects differ in a pointable's fields:

    v1      2013: unordered, `length` is the length the device sees; no bones, no side
    v2      2014: five named fingers with joints; their lengths are fixed
    v3      Orion: v2 with carpals, `bases` of every bone and an arm
    bridge  UltraleapTrackingWebSocket: v3 without palm sphere, and `length` is a width by mistake

Leap: millimetres, microseconds, x right, y up, z towards the person. HandFrame: metres, seconds, x
right, y away from the person, z up. Both are right-handed, so nothing is mirrored. If joints are
given, a finger's length is the sum of its bones, as v2 and v3 define it; the bridge's is wrong.

The last bone ends at `btipPosition`. `tipPosition` is the centre of a sphere at the fingertip: on
33,262 real v3 hands the two are 6.5 mm apart on average. Software before 2.0 sends no
`btipPosition`; its bones end at `tipPosition`.

Fields are checked here and not by structs: a struct would refuse a whole finger for a wrong
optional field (side, hand, confidence), while here everything else is used.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import Any, TypeGuard

from models.errors import DeviceError, FrameError
from models.frames import HandFrame, TrackedFinger, TrackedHand, Vector

METRES_PER_MM = 1e-3
SECONDS_PER_US = 1e-6

RESTART = 1.0
"""s. If time runs back by more, the service was restarted; by less, the frame is late."""
LEAP = 2.0
"""s. A time that is farther ahead comes after a pause. It is believed once the next frame's follows
on it, as that of a restart is: a single wrong one would stretch a recording."""

_JOINTS = ("mcpPosition", "pipPosition", "dipPosition")
_END = "btipPosition"
_TOO_LARGE = 2**53
"""Integers from here on are not exact as a float."""
_FARTHEST = 10_000.0
"""mm, largest coordinate of a valid position; the device sees about one metre."""
_MOST_HANDS = 8


class LeapDecoder:
    """Turns the messages of one connection or file into frames; invalid parts are counted.

    Args:
        source: Name written into the frames.
        rate: Hz, frame rate of recordings without times and rate.
    """

    def __init__(self, source: str = "leap", rate: float = 100.0) -> None:
        self.counts: Counter[str] = Counter()
        self.dialect: str | None = None
        self.version: str | None = None
        self._source, self._rate = source, rate
        self._time: float | None = None
        # s, time of the frame before, if it was refused as it leapt.
        self._leapt: float | None = None
        self._offset = 0.0

    def feed(self, message: Any) -> HandFrame | None:
        """The frame of a decoded JSON message; None if it contains no usable frame."""
        if not isinstance(message, Mapping):
            self.counts["messages that are not JSON objects"] += 1
            return None
        if "hands" not in message and "pointables" not in message:
            if "version" in message:
                self.version = str(message.get("serviceVersion", message["version"]))[:64]
                self.counts["handshakes"] += 1
            elif "event" in message:
                self.counts["events"] += 1
            else:
                self.counts["messages of another program"] += 1
            return None
        try:
            hands = self._hands(message)
            time = self._moment(message)
            if time is None:
                return None
            frame = HandFrame(time, hands, self._source, self.dialect)
        except (DeviceError, FrameError) as error:
            self.counts[f"frames refused: {error.what}"] += 1
            return None
        self._time = time
        self.counts["frames"] += 1
        return frame

    def _moment(self, message: Mapping[str, Any]) -> float | None:
        """s, time of a message on a clock that never runs backwards; None, which is counted, for a
        late frame and for one that leaps back or ahead alone."""
        if "timestamp" not in message:
            rate = message.get("currentFrameRate", self._rate)
            step = 1.0 / (rate if _is_number(rate) and 1.0 <= rate <= 1000.0 else self._rate)
            return 0.0 if self._time is None else self._time + step
        stamp = _number(message["timestamp"], "timestamp")
        if abs(stamp) > _TOO_LARGE:
            raise DeviceError("timestamp is out of range", got=f"{stamp:g}", expected="us")
        time = stamp * SECONDS_PER_US + self._offset
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
            # After a single frame it is that one whose time was wrong.
            self.counts["restarts of the device's clock"] += 1
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
                finger = _finger(pointable)
            except (DeviceError, FrameError) as error:
                self.counts[f"fingers skipped: {error.what}"] += 1
                continue
            hand = pointable.get("handId")
            fingers.setdefault(hand if _is_number(hand) else None, []).append(finger)
            self._learn(pointable)
        hands: list[TrackedHand] = []
        for record in _items(message, "hands")[:_MOST_HANDS]:
            try:
                own = fingers.pop(_identity(record), ())
                hands.append(_hand(record, tuple(own)))
            except (DeviceError, FrameError) as error:
                self.counts[f"hands skipped: {error.what}"] += 1
        self.counts["fingers without a hand"] += sum(map(len, fingers.values()))
        if len({hand.id for hand in hands}) != len(hands):
            raise DeviceError("two hands share an id")
        if message.get("hands") and not hands:
            raise DeviceError("none of its hands can be used")
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


def _finger(record: Mapping[str, Any]) -> TrackedFinger:
    tip = _place(record, "tipPosition")
    joints = None
    if _JOINTS[0] in record:
        mcp, pip, dip = (_place(record, name) for name in _JOINTS)
        end = _place(record, _END) if _END in record else tip
        joints = (mcp, pip, dip, end)
        length = math.dist(mcp, pip) + math.dist(pip, dip) + math.dist(dip, end)
    else:
        length = _number(record.get("length"), "length") * METRES_PER_MM
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
    """Label of the finger; without `type` it follows from the id, 10 times the hand's plus it."""
    if kind is None and _is_identity(record.get("handId")):
        kind = record["id"] - 10 * record["handId"]
    return kind if isinstance(kind, int) and not isinstance(kind, bool) else None


def _hand(record: Mapping[str, Any], fingers: tuple[TrackedFinger, ...]) -> TrackedHand:
    side = record.get("type")
    radius, confidence = record.get("sphereRadius"), record.get("confidence")
    return TrackedHand(
        id=_identity(record),
        palm=_place(record, "palmPosition"),
        normal=_direction(record, "palmNormal"),
        direction=_direction(record, "direction"),
        fingers=fingers,
        side=side if side in ("right", "left") else None,
        confidence=min(max(float(confidence), 0.0), 1.0) if _is_number(confidence) else 1.0,
        sphere_radius=radius * METRES_PER_MM if _is_number(radius) and radius > 0 else None,
        wrist=_place(record, "wrist") if "wrist" in record else None,
    )


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
        # Nearly all vectors: a sum is finite only if all its parts are.
        if type(x) is type(y) is type(z) is float and math.isfinite(x + y + z):
            return x, -z, y
    if not (isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))):
        raise DeviceError(f"{name} is not three finite numbers", got=str(value)[:60])
    x, y, z = value
    return float(x), -float(z), float(y)


def _place(record: Mapping[str, Any], name: str) -> Vector:
    x, y, z = _vector(record, name)
    if not (
        -_FARTHEST <= x <= _FARTHEST
        and -_FARTHEST <= y <= _FARTHEST
        and -_FARTHEST <= z <= _FARTHEST
    ):
        raise DeviceError(f"{name} is farther away than the device can see")
    return x * METRES_PER_MM, y * METRES_PER_MM, z * METRES_PER_MM


def _direction(record: Mapping[str, Any], name: str) -> Vector:
    x, y, z = _vector(record, name)
    length = math.hypot(x, y, z)
    if not 0.5 <= length <= 2.0:
        raise DeviceError(f"{name} has no direction: its length is not 1")
    return x / length, y / length, z / length
