"""Tracking of the touches of all TUIO 1.1 and 2.0 senders over time.

TUIO has no messages for touch-down and touch-up. A touch begins with the first position of an alive
id, and ends when its id is missing from the list of alive ids. Each source and profile has its own
state and frame counter, so frames of different senders are never compared.

A source is identified by host and name. Two senders of one host may have the same name, or none;
then their ports differ. But some libraries send every packet from another port. So a packet from a
new port belongs to the source whose frames it continues. If it continues none, it belongs to a new
source. A source may move to a new port, and packets then arrive from its former port again. Such a
source was two senders, and each gets its own touches back.

A program that sends both versions, or over two transports, reports every finger twice. Two such
sources of one host are one sender if all their touches have the same positions; the touches then
count once.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import NamedTuple

from models.reader_report import ReaderReport
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
"""Decrease of a TUIO 1.1 frame counter above which the sender was restarted (as in the reference
clients). After a smaller decrease, the packet is late: a later packet has overtaken it."""

RESTART_FRAMES = 4
"""Number of consecutive frames with increasing numbers that show a restart of a counter that has
decreased: some senders count only to 63 or 255. A late packet comes alone."""

RECONNECTION = 0.25
"""Time (s) in which a sender whose connection has ended may reconnect without losing touches."""

RESTART_TIME = 1.0
"""After this time (s) without a frame, a decrease of a TUIO 2.0 counter means a restart."""

ID_STRIDE = 2**32
"""Offset between the ids of two sources, as ids are int32 and unique per source only."""


class Touch(NamedTuple):
    """An alive touch.

    `id` is unique among all sources. x, y, width and height are in 0..1 of the surface. `label` is
    the finger, 0 (thumb) to 4. Width, height and label are None if the sender does not report them.
    """

    id: int
    x: float
    y: float
    width: float | None = None
    height: float | None = None
    label: int | None = None


@dataclass(slots=True, eq=False)
class TuioSource:
    """The state of one sender.

    Attributes:
        name: Name that the sender sends.
        peer: Network address of the packets: host and port, and before them the transport if it is
            not UDP.
        version: Version of the protocol, `1.1` or `2.0`.
        heard: Time of the last packet, s.
        turn: Serial number of its last message, counted over the messages of all sources.
        stale: True if the source has been silent for too long.
        left: True if its connection has ended.
        slot: Number of the source among those with touches; None before its first touch.
        places: Positions of the alive touches, by id.
        open: Unclosed frame by profile.
        before: State of the source before it moved to its present port; None if it never moved.
        twin: Another source that reports the same touches and is shown in place of this source;
            None without such a source.
    """

    name: str
    peer: str
    version: str
    heard: float
    turn: int = 0
    stale: bool = False
    left: bool = False
    slot: int | None = None
    places: dict[int, TuioPlace] = field(default_factory=dict)
    open: dict[str, TuioFrame] = field(default_factory=dict)
    before: TuioSource | None = None
    twin: TuioSource | None = None
    _settled: bool = False
    _alive: dict[str, tuple[int, ...]] = field(default_factory=dict)
    _numbers: dict[str, int] = field(default_factory=dict)
    _behind: dict[str, tuple[int, int]] = field(default_factory=dict)
    _counted_at: float = 0.0
    _blobs: dict[int, TuioPlace] = field(default_factory=dict)

    @property
    def host(self) -> str:
        """`peer` without the port."""
        return _without_port(self.peer)

    def continues(self, frame: TuioFrame | None) -> bool:
        """True if a packet from another port of the same host comes from this source.

        Args:
            frame: First frame about touches in the packet; None if the packet has none.
        """
        wanders = self.before is not None
        if self._settled or frame is None:
            return wanders and not self._settled
        if self.open or frame.number is None:
            return wanders or bool(self.open)
        mine, alive = self._alive.get(frame.profile, ()), frame.alive or ()
        shared = not set(mine).isdisjoint(alive)
        last = self._numbers.get(frame.profile)
        if frame.number <= 0 or last is None:
            return shared or wanders or not (mine and alive)
        step = frame.number - last
        if wanders:
            return abs(step) <= RESTART_GAP  # including overtaken packets
        return step == 1 or (0 <= step <= RESTART_GAP and (shared or not (mine or alive)))

    def moved(self, peer: str) -> TuioSource:
        """Returns the same source at another port."""
        self.before = None
        return replace(
            self,
            peer=peer,
            before=self,
            open=dict(self.open),
            _alive=dict(self._alive),
            _numbers=dict(self._numbers),
            _behind=dict(self._behind),
        )

    def settle(self) -> TuioSource:
        """Marks the source as one that always sends from its own port; returns it."""
        self._settled, self.slot, self.twin = True, None, None
        return self

    def late(self, frame: TuioFrame, now: float) -> str:
        """Returns why a closed frame is late; if it is not, stores its number and returns ""."""
        number, last = frame.number, self._numbers.get(frame.profile)
        if number is None or number <= 0:  # no number (usually -1, in 2.0 0): never late
            return ""
        if last is not None and number < last:
            recent = now - self._counted_at < RESTART_TIME
            if recent if frame.profile == POINTERS else last - number <= RESTART_GAP:
                before, count = self._behind.get(frame.profile, (number, 0))
                count = count + 1 if number > before else 1
                self._behind[frame.profile] = number, count
                if count < RESTART_FRAMES:
                    return f"frame {number} came after {last}"
        self._behind.pop(frame.profile, None)
        self._numbers[frame.profile], self._counted_at = number, now
        return ""

    def completes(self, frame: TuioFrame) -> bool:
        """True if a part without `alv` belongs to the last closed frame."""
        return bool(frame.number) and frame.number == self._numbers.get(frame.profile)

    def commit(self, frame: TuioFrame, report: ReaderReport) -> None:
        """Updates the alive touches from a closed frame."""
        if frame.alive is not None:
            self._alive[frame.profile] = frame.alive
        alive = self._alive.get(frame.profile)
        if alive is None:
            report.assume(f"{self.name or self.host} lists no living touches; each frame has all")
            alive = tuple(frame.places)
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
        """Marks the source as stale: it shows no touches, and loses counters and unclosed frames.

        Positions stay stored, because a resting finger may be alive in the next frame.
        """
        self.stale, self.slot, self.twin = True, None, None
        self.open.clear()
        self._numbers.clear()
        self._behind.clear()

    def touches(self) -> Iterable[Touch]:
        """Yields the alive touches; none while the source shows none."""
        if self.slot is None:
            return
        # A sender that labels every pointer as a right index finger cannot distinguish fingers.
        times = Counter(place.label for place in self.places.values())
        for touch, place in self.places.items():
            size = (place.width, place.height) if place.width else self._size(place)
            label = place.label if times[place.label] == 1 else None
            yield Touch(touch + self.slot * ID_STRIDE, place.x, place.y, *size, label)

    def _size(self, place: TuioPlace) -> tuple[float | None, float | None]:
        """Returns width and height of the blob around a cursor, found by position.

        Ids of cursors and blobs need not match.
        """
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
"""Largest number of sources; if there are more, the one with the oldest packet is removed."""

MAX_TOUCHES = 128
"""Largest number of touches of all sources in one frame, to bound the memory."""


SAME_PLACE = 0.002
"""Distance below which touches of two sources are the same touch, in widths of the surface; 0.4 mm
on a tablet."""


class Commit(NamedTuple):
    """A committed frame: the name of its source, and the touches of all sources at that time.

    `cancelled` has the ids of touches that ended because their sender disconnected.
    """

    source: str
    touches: tuple[Touch, ...]
    cancelled: frozenset[int] = frozenset()


@dataclass(slots=True)
class Statistics:
    """Counters of packets, frames and problems.

    Malformed: packets of which parts, or all, could not be read. Late: frames that arrived after a
    later frame. Unfinished: frames that were never closed. Ignored: messages of other profiles and
    programs. Evicted: sources removed to make room. Surplus: touches beyond `MAX_TOUCHES`. Dropped:
    frames that were not polled in time. Refused: connections that were refused.
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

    def count_malformed(self, reason: str) -> None:
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
        stale_after: Time (s) without a packet after which a source's touches are lifted. The
            protocol has no such rule; without it, a finger whose last packet is lost would stay
            down forever. The time must not be short, because a resting finger may send nothing.
    """

    def __init__(self, stale_after: float = 2.0) -> None:
        self.statistics = Statistics()
        self.report = ReaderReport()
        self._stale_after = stale_after
        self._sources: list[TuioSource] = []
        self._turn = 0

    @property
    def sources(self) -> tuple[SourceStatus, ...]:
        """Status of all senders, in order of appearance."""
        return tuple(
            SourceStatus(
                s.name,
                s.peer,
                0 if s.slot is None else len(s.places),
                s.heard,
                s.stale,
                s.version,
            )
            for s in self._sources
        )

    def feed(self, data: bytes, peer: str, now: float) -> list[Commit]:
        """Processes a packet from a network address; malformed parts are left out."""
        self.statistics.packets += 1
        before = self.report.left_out.copy()
        try:
            packet = decode(data, self.report)
        except MalformedPacket as error:
            self.statistics.count_malformed(str(error))
            self.report.leave_out(f"packets: {error.what}")
            return []
        frames, names, ignored = read_frames(packet, self.report)
        pointers, also_ignored = read_frames20(packet, self.report)
        if wrong := self.report.left_out - before:
            self.statistics.count_malformed(", ".join(wrong))
        self._count_ignored([a for a in ignored if not _is_tuio20(a)] + also_ignored)
        commits: list[Commit] = []
        if not packet.messages:
            # An empty bundle shows that its sender is still running.
            for source in self._sources:
                if source.peer == peer and not source.stale:
                    source.heard = now
        for frame in frames:
            source = self._hear(peer, frame.source, "1.1", frame, now, commits)
            self._apply(frame, source, packet, now, commits)
        for name in names:  # a packet without touches also shows that the sender is running
            self._hear(peer, name, "1.1", None, now, commits)
        for frame in pointers:
            if frame.source is None and self._find(peer, None, "2.0", frame) is None:
                self.statistics.unfinished += 1  # of an unknown source
                continue
            source = self._hear(peer, frame.source, "2.0", frame, now, commits)
            self._apply_pointers(frame, source, now, commits)
        return commits

    def expire(self, now: float) -> list[Commit]:
        """Ends the touches of sources that have been silent for too long.

        They are lifted; touches of a sender whose connection has ended are cancelled.
        """
        commits: list[Commit] = []
        for source in [s for s in self._sources if not s.stale]:
            if now > source.heard + self._stale_after:
                self._end(source, commits)
        return commits

    def end(self) -> list[Commit]:
        """Cancels the touches of senders whose connection has ended and that will not return."""
        commits: list[Commit] = []
        for source in [s for s in self._sources if s.left]:
            self._end(source, commits)
        return commits

    def _end(self, source: TuioSource, commits: list[Commit]) -> None:
        """Lifts the touches of a silent source; cancels them if its connection has ended."""
        shown = frozenset(touch.id for touch in source.touches())
        if source.left:
            self._forget(source)
        else:
            source.silence()
            self._part(source)
        if shown:
            self._commit(source, commits, shown if source.left else frozenset())

    def disconnect(self, peer: str, now: float) -> None:
        """Processes the end of a connection.

        Touches are cancelled only after `RECONNECTION`, since some senders connect for every
        packet.
        """
        for source in [s for s in self._sources if s.peer == peer]:
            if source.slot is None:
                self._forget(source)
            source.left = True
            source.heard = min(source.heard, now - self._stale_after + RECONNECTION)

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
        if part.source is None:  # messages without a bundle, or the rest of a bundle
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
        """Updates the source from a closed frame; ignores a late frame and returns False."""
        reason = source.late(frame, now)
        if reason:
            self.statistics.late += 1
            self.statistics.late_reason = reason
            return False
        source.commit(frame, self.report)
        return True

    def _commit(
        self, source: TuioSource, commits: list[Commit], cancelled: frozenset[int] = frozenset()
    ) -> None:
        present = source in self._sources
        if present:
            self._find_twin(source)
        if source.twin is not None:
            return
        if present and source.slot is None and source.places and not source.stale:
            taken = {s.slot for s in self._sources}
            source.slot = next(slot for slot in range(MAX_SOURCES) if slot not in taken)
        shown = [s for s in self._sources if s.slot is not None]
        surplus = sum(len(s.places) for s in shown) - MAX_TOUCHES
        if surplus > 0:
            self.statistics.surplus += surplus
            shown.sort(key=lambda s: s is not source)  # the sending source is never left out
        touches = islice((touch for s in shown for touch in s.touches()), MAX_TOUCHES)
        self.statistics.frames += 1
        commits.append(Commit(source.name, tuple(touches), cancelled))

    def _find_twin(self, source: TuioSource) -> None:
        """Finds another source of the same host that reports the same touches.

        The touches of version 2.0 are shown, since they have more data. If only version 1.1 was
        shown before, version 2.0 takes over its slot, so that the ids of the touches do not change.
        """
        if source.twin is not None or source.stale or not source.places:
            return
        for other in self._sources:
            kinds = {(s.version, s.host) for s in (source, other)}
            if (
                len(kinds) == 2
                and other.twin is None
                and not other.stale
                and _bare(source.host) == _bare(other.host)
                and _same_places(source.places, other.places)
            ):
                shown, hidden = sorted((source, other), key=lambda s: s.version, reverse=True)
                if shown.slot is None:
                    shown.slot = hidden.slot
                hidden.slot, hidden.twin = None, shown
                self.report.assume(
                    f"{shown.name or shown.host} sends every touch twice; each counts once"
                )
                return

    def _hear(
        self,
        peer: str,
        name: str | None,
        version: str,
        frame: TuioFrame | None,
        now: float,
        commits: list[Commit],
    ) -> TuioSource:
        """Returns the source of a message, a new one if necessary, and marks it as running.

        A message without a name belongs to the last source at its address.
        """
        source = self._find(peer, name, version, frame)
        if source is None:
            if len(self._sources) >= MAX_SOURCES:
                self._evict(commits)
            source = TuioSource(name or "", peer, version, now)
            self._sources.append(source)
        elif source.peer != peer:
            source = self._at_new_port(source, peer)
        if name is not None:
            # Senders may send a few bundles before the first one with their name.
            source.name = name
        self._turn += 1
        source.heard, source.turn, source.stale, source.left = now, self._turn, False, False
        return source

    def _find(
        self, peer: str, name: str | None, version: str, frame: TuioFrame | None
    ) -> TuioSource | None:
        """Finds the source of a message, perhaps with another port; None if it is unknown.

        Args:
            peer: Address of the packet.
            name: Name of the source; None if the message has none.
            version: Version of the protocol.
            frame: The frame; None for a message that is not about touches.
        """
        sources = [s for s in self._sources if s.version == version]
        here = [s for s in sources if s.peer == peer]
        if name is None and here:
            return max(here, key=lambda s: s.turn)
        named = [s for s in sources if name is None or s.name in (name, "")]
        found = [s for s in here if s.name == name] or [s for s in here if s.name == ""]
        host = _without_port(peer)
        found = found or [
            s
            for s in named
            if s.host == host
            and (s.continues(frame) or (s.before is not None and s.before.peer == peer))
        ]
        return max(found, key=lambda s: s.turn, default=None)

    def _at_new_port(self, source: TuioSource, peer: str) -> TuioSource:
        """Moves a source to another port of its host.

        If `peer` is the port from which the source had moved, there are two senders: the former
        source is restored and returned.
        """
        index = self._sources.index(source)
        if source.before is not None and source.before.peer == peer:
            back, source.before = source.before.settle(), None
            self._sources.append(back)
            return back
        moved = self._sources[index] = source.moved(peer)
        self._part(source, moved)
        source.slot = None
        return moved

    def _evict(self, commits: list[Commit]) -> None:
        oldest = min(self._sources, key=lambda source: source.heard)
        self._forget(oldest)
        self.statistics.evicted += 1
        if oldest.slot is not None and oldest.places:
            self._commit(oldest, commits)

    def _forget(self, source: TuioSource) -> None:
        self._sources.remove(source)
        self._part(source)

    def _part(self, source: TuioSource, heir: TuioSource | None = None) -> None:
        """Replaces a source by `heir` (or None) as the `twin` of other sources."""
        for other in self._sources:
            if other.twin is source:
                other.twin = heir


def _without_port(peer: str) -> str:
    """Transport and host of a network address."""
    host, _, port = peer.rpartition(":")
    return host if port.isdigit() else peer


def _bare(host: str) -> str:
    """Returns a host without its transport."""
    return host.rpartition(" ")[2]


def _same_places(some: Mapping[int, TuioPlace], others: Mapping[int, TuioPlace]) -> bool:
    """True if two sources have touches at the same positions.

    Two fingers of different senders cannot be at the same position.
    """
    return len(some) == len(others) and all(
        any(max(abs(a.x - b.x), abs(a.y - b.y)) < SAME_PLACE for b in others.values())
        for a in some.values()
    )


def _is_tuio20(address: str) -> bool:
    """True if messages of this address belong to the decoder of TUIO 2.0."""
    return address.startswith("/tuio2/")
