"""Measures the time of one pose, called from Python on this machine."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter_ns

import numpy as np

from models.arithmetic import Array

BATCH = 120
"""Number of poses in a batch: the number of labellings of five contacts."""
BUDGET = 0.5
"""s spent on each of the two measurements."""
MOST = 3000
"""Largest number of measured calls, enough for a median."""


def us_per_call(predict: Callable[[Array], Array], U: Array) -> float:
    """Median time (microseconds) of predicting one frame of inputs (T, width), called singly."""
    predict(U[0])
    spent: list[int] = []
    end = perf_counter_ns() + int(1e9 * BUDGET)
    while len(spent) < MOST and (not spent or perf_counter_ns() < end):
        u = U[len(spent) % len(U)]
        start = perf_counter_ns()
        predict(u)
        spent.append(perf_counter_ns() - start)
    return float(np.median(spent)) / 1e3


def us_in_batch(predict: Callable[[Array], Array], U: Array, batch: int = BATCH) -> float:
    """Median time (microseconds) of one pose of a batch of inputs (T, width)."""
    rows = np.ascontiguousarray(U[np.arange(batch) % len(U)])
    predict(rows)
    spent: list[int] = []
    end = perf_counter_ns() + int(1e9 * BUDGET)
    while len(spent) < MOST and (not spent or perf_counter_ns() < end):
        start = perf_counter_ns()
        predict(rows)
        spent.append(perf_counter_ns() - start)
    return float(np.median(spent)) / 1e3 / batch
