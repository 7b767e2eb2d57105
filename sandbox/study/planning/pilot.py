"""What a pilot tells about chance: how much differences vary over people, and success rates.

Effects of a pilot are not used: differences are taken without their means, and success over all
levels together. A plan for the effect of a pilot would find too few people too often.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path

import numpy as np

from models.errors import StudyError
from models.messages.wording import counted
from sandbox.study.design.planned import PlannedTests
from sandbox.study.report.models.data import StudyData, load_study, to_numbers
from sandbox.study.report.models.fitted import Fitted
from sandbox.study.report.models.mixed import FEWEST_PEOPLE, Mixed
from sandbox.study.report.models.quantities import PLAIN, SHARE, Quantity, quantity, rows_with

CAUTION = 0.8
"""Probability that the true deviation is below the cautious one (Browne 1995)."""
FEWEST_SUCCESSFUL = 2
"""Smallest number of people who succeed in a condition whose times are compared: without one of
them, the others must still tell its mean."""


@dataclass(frozen=True)
class Spread:
    """How much a difference between two levels varies over people.

    Attributes:
        scale: Scale of `quantities`: `LOG`, `SHARE` or `PLAIN`, the scale of the outcome.
        people: Number of people behind it; 0 for a guess.
        own: Variance over people that does not depend on the number of trials.
        single: Variance of one trial around the mean of its person and condition; 0 if the pilot
            does not tell.
        between: True for the spread within groups, False for that of differences.
        success: Share of trials that succeeded, with all levels; 1 if failures do not matter.
    """

    scale: str
    people: int
    own: float
    single: float
    between: bool
    success: float

    def deviation(self, trials: float) -> float:
        """Standard deviation with so many trials of each level by each person."""
        sides = 1.0 if self.between else 2.0
        return sqrt(self.own + sides * self.single / max(trials * self.success, 1e-9))

    @property
    def caution(self) -> float:
        """Factor from the deviation to its upper limit of probability `CAUTION`."""
        from scipy import stats

        if not self.people:
            return 1.0
        freedom = self.people - (2 if self.between else 1)
        return sqrt(freedom / float(stats.chi2.ppf(1.0 - CAUTION, freedom)))


@dataclass(frozen=True)
class Pilot:
    """Spread and success of a pilot.

    Attributes:
        name, mode: Name of the study, and kind of its data.
        people, trials: Numbers used.
        success: Share of trials that succeeded.
        spreads: By outcome and factor; or the reason why there is none.
        rehearsed: Sentence on trials that a simulated user played; empty if there are none.
    """

    name: str
    mode: str
    people: int
    trials: int
    success: float
    spreads: dict[tuple[str, str], Spread | str]
    rehearsed: str = ""


def read_pilot(folder: Path, tests: Sequence[PlannedTests]) -> Pilot:
    """Reads the spread of planned comparisons from the tables of a pilot.

    Raises:
        StudyError: The folder has no usable trials.
    """
    data = load_study(folder)
    if not len(data.used):
        raise StudyError(
            "the pilot has no trials that count",
            where=str(folder),
            remedy="Give the folder of a pilot, such as studies/NAME-pilot",
        )
    names = dict.fromkeys(test.outcome for test in tests)
    asked = [quantity(data, n) for n in names if n in data.used.columns and _has(data, n)]
    fitted = Fitted(data, asked)
    return Pilot(
        data.name,
        data.mode,
        len(data.ppids),
        len(data.used),
        float(data.used["success"].mean()),
        {(t.outcome, t.factor.name): _spread(fitted, t) for t in tests},
        data.rehearsed,
    )


def _has(data: StudyData, name: str) -> bool:
    return bool(to_numbers(data.used[name]).notna().any())


def _spread(fitted: Fitted, test: PlannedTests) -> Spread | str:
    """Spread of the differences between the levels of a factor, without their means."""
    met = next((f for f in fitted.data.factors if f.name == test.factor.name), None)
    if met is None or len(met.levels) < 2:
        return "the pilot does not compare these levels"
    people = len(fitted.data.ppids)
    if people < FEWEST_PEOPLE:
        had = counted(people, "person", "people")
        return f"the pilot has {had} and at least {FEWEST_PEOPLE} are needed"
    some = [d for d in fitted.pairs(test.outcome) if d.pair.factor.name == test.factor.name]
    deviations = [d.spread for d in some if np.isfinite(d.spread)]
    if not deviations:
        return _unknown(fitted, test.outcome)
    if some[0].pair.factor.within == test.between:
        return "the pilot compares these levels within people, the design between, or the reverse"
    total = float(np.mean(np.square(deviations)))
    what = next((q for q in fitted.asked if q.name == test.outcome), None)
    if what is None:
        return Spread(PLAIN, people, total, 0.0, test.between, 1.0)
    rows, _ = rows_with(fitted.data, what)
    column = f"factor_{test.factor.name}"
    trials = len(rows) / rows[["ppid", column]].drop_duplicates().shape[0]
    success = float(fitted.data.used["success"].mean()) if what.name == "time_s" else 1.0
    single = _single(fitted, what)
    sides = 1.0 if test.between else 2.0
    # A variance of differences below that of its trials is chance: people do not differ then.
    own = max(0.0, total - sides * single / trials)
    return Spread(what.scale, people, own, single, test.between, max(success, 0.01))


def _unknown(fitted: Fitted, outcome: str) -> str:
    """Why the pilot does not tell the spread of an outcome, although it compares the levels."""
    measures = {"time_s", "success", *(what.name for what in fitted.asked)}
    if outcome not in fitted.outcomes or (outcome == "time_s" and fitted.time is None):
        return f"the pilot has no {'successes' if outcome == 'time_s' else f'numbers of {outcome}'}"
    if outcome == "time_s" and (few := _few_successes(fitted.data)):
        return few
    what = next((q for q in fitted.asked if q.name == outcome), fitted.time)
    model = fitted.compared(what).model if what is not None and outcome in measures else ""
    if isinstance(model, str) and model:
        return f"the pilot is too small: {model}"
    return (
        "its people do not tell how much others differ: too few of them met both levels, or all "
        "differ equally"
    )


def _few_successes(data: StudyData) -> str:
    """Which conditions have the successes of too few people; empty if there are none."""
    won = data.used[~data.used["censored"]].groupby("condition")["ppid"].nunique()
    few = {name: int(won.get(name, 0)) for name in data.conditions}
    told = [
        f"{count or 'none'} with {name}" for name, count in few.items() if count < FEWEST_SUCCESSFUL
    ]
    if not told:
        return ""
    return (
        f"too few people of the pilot succeeded ({', '.join(told)}) and at least "
        f"{FEWEST_SUCCESSFUL} are needed with each"
    )


def _single(fitted: Fitted, what: Quantity) -> float:
    """Variance of one trial around the mean of its person and condition."""
    if what.scale == SHARE:
        values = to_numbers(fitted.data.used[what.name]).dropna()
        # Agresti and Coull's share, so that it is not 0 if all trials succeeded.
        share = (float(values.sum()) + 2.0) / (len(values) + 4.0)
        return share * (1.0 - share)
    model = fitted.compared(what).model
    return model.spreads["residual"] ** 2 if isinstance(model, Mixed) else 0.0
