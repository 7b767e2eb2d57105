"""Decoder of a TUIO 1.1 datagram, profiles 2Dcur and 2Dblb: turns messages into frames.

A sender counts the frames of a profile (`fseq`), lists in each the ids of all living touches
(`alive`), and gives the position of those that changed (`set`); `source` names the sender.
Positions are 0 to 1 over the sensor, origin top left, y down. Cursors (2Dcur) are the touches;
blobs (2Dblb) give their sizes. Specification: TUIO 1.1 (tuio.org).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from sandbox.devices.tuio.osc import MalformedPacket, Message, Packet
from sandbox.devices.tuio.tuio_values import (
    MAX_FRAMES,
    MAX_IDS,
    TuioFrame,
    TuioPlace,
    check_count,
    check_frames,
    read_coordinate,
    read_int32,
    read_name,
    read_size,
    short,
)

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
