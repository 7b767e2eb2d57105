"""TUIO 1.1, profile 2Dcur: the touches of every sender, followed over time.

There is no message for a finger that comes down or goes up: a touch begins with the first `set` of
a living id and ends when its id is missing from `alive`. A frame larger than a datagram comes in
several bundles with one `fseq`. State and counter are kept per source, so that two senders whose
counters are close do not make each other's frames look late.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple

from sandbox.devices.osc import MalformedPacket, Packet, decode
from sandbox.devices.tuio11_frames import MAX_IDS, Frame, read_frames

MAX_SOURCES = 64
"""Sources remembered at once; the one unheard for longest makes room."""

RESTART_GAP = 100
"""A counter that falls by more than this many frames is a sender that began anew (as the reference
clients have it); by less, a packet that was overtaken on its way."""

MAX_TOUCHES = 128
"""Touches of all sources in one frame: bounds what a flood of senders can make us keep."""

ID_STRIDE = 2**32
"""Ids are int32 and unique per source only; each further source at work is moved by this much."""


class Touch(NamedTuple):
    """A living touch: an id unique among all sources, x and y in 0..1 of the surface."""

    id: int
    x: float
    y: float


class Commit(NamedTuple):
    """A frame came into force: the name of its source, and all touches of all sources after it."""

    source: str
    touches: tuple[Touch, ...]


@dataclass(slots=True)
class Statistics:
    """What happened so far. Late: overtaken frames. Unfinished: bundles without `fseq`.

    Ignored: messages for other profiles and programs. Evicted: sources that had to make room.
    Surplus: touches beyond `MAX_TOUCHES`. Dropped: frames that nobody fetched in time.
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


class SourceStatus(NamedTuple):
    """One sender as seen now; `heard` is the time of its last packet, seconds."""

    name: str
    peer: str
    touches: int
    heard: float
    stale: bool


@dataclass(slots=True)
class _Source:
    """The state of one sender's profile; `slot` numbers the sources that have had touches."""

    name: str
    peer: str
    heard: float
    stale: bool = False
    slot: int | None = None
    fseq: int | None = None
    alive: tuple[int, ...] = ()
    positions: dict[int, tuple[float, float]] = field(default_factory=dict)
    bare: Frame = field(default_factory=lambda: Frame(None))

    def commit(self, frame: Frame, fseq: int) -> bool:
        """Brings a closed frame into force; False where it is late and changes nothing."""
        if fseq > 0:  # 0 and below, usually -1: apply in any case, do not count
            if self.fseq is not None and 0 < self.fseq - fseq <= RESTART_GAP:
                return False
            self.fseq = fseq
        if frame.alive is not None:
            self.alive = frame.alive
        known = self.positions | frame.positions
        self.positions = {touch: known[touch] for touch in self.alive if touch in known}
        return True

    def touches(self) -> Iterable[Touch]:
        """The living touches, none while the source is silent."""
        if self.slot is not None:
            for touch, (x, y) in self.positions.items():
                yield Touch(touch + self.slot * ID_STRIDE, x, y)


class Tuio11:
    """Follows the touches of all senders; the caller gives datagrams and the time.

    Args:
        stale_after: Seconds without a packet after which a source's touches are lifted. The
            protocol has no such rule, and a finger whose last packet is lost would stay down for
            ever; but a resting finger is legitimately silent, so this cannot be short.
    """

    def __init__(self, stale_after: float = 2.0) -> None:
        self.statistics = Statistics()
        self._stale_after = stale_after
        self._sources: dict[tuple[str, str], _Source] = {}
        self._last_name: dict[str, str] = {}

    @property
    def sources(self) -> tuple[SourceStatus, ...]:
        """All senders remembered, in order of appearance."""
        return tuple(
            SourceStatus(
                s.name, s.peer, 0 if s.slot is None else len(s.positions), s.heard, s.stale
            )
            for s in self._sources.values()
        )

    def feed(self, data: bytes, peer: str, now: float) -> list[Commit]:
        """Takes one datagram from a network address; a malformed one is counted, no more."""
        self.statistics.packets += 1
        try:
            packet = decode(data)
            frames, names, ignored = read_frames(packet)
        except MalformedPacket as error:
            self.statistics.malformed += 1
            self.statistics.malformed_reason = str(error)
            return []
        if ignored:
            self.statistics.ignored += len(ignored)
            self.statistics.ignored_address = ignored[-1]
        commits: list[Commit] = []
        for frame in frames:
            self._apply(frame, self._hear(peer, frame.source, now, commits), packet, commits)
        for name in names:  # also a packet without touches is a sign of life
            self._hear(peer, name, now, commits)
        return commits

    def expire(self, now: float) -> list[Commit]:
        """Lifts the touches of sources that have been silent for too long."""
        commits: list[Commit] = []
        for source in self._sources.values():
            if not source.stale and now > source.heard + self._stale_after:
                # The positions are kept: a finger that only rested is alive in the next frame.
                shown = source.slot is not None and bool(source.positions)
                source.stale, source.slot, source.fseq = True, None, None
                source.bare = Frame(None)
                if shown:
                    self._commit(source, commits)
        return commits

    def _apply(self, frame: Frame, source: _Source, packet: Packet, commits: list[Commit]) -> None:
        if not packet.bundled:
            source.bare.take(frame)
            frame = source.bare
            if frame.fseq is None:  # the rest of the frame comes in further datagrams, or never
                while len(frame.positions) > MAX_IDS:
                    del frame.positions[next(iter(frame.positions))]
                return
        source.bare = Frame(None)
        if frame.fseq is None:
            self.statistics.unfinished += 1
        elif source.commit(frame, frame.fseq):
            self._commit(source, commits)
        else:
            self.statistics.late += 1
            self.statistics.late_reason = f"frame {frame.fseq} came after {source.fseq}"

    def _commit(self, source: _Source, commits: list[Commit]) -> None:
        if source.slot is None and source.positions and not source.stale:
            taken = {s.slot for s in self._sources.values()}
            source.slot = next(slot for slot in range(MAX_SOURCES) if slot not in taken)
        shown = [s for s in self._sources.values() if s.slot is not None]
        surplus = sum(len(s.positions) for s in shown) - MAX_TOUCHES
        if surplus > 0:
            self.statistics.surplus += surplus
            shown.sort(key=lambda s: s is not source)  # whoever speaks is seen in any case
        touches = islice((touch for s in shown for touch in s.touches()), MAX_TOUCHES)
        self.statistics.frames += 1
        commits.append(Commit(source.name, tuple(touches)))

    def _hear(self, peer: str, name: str | None, now: float, commits: list[Commit]) -> _Source:
        """The source that speaks; without a name, the one that last spoke from that address."""
        if name is None:
            name = self._last_name.get(peer, "")
        elif (peer, name) not in self._sources and (peer, "") in self._sources:
            # Senders open with a few bundles before they have given themselves a name.
            nameless = self._sources[peer, name] = self._sources.pop((peer, ""))
            nameless.name = name
        source = self._sources.get((peer, name))
        if source is None:
            if len(self._sources) >= MAX_SOURCES:
                self._evict(commits)
            source = self._sources[peer, name] = _Source(name, peer, now)
        self._last_name[peer] = name
        source.heard, source.stale = now, False
        return source

    def _evict(self, commits: list[Commit]) -> None:
        oldest = min(self._sources.values(), key=lambda source: source.heard)
        del self._sources[oldest.peer, oldest.name]
        if all(source.peer != oldest.peer for source in self._sources.values()):
            del self._last_name[oldest.peer]
        self.statistics.evicted += 1
        if oldest.slot is not None and oldest.positions:
            self._commit(oldest, commits)
