"""Output of touches as TUIO 1.1 (profile 2Dcur)."""

from __future__ import annotations

import errno
import math
import socket
import struct
from collections.abc import Sequence
from typing import NamedTuple

from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.tuio.tuio_frames import CURSORS

PERIOD = 1.0
"""Time (s) between two redundant bundles. They repeat the current state, in case packets were lost.
"""

SETS_PER_BUNDLE = 12
"""Largest number of touches in a bundle. A bundle of about 1,000 bytes fits into one packet of any
network (1,500 bytes)."""

SOURCE = "hand-sandbox"

PASSING = {
    errno.ENETUNREACH,
    errno.ENETDOWN,
    errno.EHOSTUNREACH,
    errno.EHOSTDOWN,
    errno.ENOBUFS,
}
"""Errors of a network that may recover. The receiver then gets the state from the next redundant
bundle."""

_FSEQ_MODULUS = 2**31 - 1
_BUNDLE = b"#bundle\x00" + struct.pack(">Q", 1)
"""Start of a bundle, with the time tag that means "immediately"."""


class _Sent(NamedTuple):
    """Last sent state of a touch: session id, time, position and speed in surface lengths."""

    session: int
    time: float
    x: float
    y: float
    dx: float
    dy: float


class TuioEncoder:
    """Encodes touch frames as bundles.

    Each touch gets a new session id: ids of a device may not fit into the protocol's 32 bits, or
    may be used again. Speeds are in surface widths and heights per second.

    Args:
        surface: Touch surface that the coordinates 0 to 1 span.
        source: Name of the source in the messages.
    """

    def __init__(self, surface: Surface, source: str = SOURCE) -> None:
        self._width, self._height = (float(length) for length in surface.size)
        self._source = source
        self._touches: dict[int, _Sent] = {}
        self._next_session = 0
        self._fseq = 0

    def bundles(self, frame: TouchFrame) -> list[bytes]:
        """Encodes a frame as one packet; a large frame as several packets with the same number."""
        self._fseq = self._fseq % _FSEQ_MODULUS + 1
        now: dict[int, _Sent] = {}
        sets: list[bytes] = []
        for contact in frame.contacts:
            before = self._touches.get(contact.id)
            now[contact.id], acceleration = self._moved(contact, before, frame.time)
            if before is None or now[contact.id][2:] != before[2:]:
                sets.append(_set(now[contact.id], acceleration))
        self._touches = now
        return self._packed(sets, self._fseq)

    def redundant(self) -> list[bytes]:
        """Encodes the current state, to be sent periodically, without a frame number."""
        return self._packed([_set(touch, 0.0) for touch in self._touches.values()], -1)

    def _moved(self, contact: Contact, before: _Sent | None, time: float) -> tuple[_Sent, float]:
        x, y = contact.x / self._width, contact.y / self._height
        if before is None:
            self._next_session += 1
            return _Sent(self._next_session - 1, time, x, y, 0.0, 0.0), 0.0
        passed = time - before.time
        if passed <= 0.0:
            return _Sent(before.session, time, x, y, before.dx, before.dy), 0.0
        dx, dy = (x - before.x) / passed, (y - before.y) / passed
        gained = math.hypot(dx, dy) - math.hypot(before.dx, before.dy)
        return _Sent(before.session, time, x, y, dx, dy), gained / passed

    def _packed(self, sets: list[bytes], fseq: int) -> list[bytes]:
        alive = _message("alive", *(touch.session for touch in self._touches.values()))
        head, tail = [_message("source", self._source), alive], _message("fseq", fseq)
        parts = [sets[n : n + SETS_PER_BUNDLE] for n in range(0, len(sets), SETS_PER_BUNDLE)]
        return [_bundle([*head, *part, tail]) for part in parts or [[]]]


class TuioOutput:
    """Sends frames over UDP.

    Args:
        to: Receiver, HOST:PORT.
        surface: Touch surface that the coordinates 0 to 1 span.

    Raises:
        DeviceError: The address is not valid.

    Attributes:
        packets: Number of packets sent.
        refused: Number of packets for which the system reported that no program receives them.
    """

    def __init__(self, to: str, surface: Surface) -> None:
        self.to = to
        self.packets = self.refused = 0
        self._encoder = TuioEncoder(surface)
        self._socket = connected(to)
        self._due = -math.inf

    def send(self, frames: Sequence[TouchFrame], now: float) -> None:
        """Sends frames, and the current state once a second; `now`: time (s) of a steady clock."""
        packets = [packet for frame in frames for packet in self._encoder.bundles(frame)]
        if now >= self._due:
            self._due = now + PERIOD
            packets += self._encoder.redundant()
        for packet in packets:
            self.refused += send_packet(self._socket, packet, self.to)
            self.packets += 1

    def close(self) -> None:
        """Lifts all fingers at the receiver; the message is sent twice in case one is lost."""
        with self._socket:
            for packet in self._encoder.bundles(TouchFrame(0.0)) + self._encoder.redundant():
                self.refused += send_packet(self._socket, packet, self.to)
                self.packets += 1


def connected(to: str) -> socket.socket:
    """Returns a UDP socket that sends to HOST:PORT.

    Raises:
        DeviceError: The address is not valid.
    """
    host, _, port = to.rpartition(":")
    channel = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        # Connected, so that the system reports a missing receiver.
        if not host:
            raise ValueError("the host is missing")
        # RFC 6761: localhost is always the loopback address; some machines do not resolve it.
        channel.connect(("127.0.0.1" if host == "localhost" else host, int(port)))
    except (OSError, ValueError, OverflowError) as error:
        channel.close()
        raise DeviceError(
            f"packets cannot be sent to this address: {error}",
            got=to,
            expected="HOST:PORT, for example 127.0.0.1:3333",
        ) from error
    return channel


def send_packet(channel: socket.socket, data: bytes, to: str) -> bool:
    """Sends a packet; True if the system reports that no program received it or an earlier packet.

    Raises:
        DeviceError: The packet cannot be sent, and the network will not recover (`PASSING`).
    """
    try:
        try:
            channel.send(data)
        except ConnectionRefusedError:
            # The error is about an earlier packet; this one has not been sent yet.
            channel.send(data)
            return True
    except OSError as error:
        if error.errno in PASSING:
            return True
        raise DeviceError(
            f"a packet cannot be sent: {error}",
            where=to,
            got=f"{len(data)} bytes",
            remedy="Check the address and the network connection",
        ) from error
    return False


def _set(touch: _Sent, acceleration: float) -> bytes:
    return _message("set", touch.session, touch.x, touch.y, touch.dx, touch.dy, acceleration)


def _bundle(messages: list[bytes]) -> bytes:
    return _BUNDLE + b"".join(struct.pack(">i", len(m)) + m for m in messages)


def _message(command: str, *values: int | float | str) -> bytes:
    """One OSC message of the profile."""
    tags, body = ",s", _text(command)
    for value in values:
        if isinstance(value, str):
            tags, body = tags + "s", body + _text(value)
        elif isinstance(value, int):
            tags, body = tags + "i", body + struct.pack(">i", value)
        else:
            tags, body = tags + "f", body + struct.pack(">f", value)
    return _text(CURSORS) + _text(tags) + body


def _text(text: str) -> bytes:
    """Encodes a text for OSC: zero-terminated, padded to words of four bytes."""
    data = text.encode()
    return data + b"\x00" * (4 - len(data) % 4)
