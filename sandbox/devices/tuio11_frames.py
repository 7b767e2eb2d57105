"""What one datagram says in TUIO 1.1, profile 2Dcur: messages become frames, and nothing is kept.

A sender counts the frames of a profile (`fseq`), lists in each the ids of all living touches
(`alive`), and gives the position of those that changed (`set`); `source` names the sender.
Positions are 0 to 1 over the sensor, origin top left, y down. Specification: TUIO 1.1 (tuio.org).
"""

from __future__ import annotations

import math
from collections.abc import Sequence, Sized
from dataclasses import dataclass, field
from typing import NamedTuple

from sandbox.devices.osc import MalformedPacket, Message, Packet

PROFILE = "/tuio/2Dcur"

MAX_IDS = 64
"""Living touches of one source. More than a room full of hands; bounds our memory."""

MAX_FRAMES = 16
"""Frames of one packet. Honest senders put one into each; bounds the work of a packet."""

LOWEST, HIGHEST = -0.1, 1.1
"""Where a position may lie, in widths of the surface: sensors see a little beyond their edge."""

_SINGLE_PRECISION = 1e-6
"""Positions travel as 32-bit floats, in which 1.1 is a little more than 1.1."""

MAX_NAME = 200
"""Characters of a source's name."""


@dataclass(slots=True)
class Frame:
    """What the messages up to one `fseq` say; positions in 0..1, None is "not said"."""

    source: str | None
    alive: tuple[int, ...] | None = None
    positions: dict[int, tuple[float, float]] = field(default_factory=dict)
    fseq: int | None = None

    def take(self, later: Frame) -> None:
        """Adds what a later part of the same frame says."""
        self.alive = self.alive if later.alive is None else later.alive
        for touch, position in later.positions.items():
            self.positions.pop(touch, None)
            self.positions[touch] = position
        self.fseq = later.fseq


class Reading(NamedTuple):
    """The frames of a datagram in their order, and what else it tells.

    Attributes:
        frames: An unclosed one has no `fseq`.
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
        MalformedPacket: A message of the profile breaks the protocol; nothing of the packet counts.
    """
    named = [_source_name(message) for message in packet.messages]
    name = next((n for n in named if n is not None), None)
    frames: list[Frame] = []
    unclosed: dict[str | None, Frame] = {}
    names: dict[str | None, None] = {}
    ignored: list[str] = []
    for message, new_name in zip(packet.messages, named, strict=True):
        if message.address.startswith("/tuio/"):
            name = name if new_name is None else new_name
            names.pop(name, None)
            names[name] = None  # in the order of their last word
        if message.address != PROFILE:
            ignored.append(ascii(message.address[:40]).strip("'"))
        elif new_name is None:
            frame = unclosed.setdefault(name, Frame(name))
            _read_command(message.arguments, frame)
            if frame.fseq is not None:
                frames.append(unclosed.pop(name))
    for name, rest in unclosed.items():
        closed = next((f for f in reversed(frames) if f.source == name), None)
        if closed is None:
            frames.append(rest)
        else:
            rest.fseq = closed.fseq
            closed.take(rest)
            _check_count(closed.positions)
    if len(frames) > MAX_FRAMES:
        raise MalformedPacket(
            "a packet has too many frames", got=len(frames), expected=f"{MAX_FRAMES} at most"
        )
    return Reading(frames, list(names), ignored)


def _source_name(message: Message) -> str | None:
    """The name in a `source` message of any profile: a sender has one name for all of them."""
    if not message.address.startswith("/tuio/") or message.arguments[:1] != ("source",):
        return None
    name = message.arguments[1] if len(message.arguments) > 1 else None
    if not isinstance(name, str) or len(name) > MAX_NAME or not name.isprintable():
        raise MalformedPacket(
            "the name of a source must be a short printable text", got=_short(name)
        )
    return name


def _read_command(arguments: Sequence[object], frame: Frame) -> None:
    """Adds one alive, set or fseq message to a frame."""
    command, values = (arguments[0], arguments[1:]) if arguments else (None, ())
    if command == "alive":
        frame.alive = tuple(dict.fromkeys(_int32(value, "alive") for value in values))
        _check_count(frame.alive)
    elif command == "set":
        # Some senders leave out speed and acceleration; we use neither and do not judge them.
        if len(values) < 3:
            raise MalformedPacket(
                "a set message is too short", got=f"{len(values)} values", expected="id x y"
            )
        touch = _int32(values[0], "set")
        frame.positions[touch] = (_coordinate(values[1], "x"), _coordinate(values[2], "y"))
        _check_count(frame.positions)
    elif command == "fseq":
        frame.fseq = _int32(values[0] if values else None, "fseq")
    else:
        raise MalformedPacket(
            "this is no command of TUIO 1.1",
            got=_short(command),
            expected="source, alive, set or fseq",
        )


def _check_count(touches: Sized) -> None:
    if len(touches) > MAX_IDS:
        raise MalformedPacket(
            "a frame has too many touches", got=len(touches), expected=f"{MAX_IDS} at most"
        )


def _int32(value: object, where: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not -(2**31) <= value < 2**31:
        raise MalformedPacket(
            "a whole number is missing", where=where, got=_short(value), expected="an int32"
        )
    return value


def _coordinate(value: object, axis: str) -> float:
    """A position on the surface, moved to 0..1 where it lies in the margin."""
    number = value if isinstance(value, (int, float)) and not isinstance(value, bool) else math.nan
    slack = _SINGLE_PRECISION
    if not LOWEST - slack <= number <= HIGHEST + slack:  # false for what is not a number, too
        raise MalformedPacket(
            "a position is not on the surface",
            where=f"set, {axis}",
            got=_short(value),
            expected=f"{LOWEST} to {HIGHEST}",
        )
    return min(max(float(number), 0.0), 1.0)


def _short(value: object) -> object:
    """The value as an error message may show it."""
    return value if value is None or isinstance(value, (int, float)) else str(value)[:60]
