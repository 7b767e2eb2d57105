"""Packet captures of touch senders: JSON lines `{"t": seconds, "hex": "23627564..."}`.

A capture has all packets from the network, including invalid ones, so that a problem can be
reproduced. `"from"` may name the sender of a packet. `{"t": seconds, "closed": "..."}` marks the
end of a sender's connection.

A file is read up to a line that is not JSON. Packets without bytes or time are left out. If the
times are impossible in seconds, they are read in a unit in which they are possible.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean
from typing import NamedTuple

import msgspec
from msgspec import Struct

from models.errors import RecordingError
from models.frames import TouchFrame
from models.json_input import converted, decoded, loosely_decoded, numbered_lines
from models.plausible import (
    TOUCH_STEP,
    ContactSizes,
    TouchIds,
    Units,
    find_units,
    in_order,
    parse_units,
    steps_of,
    touch_steps,
    unit_size,
)
from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.tuio.osc import MAX_PACKET_BYTES
from sandbox.devices.tuio.tuio import touch_frame
from sandbox.devices.tuio.tuio_senders import Commit, Statistics, Tuio

_MAX_LINE = 2 * MAX_PACKET_BYTES + 4096
"""Largest number of bytes in a line: the largest packet in hex, and space for other keys."""

_MAX_PEER = 200
"""Largest number of characters in a sender's address."""

_EXPECTED = '{"t": seconds, "hex": "..."}'

_DAMAGED = "the capture of touches is damaged here"
_PLAYABLE = "The lines before this one can be played"
_FORMATS = "`sandbox touches formats` lists what can be played"

_SAMPLE = 500
"""Number of packets from which the unit of time is found."""
_DENSE = 0.2
"""If the mean time between two packets is at most this, the unit of the times is seconds."""


class _PacketLine(Struct):
    """A line: a packet in hex and its sender, or the sender whose connection has ended.

    `t` is NaN if there is no time.
    """

    t: float
    hex: str | None = None
    sender: str = msgspec.field(default="", name="from")
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
        report: Values left out, and assumptions.
    """

    packets: tuple[CapturedPacket, ...]
    damage: RecordingError | None = None
    report: ReaderReport = field(default_factory=ReaderReport)

    @property
    def duration(self) -> float:
        """Seconds from the first packet to the last."""
        return self.packets[-1].time - self.packets[0].time


def read_capture(path: Path, unit: str = "") -> TouchCapture:
    """Reads a capture up to its end or to the first line that is not JSON.

    Args:
        path: The file.
        unit: Unit of the times that a person gave; empty: the unit is found.

    Raises:
        RecordingError: The file does not exist, its first packet cannot be read, or its times are
            impossible in any unit.
    """
    packets: list[CapturedPacket] = []
    damage: RecordingError | None = None
    report = ReaderReport()
    try:
        for number, line in numbered_lines(path, _MAX_LINE):
            remedy = _PLAYABLE if packets else _FORMATS
            packet = _packet(_decoded(line, f"{path}, line {number}", remedy), report)
            packets += [packet] if packet is not None else []
    except RecordingError as error:
        damage = error
    except OSError as error:
        raise RecordingError(f"the capture cannot be read: {error}", where=str(path)) from error
    if not packets:
        raise damage or RecordingError(
            "the capture has no packets of touches",
            where=str(path),
            got=report.line() or None,
            expected=f"lines like {_EXPECTED}",
        )
    packets = in_order(packets, report)
    second = _second(packets, parse_units(unit), str(path), report)
    if second != 1.0:
        packets = [packet._replace(time=second * packet.time) for packet in packets]
    return TouchCapture(tuple(packets), damage, report)


def _second(
    packets: Sequence[CapturedPacket], given: Units, where: str, report: ReaderReport
) -> float:
    """Returns the unit (s) of the packets' times.

    Raises:
        RecordingError: The times are impossible in any unit.
    """
    gaps = steps_of([packet.time for packet in packets[:_SAMPLE]])
    if not given and gaps and TOUCH_STEP.least <= fmean(gaps) <= _DENSE:
        # Only seconds are possible for such gaps, so packets need not be decoded.
        return 1.0
    tuio = Tuio(math.inf)
    times: list[float] = []
    touched: list[bool] = []
    for packet in packets[:_SAMPLE]:
        commits = tuio.feed(packet.data, packet.peer, packet.time) if packet.data else []
        if commits:
            times.append(packet.time)
            touched.append(bool(commits[-1].touches))
    seen = {TOUCH_STEP: touch_steps(times, touched)}
    found = find_units(seen, {"time": "s"}, given, where=where, report=report, error=RecordingError)
    return unit_size(found, "time")


def _decoded(line: bytes, where: str, remedy: str) -> _PacketLine:
    """Decodes a line; values that cannot be read are left out.

    Raises:
        RecordingError: The line is not one of a capture.
    """
    try:
        return decoded(
            line,
            _PacketLine,
            RecordingError,
            what=_DAMAGED,
            where=where,
            expected=_EXPECTED,
            remedy=remedy,
        )
    except RecordingError:
        loose = loosely_decoded(line)
        if not isinstance(loose, dict) or not loose.keys() & {"hex", "closed"}:
            raise
    time = converted(loose.get("t"), float)
    return _PacketLine(
        math.nan if time is None else time,
        converted(loose.get("hex"), str),
        converted(loose.get("from"), str) or "",
        converted(loose.get("closed"), str),
    )


def _packet(line: _PacketLine, report: ReaderReport) -> CapturedPacket | None:
    """Returns the packet of a line; None if it is left out, which is reported."""
    data: bytes | None = None
    reason = "" if math.isfinite(line.t) else "packets without a time"
    if line.closed is None:
        try:
            data = bytes.fromhex(line.hex or "")
        except ValueError:
            reason = reason or "packets that are not hexadecimal"
        if line.hex is None:
            reason = reason or "packets without bytes"
        elif data is not None and len(data) > MAX_PACKET_BYTES:
            reason = reason or "packets larger than UDP carries"
    if reason:
        report.leave_out(reason)
        return None
    peer = line.sender if line.closed is None else line.closed
    return CapturedPacket(line.t, data, peer[:_MAX_PEER])


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
        self._tuio.report.add(capture.report)
        self._sizes = ContactSizes(self._tuio.report)
        self._ids = TouchIds(self._tuio.report)
        self._next = 0

    @property
    def statistics(self) -> Statistics:
        """The counters of the decoder."""
        return self._tuio.statistics

    @property
    def report(self) -> ReaderReport:
        """The decoder's report on left-out data and assumptions."""
        return self._tuio.report

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
            # A source may become stale before this packet; that comes first.
            silence = self._silence_ends()
            if silence < min(time, now):
                frames += self._frames(self._tuio.expire(silence), silence)
            elif time <= now:
                peer = packet.peer or self.name
                self._next += 1
                if packet.data is None:
                    self._tuio.disconnect(peer, time)
                else:
                    frames += self._frames(self._tuio.feed(packet.data, peer, time), time)
                if self.finished:
                    frames += self._frames(self._tuio.end(), time)
            else:
                break
        return frames

    def close(self) -> None:
        """Ends playback."""
        self._next = len(self._packets)

    def _silence_ends(self) -> float:
        """Time (s) at which the next source becomes stale, just after its limit."""
        heard = [source.heard for source in self._tuio.sources if not source.stale]
        return math.nextafter(min(heard) + self._stale_after, math.inf) if heard else math.inf

    def _frames(self, commits: list[Commit], time: float) -> list[TouchFrame]:
        frames = [touch_frame(commit, self._surface, time, self._sizes) for commit in commits]
        for frame in frames:
            self._ids.look(frame)
        return frames
