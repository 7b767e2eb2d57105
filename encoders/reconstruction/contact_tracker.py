"""Tracks fingers in touch frames through drop-outs, changed ids, palms and noise.

A lost finger is kept for a moment, shifted with the others, and a new id close by inherits it:
touch screens lose and find resting fingers, and a grasp must survive that. The person did not lift
a touch that the system *cancelled*, so it is kept longer.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import expm1, inf

import numpy as np

from encoders.reconstruction.palms import Kind, PalmJudge
from models.arithmetic.arrays import Array
from models.arithmetic.products import distance, length
from models.frames import FINGERS, Contact, TouchFrame

PALM = "palm"
"""Why a contact is ignored that is none of a finger."""


JOINING = 0.2
"""s after which a finger with an extent may join a hand that is down. Before, a palm that begins to
grow slowly looks like a finger, and would push at once."""


@dataclass(frozen=True)
class TrackerSettings:
    """Settings of the contact tracker.

    Attributes:
        grace: s that a lost contact is kept.
        cancelled_grace: s that a cancelled contact is kept.
        inherit: m, largest distance from a lost contact at which a new id inherits it.
        low_pass: s, time constant of the smoothing of positions.
        blob: m, least contact diameter of a palm where only the diameter is known; smaller contacts
            are fingers.
        span: m, largest distance between two fingers of one hand.
    """

    grace: float = 0.15
    cancelled_grace: float = 0.35
    inherit: float = 0.025
    low_pass: float = 0.02
    blob: float = 0.035
    span: float = 0.24


@dataclass
class Track:
    """One finger followed through time.

    Attributes:
        id: Our id; it stays the same when the device gives the finger a new id.
        device_id: The device's id at present.
        place: (x, y) m, smoothed position on the surface.
        born: s, time when it came down.
        lost_at: s, time when the device lost it; None while it touches.
        grace: s that it is kept once lost.
        device_label: Finger according to the device, if it knows.
        unsure: True while it may still turn out to be a palm; it must get no label until then.
        joins: s, time from which on it may join a hand that is down.
    """

    id: int
    device_id: int
    place: tuple[float, float]
    born: float
    lost_at: float | None = None
    grace: float = 0.0
    device_label: int | None = None
    unsure: bool = False
    joins: float = -inf

    @property
    def xy(self) -> Array:
        """`place` as an array (2,), m."""
        return np.array(self.place)

    @property
    def active(self) -> bool:
        """True if the device currently reports it."""
        return self.lost_at is None


@dataclass
class ContactTracker:
    """Turns touch frames into at most five tracks of one hand.

    Attributes:
        tracks: Current tracks by our id, in the order in which they came down.
        ignored: Contacts of the last frame that are not fingers of this hand, for views.
        palms: Ids of those of them that are palms.
        counts: Number of ignored or repaired contacts, by reason.
    """

    settings: TrackerSettings = field(default_factory=TrackerSettings)
    tracks: dict[int, Track] = field(default_factory=dict)
    ignored: tuple[Contact, ...] = ()
    palms: frozenset[int] = frozenset()
    counts: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._next_id = 0
        self._time: float | None = None
        self._ignored_ids: dict[int, str] = {}
        self._judge = PalmJudge()

    def reset(self) -> None:
        """Forgets all tracks, but not the counts."""
        self.tracks, self.ignored, self._time = {}, (), None
        self.palms, self._ignored_ids = frozenset(), {}
        self._judge.reset()

    def step(self, frame: TouchFrame) -> None:
        """Processes the next frame; its time never runs backwards."""
        dt = 0.0 if self._time is None else max(frame.time - self._time, 0.0)
        self._time = frame.time
        seen = {c.id: c for c in frame.contacts}
        if self._ignored_ids:
            self._ignored_ids = {i: why for i, why in self._ignored_ids.items() if i in seen}
        self._drop_reused_ids(seen)
        self._judge.step(frame.time, frame.contacts)
        self._drop_palms(seen)
        by_device = {t.device_id for t in self.tracks.values()}

        lost, moves = False, []
        # A first-order low-pass, exact for a position held over the step.
        low_pass = self.settings.low_pass
        share = 1.0 if low_pass <= 0 else -expm1(-dt / low_pass)
        for track in self.tracks.values():
            contact = seen.get(track.device_id)
            if contact is None:
                lost = True
                if track.lost_at is None:
                    self._lose(track, frame)
            elif track.lost_at is not None:
                # The same id returns: devices that keep ids need no inheritance.
                self._find(track, contact, share)
            else:
                moved = self._follow(track, contact, share)
                if not track.unsure:
                    moves.append(moved)
        if lost and moves:
            right, down = np.mean(moves, axis=0).tolist()
            for track in self.tracks.values():
                if track.lost_at is not None:
                    x, y = track.place
                    track.place = x + right, y + down
        new = [c for i, c in seen.items() if i not in by_device and i not in self._ignored_ids]
        for contact in sorted(new, key=lambda c: c.id) if new else ():
            self._arrive(contact, frame.time, share)
        if lost:
            self._expire(frame.time)
        if self._ignored_ids or self.ignored:
            self.ignored = tuple(seen[i] for i in sorted(self._ignored_ids))
            self.palms = frozenset(i for i, why in self._ignored_ids.items() if why == PALM)

    def _drop_palms(self, seen: dict[int, Contact]) -> None:
        """Forgets fingers that turned out to be palms, and lets those come that had no room."""
        if not self._judge.judges:
            for track in self.tracks.values():
                track.unsure = False
            return
        dropped = False
        for track in list(self.tracks.values()):
            kind = self._judge.kind(track.device_id)
            track.unsure = track.unsure and kind is Kind.UNSURE
            if kind is Kind.PALM and track.device_id in seen:
                del self.tracks[track.id]
                self._ignored_ids[track.device_id] = PALM
                self._count(PALM)
                dropped = True
        for i, why in list(self._ignored_ids.items()):
            if why == PALM:
                continue
            if self._judge.kind(i) is Kind.PALM:
                self._ignored_ids[i] = PALM
                self._count(PALM)
            elif dropped:
                del self._ignored_ids[i]

    def _drop_reused_ids(self, seen: dict[int, Contact]) -> None:
        """Forgets lost fingers whose id the device has given to a contact in another place."""
        for track in list(self.tracks.values()):
            if track.lost_at is None:
                continue
            contact = seen.get(track.device_id)
            if contact is not None:
                way = distance(track.place, (contact.x, contact.y))
                if way > self.settings.inherit:
                    del self.tracks[track.id]

    def _follow(self, track: Track, contact: Contact, share: float) -> tuple[float, float]:
        """Moves a track a share of the way to its contact; returns the distance moved."""
        left, top = track.place
        x, y = left + share * (contact.x - left), top + share * (contact.y - top)
        track.place = x, y
        track.device_label = contact.label if contact.label is not None else track.device_label
        return x - left, y - top

    def _lose(self, track: Track, frame: TouchFrame) -> None:
        cancelled = track.device_id in frame.cancelled
        track.lost_at = frame.time
        track.grace = self.settings.cancelled_grace if cancelled else self.settings.grace
        self._count("cancelled" if cancelled else "lifted")

    def _find(self, track: Track, contact: Contact, share: float) -> None:
        track.device_id, track.lost_at = contact.id, None
        self._count("found again")
        self._follow(track, contact, share)

    def _arrive(self, contact: Contact, time: float, share: float) -> None:
        xy = np.array([contact.x, contact.y])
        why = self._reason_to_ignore(contact, xy)
        if why:
            self._ignored_ids[contact.id] = why
            self._count(why)
            return
        lost = [t for t in self.tracks.values() if not t.active]
        if lost and self.settings.grace > 0:
            nearest = min(lost, key=lambda t: (length(t.xy - xy), t.id))
            if length(nearest.xy - xy) <= self.settings.inherit:
                self._find(nearest, contact, share)
                return
        if len(self.tracks) >= len(FINGERS):
            # A sixth contact replaces a lost finger that is still kept.
            oldest = min(lost, key=lambda t: (t.lost_at, t.id))
            del self.tracks[oldest.id]
        self.tracks[self._next_id] = Track(
            self._next_id,
            contact.id,
            (contact.x, contact.y),
            time,
            device_label=contact.label,
            unsure=self._judge.kind(contact.id) is Kind.UNSURE,
            joins=-inf if contact.extent is None else time + JOINING,
        )
        self._next_id += 1

    def _reason_to_ignore(self, contact: Contact, xy: Array) -> str:
        """Reason why a new contact is not a finger of this hand; empty if it is one."""
        if contact.extent is not None:
            if self._judge.kind(contact.id) is Kind.PALM:
                return PALM
        elif contact.size is not None and contact.size > self.settings.blob:
            return PALM
        active = [t for t in self.tracks.values() if t.active]
        if len(active) >= len(FINGERS):
            return "more than five"
        if any(length(t.xy - xy) > self.settings.span for t in active):
            return "farther away than a hand reaches"
        return ""

    def _expire(self, time: float) -> None:
        lost = [t for t in self.tracks.values() if t.lost_at is not None]
        over = [t for t in lost if time - float(t.lost_at or 0.0) >= t.grace - 1e-9]
        # When no finger is left on the surface, all are dropped together: if each one were dropped
        # after its own grace, the last one would still squeeze and push the object aside.
        gone = lost if over and len(lost) == len(self.tracks) else over
        for track in gone:
            del self.tracks[track.id]

    def _count(self, what: str) -> None:
        self.counts[what] = self.counts.get(what, 0) + 1
