"""Tracking of the touches of all TUIO 1.1 and 2.0 senders over time.

TUIO has no messages for touch-down and touch-up: a touch begins with the first position of a living
id and ends when its id is missing from the list of living ids. State and counters are kept per
source and profile, so that frames of one sender are not taken as late because of another's counter.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple

from sandbox.devices.tuio.osc import MalformedPacket, Packet, decode
from sandbox.devices.tuio.tuio_frames import (
    BLOBS,
    POINTERS,
    TuioFrame,
    TuioPlace,
    read_frames,
    read_frames20,
)

RESTART_GAP = 100
"""Fall of a TUIO 1.1 frame counter above which the sender was restarted (as in the reference
clients); a smaller fall means that a packet was overtaken."""

RESTART_TIME = 1.0
"""s after the last frame from which on a fall of a TUIO 2.0 counter means a restarted sender."""

ID_STRIDE = 2**32
"""Offset between the ids of two sources, as ids are int32 and unique per source only."""


class Touch(NamedTuple):
    """A living touch: an id unique among all sources, x and y in 0..1 of the surface.

    Width and height are in 0..1 of the surface too; `label` is the finger, 0 (thumb) to 4. They are
    None if the sender does not report them.
    """

    id: int
    x: float
    y: float
    width: float | None = None
    height: float | None = None
    label: int | None = None


@dataclass(slots=True)
class TuioSource:
    """The state of one sender.

    Attributes:
        name: Name that it sends.
        peer: Network address of its packets.
        version: Version of the protocol, `1.1` or `2.0`.
        heard: s, time of its last packet.
        stale: True if it has been silent for too long.
        slot: Number among the sources with touches; None before its first touch.
        places: Positions of its living touches, by id.
        open: Unclosed frame by profile.
    """

    name: str
    peer: str
    version: str
    heard: float
    stale: bool = False
    slot: int | None = None
    places: dict[int, TuioPlace] = field(default_factory=dict)
    open: dict[str, TuioFrame] = field(default_factory=dict)
    _alive: dict[str, tuple[int, ...]] = field(default_factory=dict)
    _numbers: dict[str, int] = field(default_factory=dict)
    _counted_at: float = 0.0
    _blobs: dict[int, TuioPlace] = field(default_factory=dict)

    def late(self, frame: TuioFrame, now: float) -> str:
        """Reason why a closed frame is late; empty if it is in time, and its number is stored."""
        number, last = frame.number, self._numbers.get(frame.profile)
        if number is None or number <= 0:  # unnumbered, usually -1, in 2.0 0: never late
            return ""
        if last is not None and number < last:
            recent = now - self._counted_at < RESTART_TIME
            if recent if frame.profile == POINTERS else last - number <= RESTART_GAP:
                return f"frame {number} came after {last}"
        self._numbers[frame.profile], self._counted_at = number, now
        return ""

    def completes(self, frame: TuioFrame) -> bool:
        """True if a part without `alv` belongs to the frame that was closed last."""
        return bool(frame.number) and frame.number == self._numbers.get(frame.profile)

    def commit(self, frame: TuioFrame) -> None:
        """Updates the living touches from a closed frame."""
        if frame.alive is not None:
            self._alive[frame.profile] = frame.alive
        alive = self._alive.get(frame.profile, ())
        if frame.profile == BLOBS:
            blobs = self._blobs | frame.places
            self._blobs = {blob: blobs[blob] for blob in alive if blob in blobs}
            return
        known = self.places | frame.places
        sizes = {touch: (p.width, p.height) for touch, p in self.places.items()} | frame.sizes
        self.places = {}
        for touch in alive:
            if touch in known:
                # Bounds are not sent again while they do not change.
                width, height = sizes.get(touch, (None, None))
                self.places[touch] = known[touch]._replace(width=width, height=height)

    def silence(self) -> None:
        """Marks it stale: removes its touches, counters and unclosed frames.

        The positions are kept, because a finger that only rested is alive in the next frame.
        """
        self.stale, self.slot = True, None
        self.open.clear()
        self._numbers.clear()

    def touches(self) -> Iterable[Touch]:
        """The living touches, none while the source is silent."""
        if self.slot is None:
            return
        # A sender that labels every pointer as a right index finger does not know fingers.
        times = Counter(place.label for place in self.places.values())
        for touch, place in self.places.items():
            size = (place.width, place.height) if place.width else self._size(place)
            label = place.label if times[place.label] == 1 else None
            yield Touch(touch + self.slot * ID_STRIDE, place.x, place.y, *size, label)

    def _size(self, place: TuioPlace) -> tuple[float | None, float | None]:
        """Width and height of the blob around a cursor; ids need not match, as senders differ."""
        nearest = 1.0
        size: tuple[float | None, float | None] = (None, None)
        for blob in self._blobs.values():
            if blob.width is None or blob.height is None:
                continue
            reach = 0.5 * max(blob.width, blob.height)
            away = max(abs(place.x - blob.x), abs(place.y - blob.y)) / reach
            if away <= nearest:
                nearest, size = away, (blob.width, blob.height)
        return size


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
