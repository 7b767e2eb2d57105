"""Decoders of TUIO datagrams: they turn messages of version 1.1 and 2.0 into frames, without state.

Version 1.1, profiles 2Dcur and 2Dblb: a sender counts the frames of a profile (`fseq`), lists in
each the ids of all living touches (`alive`), and gives the position of those that changed (`set`);
`source` names the sender. Positions are 0 to 1 over the sensor, origin top left, y down. Cursors
(2Dcur) are the touches; blobs (2Dblb) give their sizes. Specification: TUIO 1.1 (tuio.org).

Version 2.0, pointers: `frm` opens a frame (its number, a time, the sensor's size, the source's
name), `ptr` gives the position of a pointer that has changed, `bnd` the size of the component with
the same id, `alv` lists all living ids and closes the frame. A large frame comes in several bundles
that all begin with the same `frm`; only the last has `alv`. Specification: TUIO 2.0 (tuio.org).
"""

from __future__ import annotations

import math
from collections.abc import Sequence, Sized
from dataclasses import dataclass, field
from typing import NamedTuple

from sandbox.devices.tuio.osc import MalformedPacket, Message, Packet

MAX_IDS = 64
"""Largest number of living touches of one source; bounds memory."""

MAX_FRAMES = 16
"""Largest number of frames in a packet; regular senders use one. Bounds the work per packet."""

LOWEST, HIGHEST = -0.1, 1.1
"""Range of valid positions, in widths of the surface: sensors see a little beyond their edge."""

SMALLEST = 1e-6
"""Smallest length of a touch, in widths of the surface. Smaller ones are no finger's, and become 0
in metres."""

_SINGLE_PRECISION = 1e-6
"""Tolerance of positions, which are 32-bit floats, where 1.1 is slightly larger."""

MAX_NAME = 200
"""Largest number of characters in a source's name."""


class TuioPlace(NamedTuple):
    """Position and size of a touch, in 0..1 of the surface's width and height.

    `label` is the finger, 0 (thumb) to 4; None if the sender does not know it.
    """

    x: float
    y: float
    width: float | None = None
    height: float | None = None
    label: int | None = None


@dataclass(slots=True)
class TuioFrame:
    """Values from the messages of one frame; None for a value that was not sent.

    Attributes:
        source: Name of the sender.
        profile: Address of the profile, such as `/tuio/2Dcur`.
        alive: Ids of all living touches.
        places: Positions of the touches that have changed, by id.
        number: Number of the frame.
        sizes: Widths and heights that were sent apart from the positions, by id.
    """

    source: str | None
    profile: str
    alive: tuple[int, ...] | None = None
    places: dict[int, TuioPlace] = field(default_factory=dict)
    number: int | None = None
    sizes: dict[int, tuple[float, float]] = field(default_factory=dict)

    def take(self, later: TuioFrame) -> None:
        """Adds the values of a later part of the same frame."""
        self.alive = self.alive if later.alive is None else later.alive
        for touch, place in later.places.items():
            self.places.pop(touch, None)
            self.places[touch] = place
        self.sizes |= later.sizes
        self.number = later.number

    def forget_the_first(self) -> None:
        """Removes the oldest touches beyond `MAX_IDS`, for senders that never close a frame."""
        for kept in (self.places, self.sizes):
            while len(kept) > MAX_IDS:
                del kept[next(iter(kept))]


def read_int32(value: object, where: str) -> int:
    """Checks a 32-bit integer.

    Raises:
        MalformedPacket: The value is not one.
    """
    if isinstance(value, bool) or not isinstance(value, int) or not -(2**31) <= value < 2**31:
        raise MalformedPacket(
            "a value must be an integer", where=where, got=short(value), expected="an int32"
        )
    return value


def read_coordinate(value: object, where: str) -> float:
    """Checks a coordinate on the surface, and clips it to 0..1 if it lies in the margin.

    Raises:
        MalformedPacket: The value is not a number, or lies beyond the margin.
    """
    number = value if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
    slack = _SINGLE_PRECISION
    if not LOWEST - slack <= number <= HIGHEST + slack:  # also true for NaN
        raise MalformedPacket(
            "a position is not on the surface",
            where=where,
            got=short(value),
            expected=f"{LOWEST} to {HIGHEST}",
        )
    return min(max(float(number), 0.0), 1.0)


def read_size(value: object) -> float | None:
    """A length in 0..1; None if the value is not a valid length, or too small for any finger."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if SMALLEST <= value <= 1.0 else None


def read_name(name: object) -> str:
    """Checks the name of a source.

    Raises:
        MalformedPacket: The value is not a short printable text.
    """
    if not isinstance(name, str) or len(name) > MAX_NAME or not name.isprintable():
        raise MalformedPacket(
            "the name of a source must be a short printable text", got=short(name)
        )
    return name


def check_count(touches: Sized) -> None:
    """Checks the number of touches in a frame.

    Raises:
        MalformedPacket: The frame has too many touches.
    """
    if len(touches) > MAX_IDS:
        raise MalformedPacket(
            "a frame has too many touches", got=len(touches), expected=f"{MAX_IDS} at most"
        )


def check_frames(frames: Sized) -> None:
    """Checks the number of frames in a packet.

    Raises:
        MalformedPacket: The packet has too many frames.
    """
    if len(frames) > MAX_FRAMES:
        raise MalformedPacket(
            "a packet has too many frames", got=len(frames), expected=f"{MAX_FRAMES} at most"
        )


def short(value: object) -> object:
    """The value as an error message may show it."""
    return value if value is None or isinstance(value, int | float) else str(value)[:60]


__all__ = ["BLOBS", "CURSORS", "MAX_FRAMES", "MAX_IDS", "Reading", "read_frames"]

CURSORS, BLOBS = "/tuio/2Dcur", "/tuio/2Dblb"


class Reading(NamedTuple):
    """The contents of a datagram.

    Attributes:
        frames: Frames in order; an unclosed one has no number.
        names: Names of the sources in the order of their last messages; None for a source without
            a name.
        ignored: Addresses of messages that are not used.
    """

    frames: list[TuioFrame]
    names: list[str | None]
    ignored: list[str]


def read_frames(packet: Packet) -> Reading:
    """Sorts a packet's messages into frames, without changing any state.

    Messages may come in any order: those after the last `fseq` of a packet belong to its frame, and
    the first `source` also names the messages before it.

    Raises:
        MalformedPacket: A message about cursors breaks the protocol; the whole packet is refused.
            An invalid blob is only skipped, as its touch is valid without a size.
    """
    named = [_source_name(message) for message in packet.messages]
    name = next((n for n in named if n is not None), None)
    frames: list[TuioFrame] = []
    unclosed: dict[tuple[str | None, str], TuioFrame] = {}
    names: dict[str | None, None] = {}
    ignored: list[str] = []
    for message, new_name in zip(packet.messages, named, strict=True):
        if message.address.startswith("/tuio/"):
            name = name if new_name is None else new_name
            names.pop(name, None)
            names[name] = None  # in the order of their last messages
        if new_name is not None:
            if message.address not in (CURSORS, BLOBS):
                ignored.append(_named(message))
            continue
        if message.address not in (CURSORS, BLOBS):
            ignored.append(_named(message))
            continue
        key = (name, message.address)
        frame = unclosed.setdefault(key, TuioFrame(*key))
        try:
            _read_command(message.arguments, frame)
        except MalformedPacket:
            if message.address == CURSORS:
                raise
            ignored.append(_named(message))
        if frame.number is not None:
            frames.append(unclosed.pop(key))
    for key, rest in unclosed.items():
        closed = next((f for f in reversed(frames) if (f.source, f.profile) == key), None)
        if closed is None:
            frames.append(rest)
        else:
            rest.number = closed.number
            closed.take(rest)
            check_count(closed.places)
    check_frames(frames)
    return Reading(frames, list(names), ignored)


def _source_name(message: Message) -> str | None:
    """The name in a `source` message of any profile, since all profiles share the sender's name."""
    if not message.address.startswith("/tuio/") or message.arguments[:1] != ("source",):
        return None
    return read_name(message.arguments[1] if len(message.arguments) > 1 else None)


def _named(message: Message) -> str:
    return ascii(message.address[:40]).strip("'")


def _read_command(arguments: Sequence[object], frame: TuioFrame) -> None:
    """Adds one alive, set or fseq message to a frame."""
    command, values = (arguments[0], arguments[1:]) if arguments else (None, ())
    if command == "alive":
        alive = tuple(dict.fromkeys(read_int32(value, "alive") for value in values))
        check_count(alive)
        frame.alive = alive
    elif command == "set":
        # Some senders leave out speed and acceleration; they are neither used nor checked.
        if len(values) < 3:
            raise MalformedPacket(
                "a set message is too short", got=f"{len(values)} values", expected="id x y"
            )
        touch = read_int32(values[0], "set")
        check_count({*frame.places, touch})
        frame.places[touch] = _place(values, frame.profile)
    elif command == "fseq":
        frame.number = read_int32(values[0] if values else None, "fseq")
    else:
        raise MalformedPacket(
            "unknown command of TUIO 1.1",
            got=short(command),
            expected="source, alive, set or fseq",
        )


def _place(values: Sequence[object], profile: str) -> TuioPlace:
    """The position in a `set` message: id x y ...; for a blob id x y angle width height area ..."""
    x, y = read_coordinate(values[1], "set, x"), read_coordinate(values[2], "set, y")
    if profile == CURSORS or len(values) < 6:
        return TuioPlace(x, y)
    return TuioPlace(x, y, read_size(values[4]), read_size(values[5]))


POINTERS = "/tuio2/ptr"
_FRAME, _BOUNDS, _ALIVE = "/tuio2/frm", "/tuio2/bnd", "/tuio2/alv"

MAX_ALIVE = 255
"""Largest number of ids in one `alv`, which lists tokens, symbols and bounds besides pointers."""

FINGER_TYPES = {1: 1, 2: 2, 3: 3, 4: 4, 5: 0, 6: 1, 7: 2, 8: 3, 9: 4, 10: 0}
"""Label of a finger by type of pointer: 1 to 5 are index, middle, ring, little finger and thumb of
a right hand, 6 to 10 those of a left one. 0 is unknown; from 11 on there are pens, mice and
hands."""


class Reading20(NamedTuple):
    """The contents of a datagram.

    Attributes:
        frames: Frames in order; one without a `number` continues the sender's last frame.
        ignored: Addresses of the messages that do not concern pointers.
    """

    frames: list[TuioFrame]
    ignored: list[str]


def read_frames20(packet: Packet) -> Reading20:
    """Sorts a packet's messages into frames, without changing any state.

    Messages before the first `frm` of a bundle belong to its frame.

    Raises:
        MalformedPacket: A message about pointers breaks the protocol; the whole packet is refused.
            Invalid bounds are only skipped.
    """
    frames: list[TuioFrame] = []
    ignored: list[str] = []
    current: TuioFrame | None = None
    for message in packet.messages:
        if not message.address.startswith("/tuio2/"):
            continue
        if message.address == _FRAME:
            number, source = _opening(message)
            if current is None or current.source is not None:
                current = TuioFrame(source, POINTERS)
                frames.append(current)
            current.number, current.source = number, source
            continue
        if message.address not in (POINTERS, _BOUNDS, _ALIVE):
            ignored.append(ascii(message.address[:40]).strip("'"))
            continue
        if current is None:
            current = TuioFrame(None, POINTERS)
            frames.append(current)
        _read(message, current)
    check_frames(frames)
    return Reading20(frames, ignored)


def label_of(type_and_user: int) -> int | None:
    """Label of the finger in a pointer's type (lower 16 bits) and user (upper 16 bits)."""
    return FINGER_TYPES.get(type_and_user & 0xFFFF)


def _opening(message: Message) -> tuple[int, str]:
    """Number and source of a `frm`; the sender's time is not used."""
    values = message.arguments
    if len(values) < 4:
        raise MalformedPacket(
            "a frm message is too short",
            got=f"{len(values)} values",
            expected="number time dimension source",
        )
    return read_int32(values[0], "frm") & 0xFFFFFFFF, read_name(values[3])


def _read(message: Message, frame: TuioFrame) -> None:
    """Adds one ptr, bnd or alv message to a frame."""
    values = message.arguments
    if message.address == _ALIVE:
        alive = tuple(dict.fromkeys(read_int32(value, "alv") for value in values))
        if len(alive) > MAX_ALIVE:
            raise MalformedPacket("too many living ids", expected=f"{MAX_ALIVE} ids at most")
        frame.alive = alive
    elif message.address == POINTERS:
        touch, place = _pointer(values)
        check_count({*frame.places, touch})
        frame.places[touch] = place
    else:
        size = _bounds(values)
        if size is not None and len({*frame.sizes, size[0]}) <= MAX_ALIVE:
            frame.sizes[size[0]] = size[1:]


def _pointer(values: Sequence[object]) -> tuple[int, TuioPlace]:
    """Id and position in a `ptr` message.

    Its values are session id, type and user, component id, x, y, angle, shear, radius, pressure ...
    """
    if len(values) < 5:
        raise MalformedPacket(
            "a ptr message is too short", got=f"{len(values)} values", expected="ids x y"
        )
    touch, kind = read_int32(values[0], "ptr"), read_int32(values[1], "ptr")
    x, y = read_coordinate(values[3], "ptr, x"), read_coordinate(values[4], "ptr, y")
    return touch, TuioPlace(x, y, label=label_of(kind))


def _bounds(values: Sequence[object]) -> tuple[int, float, float] | None:
    """Id, width and height in a `bnd` message; None if it is invalid.

    Its values are session id, x, y, angle, width, height, area ...
    """
    try:
        touch = read_int32(values[0] if values else None, "bnd")
    except MalformedPacket:
        return None
    width, height = (read_size(v) for v in values[4:6]) if len(values) >= 6 else (None, None)
    return None if width is None or height is None else (touch, width, height)
