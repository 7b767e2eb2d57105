"""Leap recordings as files: plain JSON, LeapJS recordings (`.json.lz`, packed or not), JSON lines.

Recognised by content, not by name:

    [frame, frame, ...]                         the first Leap software's dumps
    {"metadata": {...}, "frames": [...]}        LeapJS; packed where frames[0] is a list of keys
    LZString base64 of such a text              LeapJS, `.json.lz`
    one message a line                          what leapd sent, as it came; good up to damage
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from models.errors import InputError, RecordingError
from models.frames import HandFrame
from sandbox.devices.leap.leap_json import LeapDecoder
from sandbox.devices.leap.leap_lz import decompress_base64

LARGEST = 1 << 28
"""Bytes of a file that is read; an hour of two hands is about half of it."""

_UNREADABLE = (msgspec.DecodeError, UnicodeDecodeError, RecursionError)
"""What damaged JSON raises; names of fields that are no UTF-8 are no DecodeError."""

_REMEDY = "`sandbox leap formats` lists what can be played"


@dataclass(frozen=True)
class LeapRecording:
    """The frames of a recording.

    Attributes:
        frames: In order of time.
        messages: The JSON objects, unpacked; what a fake leapd sends again.
        dialect: `v1`, `v2`, `v3`, `bridge`, or None where no finger was seen.
        counts: How many frames, fingers and hands were used or left out, and why.
        metadata: The file's own, where it has some.
        damage: What ended a file of JSON lines early; None where it is whole.
    """

    frames: tuple[HandFrame, ...]
    messages: tuple[dict[str, Any], ...]
    dialect: str | None
    counts: Counter[str] = field(default_factory=Counter)
    metadata: dict[str, Any] = field(default_factory=dict)
    damage: RecordingError | None = None

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return self.frames[-1].time - self.frames[0].time


def check_side(frames: Sequence[HandFrame], side: str, where: str, option: str) -> None:
    """Refuses frames of the other hand alone; those that do not name sides may be of either.

    Args:
        frames: Of a recording.
        side: That is wanted.
        where: The recording, for the message.
        option: Of the command line, which chooses the side.

    Raises:
        InputError: The recording is of the other hand.
    """
    sides = {hand.side for frame in frames for hand in frame.hands}
    if sides and None not in sides and side not in sides:
        other = ", ".join(sorted(str(s) for s in sides))
        raise InputError(
            "this hand is not in the recording",
            where=where,
            got=side,
            expected=other,
            remedy=f"{option} {other}",
        )


def read_leap(path: Path) -> LeapRecording:
    """Reads a recording, whichever of the forms it has.

    Raises:
        RecordingError: There is no such file, it is of another program, cut short, or none of its
            frames can be used.
    """
    where = str(path)
    try:
        if path.stat().st_size > LARGEST:
            raise RecordingError("the file is too large", where=where, expected=f"{LARGEST} bytes")
        data = path.read_bytes()
    except OSError as error:
        raise RecordingError(f"the recording cannot be read: {error}", where=where) from error
    try:
        messages, metadata, damage = _messages(data, where)
    except RecordingError as error:
        if error.where is not None:
            raise
        raise RecordingError(
            error.what, where=where, got=error.got, expected=error.expected, remedy=_REMEDY
        ) from error
    decoder = LeapDecoder(path.name, _rate(metadata))
    frames = tuple(f for f in map(decoder.feed, messages) if f is not None)
    if not frames:
        why = ", ".join(f"{n} {what}" for what, n in decoder.counts.items() if n) or "it is empty"
        raise RecordingError(
            "there is no usable Leap frame in it",
            where=where,
            got=why,
            expected='objects with "hands" and "pointables"',
            remedy=_REMEDY,
        )
    return LeapRecording(frames, tuple(messages), decoder.dialect, decoder.counts, metadata, damage)


def _messages(
    data: bytes, where: str
) -> tuple[list[dict[str, Any]], dict[str, Any], RecordingError | None]:
    """JSON objects of the file, its metadata, and the damage that ended it early."""
    start = data.lstrip()[:1]
    if not start:
        raise RecordingError("the file is empty")
    if start not in (b"{", b"["):
        try:
            data = decompress_base64(data.decode("ascii")).encode()
        except (UnicodeDecodeError, RecordingError) as error:
            why = f": {error.what}" if isinstance(error, RecordingError) else ""
            raise RecordingError(f"this is neither JSON nor LZString's base64{why}") from None
    if _is_lines(data):
        messages, damage = _lines(data, where)
        return messages, {}, damage
    try:
        whole = msgspec.json.decode(data)
    except _UNREADABLE as error:
        raise RecordingError(f"the JSON is damaged or cut short: {error}") from error
    if isinstance(whole, list):
        return _objects(whole), {}, None
    if not isinstance(whole, dict):
        raise RecordingError("this is no Leap recording", got=str(whole)[:40])
    if "frames" not in whole:
        return [whole], {}, None
    frames = whole["frames"]
    metadata = whole.get("metadata")
    if not isinstance(frames, list):
        raise RecordingError("its frames are no list", got=str(frames)[:40])
    if frames and isinstance(frames[0], list):
        frames = _unpacked(frames[0], frames[1:])
    return _objects(frames), metadata if isinstance(metadata, dict) else {}, None


def _is_lines(data: bytes) -> bool:
    """Whether the first line is an object of its own, and not the beginning of a longer one."""
    first, _, rest = data.lstrip().partition(b"\n")
    if not rest.strip() or not first.startswith(b"{"):
        return False
    try:
        msgspec.json.decode(first)
    except _UNREADABLE:
        return False
    return True


def _lines(data: bytes, where: str) -> tuple[list[dict[str, Any]], RecordingError | None]:
    messages: list[dict[str, Any]] = []
    for number, line in enumerate(data.split(b"\n"), start=1):
        if not line.strip():
            continue
        try:
            message = msgspec.json.decode(line)
        except _UNREADABLE as error:
            return messages, RecordingError(
                f"the recording is damaged here: {error}",
                where=f"{where}, line {number}",
                got=line[:40].decode("latin-1"),
                remedy="What stands before this line was read",
            )
        messages += _objects([message])
    return messages, None


def _objects(items: Iterable[Any]) -> list[dict[str, Any]]:
    """The items as the decoder takes them: what is no object becomes one that it counts."""
    return [i if isinstance(i, dict) else {"damaged": str(i)[:40]} for i in items]


def _unpacked(keys: Sequence[Any], rows: Sequence[Any]) -> list[Any]:
    """Objects of a packed recording's rows; a row that does not fit the keys becomes None."""

    def fitted(row: Any) -> Any:
        try:
            return _named(keys, row)
        except (TypeError, ValueError):
            return None

    return [fitted(row) for row in rows]


def _named(keys: Sequence[Any], row: Any) -> dict[str, Any]:
    if not isinstance(row, list):
        raise TypeError("a packed row is a list")
    named: dict[str, Any] = {}
    for key, value in zip(keys, row, strict=True):
        if isinstance(key, str):
            named[key] = value
            continue
        if not isinstance(key, Mapping) or len(key) != 1:
            raise TypeError("a packed key is a text, or one name with its keys")
        name, inner = next(iter(key.items()))
        many = bool(inner) and isinstance(inner[0], list)
        named[name] = [_named(inner[0], v) for v in value] if many else _named(inner, value)
    return named


def _rate(metadata: Mapping[str, Any]) -> float:
    """Hz, of the metadata, which write it as text; 100 where there is none."""
    try:
        rate = float(metadata.get("frameRate", 100.0))
    except (TypeError, ValueError):
        return 100.0
    return rate if 1.0 <= rate <= 1000.0 else 100.0
