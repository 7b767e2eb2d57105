"""Measures what reports find in studies whose truth is known: nothing where nothing is, also where
people did one level only, and planted effects as often as `sandbox study plan` says.

python -m benchmarks.study_findings [--studies 1000] [--only nothing] [--dz 0.4 0.8]

Tables are drawn from a model (tools/planted_study.py), not simulated. Each study is written as
tables, read again, and tested by the code of `sandbox study report`.
"""

from __future__ import annotations

import argparse
import csv
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import exp
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.machine import describe_machine
from sandbox.study.design.design import END, Design, Item
from sandbox.study.design.design_file import load_design
from sandbox.study.design.power import power
from sandbox.study.design.scoring import scores
from sandbox.study.planning.pilot import Spread
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import load_study
from sandbox.study.report.models.family import ALPHA, family_of
from sandbox.study.report.models.fitted import Fitted
from sandbox.study.report.models.quantities import LOG
from sandbox.study.tables.column import csv_bytes
from tools.planted_study import Truth, write_study

DESIGN = Path(__file__).resolve().parent.parent / "examples" / "study" / "design.toml"
PRIMARY = ("time_s", "nasa-tlx-raw")
"""Primary outcomes of the studies that name some."""
NOTHING = Truth(times=(8.5, 8.5, 8.5), tasks=(1.0, 1.0), losses=(0.012,) * 3, repetitions=3)
"""Equal levels, with trials that fail."""
PLANTED = Truth(times=(10.0, 10.0), tasks=(1.0,), losses=(1e-9,) * 2, limit=3600.0, repetitions=6)
"""Two levels, where every trial succeeds; the times of the second are changed."""
SIZES = (0.4, 0.8)
"""Planted standardised effects dz."""
PEOPLE = (12, 36)
INCOMPLETE = ((6, 2), (8, 3), (8, 6))
"""People, and how many of them did both levels."""
TABLES = ("nothing", "planted", "incomplete")
SEED = 7_331


@dataclass(frozen=True)
class Told:
    """What the report says of a planted effect.

    Attributes:
        found: True if its confirmatory test found a difference in the planted direction.
        covers: True if its interval covers the truth.
    """

    found: bool
    covers: bool


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--studies", type=int, default=1000, help="of each kind")
    parser.add_argument("--only", choices=TABLES, help="one of the tables")
    parser.add_argument("--dz", type=float, nargs="+", default=SIZES, help="planted effects")
    options = parser.parse_args()
    print(f"{describe_machine()}\n", flush=True)
    wanted = (options.only,) if options.only else TABLES
    if "nothing" in wanted:
        _print_nothing(options.studies)
    if "planted" in wanted:
        _print_planted(options.studies, options.dz)
    if "incomplete" in wanted:
        _print_incomplete(options.studies)


def _print_nothing(count: int) -> None:
    design = load_design(DESIGN, try_out=False)
    kinds = {"no primary outcome": (), f"primary: {', '.join(PRIMARY)}": PRIMARY}
    wrong: Counter[str] = Counter()
    tests: Counter[str] = Counter()
    for found in nothing(design, count, list(kinds.values())):
        for name, (tested, findings) in zip(kinds, found, strict=True):
            tests[name] = tested
            wrong[name] += findings > 0
    print(
        f"Equal levels, answers by chance: {NOTHING.people} people, {len(NOTHING.times)} levels x "
        f"{len(NOTHING.tasks)} tasks x {NOTHING.repetitions} repetitions, questionnaires of "
        "examples/study/design.toml\n"
    )
    print("| design | tests | studies with a finding | share | 95 % interval |")
    print("| --- | --- | --- | --- | --- |")
    for name in kinds:
        print(f"| {name} | {tests[name]} | {_shares(wrong[name], count)} |", flush=True)


def _print_planted(count: int, sizes: Sequence[float]) -> None:
    deviation = spread_of(PLANTED).deviation(PLANTED.repetitions)
    print(
        f"\nPlanted effects in completion time: two levels x {PLANTED.repetitions} repetitions, "
        f"standard deviation of differences {deviation:.3f} of log time\n"
    )
    print(
        "| dz | people | change | plan says | found | share | 95 % interval | intervals cover "
        "| share | 95 % interval |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for size in sizes:
        for people in PEOPLE:
            told = list(planted(size, people, count))
            found, covers = sum(t.found for t in told), sum(t.covers for t in told)
            print(
                f"| {size} | {people} | {100 * (exp(size * deviation) - 1):+.0f} % | "
                f"{100 * power(size, people, ALPHA):.1f} % | {_shares(found, count)} | "
                f"{_shares(covers, count)} |",
                flush=True,
            )


def _print_incomplete(count: int) -> None:
    print("\nEqual levels, and people who did one of the two levels only\n")
    print(
        "| people | did both | the others | degrees of freedom | p < 0.05 | share | 95 % interval |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for people, both in INCOMPLETE:
        for others, turns in (("the first level", False), ("either, by turns", True)):
            differences = list(incomplete(people, both, turns, count))
            wrong = sum(d.p < ALPHA for d in differences)
            freedom = differences[0].freedom
            about = f"{people} | {both} | {others} | {freedom:g}"
            print(f"| {about} | {_shares(wrong, count)} |", flush=True)


def _shares(count: int, studies: int) -> str:
    from scipy import stats

    ends = stats.binomtest(count, studies).proportion_ci(method="wilson")
    return (
        f"{count} of {studies} | {100 * count / studies:.1f} % | "
        f"{100 * ends.low:.1f} to {100 * ends.high:.1f} %"
    )


def nothing(
    design: Design, count: int, primaries: Sequence[tuple[str, ...]]
) -> Iterator[list[tuple[int, int]]]:
    """Studies without any difference: numbers of tests and of findings, for each list of primary
    outcomes.

    Args:
        design: Design with the questionnaires.
        count: How many studies.
        primaries: Lists of primary outcomes; an empty one tests everything.
    """
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        for seed in range(count):
            write_study(folder, NOTHING, seed)
            write_answers(folder, design, NOTHING, seed)
            fitted = Fitted(load_study(folder), ())
            families = [family_of(fitted, primary) for primary in primaries]
            yield [(len(f.tests), len(f.findings)) for f in families]


def planted(size: float, people: int, count: int) -> Iterator[Told]:
    """Studies with an effect on completion time, which is their primary outcome.

    Args:
        size: Standardised effect dz.
        people: Number of participants.
        count: How many studies.
    """
    ratio = size * spread_of(PLANTED).deviation(PLANTED.repetitions)
    first, second = PLANTED.times[0] * exp(-ratio / 2), PLANTED.times[0] * exp(ratio / 2)
    truth = replace(PLANTED, people=people, times=(first, second))
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        for seed in range(count):
            write_study(folder, truth, seed)
            fitted = Fitted(load_study(folder), ())
            (test,) = family_of(fitted, ("time_s",)).tests
            (d,) = fitted.pairs("time_s")
            assert isinstance(d, Difference)
            # Levels come in order of appearance, since there is no codebook.
            true = ratio if d.pair.second == truth.levels[1] else -ratio
            covers = d.estimate.low <= true <= d.estimate.high
            yield Told(test.found and d.estimate.value * true > 0.0, covers)


def incomplete(people: int, both: int, turns: bool, count: int) -> Iterator[Difference]:
    """Comparisons of two equal levels, of which some people did one only.

    Args:
        people: Number of participants.
        turns: True if the others did the first and the second level by turns, False if all did the
            first one, as where the second was added later.
        both: How many did both levels.
        count: How many studies.
    """
    truth = replace(PLANTED, people=people, repetitions=2, person_level=0.25, residual=0.12)
    with tempfile.TemporaryDirectory() as work:
        table = Path(work) / "trial_results.csv"
        for seed in range(count):
            write_study(table.parent, truth, seed)
            with table.open(newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            numbers = {ppid: i for i, ppid in enumerate(sorted({r["ppid"] for r in rows}))}
            kept = []
            for row in rows:
                number = numbers[row["ppid"]]
                own = truth.levels[number % 2 if turns else 0]
                if number < both or row["factor_encoder"] == own:
                    kept.append(row)
            table.write_bytes(csv_bytes(kept, tuple(rows[0])))
            (d,) = Fitted(load_study(table.parent), ()).pairs("time_s")
            assert isinstance(d, Difference)
            yield d


def spread_of(truth: Truth) -> Spread:
    """The planted spread, as a pilot would tell it."""
    return Spread(LOG, truth.people, 2 * truth.person_level**2, truth.residual**2, False, 1.0)


def write_answers(folder: Path, design: Design, truth: Truth, seed: int) -> None:
    """Writes `questionnaires.csv` and `questionnaire_scores.csv` of answers by chance.

    Args:
        folder: Folder of the study.
        design: Design with the questionnaires.
        truth: The people, and the levels of `encoder` that forms are about.
        seed: Seed of the answers.
    """
    rng = np.random.default_rng([seed, SEED])
    answers: list[dict[str, Any]] = []
    scored: list[dict[str, Any]] = []
    for p in range(truth.people):
        for form in design.questionnaires:
            for level in [""] if form.at == END else truth.levels:
                about = {
                    "ppid": f"P{p + 1:03d}",
                    "instrument": form.name,
                    "factor_encoder": level,
                }
                given = {item.name: _answer(item, rng) for item in form.items}
                answers += [{**about, "item": k, "answer": v} for k, v in given.items()]
                scored += [
                    {
                        **about,
                        "scale": scale.name,
                        "score": one.value,
                        "score_low": scale.range[0],
                        "score_high": scale.range[1],
                    }
                    for scale, one in zip(form.scales, scores(form.scales, given), strict=True)
                ]
    for name, rows in (("questionnaires", answers), ("questionnaire_scores", scored)):
        (folder / f"{name}.csv").write_bytes(csv_bytes(rows, tuple(rows[0])))


def _answer(item: Item, rng: np.random.Generator) -> float:
    steps = int((item.high - item.low) / item.step)
    return item.low + item.step * int(rng.integers(0, steps + 1))


if __name__ == "__main__":
    main()
