"""Tracking of the touches of all TUIO 1.1 and 2.0 senders over time.

TUIO has no messages for touch-down and touch-up: a touch begins with the first position of a living
id and ends when its id is missing from the list of living ids. State and counters are kept per
source and profile, so that frames of one sender are not taken as late because of another's counter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from typing import NamedTuple

from sandbox.devices.tuio.osc import MalformedPacket, Packet, decode
from sandbox.devices.tuio.tuio11_frames import BLOBS, read_frames
from sandbox.devices.tuio.tuio20_frames import POINTERS, read_frames20
from sandbox.devices.tuio.tuio_source import Touch, TuioSource
from sandbox.devices.tuio.tuio_values import TuioFrame

MAX_SOURCES = 64
"""Largest number of known sources; beyond it the one silent for longest is removed."""

MAX_TOUCHES = 128
"""Largest number of touches of all sources in one frame; bounds the memory for many senders."""


class Commit(NamedTuple):
    """A committed frame: the name of its source, and the touches of all sources after it.

    `cancelled` has the ids of touches that ended because their sender disconnected.
    """

    source: str
    touches: tuple[Touch, ...]
    cancelled: frozenset[int] = frozenset()


@dataclass(slots=True)
class Statistics:
    """Counters of packets, frames and problems.

    Late: overtaken frames. Unfinished: frames that were never closed. Ignored: messages of other
    profiles and programs. Evicted: sources removed to make room. Surplus: touches beyond
    `MAX_TOUCHES`. Dropped: frames that were not fetched in time. Refused: connections that were
    refused.
    """

    packets: int = 0
    frames: int = 0
    malformed: int = 0
    malformed_reason: str = ""
    late: int = 0
    late_reason: str = ""
    unfinished: int = 0
    ignored: int = 0
    ignored_address: str = ""
    evicted: int = 0
    surplus: int = 0
    dropped: int = 0
    refused: int = 0
    refused_reason: str = ""

    def refuse_packet(self, reason: str) -> None:
        """Counts a malformed packet."""
        self.malformed += 1
        self.malformed_reason = reason

    def refuse_connection(self, reason: str) -> None:
        """Counts a refused connection."""
        self.refused += 1
        self.refused_reason = reason


class SourceStatus(NamedTuple):
    """Current status of a sender; `heard` is the time of its last packet, s."""

    name: str
    peer: str
    touches: int
    heard: float
    stale: bool
    version: str


class Tuio:
    """Tracks the touches of all senders; the caller supplies packets and the time.

    Args:
        stale_after: s without a packet after which a source's touches are lifted. The protocol has
            no such rule, and a finger whose last packet is lost would stay down for ever. It must
            not be short, because a resting finger may send nothing.
    """

    def __init__(self, stale_after: float = 2.0) -> None:
        self.statistics = Statistics()
        self._stale_after = stale_after
        self._sources: dict[tuple[str, str, str], TuioSource] = {}
        self._last_name: dict[tuple[str, str], str] = {}

    @property
    def sources(self) -> tuple[SourceStatus, ...]:
        """Status of all known senders, in order of appearance."""
        return tuple(
            SourceStatus(
                s.name,
                s.peer,
                0 if s.slot is None else len(s.places),
                s.heard,
                s.stale,
                s.version,
            )
            for s in self._sources.values()
        )

    def feed(self, data: bytes, peer: str, now: float) -> list[Commit]:
        """Processes a packet from a network address; a malformed one is only counted."""
        self.statistics.packets += 1
        try:
            packet = decode(data)
            frames, names, ignored = read_frames(packet)
            pointers, also_ignored = read_frames20(packet)
        except MalformedPacket as error:
            self.statistics.refuse_packet(str(error))
            return []
        self._count_ignored([a for a in ignored if not _is_tuio20(a)] + also_ignored)
        commits: list[Commit] = []
        for frame in frames:
            source = self._hear(peer, frame.source, "1.1", now, commits)
            self._apply(frame, source, packet, now, commits)
        for name in names:  # a packet without touches shows that the source is alive, too
            self._hear(peer, name, "1.1", now, commits)
        for frame in pointers:
            if frame.source is None and (peer, "2.0") not in self._last_name:
                self.statistics.unfinished += 1  # its source is unknown
                continue
            source = self._hear(peer, frame.source, "2.0", now, commits)
            self._apply_pointers(frame, source, now, commits)
        return commits

    def expire(self, now: float) -> list[Commit]:
        """Lifts the touches of sources that have been silent for too long."""
        commits: list[Commit] = []
        for source in self._sources.values():
            if not source.stale and now > source.heard + self._stale_after:
                shown = source.slot is not None and bool(source.places)
                source.silence()
                if shown:
                    self._commit(source, commits)
        return commits

    def disconnect(self, peer: str) -> list[Commit]:
        """Removes the sources of a closed connection; their touches are cancelled, not lifted."""
        commits: list[Commit] = []
        for source in [s for s in self._sources.values() if s.peer == peer]:
            gone = frozenset(touch.id for touch in source.touches())
            self._forget(source)
            if gone:
                self._commit(source, commits, gone)
        return commits

    def _count_ignored(self, ignored: Sequence[str]) -> None:
        if ignored:
            self.statistics.ignored += len(ignored)
            self.statistics.ignored_address = ignored[-1]

    def _apply(
        self,
        frame: TuioFrame,
        source: TuioSource,
        packet: Packet,
        now: float,
        commits: list[Commit],
    ) -> None:
        if not packet.bundled:
            begun = source.open.setdefault(frame.profile, TuioFrame(source.name, frame.profile))
            begun.take(frame)
            frame = begun
            if frame.number is None:  # the rest of the frame may come in further datagrams
                frame.forget_the_first()
                return
        source.open.pop(frame.profile, None)
        if frame.number is None:
            self.statistics.unfinished += 1
        elif self._in_time(frame, source, now) and frame.profile != BLOBS:
            self._commit(source, commits)

    def _apply_pointers(
        self, part: TuioFrame, source: TuioSource, now: float, commits: list[Commit]
    ) -> None:
        begun = source.open.pop(POINTERS, None)
        if part.source is None:  # messages without a bundle, or the rest of one
            if begun is None:
                self.statistics.unfinished += 1
                return
            part.number = begun.number
        if begun is not None and begun.number == part.number:
            begun.take(part)
            part = begun
        elif begun is not None:
            self.statistics.unfinished += 1
        if part.alive is None and not source.completes(part):
            part.forget_the_first()
            source.open[POINTERS] = part
        elif self._in_time(part, source, now):
            self._commit(source, commits)

    def _in_time(self, frame: TuioFrame, source: TuioSource, now: float) -> bool:
        """Commits a closed frame; False if it is late and changes nothing."""
        reason = source.late(frame, now)
        if reason:
            self.statistics.late += 1
            self.statistics.late_reason = reason
            return False
        source.commit(frame)
        return True

    def _commit(
        self, source: TuioSource, commits: list[Commit], cancelled: frozenset[int] = frozenset()
    ) -> None:
        present = (source.peer, source.name, source.version) in self._sources
        if present and source.slot is None and source.places and not source.stale:
            taken = {s.slot for s in self._sources.values()}
            source.slot = next(slot for slot in range(MAX_SOURCES) if slot not in taken)
        shown = [s for s in self._sources.values() if s.slot is not None]
        surplus = sum(len(s.places) for s in shown) - MAX_TOUCHES
        if surplus > 0:
            self.statistics.surplus += surplus
            shown.sort(key=lambda s: s is not source)  # the sending source is never left out
        touches = islice((touch for s in shown for touch in s.touches()), MAX_TOUCHES)
        self.statistics.frames += 1
        commits.append(Commit(source.name, tuple(touches), cancelled))

    def _hear(
        self, peer: str, name: str | None, version: str, now: float, commits: list[Commit]
    ) -> TuioSource:
        """The source of a message; without a name, the last one at that address."""
        nameless = (peer, "", version)
        if name is None:
            name = self._last_name.get((peer, version), "")
        elif (peer, name, version) not in self._sources and nameless in self._sources:
            # Senders may send a few bundles before the first one with their name.
            renamed = self._sources[peer, name, version] = self._sources.pop(nameless)
            renamed.name = name
        source = self._sources.get((peer, name, version))
        if source is None:
            if len(self._sources) >= MAX_SOURCES:
                self._evict(commits)
            source = self._sources[peer, name, version] = TuioSource(name, peer, version, now)
        self._last_name[peer, version] = name
        source.heard, source.stale = now, False
        return source

    def _evict(self, commits: list[Commit]) -> None:
        oldest = min(self._sources.values(), key=lambda source: source.heard)
        self._forget(oldest)
        self.statistics.evicted += 1
        if oldest.slot is not None and oldest.places:
            self._commit(oldest, commits)

    def _forget(self, source: TuioSource) -> None:
        del self._sources[source.peer, source.name, source.version]
        mine = (source.peer, source.version)
        if all((s.peer, s.version) != mine for s in self._sources.values()):
            self._last_name.pop(mine, None)


def _is_tuio20(address: str) -> bool:
    """True if messages of this address belong to the decoder of TUIO 2.0."""
    return address.startswith("/tuio2/")
