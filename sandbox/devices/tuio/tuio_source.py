"""One sender of TUIO: its living touches, its counters, and what it has not said to the end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from sandbox.devices.tuio.tuio11_frames import BLOBS
from sandbox.devices.tuio.tuio20_frames import POINTERS
from sandbox.devices.tuio.tuio_values import Frame, Place

RESTART_GAP = 100
"""A counter of TUIO 1.1 that falls by more than this many frames is a sender that began anew (as
the reference clients have it); by less, a packet that was overtaken on its way."""

RESTART_TIME = 1.0
"""s. A counter of TUIO 2.0 that falls so long after the last frame is a sender that began anew."""

ID_STRIDE = 2**32
"""Ids are int32 and unique per source only; each further source at work is moved by this much."""


class Touch(NamedTuple):
    """A living touch: an id unique among all sources, x and y in 0..1 of the surface.

    Width and height are in 0..1 of the surface too; `label` is the finger, 0 (thumb) to 4. Both
    are None where the sender does not tell.
    """

    id: int
    x: float
    y: float
    width: float | None = None
    height: float | None = None
    label: int | None = None


@dataclass(slots=True)
class Source:
    """The state of one sender.

    Attributes:
        name: As it calls itself.
        peer: Where its packets come from.
        version: Of the protocol, `1.1` or `2.0`.
        heard: Time of its last packet, s.
        stale: It has been silent for too long.
        slot: Numbers the sources that have had touches; None while it has none.
        places: Of its living touches.
        open: By profile, the frame that it has not closed yet.
    """

    name: str
    peer: str
    version: str
    heard: float
    stale: bool = False
    slot: int | None = None
    places: dict[int, Place] = field(default_factory=dict)
    open: dict[str, Frame] = field(default_factory=dict)
    _alive: dict[str, tuple[int, ...]] = field(default_factory=dict)
    _numbers: dict[str, int] = field(default_factory=dict)
    _counted_at: float = 0.0
    _blobs: dict[int, Place] = field(default_factory=dict)

    def late(self, frame: Frame, now: float) -> str:
        """Why a closed frame was overtaken by a later one, if it was; else it is counted."""
        number, last = frame.number, self._numbers.get(frame.profile)
        if number is None or number <= 0:  # usually -1; of 2.0: 0. Applies in any case
            return ""
        if last is not None and number < last:
            recent = now - self._counted_at < RESTART_TIME
            if recent if frame.profile == POINTERS else last - number <= RESTART_GAP:
                return f"frame {number} came after {last}"
        self._numbers[frame.profile], self._counted_at = number, now
        return ""

    def completes(self, frame: Frame) -> bool:
        """Whether a part without `alv` belongs to the frame that was closed last."""
        return bool(frame.number) and frame.number == self._numbers.get(frame.profile)

    def commit(self, frame: Frame) -> None:
        """Brings a frame into force."""
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
                # Bounds are not sent again as long as they stay as they are.
                width, height = sizes.get(touch, (None, None))
                self.places[touch] = known[touch]._replace(width=width, height=height)

    def silence(self) -> None:
        """Takes its touches away, and all that a later packet could be wrongly compared with.

        The places are kept: a finger that only rested is alive in the next frame.
        """
        self.stale, self.slot = True, None
        self.open.clear()
        self._numbers.clear()

    def touches(self) -> Iterable[Touch]:
        """The living touches, none while the source is silent."""
        if self.slot is None:
            return
        # A sender that calls every pointer a right index finger does not know fingers.
        times = Counter(place.label for place in self.places.values())
        for touch, place in self.places.items():
            size = (place.width, place.height) if place.width else self._size(place)
            label = place.label if times[place.label] == 1 else None
            yield Touch(touch + self.slot * ID_STRIDE, place.x, place.y, *size, label)

    def _size(self, place: Place) -> tuple[float | None, float | None]:
        """Of the blob that a cursor lies in. Some senders give both the same id, others do not."""
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
