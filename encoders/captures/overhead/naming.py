"""Labels the contacts of a recording from the fingertips in the camera's pictures.

A belief over the fingers of all contacts on the surface is updated from sample to sample.

A state assigns different fingers to the contacts that are down; there are at most 120 states. Every
sample has the distance of each contact from each finger's pad. These distances make states more or
less likely. A contact that lands takes any free finger with equal probability. A contact that lifts
is summed out. The probability that a finger makes a contact is the sum over all states that assign
this finger to the contact.

The forward pass labels contacts while a person touches. The forward and backward passes together
label them from the whole recording. Sums are taken in log space and in fixed order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from encoders.captures.conversion.fingers import LabelledTrack
from encoders.captures.conversion.touch_log import ContactTrack
from encoders.captures.overhead.picture_track import LAST_JOINTS, TIPS, PictureTrack
from encoders.captures.overhead.tablet_plane import Moment, TabletPlane
from models.arithmetic import Array
from models.frames import FINGERS

MOST = len(FINGERS)
"""Largest number of contacts that are labelled at a time; further contacts get no label."""


@dataclass(frozen=True)
class NamingRules:
    """Rules that turn a sample of distances into evidence for fingers.

    Attributes:
        spread: Standard deviation (m) of a touch about the pad of its finger in the picture.
        tail: Degrees of freedom of Student's t-distribution. With fewer degrees of freedom, large
            distances have less weight.
        look: Time (s) in which all samples together count as one independent sample, since errors
            of the camera persist from picture to picture.
        least: Least probability at which a contact gets a label.
        reach: Largest median distance (m) of a contact from its finger's pad.
    """

    spread: float = 0.005
    tail: float = 3.0
    look: float = 0.15
    least: float = 0.98
    reach: float = 0.02

    def evidence(self, off: Array) -> Array:
        """Log likelihoods (n, 5) of distances (n, 5) m, up to a constant; 0 in rows with NaN."""
        told = -0.5 * (self.tail + 2.0) * np.log1p((off / self.spread) ** 2 / self.tail)
        return np.where(np.isfinite(off).all(axis=-1, keepdims=True), told, 0.0)


@dataclass(frozen=True)
class _Belief:
    """Log weights (P,) of assignments (P, n): each row has the fingers of n contacts in order."""

    contacts: tuple[int, ...]
    fingers: Array
    weight: Array


_NOTHING = _Belief((), np.zeros((1, 0), int), np.zeros(1))


class Belief:
    """Belief over the fingers of the contacts that are down, updated sample by sample.

    Args:
        rules: Rules that turn a sample into evidence.
    """

    def __init__(self, rules: NamingRules) -> None:
        self._rules = rules
        self._now = _NOTHING

    def update(self, off: Mapping[int, Array], seconds: float) -> None:
        """Updates the belief with a sample.

        Args:
            off: Contact number -> distances (5,) m from the fingers' pads, for each contact that is
                down; NaN where the hand is not seen.
            seconds: Time (s) that this sample represents.
        """
        before = self._now.contacts
        self._now = _followed(self._now, tuple(off))
        self._now = _updated(self._now, off, self._rules, seconds, before)

    def names(self) -> dict[int, Array]:
        """Probabilities (5,) of the fingers of each contact that is down."""
        return _shares(self._now)


def names_of(
    looks: Sequence[Mapping[int, Array]], seconds: Sequence[float], rules: NamingRules
) -> dict[int, Array]:
    """Probabilities (5,) of the fingers of every contact, from all samples.

    Args:
        looks: Samples in order of time: contact number -> distances (5,) m from the fingers' pads,
            for each contact that is down.
        seconds: Time (s) that each sample represents.
        rules: Rules that turn a sample into evidence.
    """
    before: list[_Belief] = []
    now = _NOTHING
    for off, long in zip(looks, seconds, strict=True):
        now = _updated(_followed(now, tuple(off)), off, rules, long, now.contacts)
        before.append(now)
    shares: dict[int, Array] = {}
    after = _Belief(before[-1].contacts, before[-1].fingers, np.zeros(len(before[-1].weight)))
    for i in range(len(looks) - 1, -1, -1):
        here = before[i]
        whole = _Belief(here.contacts, here.fingers, here.weight + after.weight)
        # The belief at a contact's last sample contains all evidence about the contact.
        for contact, share in _shares(whole).items():
            shares.setdefault(contact, share)
        if i:
            told = _updated(after, looks[i], rules, seconds[i], before[i - 1].contacts)
            after = _back(told, before[i - 1])
    return shares


def _followed(now: _Belief, contacts: tuple[int, ...]) -> _Belief:
    """The belief after some contacts lifted and others landed."""
    kept = [c for c in now.contacts if c in contacts]
    new = [c for c in contacts if c not in now.contacts][: MOST - len(kept)]
    if len(kept) == len(now.contacts) and not new:
        return now
    columns = [now.contacts.index(c) for c in kept]
    merged: dict[tuple[int, ...], list[float]] = {}
    for fingers, weight in zip(now.fingers.tolist(), now.weight.tolist(), strict=True):
        merged.setdefault(tuple(fingers[k] for k in columns), []).append(weight)
    rows, weights = [], []
    for fingers, terms in merged.items():
        free = [f for f in range(len(FINGERS)) if f not in fingers]
        for more in permutations(free, len(new)):
            rows.append((*fingers, *more))
            weights.append(_log_sum(np.array(terms)))
    fingers = np.array(rows, int).reshape(len(rows), len(kept) + len(new))
    return _Belief((*kept, *new), fingers, _scaled(np.array(weights)))


def _back(later: _Belief, earlier: _Belief) -> _Belief:
    """Evidence of later samples for the assignments of an earlier sample."""
    if earlier.contacts == later.contacts:
        return later
    shared = [c for c in earlier.contacts if c in later.contacts]
    here = [earlier.contacts.index(c) for c in shared]
    there = [later.contacts.index(c) for c in shared]
    told: dict[tuple[int, ...], list[float]] = {}
    for fingers, weight in zip(later.fingers.tolist(), later.weight.tolist(), strict=True):
        told.setdefault(tuple(fingers[k] for k in there), []).append(weight)
    sums = {key: _log_sum(np.array(terms)) for key, terms in told.items()}
    weights = [sums[tuple(fingers[k] for k in here)] for fingers in earlier.fingers.tolist()]
    return _Belief(earlier.contacts, earlier.fingers, _scaled(np.array(weights)))


def _updated(
    now: _Belief,
    off: Mapping[int, Array],
    rules: NamingRules,
    seconds: float,
    known: tuple[int, ...],
) -> _Belief:
    """The belief after a sample.

    The first sample of a contact counts as one independent sample. A later sample counts as the
    share of `rules.look` that it represents.

    Args:
        now: The belief before the sample, with the same contacts.
        off: Contact number -> distances (5,) m from the fingers' pads.
        rules: Rules that turn a sample into evidence.
        seconds: Time (s) that the sample represents.
        known: Contacts that had a sample before.
    """
    if not now.contacts:
        return now
    # A sample after a long pause counts as one sample, not more.
    again = min(seconds / rules.look, 1.0)
    looks = np.array([[again if c in known else 1.0] for c in now.contacts])
    evidence = looks * rules.evidence(np.array([off[c] for c in now.contacts]))
    weight = now.weight.copy()
    for column, row in enumerate(evidence):
        weight = weight + row[now.fingers[:, column]]
    return _Belief(now.contacts, now.fingers, _scaled(weight))


def _shares(now: _Belief) -> dict[int, Array]:
    share = np.exp(now.weight - now.weight.max())
    share = share / share.sum()
    return {
        contact: np.bincount(now.fingers[:, column], share, len(FINGERS)).astype(float)
        for column, contact in enumerate(now.contacts)
    }


def _scaled(weight: Array) -> Array:
    return np.asarray(weight - weight.max())


def _log_sum(terms: Array) -> float:
    top = float(terms.max())
    return top + float(np.log(np.exp(terms - top).sum()))


def chosen(share: Array, rules: NamingRules) -> int | None:
    """The most probable finger of probabilities (5,); None if it is below `rules.least`."""
    finger = int(share.argmax())
    return finger if share[finger] >= rules.least else None


LOOK = 1.0 / 30.0
"""Interval (s) between two samples of a recording."""


@dataclass(frozen=True)
class NamedContact:
    """A contact, labelled from the camera's pictures.

    Attributes:
        track: The contact.
        share: (5,) probabilities of the fingers.
        finger: Label, thumb 0 to little 4; None if the contact has no label.
        distance: Median distance (m) from the most probable finger's pad; NaN where the hand was
            not seen.
        why: Reason why the contact has no label; empty if it has a label.
    """

    track: ContactTrack
    share: Array
    finger: int | None
    distance: float
    why: str

    def labelled(self) -> LabelledTrack | None:
        """The contact with its finger; None if it has no label."""
        return (
            None if self.finger is None else LabelledTrack(self.track, self.finger, self.distance)
        )


def moments_of(
    tracks: Sequence[ContactTrack], pictures: PictureTrack, offset: float, gap: float
) -> list[Moment]:
    """Hand landmarks and touches of the same moments, at the times of the pictures.

    Args:
        tracks: Contacts.
        pictures: Landmarks of the hand in the pictures.
        offset: Pictures' clock minus touches' clock (s).
        gap: Longest time (s) between two samples of a contact that is interpolated.
    """
    moments = []
    for row, time in enumerate((pictures.time - offset).tolist()):
        down = [t for t in tracks if t.start <= time < t.end][:MOST]
        if down:
            xy = np.array([t.at(np.array([time]), gap)[0] for t in down])
            image = pictures.image[row]
            moments.append(Moment(image[list(TIPS)], image[list(LAST_JOINTS)], xy))
    return moments


def name_contacts(
    tracks: Sequence[ContactTrack],
    pictures: PictureTrack,
    plane: TabletPlane,
    offset: float,
    gap: float,
    rules: NamingRules,
) -> list[NamedContact]:
    """Labels contacts with fingers.

    Args:
        tracks: Contacts, in order of touch-down.
        pictures: Landmarks of the hand in the pictures.
        plane: Location of the surface in the picture.
        offset: Pictures' clock minus touches' clock (s).
        gap: Longest time (s) between two samples of a contact that is interpolated.
        rules: Rules that turn a sample into evidence.
    """
    looks: list[dict[int, Array]] = []
    seconds: list[float] = []
    every: list[list[Array]] = [[] for _ in tracks]
    for time in _times(tracks):
        down = [n for n, t in enumerate(tracks) if t.start <= time < t.end]
        if not down:
            continue
        pads, known = _pads(pictures, plane, np.array([time + offset]))
        off: dict[int, Array] = {}
        for n in down:
            xy = tracks[n].at(np.array([time]), gap)[0]
            row = np.linalg.norm(pads[0] - xy, axis=1) if known[0] else _UNKNOWN
            off[n] = row
            every[n].append(row)
        looks.append(off)
        seconds.append(LOOK)
    shares = names_of(looks, seconds, rules) if looks else {}
    named = []
    for n, track in enumerate(tracks):
        share = shares.get(n)
        rows = np.array(every[n]) if every[n] else _UNKNOWN[None]
        named.append(_judged(track, share, rows, rules))
    return named


_UNKNOWN = np.full(len(FINGERS), np.nan)


def _judged(
    track: ContactTrack, share: Array | None, off: Array, rules: NamingRules
) -> NamedContact:
    seen = off[np.isfinite(off).all(axis=1)]
    equal = np.full(len(FINGERS), 1.0 / len(FINGERS))
    if share is None:
        return NamedContact(track, equal, None, np.nan, "more than five touches at a time")
    if not len(seen):
        return NamedContact(track, share, None, np.nan, "the hand was not in the picture")
    finger = chosen(share, rules)
    near = float(np.median(seen[:, int(share.argmax())]))
    if near > rules.reach:
        why = f"no fingertip within {1000 * rules.reach:g} mm"
        return NamedContact(track, share, None, near, why)
    if finger is None:
        return NamedContact(track, share, None, near, "two fingers are about as near")
    return NamedContact(track, share, finger, near, "")


def _pads(
    pictures: PictureTrack, plane: TabletPlane, times: Array
) -> tuple[Array, NDArray[np.bool_]]:
    image, known = pictures.between(pictures.image, times)
    return plane.pads(image[:, TIPS], image[:, LAST_JOINTS]), known


def _times(tracks: Sequence[ContactTrack]) -> list[float]:
    """Sample times (s): a grid with the step `LOOK`, and the starts of shorter contacts."""
    if not tracks:
        return []
    begin, end = min(t.start for t in tracks), max(t.end for t in tracks)
    times = (begin + LOOK * np.arange(int((end - begin) / LOOK) + 1)).tolist()
    short = [t.start for t in tracks if t.end - t.start < LOOK]
    return sorted({*times, *short})
