"""Files of Leap recordings: plain JSON, LeapJS recordings (`.json.lz`, packed or not), JSON lines.

Files are recognised by their content, not by their names:

    [frame, frame, ...]                         dumps of the first Leap software
    {"metadata": {...}, "frames": [...]}        LeapJS; packed if frames[0] is a list of keys
    {"frames": 87, "data": [...]}               the list of frames may have any key
    LZString base64 of such a text              LeapJS, `.json.lz`
    one message per line                        messages of leapd; read up to the first damage

LZString is a dictionary coder after LZ78 on 16-bit characters. The first code has 2 bits; the later
codes have 3 bits and more. Codes and characters are stored with the least significant bit first.
Source: the format of the npm package lz-string, which wrote the recordings.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from encoders.paalm.identity import side_by_thumb
from models.errors import InputError, RecordingError
from models.frames import HandFrame
from models.json_input import any_json
from models.plausible import Units, parse_units
from models.reader_report import ReaderReport
from sandbox.devices.leap.leap_json import LEAP_UNITS, LeapDecoder, canonical, find_leap_units

MOST_CHARACTERS = 1 << 28
"""Largest length of a decoded text. Without a bound, a small file could fill the memory."""

_ALPHABET = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
_BITS = {ord(c): f"{i:06b}" for i, c in enumerate(_ALPHABET)} | {ord("="): "000000"}
_BYTE, _WORD, _END = 0, 1, 2
"""Codes for a new 8-bit character, a new 16-bit character, and the end."""


def is_json_in_base64(start: bytes) -> bool:
    """True if a text begins like LZString's base64 of a JSON object or list.

    Such a text begins with the code of a new character (2 bits) and the character (8 bits, least
    significant first): `{` becomes N4 to N7, `[` becomes No to Nr.
    """
    known = set(_ALPHABET.encode()) | set(b"=\r\n")
    return (
        start[:1] == b"N" and start[1:2] in b"4567opqr" and len(start) > 1 and set(start) <= known
    )


def decompress_base64(text: str, limit: int = MOST_CHARACTERS) -> str:
    """Decodes a text that LZString's compressToBase64 made.

    Raises:
        RecordingError: The text is not LZString's base64, is cut short, or is larger than `limit`.
    """
    text = "".join(text.split())
    if not text or not text.isascii() or any(ord(c) not in _BITS for c in set(text)):
        raise RecordingError("the text is not LZString's base64")
    bits = text.translate(_BITS)
    known: list[str] = ["", "", ""]
    position, width, size = 0, 2, 0
    last = ""
    parts: list[str] = []
    while True:
        code, position = _take(bits, position, width)
        if code == _END:
            return "".join(parts)
        fresh = code in (_BYTE, _WORD)
        if fresh:
            character, position = _take(bits, position, 8 if code == _BYTE else 16)
            known.append(chr(character))
            code = len(known) - 1
            width = _width(known, bool(last))
        if code < len(known):
            entry = known[code]
        elif code == len(known) and last:
            entry = last + last[0]
        else:
            raise RecordingError("the LZString text is damaged", got=f"code {code}")
        parts.append(entry)
        size += len(entry)
        if size > limit:
            raise RecordingError("the LZString text is too large", expected=f"up to {limit}")
        if last:
            known.append(last + entry[0])
        last = entry
        width = _width(known, True)


def _width(known: list[str], started: bool) -> int:
    """Number of bits of the next code: enough for all texts so far and one more."""
    return len(known).bit_length() if started else 2


def _take(bits: str, position: int, width: int) -> tuple[int, int]:
    end = position + width
    if end > len(bits):
        raise RecordingError("the LZString text is cut short")
    return int(bits[position:end][::-1], 2), end


LARGEST = 1 << 28
"""Size of the largest file that is read, bytes; an hour of two hands takes about half of it."""

_LOOKED_AT = 1 << 16
"""Number of bytes at the beginning of a file by which it is recognised."""

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
"""Bytes that some editors put before a text."""

_UNREADABLE = (msgspec.DecodeError, UnicodeDecodeError, RecursionError)
"""Errors that damaged JSON raises. A field name that is not UTF-8 raises UnicodeDecodeError."""

_FRAME = ("hands", "pointables")
"""A message with one of these keys is a frame."""

_MARKS = (b'"pointables"', b'"palmPosition"')
"""Keys that only Leap JSON has."""

_REMEDY = "`sandbox devices leap formats` lists what can be played"


@dataclass(frozen=True)
class LeapRecording:
    """The frames of a recording.

    Attributes:
        frames: Frames in order of time.
        messages: The JSON objects, unpacked, as `sandbox devices leap fake` sends them.
        dialect: `v1`, `v2`, `v3` or `bridge`; None if no frame has a finger.
        used: Index of each frame's message.
        units: Units of the messages.
        counts: Numbers of frames, fingers and hands that were used or skipped, by reason.
        report: Report on left-out data and assumptions.
        metadata: Metadata of the file; empty if it has none.
        damage: Error that ended a file of JSON lines early; None if it is undamaged.
    """

    frames: tuple[HandFrame, ...]
    messages: tuple[dict[str, Any], ...]
    dialect: str | None
    used: tuple[int, ...] = ()
    units: Units = field(default_factory=lambda: LEAP_UNITS)
    counts: Counter[str] = field(default_factory=Counter)
    report: ReaderReport = field(default_factory=ReaderReport)
    metadata: dict[str, Any] = field(default_factory=dict)
    damage: RecordingError | None = None

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return self.frames[-1].time - self.frames[0].time


def check_side(frames: Sequence[HandFrame], side: str, where: str, option: str) -> None:
    """Checks that a recording can contain a hand of the required side.

    A hand whose side is not recorded can be of either side.

    Args:
        frames: Frames of a recording.
        side: The required side.
        where: The recording, for the error message.
        option: Command-line option that chooses the side.

    Raises:
        InputError: The recording shows only the other hand.
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


def doubt_of_side(frames: Sequence[HandFrame], side: str, option: str) -> str:
    """Returns a warning if the thumb of a recorded hand shows that it is of the other side.

    The first Leap software does not report sides.

    Args:
        frames: Frames of a recording.
        side: Assumed side of the hand.
        option: Command-line option that chooses the side.

    Returns:
        One line; empty if thumbs agree with the side or do not show it.
    """
    shown = side_by_thumb(frames)
    if shown in ("", side):
        return ""
    return f"the thumb shows that the recorded hand is a {shown} hand: use {option} {shown}"


def is_leap_recording(path: Path) -> bool:
    """True if the first bytes of a file are those of a Leap recording, which may be damaged.

    The file's name is ignored. A recording of this program is not a Leap recording, although its
    lines may also have a key `hands`.
    """
    try:
        with path.open("rb") as file:
            start = file.read(_LOOKED_AT).removeprefix(_BYTE_ORDER_MARK).lstrip()
    except OSError:
        return False
    if start[:1] not in (b"{", b"["):
        return is_json_in_base64(start)
    for line in start.split(b"\n"):
        try:
            message = msgspec.json.decode(line)
        except _UNREADABLE:
            break
        if _is_frame(message):
            return "kind" not in message
        # A handshake or an event comes before the frames.
        if not isinstance(message, dict) or not {"version", "event"} & set(message):
            break
    return any(mark in start for mark in _MARKS)


def read_leap(path: Path, unit: str = "") -> LeapRecording:
    """Reads a recording in any of the forms of this module.

    Args:
        path: The file.
        unit: Units that a person gave, such as `cm,ms`. Missing ones are found from the hand's size
            and the frames' rate.

    Raises:
        RecordingError: The file does not exist, is not a Leap recording, or is cut short; or it has
            no usable frame, no finger, or sizes that are impossible for a hand.
    """
    where, report = str(path), ReaderReport()
    try:
        if path.stat().st_size > LARGEST:
            raise RecordingError("the file is too large", where=where, expected=f"{LARGEST} bytes")
        data = path.read_bytes().removeprefix(_BYTE_ORDER_MARK)
    except OSError as error:
        raise RecordingError(f"the recording cannot be read: {error}", where=where) from error
    try:
        messages, metadata, damage = _messages(data, where, report)
    except RecordingError as error:
        if error.where is not None:
            raise
        raise RecordingError(
            error.what, where=where, got=error.got, expected=error.expected, remedy=_REMEDY
        ) from error
    units, stride = find_leap_units(messages, parse_units(unit), where, report)
    decoder = LeapDecoder(path.name, rate_in(metadata), units, stride)
    used, frames = [], []
    for index, message in enumerate(messages):
        frame = decoder.feed(message)
        if frame is not None:
            used.append(index)
            frames.append(frame)
    report.add(decoder.report)
    if not frames:
        raise no_frame(where, report)
    if any(f.hands for f in frames) and not any(h.fingers for f in frames for h in f.hands):
        raise no_finger(where, report)
    return LeapRecording(
        tuple(frames),
        tuple(messages),
        decoder.dialect,
        tuple(used),
        units,
        decoder.counts,
        report,
        metadata,
        damage,
    )


def no_frame(where: str, report: ReaderReport) -> RecordingError:
    """Returns the error for a recording without a usable frame."""
    return RecordingError(
        "the file contains no usable Leap frames",
        where=where,
        got=report.main_reason or "it is empty",
        expected='objects with "hands" and "pointables"',
        remedy=_REMEDY,
    )


def no_finger(where: str, report: ReaderReport) -> RecordingError:
    """Returns the error for a recording whose hands have no fingers."""
    return RecordingError(
        "no finger in any frame",
        where=where,
        got=report.main_reason or "hands without fingers",
        expected="fingers, in `pointables` or inside each hand, each with a length or with joints",
        remedy=_REMEDY,
    )


def _messages(
    data: bytes, where: str, report: ReaderReport
) -> tuple[list[dict[str, Any]], dict[str, Any], RecordingError | None]:
    """Returns the JSON objects of a file, its metadata, and the damage that ended it early."""
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
        whole = any_json(data)
    except _UNREADABLE as error:
        raise RecordingError(f"the JSON is damaged or cut short: {error}") from error
    if isinstance(whole, list):
        return _objects(whole), {}, None
    if not isinstance(whole, dict):
        raise RecordingError(
            "this is not a Leap recording",
            got=str(whole)[:40],
            expected="a JSON object or list of frames",
        )
    if _is_frame(whole):
        return [whole], {}, None
    frames = _list_of_frames(whole)
    stated = whole.get("frames", whole.get("frameCount"))
    if isinstance(stated, int) and stated != len(frames):
        report.assume(f"the file states {stated} frames and has {len(frames)}; all were read")
    metadata = whole.get("metadata")
    if frames and isinstance(frames[0], list):
        frames = _unpacked(frames[0], frames[1:])
    return _objects(frames), metadata if isinstance(metadata, dict) else {}, None


def _list_of_frames(whole: Mapping[str, Any]) -> list[Any]:
    """Returns the frames of a file: its list `frames`, or else its only list with Leap frames."""
    if isinstance(whole.get("frames"), list):
        return list(whole["frames"])
    framed = [v for v in whole.values() if isinstance(v, list) and any(map(_is_frame, v))]
    inside = [v for v in whole.values() if isinstance(v, dict)]
    if not framed and len(inside) == 1:
        return _list_of_frames(inside[0])
    if len(framed) != 1:
        raise RecordingError(
            "the file has no list of Leap frames" if not framed else "two lists hold Leap frames",
            got=", ".join(map(str, list(whole)[:6]))[:80] or "an empty object",
            expected='objects with "hands" and "pointables" in one list',
        )
    return list(framed[0])


def _is_frame(message: Any) -> bool:
    return isinstance(message, dict) and any(name in canonical(message) for name in _FRAME)


def _is_lines(data: bytes) -> bool:
    """True if the first line is a complete JSON object and further lines follow."""
    first, _, rest = data.lstrip().partition(b"\n")
    if not rest.strip() or not first.startswith(b"{"):
        return False
    try:
        any_json(first)
    except _UNREADABLE:
        return False
    return True


def _lines(data: bytes, where: str) -> tuple[list[dict[str, Any]], RecordingError | None]:
    messages: list[dict[str, Any]] = []
    for number, line in enumerate(data.split(b"\n"), start=1):
        if not line.strip():
            continue
        try:
            message = any_json(line)
        except _UNREADABLE as error:
            return messages, RecordingError(
                f"the recording is damaged here: {error}",
                where=f"{where}, line {number}",
                got=line[:40].decode("latin-1"),
                remedy="The lines before this one were read",
            )
        messages += _objects([message])
    return messages, None


def _objects(items: Iterable[Any]) -> list[dict[str, Any]]:
    """Returns the items as JSON objects.

    An item that is not a JSON object is wrapped in one, so that the decoder counts it.
    """
    return [i if isinstance(i, dict) else {"damaged": str(i)[:40]} for i in items]


def _unpacked(keys: Sequence[Any], rows: Sequence[Any]) -> list[Any]:
    """Returns the rows of a packed recording as objects; a row that does not fit becomes None."""

    def fitted(row: Any) -> Any:
        try:
            return _named(keys, row)
        except (TypeError, ValueError):
            return None

    return [fitted(row) for row in rows]


def _named(keys: Sequence[Any], row: Any) -> dict[str, Any]:
    if not isinstance(row, list):
        raise TypeError("a packed row must be a list")
    named: dict[str, Any] = {}
    for key, value in zip(keys, row, strict=True):
        if isinstance(key, str):
            named[key] = value
            continue
        if not isinstance(key, Mapping) or len(key) != 1:
            raise TypeError("a packed key must be a text, or one name with its keys")
        name, inner = next(iter(key.items()))
        many = bool(inner) and isinstance(inner[0], list)
        named[name] = [_named(inner[0], v) for v in value] if many else _named(inner, value)
    return named


def rate_in(metadata: Mapping[str, Any]) -> float | None:
    """Returns the frame rate (Hz) in the metadata, number or text; None if missing or invalid."""
    try:
        rate = float(metadata["frameRate"])
    except (KeyError, TypeError, ValueError):
        return None
    return rate if 1.0 <= rate <= 1000.0 else None
