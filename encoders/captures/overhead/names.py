"""Belief over the fingers of all contacts on the surface, updated from sample to sample.

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
