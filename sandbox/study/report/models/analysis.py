"""Computes all numbers of the report once, for the page and for the tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sandbox.study.report.models.answers import ScaleAnswers, scales
from sandbox.study.report.models.censored import Censored, censored_differences, fit_censored
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import SESSION, ObservedFactor, StudyData
from sandbox.study.report.models.intervals import holm
from sandbox.study.report.models.mixed import Mixed, fit_mixed, mixed_differences
from sandbox.study.report.models.order import LearningPoint, LevelPlace, learning, places
from sandbox.study.report.models.quantities import (
    SHARE,
    Quantity,
    other_quantities,
    quantity,
    rows_for_model,
    rows_with,
)
from sandbox.study.report.models.success import ShareDifference, odds, success_differences
from sandbox.study.report.models.summaries import Summary, summaries


@dataclass(frozen=True)
class MeasureSummary:
    """Summaries of a measure by condition and by level.

    Attributes:
        what: The measure.
        conditions: Summary of each condition.
        levels: Summaries of the levels, by factor.
    """

    what: Quantity
    conditions: list[Summary]
    levels: dict[str, list[Summary]]


@dataclass(frozen=True)
class MeasureModel:
    """Summaries and comparisons of a measure.

    Attributes:
        described: Summaries by condition and level.
        model: The mixed model, or the reason why there is none; empty for shares.
        differences: Differences by the mixed model.
        shares: Differences of shares, for a measure of 0 and 1.
    """

    described: MeasureSummary
    model: Mixed | str
    differences: list[Difference]
    shares: list[ShareDifference]


@dataclass(frozen=True)
class Analysis:
    """All results of a study.

    Attributes:
        data: Data of the study.
        time: Completion time of successful trials; None without one.
        censored: The model that includes trials without success, or the reason why there is none.
        unseen: Its differences, in log time.
        success: Success; None without trials.
        odds: Log odds ratios, or the reason why there are none.
        asked: The requested measures.
        rest: All other measures, described only.
        scales: Scales of questionnaires.
        places: Completion time at every position in the order, by factor.
        learning: Completion time from trial to trial.
        main: The factor shown in colours: the first one with several levels, except the session, if
            there is one.
    """

    data: StudyData
    time: MeasureModel | None
    censored: Censored | str
    unseen: list[Difference]
    success: MeasureModel | None
    odds: list[Difference] | str
    asked: list[MeasureModel]
    rest: list[MeasureSummary]
    scales: list[ScaleAnswers]
    places: dict[str, list[LevelPlace]]
    learning: list[LearningPoint]
    main: ObservedFactor | None

    @property
    def leading(self) -> list[Difference]:
        """The main differences in log time: with censored times, if there are any."""
        if self.unseen and isinstance(self.censored, Censored) and self.censored.unseen:
            return self.unseen
        return self.time.differences if self.time else []


def analyse(data: StudyData, measures: Sequence[str] = ()) -> Analysis:
    """Computes all results.

    Args:
        data: Data of the study.
        measures: Names of measures to be compared besides time and success.

    Raises:
        StudyError: A measure is unknown.
    """
    asked, rest = other_quantities(data, measures)
    several = [f for f in data.factors if len(f.levels) > 1]
    # Factors of the design come before the session.
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
        places={
            f.name: places(data, time, f)
            for f in data.factors
            if time and timed and f.within and len(f.levels) > 1
        },
        learning=learning(data, time, main) if time and timed else [],
        main=main,
    )


def _describe(data: StudyData, what: Quantity) -> MeasureSummary:
    several = [f for f in data.factors if len(f.levels) > 1]
    return MeasureSummary(
        what, summaries(data, what), {f.name: summaries(data, what, f) for f in several}
    )


def _model(data: StudyData, what: Quantity) -> MeasureModel:
    described = _describe(data, what)
    if what.scale == SHARE:
        return MeasureModel(described, "", [], success_differences(data, what.name))
    rows, y = rows_for_model(data, what)
    model = fit_mixed(data, rows, y)
    differences = [] if isinstance(model, str) else mixed_differences(data, rows, model)
    return MeasureModel(described, model, differences, [])


def adjusted(pairs: Sequence[Difference | ShareDifference]) -> list[float]:
    """P values, adjusted (Holm 1979) for all pairs of levels of the same factor."""
    out = [float("nan")] * len(pairs)
    factors = [one.pair.factor.name for one in pairs]
    for name in dict.fromkeys(factors):
        mine = [i for i, factor in enumerate(factors) if factor == name]
        for i, p in zip(mine, holm([pairs[i].p for i in mine]), strict=True):
            out[i] = p
    return out
