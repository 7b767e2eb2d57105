"""Declaration of a measure: name, unit, meaning and computation, in one place.

The column of `trial_results.csv`, codebook, exclusion rules and report are derived from it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from sandbox.study.measures.played_trial import PlayedTrial
from sandbox.trial.result import TrialResult, fields

Value = bool | int | float | str | None
"""Value of a measure; None if it does not apply to the trial."""

Row = Mapping[str, Any]
"""A row of `trial_results.csv` by column."""

ALL = "all"
HANDLING = "tasks with objects to handle"
GOALS = "tasks with goals"
HINGES = "tasks with goals of parts on hinges"
SLIDES = "tasks with goals of parts on slides"
PLACES = "tasks with one goal that does not move"
LABELS = "trials in which the true fingers are known, from a simulated user or from the device"
LIVE = "trials with a live device"
PAGE = "trials on the page"

HIGH, LOW = "high", "low"
"""Values of `TrialMeasure.better`."""


PRIMARY = "primary"
"""Role of a confirmatory outcome in a study's codebook."""
SIMULATED_USER = "simulated user"
"""Source of the true fingers where a simulated user, and no person, played a trial."""


@dataclass(frozen=True)
class TrialMeasure:
    """A measure of a trial.

    Exactly one of `of_trial`, `of_result` and `of_trials` computes it. If the function raises an
    error, or returns None or a number that is not finite, the cell is empty, the reason is stored,
    and the trial is kept.

    Attributes:
        name: Column of `trial_results.csv`.
        unit: Unit of the numbers; `0/1` for yes or no; empty for counts and words.
        title: Title in plots.
        means: Definition in one line, for the codebook.
        better: `HIGH` or `LOW`, the better direction; empty if neither is better.
        tasks: Description of the trials that it applies to.
        source: Publication that defines it; `ours` if it was defined for this program.
        of_trial: Computes it from the trial's result and 60 Hz table.
        of_result: Computes it from the result only.
        of_trials: Computes it from rows of one session and one combination of levels: successful
            and counted trials, without practice and excluded ones. All rows of the combination get
            this value.
        words: True if the values are words; exclusion rules and models cannot use them.
        in_report: True if the report shows it when a study has different values of it.
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
        """Definition with its source, for the codebook."""
        return self.means if self.source == "ours" else f"{self.means} ({self.source})"


def result_measure(name: str, title: str, better: str = "", in_report: bool = True) -> TrialMeasure:
    """Creates a measure from a field of the trial's result, with its unit and meaning."""
    field = fields()[name]
    return TrialMeasure(
        name,
        field.unit,
        title,
        field.meaning,
        better,
        of_result=attrgetter(name),
        in_report=in_report,
    )


def live_measure(name: str) -> Callable[[TrialResult], Value]:
    """Returns a function that reads a value which was measured while the trial ran.

    Such values, as latencies, cannot be computed from tables later.
    """

    def value(result: TrialResult) -> Value:
        measured: Value = (result.measures or {}).get(name)
        return measured

    return value
