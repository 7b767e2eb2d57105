"""Decoder of OSC packets: bundles are walked here, single messages are read by python-osc.

python-osc's own readers of packets and bundles never get bytes from the network: they do not return
from a bundle whose element claims a negative size, and raise errors of the interpreter on nested
bundles and on text that is not UTF-8. The walk below is a loop over an explicit stack in which
every turn consumes bytes, so its work is bounded by the size of the packet.
"""

from __future__ import annotations

from typing import NamedTuple

from pythonosc.osc_message import OscMessage

from models.errors import DeviceError

MAX_PACKET_BYTES = 65_507
"""Largest payload of a UDP datagram over IPv4, bytes (65,535 less the IP and UDP headers)."""

MAX_DEPTH = 8
"""Largest number of nested bundles; touch senders use one level."""

MAX_ELEMENTS = 1024
"""Largest number of elements in a packet; 64 touches in each of three profiles take about 200."""

MAX_ARGUMENTS = 256
"""Largest number of arguments in a message; a list of 64 living touches takes 65."""

_BUNDLE = b"#bundle\x00"
_BUNDLE_HEADER = len(_BUNDLE) + 8
"""Bytes before a bundle's first element: its name and a time tag of 8 bytes."""

_FIXED_SIZE = {
    **dict.fromkeys(b"ifrm", 4),
    **dict.fromkeys(b"hdt", 8),
    **dict.fromkeys(b"TFN[]", 0),
}
"""Bytes of an argument by type tag (OSC 1.0 and its usual extensions)."""

_TEXT, _BLOB = ord("s"), ord("b")


class MalformedPacket(DeviceError):  # noqa: N818  (names the packet)
    """A packet from the network cannot be understood, and is refused as a whole."""


class Message(NamedTuple):
    """One OSC message."""

    address: str
    arguments: tuple[object, ...]


class Packet(NamedTuple):
    """The messages of one datagram in order; nested bundles are flattened.

    `bundled` is False if the datagram is a single message without a bundle.
    """

    messages: tuple[Message, ...]
    bundled: bool


def decode(data: bytes) -> Packet:
    """Reads one datagram.

    Raises:
        MalformedPacket: The packet is invalid; this function raises no other exception.
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
    parts = _bundle_messages(data) if bundled else [data]
    return Packet(tuple(_message(part) for part in parts), bundled)


def _bundle_messages(data: bytes) -> list[bytes]:
    """The bytes of every message in a bundle, in order."""
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


def _message(data: bytes) -> Message:
    """Reads one message."""
    _check_arguments(data)
    try:
        message = OscMessage(data)
        return Message(message.address, tuple(message.params))
    except Exception as error:  # python-osc raises its own error and several others
        raise MalformedPacket(f"an OSC message cannot be read: {error}") from error


def _check_arguments(data: bytes) -> None:
    """Refuses errors that python-osc accepts: missing bytes, unknown types, negative sizes.

    python-osc pads a float that is cut short, drops an argument of unknown type (with a line in the
    log for each), and steps back over a blob of negative size.
    """
    if not data.startswith(b"/"):
        raise MalformedPacket("an OSC address must begin with a slash", got=data[:16])
    index = _after_text(data, 0)
    if index == len(data):
        return  # an address without arguments is valid
    if data[index] != ord(","):
        raise MalformedPacket("a message has no type tags", got=data[index : index + 16])
    begin, index = index + 1, _after_text(data, index)
    tags = data[begin : data.index(0, begin)]
    if len(tags) > MAX_ARGUMENTS:
        raise MalformedPacket(
            "a message has too many arguments", got=len(tags), expected=f"{MAX_ARGUMENTS} at most"
        )
    for tag in tags:
        if tag in _FIXED_SIZE:
            index += _FIXED_SIZE[tag]
        elif tag == _TEXT:
            index = _after_text(data, index)
        elif tag == _BLOB:
            size = int.from_bytes(data[index : index + 4], "big", signed=True)
            if size < 0:
                raise MalformedPacket("a blob has a negative size", got=size)
            index += 4 + size + (-size % 4)
        else:
            raise MalformedPacket("an argument has an unknown type", got=bytes([tag]))
    if index > len(data):
        raise MalformedPacket(
            "a message ends before its arguments do",
            got=f"{len(data)} bytes",
            expected=f"{index} bytes",
        )


def _after_text(data: bytes, begin: int) -> int:
    """Index of the word after a zero-terminated text."""
    zero = data.find(0, begin)
    after = zero + 4 - zero % 4
    if zero < 0 or after > len(data):
        raise MalformedPacket("a text in a message has no end", where=f"byte {begin}")
    return after
