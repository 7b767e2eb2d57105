"""Tables over the labellings of some contacts, from tables over the labellings of others."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from encoders.labels.label_evidence import normalised
from encoders.labels.labelling import hypotheses
from models.frames import FINGERS

Array = NDArray[np.float64]

LEAST = 1e-7
"""Probability below which no labelling falls, so that no mistake is ever final."""

_NEVER = 1e-300
"""Stands for the probability 0 in logarithms."""


@cache
def rows_of(count: int, places: tuple[int, ...]) -> NDArray[np.intp]:
    """(P,) for labellings of `count` contacts: the row in `hypotheses(len(places))` that gives the
    contacts at these places the same labels."""
    if not places:
        return np.zeros(len(hypotheses(count)), np.intp)
    weights = len(FINGERS) ** np.arange(len(places))
    row_of = np.full(int(weights[-1]) * len(FINGERS), -1, np.intp)
    row_of[hypotheses(len(places)) @ weights] = np.arange(len(hypotheses(len(places))))
    return row_of[hypotheses(count)[:, list(places)] @ weights]


def summed(log_weights: Array, count: int, places: Sequence[int]) -> Array:
    """Log weights of the labellings of some contacts, summed over the labels of the others.

    Args:
        log_weights: (P,) of the labellings of `count` contacts.
        count: Number of contacts.
        places: Of those to keep, in the order in which they are to stand.
    """
    if tuple(places) == tuple(range(count)):
        return log_weights
    if not places:
        return np.zeros(1)
    highest = log_weights.max()
    rows = rows_of(count, tuple(places))
    sums = np.bincount(rows, np.exp(log_weights - highest), len(hypotheses(len(places))))
    return np.asarray(highest + np.log(np.maximum(sums, _NEVER)))


def bounded(log_weights: Array) -> Array:
    """Log probabilities of which none is below the least."""
    return normalised(np.maximum(normalised(log_weights), np.log(LEAST)))
