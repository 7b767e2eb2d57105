"""Uncertainty of means: the paper's standard error, and confidence intervals over takes.

Frames of one take depend on each other. The standard error that treats them as independent is too
small by a factor of five or more; it is computed only because the paper prints it. The intervals
resample whole takes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array

RESAMPLES = 2000
LEVEL = 0.95


def standard_error(values: Array) -> float:
    """Standard error of the mean if all values were independent; 0 for a single value."""
    values = np.ravel(values)
    if len(values) < 2:
        return 0.0
    return float(values.std(ddof=1) / np.sqrt(len(values)))


def block_interval(
    values: Array, block: NDArray[np.int64], resamples: int = RESAMPLES, seed: int = 0
) -> tuple[float, float]:
    """Interval of the mean by a bootstrap over blocks.

    As many blocks as there are, drawn with replacement, give one resampled mean; a long block
    counts for as many values as it has. The interval covers the variation between takes and days of
    one subject, but not between subjects.

    Args:
        values: (T,) values.
        block: (T,) block of every value; values of one block are drawn together.
        resamples: Number of resampled means.
        seed: Seed; equal arguments give equal intervals.

    Returns:
        Lower and upper end of the central 95 %; NaN with fewer than two blocks, which do not show
        how much blocks differ.
    """
    blocks, index = np.unique(block, return_inverse=True)
    if len(blocks) < 2:
        return float("nan"), float("nan")
    counts = np.bincount(index).astype(float)
    sums = np.bincount(index, np.asarray(values, float))
    picks = np.random.default_rng(seed).integers(0, len(counts), (resamples, len(counts)))
    means = sums[picks].sum(axis=1) / counts[picks].sum(axis=1)
    tail = 50.0 * (1.0 - LEVEL)
    low, high = np.percentile(means, [tail, 100.0 - tail])
    return float(low), float(high)
