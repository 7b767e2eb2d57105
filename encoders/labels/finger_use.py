"""The finger sets that a person uses: as text, and as prior odds of labellings.

The same two touches may be those of a thumb and an index finger, or those of two neighbouring
fingers of a larger hand. The touches alone cannot decide between the two. A person can therefore
declare the finger sets in use as text, such as `thumb+index,thumb+index+middle:2`. The number after
a colon is the frequency of a set relative to the other sets.

For a hand with fewer fingers, such as a robot's, all sets of its fingers are in use.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from math import comb, isfinite, log

import numpy as np

from encoders.labels.labelling import finger_sets, hypotheses, set_of_labelling
from models.arithmetic import Array
from models.errors import InputError, unknown_name
from models.frames import FINGERS

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
