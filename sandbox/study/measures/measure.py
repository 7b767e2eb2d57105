"""The declaration of a measure: its name, unit, meaning and how it is computed, in one place.

Column of `trial_results.csv`, codebook, exclusion rules and report are derived from it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from sandbox.study.measures.played_trial import PlayedTrial
from sandbox.trial.result import TrialResult, fields

Value = bool | int | float | str | None
"""A value of a measure; None: it does not apply to the trial."""

Row = Mapping[str, Any]
"""A row of `trial_results.csv` by column."""

ALL = "all"
HANDLING = "tasks with objects to handle"
GOALS = "tasks with goals"
PLACES = "tasks with one goal that does not move"
LABELS = "trials in which the true fingers are known: of simulated users, of devices that tell them"
LIVE = "devices with a clock of their own"
PAGE = "trials on the page"

HIGH, LOW = "high", "low"
"""Direction in which a measure is better."""


@dataclass(frozen=True)
class Measure:
    """A measure of a trial.

    Exactly one of `of_trial`, `of_result` and `of_trials` computes it. An error in it, None, or a
    number that is not finite gives an empty cell and a reason, and costs no trial.

    Attributes:
        name: Column of `trial_results.csv`.
        unit: Unit of its numbers; `0/1` for yes or no; empty for counts and words.
        title: Title in plots.
        means: Definition in a line, for the codebook.
        better: `HIGH`, `LOW`, or empty where neither is better.
        tasks: Trials that it applies to.
        source: Publication that defines it; `ours` where none does.
        of_trial: Computes it from the trial's result and 60 Hz table.
        of_result: Computes it from the result alone.
        of_trials: Computes it from the rows of those trials of one session and one combination of
            levels that succeeded, count, and are neither practice nor excluded; the value is the
            same in all rows of that combination.
        words: Its values are words, so that no rule and no model can use it.
        in_report: The report shows it where a study has different values of it.
    """

    name: str
    unit: str
    title: str
    means: str
    better: str = ""
    tasks: str = ALL
    source: str = "ours"
    of_trial: Callable[[PlayedTrial], Value] | None = None
    of_result: Callable[[TrialResult], Value] | None = None
    of_trials: Callable[[Sequence[Row]], Value] | None = None
    words: bool = False
    in_report: bool = True

    @property
    def meaning(self) -> str:
        """Definition with its source, as the codebook has it."""
        return self.means if self.source == "ours" else f"{self.means} ({self.source})"


def result_measure(name: str, title: str, better: str = "", in_report: bool = True) -> Measure:
    """A measure that is a field of the trial's result; unit and meaning are declared there."""
    field = fields()[name]
    return Measure(
        name,
        field.unit,
        title,
        field.meaning,
        better,
        of_result=attrgetter(name),
        in_report=in_report,
    )


def live_measure(name: str) -> Callable[[TrialResult], Value]:
    """Reads a measure that is taken while the trial runs, since no table can tell it later."""

    def value(result: TrialResult) -> Value:
        found: Value = (result.measures or {}).get(name)
        return found

    return value
