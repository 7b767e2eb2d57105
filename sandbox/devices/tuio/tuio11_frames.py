"""What one datagram says in TUIO 1.1, profiles 2Dcur and 2Dblb: messages become frames, no more.

A sender counts the frames of a profile (`fseq`), lists in each the ids of all living touches
(`alive`), and gives the position of those that changed (`set`); `source` names the sender.
Positions are 0 to 1 over the sensor, origin top left, y down. Cursors (2Dcur) are the touches;
blobs (2Dblb) tell how large they are. Specification: TUIO 1.1 (tuio.org).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from sandbox.devices.tuio.osc import MalformedPacket, Message, Packet
from sandbox.devices.tuio.tuio_values import (
    MAX_FRAMES,
    MAX_IDS,
    Frame,
    Place,
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
    """The frames of a datagram in their order, and what else it tells.

    Attributes:
        frames: An unclosed one has no number.
        names: The sources that spoke, in the order of their last word (None: no name was given).
        ignored: Addresses of the messages that are not for us.
    """

    frames: list[Frame]
    names: list[str | None]
    ignored: list[str]


def read_frames(packet: Packet) -> Reading:
    """Sorts a packet's messages into frames, without touching any state.

    Messages may come in any order: what follows the last `fseq` of a packet belongs to it, and the
    first `source` also names what stands before it.

    Raises:
        MalformedPacket: A message about cursors breaks the protocol; nothing of the packet counts.
            A blob that cannot be understood is passed over: a size is no reason to lose a touch.
    """
    named = [_source_name(message) for message in packet.messages]
    name = next((n for n in named if n is not None), None)
    frames: list[Frame] = []
    unclosed: dict[tuple[str | None, str], Frame] = {}
    names: dict[str | None, None] = {}
    ignored: list[str] = []
    for message, new_name in zip(packet.messages, named, strict=True):
        if message.address.startswith("/tuio/"):
            name = name if new_name is None else new_name
            names.pop(name, None)
            names[name] = None  # in the order of their last word
        if new_name is not None:
            if message.address not in (CURSORS, BLOBS):
                ignored.append(_named(message))
            continue
        if message.address not in (CURSORS, BLOBS):
            ignored.append(_named(message))
            continue
        key = (name, message.address)
        frame = unclosed.setdefault(key, Frame(*key))
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
    """The name in a `source` message of any profile: a sender has one name for all of them."""
    if not message.address.startswith("/tuio/") or message.arguments[:1] != ("source",):
        return None
    return read_name(message.arguments[1] if len(message.arguments) > 1 else None)


def _named(message: Message) -> str:
    return ascii(message.address[:40]).strip("'")


def _read_command(arguments: Sequence[object], frame: Frame) -> None:
    """Adds one alive, set or fseq message to a frame."""
    command, values = (arguments[0], arguments[1:]) if arguments else (None, ())
    if command == "alive":
        alive = tuple(dict.fromkeys(read_int32(value, "alive") for value in values))
        check_count(alive)
        frame.alive = alive
    elif command == "set":
        # Some senders leave out speed and acceleration; we use neither and do not judge them.
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
            "this is no command of TUIO 1.1",
            got=short(command),
            expected="source, alive, set or fseq",
        )


def _place(values: Sequence[object], profile: str) -> Place:
    """Of a cursor: id x y ...; of a blob: id x y angle width height area ..."""
    x, y = read_coordinate(values[1], "set, x"), read_coordinate(values[2], "set, y")
    if profile == CURSORS or len(values) < 6:
        return Place(x, y)
    return Place(x, y, read_size(values[4]), read_size(values[5]))
