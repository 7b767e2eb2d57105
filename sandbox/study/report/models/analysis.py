"""Computes all numbers of the report once, for the page and for the tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sandbox.study.report.models.answers import ScaleAnswers
from sandbox.study.report.models.censored import Censored
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import SESSION, ObservedFactor, StudyData, to_numbers
from sandbox.study.report.models.family import Family, family_of
from sandbox.study.report.models.fitted import Compared, Fitted
from sandbox.study.report.models.interactions import Dependence
from sandbox.study.report.models.order import LearningPoint, LevelPlace, learning, places
from sandbox.study.report.models.quantities import Quantity, other_quantities, quantity
from sandbox.study.report.models.success import odds
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
class MeasureModel(Compared):
    """Summaries and comparisons of a measure.

    Attributes:
        described: Summaries by condition and level.
        dependences: Simple effects and interactions of the main factor.
    """

    described: MeasureSummary
    dependences: list[Dependence]


@dataclass(frozen=True)
class Analysis:
    """All results of a study.

    Attributes:
        data: Data of the study.
        family: What is tested, with adjusted p values; everything else is exploratory.
        time: Completion time of successful trials; None without one.
        censored: The model that includes trials without success, or the reason why there is none.
        unseen: Its differences, in log time.
        with_unseen: True if these are the tested differences in time, since there are such trials;
            otherwise those of the mixed model are.
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
    family: Family
    time: MeasureModel | None
    censored: Censored | str
    unseen: list[Difference]
    with_unseen: bool
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
        """The differences in log time that are tested."""
        return self.unseen if self.with_unseen else self.time.differences if self.time else []


def analyse(data: StudyData, measures: Sequence[str] = ()) -> Analysis:
    """Computes all results.

    Args:
        data: Data of the study.
        measures: Names of measures to be compared besides time and success.

    Raises:
        StudyError: A measure is unknown.
    """
    asked, rest = other_quantities(data, [*primary_measures(data), *measures])
    fitted = Fitted(data, asked)
    family = family_of(fitted, data.primary)
    several = [f for f in data.factors if len(f.levels) > 1]
    # Factors of the design come before the session.
    main = min(several, key=lambda f: f.name == SESSION, default=None)
    if not len(data.used):
        return Analysis(
            data=data,
            family=family,
            time=None,
            censored=fitted.censored,
            unseen=[],
            with_unseen=False,
            success=None,
            odds="no trials are used",
            asked=[],
            rest=[],
            scales=fitted.scales,
            places={},
            learning=[],
            main=main,
        )
    time = fitted.time
    return Analysis(
        data=data,
        family=family,
        time=_model(fitted, time, main) if time else None,
        censored=fitted.censored,
        unseen=fitted.unseen,
        with_unseen=fitted.with_unseen,
        success=_model(fitted, quantity(data, "success"), main),
        odds=odds(data),
        asked=[_model(fitted, what, main) for what in asked],
        rest=[_describe(data, what) for what in rest],
        scales=fitted.scales,
        places={
            f.name: places(data, time, f)
            for f in data.factors
            if time and f.within and len(f.levels) > 1
        },
        learning=learning(data, time, main) if time else [],
        main=main,
    )


def primary_measures(data: StudyData) -> list[str]:
    """Primary outcomes that are measures of trials, and have numbers in these data."""
    return [
        name
        for name in data.primary
        if name in data.used.columns and to_numbers(data.used[name]).notna().any()
    ]


def _describe(data: StudyData, what: Quantity) -> MeasureSummary:
    several = [f for f in data.factors if len(f.levels) > 1]
    return MeasureSummary(
        what, summaries(data, what), {f.name: summaries(data, what, f) for f in several}
    )


def _model(fitted: Fitted, what: Quantity, main: ObservedFactor | None) -> MeasureModel:
    compared = fitted.compared(what)
    dependences = fitted.dependences(what, main) if main else []
    described = _describe(fitted.data, what)
    return MeasureModel(
        compared.model, compared.differences, compared.shares, described, dependences
    )
