"""Decoder of OSC packets; it reads every readable message and raises one kind of error.

The program has its own decoder because of hostile packets. Ready-made readers do not return from a
bundle with an element of negative size, and raise errors of the interpreter for nested bundles and
for text that is not UTF-8. This decoder is a loop with an explicit stack. Every step consumes
bytes, so the work is bounded by the size of the packet. A message that cannot be read is left out;
the other messages of the packet are read. Text need not be UTF-8.
"""

from __future__ import annotations

from struct import Struct
from typing import NamedTuple

from models.errors import DeviceError
from models.motion.text import decoded
from models.reader_report import ReaderReport

MAX_PACKET_BYTES = 65_507
"""Largest payload of a UDP datagram over IPv4, bytes (65,535 less the IP and UDP headers)."""

MAX_DEPTH = 8
"""Largest number of nested bundles; touch senders use one level."""

MAX_ELEMENTS = 1024
"""Largest number of elements in a packet; 64 touches in each of three profiles take about 200."""

MAX_ARGUMENTS = 256
"""Largest number of arguments in a message; a list of 64 current touches takes 65."""

_BUNDLE = b"#bundle\x00"
_BUNDLE_HEADER = len(_BUNDLE) + 8
"""Bytes before a bundle's first element: its name and a time tag of 8 bytes."""

_NUMBERS = {
    ord(tag): Struct(form)
    for tag, form in {"i": ">i", "f": ">f", "h": ">q", "d": ">d", "t": ">Q"}.items()
}
_FOUR_BYTES = frozenset(b"crm")
_CONSTANTS = {ord("T"): True, ord("F"): False, ord("N"): None, ord("I"): None}
_TEXTS, _BLOB = frozenset(b"sS"), ord("b")
"""Type tags of arguments, OSC 1.0 and its usual extensions."""


class MalformedPacket(DeviceError):  # noqa: N818  (names the packet)
    """A packet from the network, or a part of it, cannot be decoded."""


class Message(NamedTuple):
    """One OSC message; values of arrays are arguments like all others."""

    address: str
    arguments: tuple[object, ...]


class Packet(NamedTuple):
    """The messages of one datagram in order; nested bundles are flattened.

    `bundled` is False if the datagram is a single message without a bundle.
    """

    messages: tuple[Message, ...]
    bundled: bool


def decode(data: bytes, report: ReaderReport) -> Packet:
    """Reads one datagram.

    Args:
        data: The datagram.
        report: Messages that cannot be read are added to it as left out.

    Raises:
        MalformedPacket: The packet cannot be split into messages. No other exception is raised.
    """
    if len(data) > MAX_PACKET_BYTES:
        raise MalformedPacket(
            "the packet is too large", got=len(data), expected=f"{MAX_PACKET_BYTES} bytes at most"
        )
    if not data or len(data) % 4:
        raise MalformedPacket(
            "an OSC packet must be a whole number of 4-byte words", got=f"{len(data)} bytes"
        )
    bundled = data.startswith(_BUNDLE)
    messages = []
    for part in _bundle_messages(data) if bundled else [data]:
        try:
            messages.append(_message(part, report))
        except MalformedPacket as error:
            report.leave_out(f"messages: {error.what}")
    return Packet(tuple(messages), bundled)


def _bundle_messages(data: bytes) -> list[bytes]:
    """Returns the bytes of every message in a bundle, in order."""
    if len(data) < _BUNDLE_HEADER:
        raise MalformedPacket("a bundle ends before its time tag", got=f"{len(data)} bytes")
    messages: list[bytes] = []
    elements = 0
    # One entry per open bundle: start of its next element, and its end.
    open_bundles = [(_BUNDLE_HEADER, len(data))]
    while open_bundles:
        begin, end = open_bundles.pop()
        if begin == end:
            continue
        size = int.from_bytes(data[begin : begin + 4], "big", signed=True)
        begin += 4
        if size <= 0 or size % 4 or begin + size > end:
            raise MalformedPacket(
                "a bundle's element has an impossible size",
                where=f"byte {begin - 4}",
                got=size,
                expected=f"4 to {max(end - begin, 0)} bytes in words of 4",
            )
        elements += 1
        if elements > MAX_ELEMENTS:
            raise MalformedPacket(
                "a packet has too many elements", expected=f"{MAX_ELEMENTS} at most"
            )
        open_bundles.append((begin + size, end))
        if data.startswith(_BUNDLE, begin, begin + size):
            if len(open_bundles) >= MAX_DEPTH or size < _BUNDLE_HEADER:
                raise MalformedPacket(
                    "a bundle within a bundle is too deep or too short",
                    where=f"byte {begin}",
                    expected=f"{MAX_DEPTH} levels at most",
                )
            open_bundles.append((begin + _BUNDLE_HEADER, begin + size))
        else:
            messages.append(data[begin : begin + size])
    return messages


def _message(data: bytes, report: ReaderReport) -> Message:
    """Reads one message.

    Raises:
        MalformedPacket: The message is cut short, or has an argument of unknown type.
    """
    if not data.startswith(b"/"):
        raise MalformedPacket("an OSC address must begin with a slash", got=data[:16])
    address, index = _text(data, 0, report)
    if index == len(data):
        return Message(address, ())  # an address without arguments is valid
    if data[index] != ord(","):
        raise MalformedPacket("a message has no type tags", got=data[index : index + 16])
    begin, (_, index) = index + 1, _text(data, index, report)
    tags = data[begin : data.index(0, begin)]
    if len(tags) > MAX_ARGUMENTS:
        raise MalformedPacket(
            "a message has too many arguments", got=len(tags), expected=f"{MAX_ARGUMENTS} at most"
        )
    values: list[object] = []
    depth = 0
    for tag in tags:
        if tag in _NUMBERS:
            number = _NUMBERS[tag]
            end = index + number.size
            values += number.unpack_from(data, index) if end <= len(data) else ()
        elif tag in _TEXTS:
            text, end = _text(data, index, report)
            values.append(text)
        elif tag in _CONSTANTS:
            values.append(_CONSTANTS[tag])
            end = index
        elif tag in b"[]":
            depth += 1 if tag == ord("[") else -1
            if depth < 0:
                raise MalformedPacket("an array in a message ends before it begins")
            end = index
        elif tag == _BLOB:
            size = int.from_bytes(data[index : index + 4], "big", signed=True)
            if size < 0:
                raise MalformedPacket("a blob has a negative size", got=size)
            end = index + 4 + size + (-size % 4)
            values.append(data[index + 4 : index + 4 + size])
        elif tag in _FOUR_BYTES:
            end = index + 4
            values.append(data[index:end])
        else:
            raise MalformedPacket("an argument has an unknown type", got=bytes([tag]))
        if end > len(data):
            raise MalformedPacket(
                "a message ends before its arguments do", got=f"{len(data)} bytes"
            )
        index = end
    if depth:
        raise MalformedPacket("an array in a message has no end")
    return Message(address, tuple(values))


def _text(data: bytes, begin: int, report: ReaderReport) -> tuple[str, int]:
    """Returns a zero-terminated text, and the index of the 4-byte word after it."""
    zero = data.find(0, begin)
    after = zero + 4 - zero % 4
    if zero < 0 or after > len(data):
        raise MalformedPacket("a text in a message has no end", where=f"byte {begin}")
    text = data[begin:zero]
    return (text.decode("ascii") if text.isascii() else decoded(text, report)), after
