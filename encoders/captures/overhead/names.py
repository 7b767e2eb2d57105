"""Belief over the fingers of all contacts on the surface, from one look to the next.

A state is an assignment of different fingers to the contacts that are down: 120 of them at most.
Every look at the hand tells how far each contact is from each fingertip, and makes assignments more
or less likely. A contact that lands takes a free finger, each as likely; one that is lifted is
summed over. What is known of a contact is its finger's share of the belief.

Going forward gives names while a person touches; going forward and back gives what is known in the
end. Sums are in log space, in fixed order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from models.arithmetic import Array
from models.frames import FINGERS

MOST = len(FINGERS)
"""Contacts that are named at a time; what lands beyond them has no name."""


@dataclass(frozen=True)
class NamingRules:
    """Evidence that one look gives.

    Attributes:
        spread: m, standard deviation of a touch about the pad of its finger in the picture.
        tail: Degrees of freedom of Student's distribution: the lower, the less a far one says.
        look: s of looking that tells as much as one independent look; errors last.
        least: Least probability of a name; below it a contact is unnamed.
        reach: m, farthest median distance of a contact from its finger's pad.
    """

    spread: float = 0.005
    tail: float = 3.0
    look: float = 0.15
    least: float = 0.98
    reach: float = 0.02

    def evidence(self, off: Array) -> Array:
        """Logarithm of how likely distances (n, 5) m are, up to a constant; 0 where not known."""
        told = -0.5 * (self.tail + 2.0) * np.log1p((off / self.spread) ** 2 / self.tail)
        return np.where(np.isfinite(off).all(axis=-1, keepdims=True), told, 0.0)


@dataclass(frozen=True)
class _Belief:
    """Logarithms (P,) of the belief in assignments (P, n) of contacts in order."""

    contacts: tuple[int, ...]
    fingers: Array
    weight: Array


_NOTHING = _Belief((), np.zeros((1, 0), int), np.zeros(1))


class Belief:
    """Belief over the contacts that are down; one look after another.

    Args:
        rules: What a look tells.
    """

    def __init__(self, rules: NamingRules) -> None:
        self._rules = rules
        self._now = _NOTHING

    def update(self, off: Mapping[int, Array], seconds: float) -> None:
        """Takes in a look.

        Args:
            off: For each contact that is down, by its number: distances (5,) m from the fingers'
                pads; NaN where the hand is not seen.
            seconds: Time for which this look stands.
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
    """Probabilities (5,) of the fingers of every contact, from all looks.

    Args:
        looks: One after another, for each contact that is down, by its number: distances (5,) m.
        seconds: Time for which each look stands.
        rules: What a look tells.
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
        # The belief of the last look of a contact holds all there is to know about it.
        for contact, share in _shares(whole).items():
            shares.setdefault(contact, share)
        if i:
            told = _updated(after, looks[i], rules, seconds[i], before[i - 1].contacts)
            after = _back(told, before[i - 1])
    return shares


def _followed(now: _Belief, contacts: tuple[int, ...]) -> _Belief:
    """The belief after contacts were lifted and others have landed."""
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
    """Evidence of later looks for the assignments of an earlier one."""
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
    """The belief after a look; the first one at a contact, which was not known, is a whole look."""
    if not now.contacts:
        return now
    # A look after a long pause is one look, too.
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
    """The finger of probabilities (5,), or None in doubt."""
    finger = int(share.argmax())
    return finger if share[finger] >= rules.least else None
