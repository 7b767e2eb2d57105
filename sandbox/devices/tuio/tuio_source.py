"""State of one TUIO sender: its living touches, counters and unclosed frames."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from sandbox.devices.tuio.tuio11_frames import BLOBS
from sandbox.devices.tuio.tuio20_frames import POINTERS
from sandbox.devices.tuio.tuio_values import TuioFrame, TuioPlace

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
