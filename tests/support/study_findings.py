"""What reports find in studies whose truth is known.

Tables are drawn from a model (tests/support/planted_study.py), not simulated. Each study is written
as tables, read again, and tested by the code of `sandbox study report`.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import exp, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.study.design.design import END, Design, Item
from sandbox.study.design.scoring import scores
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import load_study
from sandbox.study.report.models.family import family_of
from sandbox.study.report.models.fitted import Fitted
from sandbox.study.tables.column import csv_bytes
from tests.support.planted_study import Truth, write_study

DESIGN = Path(__file__).resolve().parents[2] / "examples" / "study" / "design.toml"

PRIMARY = ("time_s", "nasa-tlx-raw")
"""Primary outcomes of the studies that name some."""

NOTHING = Truth(times=(8.5, 8.5, 8.5), tasks=(1.0, 1.0), losses=(0.012,) * 3, repetitions=3)
"""Equal levels, with trials that fail."""

PLANTED = Truth(times=(10.0, 10.0), tasks=(1.0,), losses=(1e-9,) * 2, limit=3600.0, repetitions=6)
"""Two levels, where every trial succeeds; the times of the second are changed."""

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
    ratio = size * deviation_of(PLANTED)
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


def deviation_of(truth: Truth) -> float:
    """The planted standard deviation over people of the difference in log time."""
    return sqrt(2 * truth.person_level**2 + 2 * truth.residual**2 / truth.repetitions)


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
