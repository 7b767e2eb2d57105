"""Decoders of TUIO datagrams: they turn messages of version 1.1 and 2.0 into frames, without state.

Version 1.1, profiles 2Dcur and 2Dblb. Each frame of a profile has: `alive`, the ids of all current
touches; a `set` for each touch that has changed, with its position; and `fseq`, the number of the
frame. `source` names the sender. Positions are 0 to 1 over the sensor, origin top left, y down.
Cursors (2Dcur) are the touches; blobs (2Dblb) give their sizes. Specification: TUIO 1.1 (tuio.org).

Version 2.0, pointers. `frm` opens a frame (its number, a time, the sensor's size, the source's
name). `ptr` gives the position of a pointer that has changed, `bnd` the size of the component with
the same id. `alv` lists all current ids and closes the frame. A large frame comes in several
bundles that all begin with the same `frm`; only the last has `alv`. Specification: TUIO 2.0
(tuio.org).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple, TypeVar, cast

from models.plausible import IMPOSSIBLE_SIZE, on_surface
from models.reader_report import ReaderReport
from sandbox.devices.tuio.osc import MalformedPacket, Message, Packet

MAX_IDS = 64
"""Largest number of current touches of one source, to bound the memory."""

MAX_FRAMES = 16
"""Largest number of frames in a packet, to bound the work; regular senders use one frame."""

SMALLEST = 1e-6
"""Smallest width or height of a touch, as a share of the surface; smaller ones could become 0 in
metres."""

MAX_NAME = 200
"""Largest number of characters in a source's name."""

TOO_MANY = "touches beyond 64 of a sender"

T = TypeVar("T")
Size = tuple[float, float] | tuple[None, None]


class TuioPlace(NamedTuple):
    """Position and size of a touch, in 0..1 of the surface's width and height.

    `label` is the finger, 0 (thumb) to 4; None if the sender does not report it.
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
        alive: Ids of all current touches.
        places: Positions of the touches that have changed, by id.
        number: Number of the frame.
        sizes: Widths and heights that were sent in messages of their own, by id.
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


def read_int32(value: object) -> int:
    """Reads a 32-bit integer; a float without a fraction is accepted.

    Raises:
        MalformedPacket: The value is not an integer.
    """
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not -(2**31) <= value < 2**31:
        raise MalformedPacket("ids and counters that are not int32")
    return value


def read_ids(values: Iterable[object], most: int, report: ReaderReport) -> tuple[int, ...]:
    """Returns the ids of the current touches, each once; invalid and surplus ids are left out."""
    ids: dict[int, None] = {}
    for value in values:
        try:
            ids[read_int32(value)] = None
        except MalformedPacket as error:
            report.leave_out(error.what)
    report.leave_out(TOO_MANY, len(ids) - most if len(ids) > most else 0)
    return tuple(islice(ids, most))


def read_position(x: object, y: object) -> tuple[float, float]:
    """Returns a position on the surface; a position in the margin is moved onto the edge.

    Raises:
        MalformedPacket: x or y is not a number, or the position is beyond the margin.
    """
    places = [
        on_surface(value)
        if isinstance(value, int | float) and not isinstance(value, bool)
        else None
        for value in (x, y)
    ]
    if places[0] is None or places[1] is None:
        raise MalformedPacket("positions beyond the surface")
    return float(places[0]), float(places[1])


def read_size(width: object, height: object, report: ReaderReport) -> Size:
    """Returns width and height in 0..1; (None, None) if the sender does not measure both (0).

    Lengths that are not shares of the surface, such as pixels, are left out.
    """
    if not width or not height:
        return None, None
    size = [
        float(value) if isinstance(value, int | float) and SMALLEST <= value <= 1.0 else None
        for value in (width, height)
    ]
    if None in size:
        report.leave_out(IMPOSSIBLE_SIZE)
        return None, None
    return cast(Size, tuple(size))


def printable_name(name: object) -> str:
    """Returns the name of a source as printable text."""
    text = str(name)[:MAX_NAME]
    return "".join(c if c.isprintable() else "\ufffd" for c in text)


def _put(touches: dict[int, T], touch: int, value: T, most: int = MAX_IDS) -> None:
    """Stores a value of a touch.

    Raises:
        MalformedPacket: The frame has too many touches.
    """
    if touch not in touches and len(touches) >= most:
        raise MalformedPacket(TOO_MANY)
    touches[touch] = value


def _limited(frames: list[TuioFrame], report: ReaderReport) -> list[TuioFrame]:
    """Returns the last `MAX_FRAMES` frames of a packet."""
    report.leave_out("frames beyond 16 in a packet", max(len(frames) - MAX_FRAMES, 0))
    return frames[-MAX_FRAMES:]


CURSORS, BLOBS = "/tuio/2Dcur", "/tuio/2Dblb"


class Reading(NamedTuple):
    """The contents of a datagram.

    Attributes:
        frames: Frames in order; an unclosed frame has no number.
        names: Names of the sources in the order of their last messages; None for a source without
            a name.
        ignored: Addresses of messages that are not used.
    """

    frames: list[TuioFrame]
    names: list[str | None]
    ignored: list[str]


def read_frames(packet: Packet, report: ReaderReport) -> Reading:
    """Sorts a packet's messages into frames, without changing any state.

    Messages may come in any order. Messages after the last `fseq` of a packet belong to its frame,
    and the first `source` also names the messages before it.

    Args:
        packet: The packet.
        report: Each left-out message is added to it.
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
            names[name] = None  # keeps the names in the order of their last messages
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
            _read_command(message.arguments, frame, report)
        except MalformedPacket as error:
            report.leave_out(error.what)
        if frame.number is not None:
            frames.append(unclosed.pop(key))
    for key, rest in unclosed.items():
        closed = next((f for f in reversed(frames) if (f.source, f.profile) == key), None)
        if closed is None:
            frames.append(rest)
        else:
            rest.number = closed.number
            closed.take(rest)
            closed.forget_the_first()
    return Reading(_limited(frames, report), list(names), ignored)


def _source_name(message: Message) -> str | None:
    """Returns the sender's name in a `source` message of any profile; None for other messages."""
    if not message.address.startswith("/tuio/") or message.arguments[:1] != ("source",):
        return None
    return printable_name("".join(map(str, message.arguments[1:2])))


def _named(message: Message) -> str:
    return ascii(message.address[:40]).strip("'")


def _read_command(arguments: Sequence[object], frame: TuioFrame, report: ReaderReport) -> None:
    """Adds one alive, set or fseq message to a frame.

    Raises:
        MalformedPacket: The message is invalid; the caller leaves out this message only.
    """
    command, values = (arguments[0], arguments[1:]) if arguments else (None, ())
    if command == "alive":
        frame.alive = read_ids(values, MAX_IDS, report)
    elif command == "set":
        # Speed and acceleration are neither used nor checked; some senders leave them out.
        if len(values) < 3:
            raise MalformedPacket("set messages without id, x and y")
        place = _place(values, frame.profile, report)
        _put(frame.places, read_int32(values[0]), place)
    elif command == "fseq":
        frame.number = _number(values, -1, report)
    else:
        raise MalformedPacket("unknown commands of TUIO 1.1")


def _number(values: Sequence[object], uncounted: int, report: ReaderReport) -> int:
    """Returns the number of a frame; `uncounted` if it cannot be read."""
    try:
        return read_int32(values[0] if values else None)
    except MalformedPacket as error:
        report.leave_out(error.what)
        return uncounted


def _place(values: Sequence[object], profile: str, report: ReaderReport) -> TuioPlace:
    """Returns the position in a `set` message: id x y ...; blob: id x y angle width height ..."""
    position = read_position(values[1], values[2])
    if profile == CURSORS or len(values) < 6:
        return TuioPlace(*position)
    return TuioPlace(*position, *read_size(values[4], values[5], report))


POINTERS = "/tuio2/ptr"
_FRAME, _BOUNDS, _ALIVE = "/tuio2/frm", "/tuio2/bnd", "/tuio2/alv"

MAX_ALIVE = 255
"""Largest number of ids in one `alv`, which lists tokens, symbols and bounds besides pointers."""

FINGER_TYPES = {1: 1, 2: 2, 3: 3, 4: 4, 5: 0, 6: 1, 7: 2, 8: 3, 9: 4, 10: 0}
"""Label of a finger by type of pointer. 1 to 5 are index, middle, ring, little finger and thumb of
a right hand, 6 to 10 those of a left hand. 0 is unknown; 11 and more are pens, mice and hands."""


class Reading20(NamedTuple):
    """The contents of a datagram.

    Attributes:
        frames: Frames in order; a frame without `number` continues the sender's last frame.
        ignored: Addresses of the messages that do not concern pointers.
    """

    frames: list[TuioFrame]
    ignored: list[str]


def read_frames20(packet: Packet, report: ReaderReport) -> Reading20:
    """Sorts a packet's messages into frames, without changing any state.

    Messages before the first `frm` of a bundle belong to its frame.

    Args:
        packet: The packet.
        report: Each left-out message is added to it.
    """
    frames: list[TuioFrame] = []
    ignored: list[str] = []
    current: TuioFrame | None = None
    for message in packet.messages:
        if not message.address.startswith("/tuio2/"):
            continue
        if message.address == _FRAME:
            number, source = _opening(message.arguments, report)
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
        try:
            _read(message, current, report)
        except MalformedPacket as error:
            report.leave_out(error.what)
    return Reading20(_limited(frames, report), ignored)


def label_of(type_and_user: int) -> int | None:
    """Returns the finger's label, from a pointer's type (lower 16 bits) and user (upper 16 bits).

    Returns None if the type is not a finger.
    """
    return FINGER_TYPES.get(type_and_user & 0xFFFF)


def _opening(values: Sequence[object], report: ReaderReport) -> tuple[int, str]:
    """Returns number and source of a `frm`; the sender's time and sensor size are not used."""
    return _number(values, 0, report) & 0xFFFFFFFF, printable_name("".join(map(str, values[3:4])))


def _read(message: Message, frame: TuioFrame, report: ReaderReport) -> None:
    """Adds one ptr, bnd or alv message to a frame.

    Raises:
        MalformedPacket: The message is invalid; the caller leaves out this message only.
    """
    values = message.arguments
    if message.address == _ALIVE:
        frame.alive = read_ids(values, MAX_ALIVE, report)
    elif message.address == POINTERS:
        # Session id, type and user, component id, x, y, angle, shear, radius, pressure ...
        if len(values) < 5:
            raise MalformedPacket("ptr messages without ids, x and y")
        kind = values[1]
        label = label_of(kind) if isinstance(kind, int) else None
        place = TuioPlace(*read_position(values[3], values[4]), label=label)
        _put(frame.places, read_int32(values[0]), place)
    else:
        # Session id, x, y, angle, width, height, area ...
        if len(values) < 6:
            raise MalformedPacket("bnd messages without id, width and height")
        width, height = read_size(values[4], values[5], report)
        if width is not None and height is not None:
            _put(frame.sizes, read_int32(values[0]), (width, height), MAX_ALIVE)
