"""Measures how often intervals of a study's report cover the truth, where the truth is known.

python -m benchmarks.coverage [--studies 100] [--people 24] [--seconds]

Each study is written as tables, read again, and analysed as `sandbox study report` does it. The
numbers are counts of studies whose 95 % interval has the truth inside of it, and of those that say
p < 0.05; where there is no effect, these are false alarms.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.machine import describe_machine
from sandbox.study.measures.registry import measures
from sandbox.study.report.make import make_report
from sandbox.study.report.models.censored import (
    Censored,
    censored_differences,
    fit_censored,
)
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import load_study
from sandbox.study.report.models.mixed import Mixed, fit_mixed, mixed_differences
from sandbox.study.report.models.success import odds, success_differences
from tools.planted_study import Truth, true_success, write_study

FIRST, SECOND = "a", "c"
"""The planted pair that is told."""
TIMES, SEEN, SHARES, ODDS = (
    "time, all trials",
    "time, successes only",
    "success, shares",
    "success, odds",
)
SCENARIOS = {
    "effects, and trials without success": Truth(),
    "effects, every trial succeeds": Truth(limit=3600.0, losses=(1e-9, 1e-9, 1e-9)),
    "no effects": Truth(times=(8.5, 8.5, 8.5), losses=(0.012, 0.012, 0.012)),
}


@dataclass(frozen=True)
class Told:
    """Result of one study for the pair: covers the truth (None: not asked), p < 0.05."""

    covers: bool | None
    found: bool


def studies(
    truth: Truth, count: int, mixed: bool = True, first: int = 0
) -> Iterator[dict[str, Told]]:
    """Makes and analyses studies.

    Args:
        truth: What they follow.
        count: How many.
        mixed: With the mixed model and the odds, which take longest.
        first: Seed of the first one.
    """
    i, j = truth.levels.index(FIRST), truth.levels.index(SECOND)
    ratio = truth.log_ratio(i, j)
    shares = true_success(truth)
    # Equal rates have equal shares, whatever was drawn.
    gain = shares[j] - shares[i] if ratio or truth.losses[i] != truth.losses[j] else 0.0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(first, first + count):
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
    some = odds(data)
    if not isinstance(some, str):
        told[ODDS] = Told(None, _pair(some).p < 0.05)
    return told


def _pair(some: list[Difference]) -> Difference:
    return next(d for d in some if (d.pair.first, d.pair.second) == (FIRST, SECOND))


def main() -> None:
    """Prints a table for each truth, or how long a report takes."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--studies", type=int, default=100)
    parser.add_argument("--people", type=int, default=24)
    parser.add_argument("--seconds", action="store_true", help="of a report, instead")
    options = parser.parse_args()
    print(describe_machine())
    if options.seconds:
        _seconds(options.people)
        return
    print(f"{options.studies} studies of {options.people} people each")
    for name, truth in SCENARIOS.items():
        _table(name, replace(truth, people=options.people), options.studies)


def _table(name: str, truth: Truth, count: int) -> None:
    covers: Counter[str] = Counter()
    found: Counter[str] = Counter()
    seen: Counter[str] = Counter()
    asked = set()
    for told in studies(truth, count):
        for what, one in told.items():
            seen[what] += 1
            covers[what] += bool(one.covers)
            found[what] += one.found
            if one.covers is not None:
                asked.add(what)
    share = true_success(truth)
    i, j = truth.levels.index(FIRST), truth.levels.index(SECOND)
    print(
        f"\n{name}: time x {truth.times[j] / truth.times[i]:.2f}, success "
        f"{100 * share[i]:.1f} % -> {100 * share[j]:.1f} %"
    )
    for what in (TIMES, SEEN, SHARES, ODDS):
        if seen[what]:
            inside = f"{covers[what]:4d} of {seen[what]}" if what in asked else "   -       "
            print(
                f"  {what:<22} covers the truth {inside}   p < 0.05 in {found[what]:4d}", flush=True
            )


def _seconds(people: int) -> None:
    truth = replace(
        Truth(), people=people, times=(10.0, 8.5, 7.0), tasks=(0.8, 1.0, 1.25), repetitions=3
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "trial_results.csv"
        write_study(Path(folder), truth, 0)
        table = pd.read_csv(path)
        rng = np.random.default_rng(0)
        # A study has all measures, each of which is a picture.
        for measure in measures():
            if measure.name not in table.columns and measure.unit != "0/1":
                table[measure.name] = rng.lognormal(size=len(table)).round(4)
        table.to_csv(path, index=False)
        began, cpu = time.perf_counter(), time.process_time()
        make_report(Path(folder), Path(folder) / "report")
        print(
            f"a report of {people} people, {len(table)} trials, {len(measures())} measures: "
            f"{time.perf_counter() - began:.1f} s by the clock, "
            f"{time.process_time() - cpu:.1f} s of processor time"
        )


if __name__ == "__main__":
    main()
