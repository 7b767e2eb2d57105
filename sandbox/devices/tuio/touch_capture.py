"""Packet captures of touch senders: JSON lines `{"t": seconds, "hex": "23627564..."}`.

A capture holds packets as they came from the network, invalid ones included, so that a problem can
be reproduced. `"from"` may name the sender of a packet; `{"t": seconds, "closed": "..."}` says that
a sender's connection has ended. A damaged file is read up to the damage.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from msgspec import Struct, field

from models.errors import RecordingError
from models.frames import TouchFrame
from models.json_input import decoded, numbered_lines
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.tuio.osc import MAX_PACKET_BYTES
from sandbox.devices.tuio.tuio import touch_frame
from sandbox.devices.tuio.tuio_senders import Commit, Statistics, Tuio

_MAX_LINE = 2 * MAX_PACKET_BYTES + 4096
"""Largest number of bytes in a line: the largest packet in hex, and room for other keys."""

_MAX_PEER = 200
"""Largest number of characters in a sender's address."""

_EXPECTED = '{"t": seconds, "hex": "..."} with times that never run backwards'


_DAMAGED = "the capture of touches is damaged here"
_PLAYABLE = "The lines before this one can be played"
_FORMATS = "`sandbox touches formats` lists what can be played"


class _PacketLine(Struct):
    """A line: a packet in hex and its sender, or the sender whose connection has ended."""

    t: float
    hex: str | None = None
    sender: str = field(default="", name="from")
    closed: str | None = None


class CapturedPacket(NamedTuple):
    """A packet and its time of arrival, s on the capture's own clock.

    `data` is None if the connection to `peer` has ended.
    """

    time: float
    data: bytes | None
    peer: str = ""


@dataclass(frozen=True)
class TouchCapture:
    """The packets of a capture.

    Attributes:
        packets: Packets up to the end or the damage, in order of time.
        damage: Error with file and line that ended the capture early; None if it is undamaged.
    """

    packets: tuple[CapturedPacket, ...]
    damage: RecordingError | None = None

    @property
    def duration(self) -> float:
        """Seconds from the first packet to the last."""
        return self.packets[-1].time - self.packets[0].time


def read_capture(path: Path) -> TouchCapture:
    """Reads a capture up to its end or to the first damaged line.

    Raises:
        RecordingError: The file does not exist, or its first packet cannot be read.
    """
    packets: list[CapturedPacket] = []
    damage: RecordingError | None = None
    try:
        for packet in _packets(path):
            packets.append(packet)
    except RecordingError as error:
        damage = error
    except OSError as error:
        raise RecordingError(f"the capture cannot be read: {error}", where=str(path)) from error
    if not packets:
        raise damage or RecordingError(
            "the capture is empty", where=str(path), expected=f"lines like {_EXPECTED}"
        )
    return TouchCapture(tuple(packets), damage)


def _packets(path: Path) -> Iterator[CapturedPacket]:
    last = -math.inf
    for number, line in numbered_lines(path, _MAX_LINE):
        where = f"{path}, line {number}"
        remedy = _PLAYABLE if math.isfinite(last) else _FORMATS
        record = decoded(
            line,
            _PacketLine,
            RecordingError,
            what=_DAMAGED,
            where=where,
            expected=_EXPECTED,
            remedy=remedy,
        )
        try:
            packet = _packet(record)
            if packet.time < last:
                raise ValueError(f"the time runs backwards, from {last} to {packet.time} s")
        except ValueError as error:
            raise RecordingError(
                f"{_DAMAGED}: {error}",
                where=where,
                got=line[:40].decode(errors="replace"),
                expected=_EXPECTED,
                remedy=remedy,
            ) from None
        last = packet.time
        yield packet


def _packet(line: _PacketLine) -> CapturedPacket:
    """The packet of a line.

    Raises:
        ValueError: The bytes are not a packet.
    """
    if line.closed is not None:
        return CapturedPacket(line.t, None, line.closed[:_MAX_PEER])
    if line.hex is None:
        raise ValueError("hex is missing")
    data = bytes.fromhex(line.hex)
    if len(data) > MAX_PACKET_BYTES:
        raise ValueError(f"a packet of {len(data)} bytes does not exist in UDP")
    return CapturedPacket(line.t, data, line.sender[:_MAX_PEER])


def packet_record(packet: CapturedPacket) -> dict[str, object]:
    """JSON values of a packet's line."""
    if packet.data is None:
        return {"t": packet.time, "closed": packet.peer}
    return {"t": packet.time, "hex": packet.data.hex(), "from": packet.peer}


class CaptureDevice(Device):
    """Plays a packet capture of TUIO 1.1 or 2.0.

    The first packet plays at session time 0. Silent sources become stale as in the live device.
    """

    name = "capture"
    plays_file = True
    damage: RecordingError | None

    def __init__(
        self, capture: TouchCapture, surface: Surface, *, stale_after: float = 2.0
    ) -> None:
        self.damage = capture.damage
        self._packets = capture.packets
        self._surface = surface
        self._stale_after = stale_after
        self._tuio = Tuio(stale_after)
        self._next = 0

    @property
    def statistics(self) -> Statistics:
        """The counters of the decoder."""
        return self._tuio.statistics

    @property
    def finished(self) -> bool:
        """True after the last packet."""
        return self._next >= len(self._packets)

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The frames due by `now`, oldest first."""
        frames: list[TouchFrame] = []
        while not self.finished:
            packet = self._packets[self._next]
            time = packet.time - self._packets[0].time
            # A source becomes stale at a time between two packets, so this is checked before each.
            silence = self._silence_ends()
            if silence < min(time, now):
                frames += self._frames(self._tuio.expire(silence), silence)
            elif time <= now:
                peer = packet.peer or self.name
                frames += self._frames(
                    self._tuio.disconnect(peer)
                    if packet.data is None
                    else self._tuio.feed(packet.data, peer, time),
                    time,
                )
                self._next += 1
            else:
                break
        return frames

    def close(self) -> None:
        """Ends playback."""
        self._next = len(self._packets)

    def _silence_ends(self) -> float:
        """s, time at which the next source becomes stale, just after its limit."""
        heard = [source.heard for source in self._tuio.sources if not source.stale]
        return math.nextafter(min(heard) + self._stale_after, math.inf) if heard else math.inf

    def _frames(self, commits: list[Commit], time: float) -> list[TouchFrame]:
        return [touch_frame(commit, self._surface, time) for commit in commits]
