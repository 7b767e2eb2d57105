"""Packet captures of touch senders: JSON lines `{"t": seconds, "hex": "23627564..."}`.

A capture holds packets as they came from the network, wrong ones included, so that a problem seen
once can be shown again. `"from"` may tell whom a packet is from; `{"t": seconds, "closed": "..."}`
says that somebody's connection has ended. A damaged file is good up to the damage.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from models.errors import RecordingError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.tuio.osc import MAX_PACKET_BYTES
from sandbox.devices.tuio.tuio import touch_frame
from sandbox.devices.tuio.tuio_senders import Commit, Statistics, Tuio
from sandbox.session.device import Device

_MAX_LINE = 2 * MAX_PACKET_BYTES + 4096
"""Bytes of a line: the largest packet in hex, and room for other keys."""

_MAX_PEER = 200
"""Characters of a sender's address."""

_EXPECTED = '{"t": seconds, "hex": "..."} with times that never run backwards'


class CapturedPacket(NamedTuple):
    """A packet and when it came, seconds on the capture's own clock.

    `data` is None where the connection to `peer` has ended.
    """

    time: float
    data: bytes | None
    peer: str = ""


@dataclass(frozen=True)
class TouchCapture:
    """The packets of a capture.

    Attributes:
        packets: Up to the end or the damage, in order of time.
        damage: What ended the capture early, with file and line; None where it is whole.
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
        RecordingError: There is no such file, or not even its first packet can be read.
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
    with path.open("rb") as file:
        number = 0
        while line := file.readline(_MAX_LINE):
            number += 1
            if not line.strip():
                continue
            try:
                packet = _packet(line)
                if packet.time < last:
                    raise ValueError(f"the time runs backwards, from {last} to {packet.time} s")
            except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
                raise RecordingError(
                    f"the capture of touches is damaged here: {_reason(error)}",
                    where=f"{path}, line {number}",
                    got=line[:40],
                    expected=_EXPECTED,
                    remedy="What stands before this line can be played"
                    if math.isfinite(last)
                    else "`sandbox touches formats` lists what can be played",
                ) from error
            last = packet.time
            yield packet


def _packet(line: bytes) -> CapturedPacket:
    """One line; what is wrong with it leaves as one of Python's own errors."""
    if len(line) >= _MAX_LINE:
        raise ValueError("the line is too long")
    record = json.loads(line)
    if not isinstance(record, dict):
        raise TypeError("the line is not a JSON object")
    ended = "closed" in record
    seconds, text = record["t"], "" if ended else record["hex"]
    peer = record.get("closed" if ended else "from", "")
    if not isinstance(peer, str):
        raise TypeError("the name of a sender is not a text")
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
        raise TypeError("t is not a number")
    if not math.isfinite(seconds):
        raise ValueError("t is not finite")
    if not isinstance(text, str):
        raise TypeError("hex is not a text")
    data = bytes.fromhex(text)
    if len(data) > MAX_PACKET_BYTES:
        raise ValueError(f"a packet of {len(data)} bytes does not exist in UDP")
    return CapturedPacket(float(seconds), None if ended else data, peer[:_MAX_PEER])


def packet_record(packet: CapturedPacket) -> dict[str, object]:
    """A packet as a line has it."""
    if packet.data is None:
        return {"t": packet.time, "closed": packet.peer}
    return {"t": packet.time, "hex": packet.data.hex(), "from": packet.peer}


def _reason(error: Exception) -> str:
    return f"{error} is missing" if isinstance(error, KeyError) else str(error)


class CaptureDevice(Device):
    """Plays a capture as the device that it was taken from; the protocol is TUIO 1.1 or 2.0.

    Time 0 of the session is the first packet. Silent sources go stale as they would have live.
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
            # The moment at which silence ended a touch lies between two packets, so it is looked
            # for before each of them.
            silence = self._silence_ends()
            if silence < min(time, now):
                frames += self._frames(self._tuio.expire(silence), silence)
            elif time <= now:
                peer = packet.peer or self.name
                frames += self._frames(
                    self._tuio.leave(peer)
                    if packet.data is None
                    else self._tuio.feed(packet.data, peer, time),
                    time,
                )
                self._next += 1
            else:
                break
        return frames

    def close(self) -> None:
        """Ends the play."""
        self._next = len(self._packets)

    def _silence_ends(self) -> float:
        """When the next source goes stale, seconds; just after its limit."""
        heard = [source.heard for source in self._tuio.sources if not source.stale]
        return math.nextafter(min(heard) + self._stale_after, math.inf) if heard else math.inf

    def _frames(self, commits: list[Commit], time: float) -> list[TouchFrame]:
        return [touch_frame(commit, self._surface, time) for commit in commits]
