"""Statistics of the columns of a data set, by which learners scale what they read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from models.arithmetic import Array

QUANTILES = (0.01, 0.10, 0.50, 0.90, 0.99)
"""The quantiles that LeRobot keeps, as q01, q10 and so on."""

Statistics = dict[str, Array]
"""Name -> (n,) values: min, max, mean, std, the quantiles, and the number of rows as count (1,)."""


def statistics_of(values: Array) -> Statistics:
    """Statistics of every column of (T, n) values."""
    return {
        "min": values.min(axis=0),
        "max": values.max(axis=0),
        "mean": values.mean(axis=0),
        "std": values.std(axis=0),
        "count": np.array([len(values)]),
        **dict(zip(map(_name, QUANTILES), np.quantile(values, QUANTILES, axis=0), strict=True)),
    }


def combined(parts: Sequence[Statistics]) -> Statistics:
    """Statistics of several episodes together.

    Quantiles are the means of those of the episodes, weighted by their lengths, as LeRobot has
    them; everything else is exact.
    """
    counts = np.array([part["count"][0] for part in parts], float)
    share = (counts / counts.sum())[:, None]
    means = np.array([part["mean"] for part in parts])
    mean = (share * means).sum(axis=0)
    squares = np.array([part["std"] for part in parts]) ** 2 + (means - mean) ** 2
    return {
        "min": np.min([part["min"] for part in parts], axis=0),
        "max": np.max([part["max"] for part in parts], axis=0),
        "mean": mean,
        "std": np.sqrt((share * squares).sum(axis=0)),
        "count": np.array([int(counts.sum())]),
        **{
            name: (share * np.array([part[name] for part in parts])).sum(axis=0)
            for name in map(_name, QUANTILES)
        },
    }


def _name(quantile: float) -> str:
    return f"q{round(100 * quantile):02d}"
