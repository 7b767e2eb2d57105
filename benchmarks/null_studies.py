"""Measures how often reports find a difference in studies without one, and checks their intervals.

Each study has 12 people, two equal levels, and 4 trials at each level, of which about one in ten
fails (`tests/support/planted_study.py`). Its tables are read and compared like those of any study.
Prints

- the share of studies with a "difference": a pair whose p value, adjusted for all tests of the
  study (Holm), is below 0.05. With a correct test, 6.2 % or fewer of 2,000 studies have one, with a
  probability of 99 %;
- the share of the existing 95 % intervals that contain the true difference, 0.

    python -m benchmarks.null_studies --studies 2000
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from sandbox.study.report.data import load_study
from sandbox.study.report.numbers import ALPHA, results
from tests.support.planted_study import Truth, write_study

NOTHING = Truth(people=12, times=(9.0, 9.0), tasks=(1.0,), losses=(0.01, 0.01), repetitions=4)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--studies", type=int, default=2_000, help="their seeds are 0, 1, ...")
    studies = parser.parse_args().studies
    counts: Counter[str] = Counter()
    for seed in range(studies):
        with TemporaryDirectory() as folder:
            write_study(Path(folder), NOTHING, seed)
            found = results(load_study(Path(folder)))
        data = found.data
        counts["trials"] += len(data.used)
        counts["solved"] += int(data.used["success"].sum())
        pairs = [(one.what.name, pair) for one in found.compared for pair in one.pairs]
        counts["difference"] += any(pair.p_holm < ALPHA for _, pair in pairs)
        for name, pair in pairs:
            counts[f"{name} p"] += pair.p < ALPHA
            if pair.estimate.is_known:
                counts[f"{name} known"] += 1
                counts[f"{name} holds"] += pair.estimate.low <= 0.0 <= pair.estimate.high
    print(f"{studies} studies, {counts['solved'] / counts['trials']:.1%} of trials solved")
    print(f"with a difference: {counts['difference'] / studies:.2%}")
    for name in ("time_s", "success"):
        known = counts[f"{name} known"]
        print(
            f"{name}: p < 0.05 {counts[f'{name} p'] / studies:.2%}; "
            f"{counts[f'{name} holds'] / max(known, 1):.2%} of {known} intervals hold 0"
        )


if __name__ == "__main__":
    main()
