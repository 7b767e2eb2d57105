"""Everything that the report says, as numbers; made once, shown as a page and as tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sandbox.study.report.models.answers import Scale, scales
from sandbox.study.report.models.censored import Censored, censored_differences, fit_censored
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import SESSION, Factor, StudyData
from sandbox.study.report.models.intervals import holm
from sandbox.study.report.models.mixed import Mixed, fit_mixed, mixed_differences
from sandbox.study.report.models.order import Learned, Place, learning, places
from sandbox.study.report.models.quantities import (
    SHARE,
    Quantity,
    other_quantities,
    quantity,
    rows_for_model,
    rows_with,
)
from sandbox.study.report.models.success import Successes, odds, success_differences
from sandbox.study.report.models.summaries import Summary, summaries


@dataclass(frozen=True)
class Described:
    """A measure by condition and by level.

    Attributes:
        what: The measure.
        conditions: By condition.
        levels: By factor, then by level.
    """

    what: Quantity
    conditions: list[Summary]
    levels: dict[str, list[Summary]]


@dataclass(frozen=True)
class Modelled:
    """A measure with comparisons.

    Attributes:
        described: By condition and level.
        model: The mixed model, or why there is none; of shares, there is none.
        differences: Of the mixed model.
        shares: Of a measure of 0 and 1.
    """

    described: Described
    model: Mixed | str
    differences: list[Difference]
    shares: list[Successes]


@dataclass(frozen=True)
class Analysis:
    """All results of a study.

    Attributes:
        data: Of the study.
        time: Of trials that succeeded; None without one.
        censored: The model that knows of trials without success, or why there is none.
        unseen: Its differences, in log time.
        success: None without trials.
        odds: Log odds ratios, or why there are none.
        asked: Measures that were asked for.
        rest: All others, described only.
        scales: Of questionnaires.
        places: By factor: the measure at every place in the order.
        learning: From trial to trial.
        main: The factor that is in colours: the first one with several levels that is not the
            session, if there is one.
    """

    data: StudyData
    time: Modelled | None
    censored: Censored | str
    unseen: list[Difference]
    success: Modelled | None
    odds: list[Difference] | str
    asked: list[Modelled]
    rest: list[Described]
    scales: list[Scale]
    places: dict[str, list[Place]]
    learning: list[Learned]
    main: Factor | None

    @property
    def leading(self) -> list[Difference]:
        """Differences in log time to be read first: with unseen times, where there are any."""
        if self.unseen and isinstance(self.censored, Censored) and self.censored.unseen:
            return self.unseen
        return self.time.differences if self.time else []


def analyse(data: StudyData, measures: Sequence[str] = ()) -> Analysis:
    """Works everything out.

    Args:
        data: Of the study.
        measures: Names of measures, besides time and success, that are to be compared.

    Raises:
        StudyError: A measure is none.
    """
    asked, rest = other_quantities(data, measures)
    several = [f for f in data.factors if len(f.levels) > 1]
    # What was varied on purpose comes before when it was done.
    main = min(several, key=lambda f: f.name == SESSION, default=None)
    if not len(data.used):
        nothing = "no trials are used"
        return Analysis(data, None, nothing, [], None, nothing, [], [], scales(data), {}, [], main)
    time = quantity(data, "time_s") if data.used["time_s"].notna().any() else None
    timed = time is not None and len(rows_with(data, time)[0]) > 0
    censored = fit_censored(data)
    return Analysis(
        data=data,
        time=_model(data, time) if time and timed else None,
        censored=censored,
        unseen=censored_differences(data, censored) if isinstance(censored, Censored) else [],
        success=_model(data, quantity(data, "success")),
        odds=odds(data),
        asked=[_model(data, what) for what in asked],
        rest=[_describe(data, what) for what in rest],
        scales=scales(data),
        places={f.name: places(data, time, f) for f in data.factors
                if time and timed and f.within and len(f.levels) > 1},
        learning=learning(data, time, main) if time and timed else [],
        main=main,
    )  # fmt: skip


def _describe(data: StudyData, what: Quantity) -> Described:
    several = [f for f in data.factors if len(f.levels) > 1]
    return Described(what, summaries(data, what),
                     {f.name: summaries(data, what, f) for f in several})  # fmt: skip


def _model(data: StudyData, what: Quantity) -> Modelled:
    described = _describe(data, what)
    if what.scale == SHARE:
        return Modelled(described, "", [], success_differences(data, what.name))
    rows, y = rows_for_model(data, what)
    model = fit_mixed(data, rows, y)
    differences = [] if isinstance(model, str) else mixed_differences(data, rows, model)
    return Modelled(described, model, differences, [])


def adjusted(found: Sequence[Difference | Successes]) -> list[float]:
    """P values, adjusted (Holm 1979) for how many pairs of levels the same factor has."""
    out = [float("nan")] * len(found)
    factors = [one.pair.factor.name for one in found]
    for name in dict.fromkeys(factors):
        mine = [i for i, factor in enumerate(factors) if factor == name]
        for i, p in zip(mine, holm([found[i].p for i in mine]), strict=True):
            out[i] = p
    return out
