"""Packets for the tests of touch input: builders, a table of wrong ones, and a second decoder."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Sequence
from typing import Any

from pythonosc.osc_message_builder import OscMessageBuilder

CUR = "/tuio/2Dcur"
IMMEDIATELY = struct.pack(">Q", 1)


def message(address: str, *arguments: Any) -> bytes:
    """One OSC message; Python's types choose the type tags (int32 or int64, float, text, ...)."""
    builder = OscMessageBuilder(address)
    for argument in arguments:
        builder.add_arg(argument)
    return builder.build().dgram


def bundle(*elements: bytes) -> bytes:
    """A bundle of messages and bundles."""
    sized = [struct.pack(">i", len(element)) + element for element in elements]
    return b"#bundle\x00" + IMMEDIATELY + b"".join(sized)


def cur(*arguments: object) -> bytes:
    """One message of profile 2Dcur."""
    return message(CUR, *arguments)


def frame(
    fseq: int,
    touches: dict[int, tuple[float, float]],
    *,
    alive: Sequence[int] | None = None,
    source: str | None = None,
) -> bytes:
    """A complete frame as senders build it; `alive` differs from `touches` where fingers rest."""
    parts = [] if source is None else [cur("source", source)]
    parts.append(cur("alive", *(touches if alive is None else alive)))
    parts += [cur("set", i, float(x), float(y), 0.0, 0.0, 0.0) for i, (x, y) in touches.items()]
    return bundle(*parts, cur("fseq", fseq))


def nested(depth: int, core: bytes) -> bytes:
    """`core` within `depth` bundles."""
    for _ in range(depth):
        core = bundle(core)
    return core


def _with_set(*values: object) -> bytes:
    return bundle(cur("alive", 1), cur("set", *values), cur("fseq", 7))


_GOOD = frame(7, {1: (0.5, 0.5)}, source="table")


def _with_size(size: int, rest: bytes) -> bytes:
    """A bundle with an element of a stated size."""
    return b"#bundle\x00" + IMMEDIATELY + struct.pack(">i", size) + rest


NO_OSC: dict[str, bytes] = {
    "an element of size -4, on which a well-known reader hangs": _with_size(-4, bytes(28)),
    "an element of size 0": _with_size(0, b""),
    "an element of 6 bytes": _with_size(6, b"/a\x00\x00\x00\x00"),
    "an element larger than the packet": _with_size(64, cur("fseq", 7)),
    "an element of the largest size": _with_size(2**31 - 4, bytes(8)),
    "a byte too many": cur("fseq", 7) + b"\x00",
    "500 bundles in each other": nested(500, cur("fseq", 7)),
    "more elements than anybody sends": bundle(*[b"/a\x00\x00"] * 5000),
    "a bundle without time tag": b"#bundle\x00",
    "half a time tag": b"#bundle\x00" + b"\x00" * 4,
    "8 random bytes": bytes.fromhex("9b03d1f07e55aa01"),
    "an address without end": b"/tuio/2Dcur!",
    "an address without slash": b"tuio\x00\x00\x00\x00,i\x00\x00\x00\x00\x00\x01",
    "no type tags": b"/tuio/2Dcur\x00fseq",
    "type tags without end": b"/tuio/2Dcur\x00,sii",
    "a type nobody knows": cur("alive", 1).replace(b",si\x00", b",sQ\x00"),
    "a closing bracket too many": cur("alive", 1).replace(b",si\x00", b",s]\x00"),
    "an opening bracket too many": cur("alive", 1).replace(b",si\x00", b",s[\x00"),
    "a float cut off": cur("set", 1, 0.5, 0.5)[:-4],
    "an int cut off": cur("fseq", 7)[:-4],
    "a text without end": b"/tuio/2Dcur\x00,s\x00\x00fseq",
    "a blob of negative size": b"/tuio/2Dcur\x00,b\x00\x00" + struct.pack(">i", -8) + b"\x00" * 8,
    "a blob larger than the packet": b"/tuio/2Dcur\x00,b\x00\x00" + struct.pack(">i", 800),
    "more arguments than anybody sends": cur("alive", *range(2000)),
    "a bundle cut in the middle of an element": _GOOD[:-8],
    "a bundle cut in the middle of a size": _GOOD[:18],
    "nothing at all": b"",
}
"""Datagrams that are not OSC, by the fault in them; nothing in them can be read."""

NO_TUIO: dict[str, bytes] = {
    "a command that is not UTF-8": cur("alive", 1).replace(b"ali", b"a\xffi"),
    "a message without command": bundle(cur()),
    "a command nobody knows": bundle(cur("alife", 1), cur("fseq", 7)),
    "a number for a command": bundle(cur(3, 1)),
    "set with an id only": _with_set(1),
    "set without y": _with_set(1, 0.5),
    "a text for an id": _with_set("1", 0.5, 0.5),
    "a truth value for an id": _with_set(True, 0.5, 0.5),
    "an id beyond int32": _with_set(2**31, 0.5, 0.5),
    "a position that is not a number": _with_set(1, math.nan, 0.5),
    "an infinite position": _with_set(1, 0.5, math.inf),
    "a position far to the right": _with_set(1, 5.0, 0.5),
    "a position far above": _with_set(1, 0.5, -3.0),
    "a text for a position": _with_set(1, "0.5", 0.5),
    "a truth value for a position": _with_set(1, 0.5, True),
    "a text among the living": bundle(cur("alive", 1, "2"), cur("fseq", 7)),
    "fseq without number": bundle(cur("alive", 1), cur("fseq")),
    "65 living touches": bundle(cur("alive", *range(65)), cur("fseq", 7)),
    "65 touches set": bundle(*[cur("set", i, 0.5, 0.5) for i in range(65)], cur("fseq", 7)),
    "17 frames in one packet": bundle(*[cur("fseq", n) for n in range(1, 18)]),
}
"""Datagrams that are OSC but break TUIO 1.1, by what is wrong with a part of them."""

MALFORMED = NO_OSC | NO_TUIO


def reference_frames(packets: Sequence[bytes]) -> list[dict[int, tuple[float, float]]]:
    """The touches after every frame of ONE well-behaved sender, decoded in another way.

    No parser and no state: messages are found by their bytes, and where a touch is, is looked up
    backwards in the history of everything sent.
    """
    alive: list[tuple[int, ...]] = []
    moved: list[dict[int, tuple[float, float]]] = []
    for data in packets:
        if b"/tuio/2Dcur\x00,si\x00fseq" not in data:
            continue
        moved.append({})
        for found in re.finditer(rb"/tuio/2Dcur\x00,s([if]*)\x00+(alive|set)\x00", data):
            body = found.end() + -found.end() % 4
            values = struct.unpack_from(">" + found[1].decode(), data, body)
            if found[2] == b"alive":
                alive.append(values)
            else:
                moved[-1][values[0]] = values[1:3]
    return [
        {
            touch: next(moved[j][touch] for j in range(now, -1, -1) if touch in moved[j])
            for touch in living
        }
        for now, living in enumerate(alive)
    ]


def blb(*arguments: object) -> bytes:
    """One message of profile 2Dblb."""
    return message("/tuio/2Dblb", *arguments)


def blobs(fseq: int, ellipses: dict[int, tuple[float, float, float, float]]) -> bytes:
    """A frame of blobs: x, y, width and height by id."""
    sets = [
        blb("set", i, x, y, 0.0, w, h, w * h, 0.0, 0.0, 0.0, 0.0, 0.0)
        for i, (x, y, w, h) in ellipses.items()
    ]
    return bundle(blb("alive", *ellipses), *sets, blb("fseq", fseq))


def frm(number: int, source: str = "two") -> bytes:
    """The message that opens a frame of TUIO 2.0; its time is that of the epoch."""
    address = b"/tuio2/frm\x00\x00,itis\x00\x00\x00"
    name = source.encode() + b"\x00" * (4 - len(source.encode()) % 4)
    return address + struct.pack(">iQi", number, 0x83AA7E80 << 32, (1024 << 16) | 768) + name


def ptr(touch: int, x: float, y: float, kind: int = 0) -> bytes:
    """A pointer; `kind` is its type, and its user in the upper half."""
    return message("/tuio2/ptr", touch, kind, 0, float(x), float(y), 0.0, 0.0, 0.0, 0.0)


def alv(*ids: int) -> bytes:
    return message("/tuio2/alv", *ids)


def bnd(touch: int, width: float, height: float) -> bytes:
    return message("/tuio2/bnd", touch, 0.5, 0.5, 0.0, width, height, width * height)


def frame20(
    number: int,
    touches: dict[int, tuple[float, float]],
    *,
    alive: Sequence[int] | None = None,
    source: str = "two",
) -> bytes:
    """A complete frame of TUIO 2.0."""
    pointers = [ptr(i, x, y) for i, (x, y) in touches.items()]
    return bundle(frm(number, source), *pointers, alv(*(touches if alive is None else alive)))
