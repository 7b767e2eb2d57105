"""Decoder of the pointers in a TUIO 2.0 datagram: turns messages into frames, without state.

`frm` opens a frame (its number, a time, the sensor's size, the source's name), `ptr` gives the
position of a pointer that has changed, `bnd` the size of the component with the same id, `alv`
lists all living ids and closes the frame. A large frame comes in several bundles that all begin
with the same `frm`; only the last has `alv`. Specification: TUIO 2.0 (tuio.org).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from sandbox.devices.tuio.osc import MalformedPacket, Message, Packet
from sandbox.devices.tuio.tuio_values import (
    TuioFrame,
    TuioPlace,
    check_count,
    check_frames,
    read_coordinate,
    read_int32,
    read_name,
    read_size,
)

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
