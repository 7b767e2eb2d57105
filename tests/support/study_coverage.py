"""Intervals of a study's report, where the truth is known.

Each study is written as tables, read again, and analysed as `sandbox study report` does it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.study.report.models.censored import (
    Censored,
    censored_differences,
    fit_censored,
)
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import load_study
from sandbox.study.report.models.mixed import Mixed, fit_mixed, mixed_differences
from sandbox.study.report.models.success import success_differences
from tests.support.planted_study import Truth, true_success, write_study

FIRST, SECOND = "a", "c"
"""The planted pair that is compared."""

TIMES, SEEN, SHARES = "time, all trials", "time, successes only", "success, shares"

SCENARIOS = {
    "effects, and trials without success": Truth(),
    "effects, every trial succeeds": Truth(limit=3600.0, losses=(1e-9, 1e-9, 1e-9)),
    "no effects": Truth(times=(8.5, 8.5, 8.5), losses=(0.012, 0.012, 0.012)),
}


@dataclass(frozen=True)
class Told:
    """Result of one study for the pair: covers the truth, p < 0.05."""

    covers: bool
    found: bool


def studies(truth: Truth, count: int, mixed: bool = True) -> Iterator[dict[str, Told]]:
    """Makes and analyses studies.

    Args:
        truth: What they follow.
        count: How many.
        mixed: With the mixed model, which takes longest.
    """
    i, j = truth.levels.index(FIRST), truth.levels.index(SECOND)
    ratio = truth.log_ratio(i, j)
    shares = true_success(truth)
    # Equal rates have equal shares, whatever was drawn.
    gain = shares[j] - shares[i] if ratio or truth.losses[i] != truth.losses[j] else 0.0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(count):
            write_study(Path(folder), truth, seed)
            yield _told(Path(folder), ratio, gain, mixed)


def _told(folder: Path, ratio: float, gain: float, mixed: bool) -> dict[str, Told]:
    data = load_study(folder)
    told = {}
    model = fit_censored(data)
    assert isinstance(model, Censored), model
    d = _pair(censored_differences(data, model))
    told[TIMES] = Told(d.estimate.low <= ratio <= d.estimate.high, d.p < 0.05)
    s = next(
        s for s in success_differences(data) if (s.pair.first, s.pair.second) == (FIRST, SECOND)
    )
    told[SHARES] = Told(s.estimate.low <= gain <= s.estimate.high, s.p < 0.05)
    if not mixed:
        return told
    rows = data.used[~data.used["censored"] & (data.used["time_s"] > 0.0)]
    fit = fit_mixed(data, rows, np.log(rows["time_s"].to_numpy()))
    assert isinstance(fit, Mixed), fit
    d = _pair(mixed_differences(data, rows, fit))
    told[SEEN] = Told(d.estimate.low <= ratio <= d.estimate.high, d.p < 0.05)
    return told


def _pair(some: list[Difference]) -> Difference:
    return next(d for d in some if (d.pair.first, d.pair.second) == (FIRST, SECOND))
