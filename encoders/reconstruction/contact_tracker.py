"""Tracks fingers in touch frames through drop-outs, changed ids, palms and noise.

Touch screens lose resting fingers and find them again, and a grasp must survive this. A lost finger
is therefore remembered for a short time and shifted with the other fingers. A contact with a new id
that lands close to a lost finger continues it. A *cancelled* touch was ended by the system, not by
the person, and is remembered longer.

Palms are distinguished from fingers by the width, height, growth and position of contacts.

Only contacts with an extent (width and height) are judged in this way. For devices that report only
a diameter, `TrackerSettings.blob` is the limit. A judgement depends only on reports so far. Until
the judgement is certain, a contact is unsure and must get no label. A palm remains a palm until it
lifts; a finger may become a palm.

Size is the diameter of the circle of equal area. Fingertips have 5 to 28 mm, whether they land at
full size or flatten. Palms have 25 to 120 mm. Half of the palms begin as small as a fingertip and
grow for 0.1 to 0.4 s. A course is one such change of size in the first half second of a touch. The
odds of a palm compare the fit of a contact's reports to the best course of a palm with their fit to
the best course of a fingertip.

Position gives further odds. The heel of a resting hand lies well below its fingertips, whereas the
tip of the thumb is nearer to the other fingertips and higher. A small network with a layer of
rectifiers computes these odds. Its inputs are the number of other contacts, the distances and
directions of the nearest four and the outermost two, and their spread. It was trained on fingertips
and heels of simulated people; `python -m training palm_places` in a checkout writes its weights.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from itertools import product
from math import exp, expm1, inf, log
from pathlib import Path
from typing import NamedTuple

import numpy as np

from models.arithmetic import Array, distance, matrix_vector, small_product
from models.frames import FINGERS, Contact, TouchFrame

_LANDED, _DECIDED_BY = 0.10, 0.45
"""Times (s) after touch-down. From the first time on, a contact's position is used as well, since
the other fingers of a grip have landed. At the second time, the more likely kind is chosen. Even
the slowest growth of a palm is over by then, and a few more reports have arrived."""

_PALM_ODDS, _FINGER_ODDS = 4.0, -4.5
"""Limits of log-odds before `_DECIDED_BY`. A contact is a palm if its odds by size exceed the first
limit. It is a finger if its odds by size and position are below the second limit. Position does not
count for a palm during this time, since further fingers may land."""

_LATE_ODDS = 0.0
"""Log-odds by size and position above which a contact is a palm after `_DECIDED_BY`. Sizes of 25 to
28 mm, which both fingers and palms may have, give log-odds of -1.4."""

_CERTAIN = 8.0
"""Log-odds by size that no position can outweigh."""

_LARGE = 0.020
"""Least width or height (m) of a report with which a certain finger is judged again. Smaller
reports are skipped to save time."""

_ROUNDING = 1e-9
"""Tolerance (s) for times, which are sums of control periods."""

_GRID = 0.01
"""Step (s) of the times at which courses are tabulated."""

_LONGEST = 0.4
"""Longest time (s) in which a palm grows."""

_NOISE = 0.12
"""Standard deviation of the logarithm of a reported size. Errors of 15 % in width and in height
would give 11 %."""

_OUTLIER = 9.0
"""Limit of the squared deviation of a report, as a multiple of the noise's variance."""

_MEMORY = 0.5
"""Time (s) after which the weight of a report is 1/e, so that a finger may become a palm later."""

_REPEATED = 0.5
"""Weight of a report that is equal to the previous report. It shows that the contact does not grow,
but its noise is not independent."""

_GROWING = log(0.25)
"""Log prior of a course that grows, relative to a course with full size from the start. It
compensates for the choice of the best of about a dozen growing courses."""

_ONTO = (100.0, 150.0, 200.0, 250.0, 300.0, 400.0)
"""Durations (ms) of growth."""

_FINGERTIPS, _PALMS = (5.0, 28.0), (25.0, 120.0)
"""Sizes (mm) of fingertips and palms at rest."""

Place = tuple[float, float]

_FILE = Path(__file__).parents[1] / "data" / "palm_places.json"
"""File with the weights of the network: lists of numbers by name."""

_UNIT = 0.1
"""Unit (m) of the network's lengths."""

_NEAREST = 4
"""Number of nearest contacts that are separate inputs of the network."""

LARGEST = 4.0
"""Bound on the log-odds by position. Training on simulated people does not justify more certainty
about real people."""


class Kind(StrEnum):
    """Kinds of contacts."""

    UNSURE = "unsure"
    FINGER = "finger"
    PALM = "palm"


@dataclass
class _Judged:
    """Sizes of a contact, its current kind, and its last log-odds by size.

    `settled`: True if only a large report could change the judgement, and the last report was
    small.
    """

    course: SizeCourse
    kind: Kind = Kind.UNSURE
    odds: float = 0.0
    settled: bool = False

    def certain(self, time: float) -> bool:
        """True if only a large report can change anything."""
        if self.kind is Kind.PALM:
            return True
        late = time - self.course.began >= _DECIDED_BY
        return late and self.kind is Kind.FINGER and self.odds < -_CERTAIN


@dataclass
class PalmJudge:
    """Judges the contacts of one device, frame by frame."""

    _judged: dict[int, _Judged] = field(default_factory=dict)

    def reset(self) -> None:
        """Forgets all contacts."""
        self._judged = {}

    @property
    def judges(self) -> bool:
        """True if a contact that is down has an extent; without extents, all contacts are
        fingers."""
        return bool(self._judged)

    def kind(self, contact: int) -> Kind:
        """Kind of the contact with this id; a finger if it has no extent."""
        judged = self._judged.get(contact)
        return Kind.FINGER if judged is None else judged.kind

    def step(self, time: float, contacts: Iterable[Contact]) -> None:
        """Judges the contacts of the next frame.

        Args:
            time: Session time (s), which never runs backwards.
            contacts: All contacts that are down.
        """
        down = {c.id: c for c in contacts}
        if self._judged:
            self._judged = {i: judged for i, judged in self._judged.items() if i in down}
        for contact in down.values():
            if contact.extent is None:
                continue
            if contact.id not in self._judged:
                self._judged[contact.id] = _Judged(SizeCourse(time))
            judged = self._judged[contact.id]
            judged.settled = judged.certain(time) and max(contact.extent) < _LARGE
            if judged.settled:
                judged.course.pause(time)
            else:
                judged.course.report(time, contact.extent)
        for i in sorted(self._judged):
            judged = self._judged[i]
            if judged.kind is not Kind.PALM and not judged.settled:
                judged.kind = self._decision(judged, down[i], down, time)

    def _decision(
        self, judged: _Judged, contact: Contact, down: dict[int, Contact], time: float
    ) -> Kind:
        size = odds = judged.odds = judged.course.odds
        age = time - judged.course.began + _ROUNDING
        if age >= _LANDED and -_CERTAIN < size < _CERTAIN:
            others = [
                (c.x, c.y)
                for i, c in down.items()
                if i != contact.id and self.kind(i) is not Kind.PALM
            ]
            odds += place_odds((contact.x, contact.y), others)
        late = age >= _DECIDED_BY
        if odds > _LATE_ODDS if late else size > _PALM_ODDS:
            return Kind.PALM
        if late or odds < _FINGER_ODDS:
            return Kind.FINGER
        return judged.kind


class _Course(NamedTuple):
    """Change from one size to another (mm) within a time (ms)."""

    first: float
    last: float
    takes: float
    palm: bool

    def size(self, time: float) -> float:
        """Size (mm) at a time (s) after touch-down."""
        share = 1.0 if self.takes <= 0 else min(1000.0 * time / self.takes, 1.0)
        return self.first + share * (self.last - self.first)

    @property
    def prior(self) -> float:
        """Log prior: the density of the last size, and `_GROWING` for a course that grows."""
        low, high = _PALMS if self.palm else _FINGERTIPS
        return -log(high - low) + (_GROWING if self.takes else 0.0)


def _courses() -> list[_Course]:
    tips = [5.0, 6.0, 7.0, 8.0, 9.0, *(float(d) for d in range(10, 29))]
    palms = [25.0, 26.0, 27.0, 28.0, 29.0, 31.0, 33.0, 36.0, 40.0, 45.0, 52.0, 60.0, 70.0, 85.0]
    courses = [_Course(d, d, 0.0, False) for d in tips]
    courses += [_Course(d, d, 0.0, True) for d in (*palms, 100.0, 120.0)]
    small = (6.0, 8.0, 10.0, 12.5, 15.0, 18.0, 21.0)
    courses += [
        _Course(first, last, takes, False)
        for first, last, takes in product(small, tips[6::2], _ONTO)
        if last >= 1.2 * first
    ]
    courses += [
        _Course(first, last, takes, True)
        for first, last, takes in product(small[1:], palms[::2], _ONTO)
        if last >= 1.2 * first
    ]
    return courses


_ALL = _courses()
_IS_PALM = np.array([c.palm for c in _ALL])
_PRIOR = np.array([c.prior for c in _ALL])
_TIMES = round(_LONGEST / _GRID) + 1
_LOG_SIZES = np.array([[log(c.size(_GRID * t)) for c in _ALL] for t in range(_TIMES)])
"""Logarithms (times, courses) of sizes in mm."""

_LEAST, _MOST = log(_FINGERTIPS[0]), log(_PALMS[1])
"""Logarithms of the least and greatest size in mm."""


class SizeCourse:
    """The reports of one contact's size so far.

    Args:
        began: Time of touch-down (s).

    Attributes:
        began: Time of touch-down (s).
    """

    def __init__(self, began: float) -> None:
        self.began = began
        self._time = began
        self._misfit: Array = np.zeros(len(_ALL))
        self._last: tuple[float, float] | None = None

    def report(self, time: float, extent: tuple[float, float]) -> None:
        """Adds a report of the width and height (m) at a time (s)."""
        weight = _REPEATED if extent == self._last else 1.0
        size = 0.5 * (log(1000.0 * extent[0]) + log(1000.0 * extent[1]))
        # A size outside all courses counts as the smallest or largest of them.
        size = min(max(size, _LEAST), _MOST)
        row = min(round((time - self.began) / _GRID), _TIMES - 1)
        off = (_LOG_SIZES[row] - size) / _NOISE
        kept = exp(-(time - self._time) / _MEMORY)
        self._misfit = kept * self._misfit + weight * np.minimum(off * off, _OUTLIER)
        self._time, self._last = time, extent

    def pause(self, time: float) -> None:
        """Skips a report; the weight of earlier reports does not decrease over the skipped time."""
        self._time = time

    @property
    def odds(self) -> float:
        """Log-odds of a palm against a fingertip, by the contact's sizes alone."""
        fit = _PRIOR - 0.5 * self._misfit
        return float(fit[_IS_PALM].max(initial=-inf) - fit[~_IS_PALM].max(initial=-inf))


@cache
def _weights() -> dict[str, Array]:
    """The shipped weights: `first` (hidden, inputs), `bias` (hidden,), `second` (hidden,) and
    `constant` (1,)."""
    return {name: np.array(values) for name, values in json.loads(_FILE.read_text()).items()}


def place_inputs(place: Place, others: Sequence[Place]) -> list[float]:
    """The network's inputs (23,).

    Args:
        place: Position (x, y) m on the surface, y down, for a right hand that touches from below.
        others: Positions of the other contacts, one or more.
    """
    x, y = place
    order = sorted(others, key=lambda other: (distance(place, other), other))
    inputs = [len(order) / _NEAREST]
    for i in range(_NEAREST):
        if i < len(order):
            right, down = order[i]
            away = distance(place, order[i]) / _UNIT
            inputs += [1.0, (x - right) / _UNIT, (y - down) / _UNIT, away]
        else:
            inputs += [0.0, 0.0, 0.0, 0.0]
    for right, down in (min(order), max(order)):
        inputs += [(x - right) / _UNIT, (y - down) / _UNIT]
    for axis in (0, 1):
        along = [other[axis] for other in order]
        inputs.append((max(along) - min(along)) / _UNIT)
    return inputs


def place_odds(place: Place, others: Sequence[Place]) -> float:
    """Log-odds of a palm against a fingertip, by the contact's position alone; 0 without other
    contacts. See `place_inputs`."""
    if not others:
        return 0.0
    w = _weights()
    hidden = matrix_vector(w["first"], np.array(place_inputs(place, others))) + w["bias"]
    odds = float(small_product(w["second"], np.maximum(hidden, 0.0)) + w["constant"][0])
    return min(max(odds, -LARGEST), LARGEST)


PALM = "palm"
"""Reason for ignoring a contact that is no finger."""


JOINING = 0.2
"""Time (s) after touch-down from which on a contact with an extent may join a hand that is down. A
slowly growing palm looks like a finger before this time, and would push objects at once."""


@dataclass(frozen=True)
class TrackerSettings:
    """Settings of the contact tracker.

    Attributes:
        grace: Time (s) for which a lost contact is remembered.
        cancelled_grace: Time (s) for which a cancelled contact is remembered.
        inherit: Largest distance (m) of a new contact from a lost contact that it continues.
        low_pass: Time constant (s) of the smoothing of positions; 0 switches it off.
        blob: Contact diameter (m) above which a contact is a palm, for devices that report only the
            diameter.
        span: Largest distance (m) between two fingers of one hand.
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
        id: Id of the track; it stays the same when the device gives the finger a new id.
        device_id: The device's current id of the finger.
        place: (x, y) m, smoothed position on the surface.
        born: Time (s) when the finger came down.
        lost_at: Time (s) when the device lost the finger; None while it touches.
        grace: Time (s) for which the finger is remembered after its loss.
        device_label: Label given by the device; None without such a label.
        unsure: True while the contact may still be a palm; it must get no label meanwhile.
        joins: Time (s) from which on the finger may join a hand that is down.
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
    def active(self) -> bool:
        """True if the device currently reports the finger."""
        return self.lost_at is None


@dataclass
class ContactTracker:
    """Turns touch frames into at most five tracks of one hand.

    Attributes:
        tracks: Current tracks by their ids, in the order in which the fingers came down.
        ignored: Contacts of the last frame that are not fingers of this hand, for display.
        palms: Ids of the ignored contacts that are palms.
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
                # The device reports a lost finger again, with the same id.
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
        """Forgets fingers that turned out to be palms. Ignored contacts may then become fingers."""
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
        """Moves a track a share of the way to its contact; returns this movement (x, y) m."""
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
        place = contact.x, contact.y
        why = self._reason_to_ignore(contact)
        if why:
            self._ignored_ids[contact.id] = why
            self._count(why)
            return
        lost = [t for t in self.tracks.values() if not t.active]
        if lost and self.settings.grace > 0:
            nearest = min(lost, key=lambda t: (distance(t.place, place), t.id))
            if distance(nearest.place, place) <= self.settings.inherit:
                self._find(nearest, contact, share)
                return
        if len(self.tracks) >= len(FINGERS):
            # A sixth contact replaces the finger that was lost first and is still remembered.
            oldest = min(lost, key=lambda t: (t.lost_at, t.id))
            del self.tracks[oldest.id]
        self.tracks[self._next_id] = Track(
            self._next_id,
            contact.id,
            place,
            time,
            device_label=contact.label,
            unsure=self._judge.kind(contact.id) is Kind.UNSURE,
            joins=-inf if contact.extent is None else time + JOINING,
        )
        self._next_id += 1

    def _reason_to_ignore(self, contact: Contact) -> str:
        """Reason why a new contact is not a finger of this hand; empty if it is."""
        if contact.extent is not None:
            if self._judge.kind(contact.id) is Kind.PALM:
                return PALM
        elif contact.size is not None and contact.size > self.settings.blob:
            return PALM
        active = [t for t in self.tracks.values() if t.active]
        if len(active) >= len(FINGERS):
            return "more than five"
        if any(distance(t.place, (contact.x, contact.y)) > self.settings.span for t in active):
            return "farther away than a hand reaches"
        return ""

    def _expire(self, time: float) -> None:
        lost = [t for t in self.tracks.values() if t.lost_at is not None]
        over = [t for t in lost if time - float(t.lost_at or 0.0) >= t.grace - 1e-9]
        # When no finger is left on the surface, all tracks are dropped together. If each were
        # dropped after its own grace, the last finger would still press and push the object aside.
        gone = lost if over and len(lost) == len(self.tracks) else over
        for track in gone:
            del self.tracks[track.id]

    def _count(self, what: str) -> None:
        self.counts[what] = self.counts.get(what, 0) + 1
