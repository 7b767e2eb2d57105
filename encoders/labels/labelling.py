"""Contract of labellers, the labellings that they choose from, and log weights over these.

k contacts can be labelled in P(5, k) = 5! / (5 - k)! ways: 5, 20, 60, 120, 120 for 1 to 5 contacts.
A labeller chooses one of them: by a belief over all (`encoders.labels.belief`), or by the paper's
rule (`encoders.labels.paper`).

The same two touches may be those of a thumb and an index finger, or those of two neighbouring
fingers of a larger hand. The touches alone cannot decide between the two. A person can therefore
declare the finger sets in use as text, such as `thumb+index,thumb+index+middle:2`. The number after
a colon is the frequency of a set relative to the other sets. The sets become log factors on the
labellings. For a hand with fewer fingers, such as a robot's, all sets of its fingers are in use.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import combinations, permutations
from math import comb, fsum, isfinite, log
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from models import arithmetic
from models.arithmetic import Array
from models.errors import EncoderError, InputError, unknown_name
from models.frames import FINGERS

Labels = NDArray[np.int64]

LEAST = 1e-7
"""Lower bound of a labelling's probability, so that every mistake can be corrected."""

_NEVER = 1e-300
"""Probability that stands for 0, so that its logarithm is finite."""


@dataclass(frozen=True)
class Labelling:
    """The fingers of all contacts.

    Attributes:
        labels: Contact id -> finger (thumb 0 to little 4); no finger occurs twice. Read-only, since
            labellers may return the same object again.
        probability: Probability of all labels together, 0 to 1.
        chances: Function that returns the probabilities (5,) of the fingers by contact id; None if
            only the probability of all labels together is known.
    """

    labels: Mapping[int, int]
    probability: float
    chances: Callable[[], Mapping[int, Array]] | None = field(
        default=None, compare=False, repr=False
    )

    @cached_property
    def label_probabilities(self) -> Mapping[int, float]:
        """Probability of the label of each contact, 0 to 1, summed over the labels of all other
        contacts. If `chances` is None, the probability of all labels together."""
        if self.chances is None:
            return dict.fromkeys(self.labels, self.probability)
        chances = self.chances()
        return {i: float(chances[i][label]) for i, label in self.labels.items()}


class Labeller(Protocol):
    """Contract of labellers, which are called whenever the set of contacts has changed.

    Attributes:
        remembers: True for a labeller with history, which may be called at every frame.
    """

    @property
    def remembers(self) -> bool: ...

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        """Labels all contacts.

        Args:
            contacts: Position (x, y) m on the surface, x right and y down, by id; 1 to 5 contacts.
            fixed: Labels by contact id that must not change, as for a hand that is already down.
                The remaining contacts get the remaining fingers.

        Raises:
            EncoderError: Contacts or fixed labels do not follow this description.
        """

    def reset(self) -> None:
        """Forgets all contacts, as when the hand has left the surface."""

    def restart(self) -> None:
        """Returns to the state at the beginning of a trial."""


@cache
def hypotheses(count: int) -> Labels:
    """All labellings (P, count) of `count` contacts, in lexicographic order; read-only.

    Raises:
        EncoderError: The count is not 1 to 5.
    """
    if count not in range(1, len(FINGERS) + 1):
        raise EncoderError(
            "a hand cannot make this number of contacts", got=count, expected="1 to 5 contacts"
        )
    table = np.array(list(permutations(range(len(FINGERS)), count)), np.int64)
    table.flags.writeable = False
    return table


def true_row(labels: NDArray[np.intp]) -> int:
    """Row of `hypotheses(k)` in which the contacts have these labels (k,)."""
    return int(np.flatnonzero((hypotheses(len(labels)) == labels).all(axis=1))[0])


@cache
def finger_sets(count: int) -> tuple[tuple[int, ...], ...]:
    """All sets of `count` fingers, in lexicographic order."""
    return tuple(combinations(range(len(FINGERS)), count))


@cache
def set_of_labelling(count: int) -> NDArray[np.intp]:
    """Index (P,) in `finger_sets(count)` of the fingers of every labelling of
    `hypotheses(count)`."""
    number = {finger_set: i for i, finger_set in enumerate(finger_sets(count))}
    return np.array([number[tuple(sorted(row))] for row in hypotheses(count).tolist()], np.intp)


def arranged(
    contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
) -> tuple[tuple[int, ...], Array]:
    """Ids and positions (k, 2) of contacts in an order that depends on their positions alone.

    The order is from left to right, so that results depend neither on the order in which a device
    lists contacts nor on its ids.

    Raises:
        EncoderError: Contacts or fixed labels are not as `Labeller.assign` expects them.
    """
    if not 1 <= len(contacts) <= len(FINGERS):
        raise EncoderError(
            "a hand cannot make this number of contacts",
            got=len(contacts),
            expected="1 to 5 contacts",
        )
    ids = tuple(sorted(contacts, key=lambda i: (*contacts[i], i)))
    xy = np.array([contacts[i] for i in ids], float)
    if xy.shape != (len(ids), 2) or not np.isfinite(xy).all():
        raise EncoderError(
            "contacts must have finite positions", got=xy.tolist(), expected="(x, y) in metres"
        )
    strangers = [i for i in fixed if i not in contacts]
    given = list(fixed.values())
    if strangers or len(set(given)) < len(given) or not set(given) <= set(range(len(FINGERS))):
        raise EncoderError(
            "fixed labels do not fit the contacts",
            got=dict(fixed),
            expected=f"different fingers 0 to 4 for ids among {sorted(contacts)}",
        )
    return ids, xy


def allowed(ids: tuple[int, ...], fixed: Mapping[int, int]) -> NDArray[np.bool_]:
    """Booleans (P,): True for the labellings of the contacts that agree with the fixed labels."""
    table = hypotheses(len(ids))
    keeps = np.ones(len(table), bool)
    for place, contact in enumerate(ids):
        if contact in fixed:
            keeps &= table[:, place] == fixed[contact]
    return keeps


@cache
def rows_of(count: int, places: tuple[int, ...]) -> NDArray[np.intp]:
    """For each of the P labellings of `count` contacts: the row (P,) of `hypotheses(len(places))`
    that has the labels of the contacts at `places`."""
    if not places:
        return np.zeros(len(hypotheses(count)), np.intp)
    weights = len(FINGERS) ** np.arange(len(places))
    row_of = np.full(int(weights[-1]) * len(FINGERS), -1, np.intp)
    row_of[hypotheses(len(places)) @ weights] = np.arange(
        len(hypotheses(len(places)))
    )  # any order: whole numbers
    return row_of[hypotheses(count)[:, list(places)] @ weights]  # any order: whole numbers


def summed(log_weights: Array, count: int, places: Sequence[int]) -> Array:
    """Marginalises log weights of labellings over the contacts that are dropped.

    Args:
        log_weights: (P,) log weights of the labellings of `count` contacts.
        count: Number of contacts.
        places: Indices of the contacts to keep, in their new order.
    """
    if tuple(places) == tuple(range(count)):
        return log_weights
    if not places:
        return np.zeros(1)
    highest = log_weights.max()
    rows = rows_of(count, tuple(places))
    sums = np.bincount(rows, arithmetic.exp(log_weights - highest), len(hypotheses(len(places))))
    return np.asarray(highest + arithmetic.log(np.maximum(sums, _NEVER)))


def normalised(log_weights: Array) -> Array:
    """Normalises logarithms of weights (P,) to logarithms of probabilities that sum to 1."""
    shifted = log_weights - log_weights.max()
    return shifted - log(fsum(arithmetic.exp(shifted).tolist()))


def bounded(log_weights: Array) -> Array:
    """Raises log probabilities to at least log(`LEAST`), and normalises them."""
    return normalised(np.maximum(normalised(log_weights), log(LEAST)))


PARTIAL = 0.02
"""Number of frames in which only some fingers of a set are down, relative to the number of frames
in which all are down. It is assumed: fingers that land together land within a tenth of a second,
and stay down for seconds."""

IMPOSSIBLE = -700.0
"""Log weight of labels that a hand cannot have; its exponential is above 0."""

EXAMPLE = "thumb+index,thumb+index+middle"


LogOdds = tuple[Array | None, ...]
"""Log factors (P,) on the labellings of 0 to 5 contacts; None stands for a factor of 1."""


def odds_of_sets(
    sets: Mapping[tuple[int, ...], float], usual: Mapping[tuple[int, ...], float]
) -> LogOdds:
    """Log factors that turn the usual odds of labellings into the odds for declared finger sets.

    With more contacts than the largest set has fingers, all fingers may touch.

    Args:
        sets: Set of fingers (thumb 0 to little 4, in rising order) -> likelihood above 0. Only the
            ratios of the likelihoods count.
        usual: Usual odds of finger sets relative to other sets of as many fingers; 1 for sets that
            are not listed.
    """
    return tuple(_odds_of_sets(sets, usual, count) for count in range(len(FINGERS) + 1))


def _odds_of_sets(
    sets: Mapping[tuple[int, ...], float], usual: Mapping[tuple[int, ...], float], count: int
) -> Array | None:
    if count == 0 or count > max(len(s) for s in sets):
        return None
    if count == 1:
        used = np.isin(hypotheses(1)[:, 0], sorted({f for s in sets for f in s}))
        return np.where(used, 0.0, IMPOSSIBLE)
    factors = []
    for finger_set in finger_sets(count):
        odds = sets.get(finger_set, 0.0) / usual.get(finger_set, 1.0)
        for larger, weight in sets.items():
            if set(finger_set) < set(larger):
                odds += PARTIAL * weight / comb(len(larger), count)
        factors.append(log(odds) if odds > 0.0 else IMPOSSIBLE)
    return np.array(factors)[set_of_labelling(count)]


@cache
def odds_of_first(number: int) -> LogOdds:
    """Log factors for a hand, such as a robot's, that has only the first fingers from the thumb on.

    With more contacts than fingers, all fingers may touch.

    Args:
        number: Number of fingers, 1 to 5.
    """
    return tuple(
        None
        if not 1 <= count <= number < len(FINGERS)
        else np.where((hypotheses(count) >= number).any(axis=1), IMPOSSIBLE, 0.0)
        for count in range(len(FINGERS) + 1)
    )


def parse_finger_sets(text: str) -> dict[tuple[int, ...], float]:
    """Parses a text such as `thumb+index:2,thumb+index+middle` to likelihoods by set of fingers.

    Raises:
        InputError: A name is not a finger's, a finger or a set occurs twice, or a likelihood is not
            a number above 0.
    """
    sets: dict[tuple[int, ...], float] = {}
    for part in text.split(","):
        names, _, likelihood = part.partition(":")
        labels = sorted(_finger(name.strip()) for name in names.split("+"))
        if len(set(labels)) < len(labels):
            raise _wrong("a finger is listed twice in a set", part)
        if tuple(labels) in sets:
            raise _wrong("a set of fingers is listed twice", part)
        try:
            weight = float(likelihood) if likelihood else 1.0
        except ValueError:
            raise _wrong("the likelihood of a set must be a number", part) from None
        if not (isfinite(weight) and weight > 0.0):
            raise _wrong("the likelihood of a set must be above 0", part)
        sets[tuple(labels)] = weight
    return sets


def _finger(name: str) -> int:
    if name not in FINGERS:
        raise unknown_name("no such finger", name, FINGERS, where="finger_sets")
    return FINGERS.index(name)


def _wrong(problem: str, part: str) -> InputError:
    return InputError(
        problem, where="finger_sets", got=part.strip(), expected=f"sets such as {EXAMPLE}"
    )
