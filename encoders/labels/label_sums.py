"""Converts tables over the labellings of one set of contacts to those of another."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import fsum, log

import numpy as np
from numpy.typing import NDArray

from encoders.labels.labelling import hypotheses
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.frames import FINGERS

LEAST = 1e-7
"""Lower bound of a labelling's probability, so that every mistake can be corrected."""

_NEVER = 1e-300
"""Stands for the probability 0 in logarithms."""


@cache
def rows_of(count: int, places: tuple[int, ...]) -> NDArray[np.intp]:
    """Row (P,) in `hypotheses(len(places))` with the same labels of the contacts at these places,
    for every labelling of `count` contacts."""
    if not places:
        return np.zeros(len(hypotheses(count)), np.intp)
    weights = len(FINGERS) ** np.arange(len(places))
    row_of = np.full(int(weights[-1]) * len(FINGERS), -1, np.intp)
    row_of[hypotheses(len(places)) @ weights] = np.arange(
        len(hypotheses(len(places)))
    )  # any order: whole numbers
    return row_of[hypotheses(count)[:, list(places)] @ weights]  # any order: whole numbers


def summed(log_weights: Array, count: int, places: Sequence[int]) -> Array:
    """Sums log weights of labellings over the labels of the contacts that are dropped.

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
    sums = np.bincount(rows, functions.exp(log_weights - highest), len(hypotheses(len(places))))
    return np.asarray(highest + functions.log(np.maximum(sums, _NEVER)))


def normalised(log_weights: Array) -> Array:
    """Normalises logarithms of weights (P,) to logarithms of probabilities that sum to 1."""
    shifted = log_weights - log_weights.max()
    return shifted - log(fsum(functions.exp(shifted).tolist()))


def bounded(log_weights: Array) -> Array:
    """Limits log probabilities to the lower bound, and normalises them."""
    return normalised(np.maximum(normalised(log_weights), log(LEAST)))
