"""Questionnaires: scores and single questions by level of the factor that they are about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sandbox.study.report.models.comparisons import Counts, Difference, Pair, t_difference
from sandbox.study.report.models.data import ObservedFactor, StudyData, to_numbers
from sandbox.study.report.models.intervals import Estimate, mean_interval, within_intervals

if TYPE_CHECKING:
    from pandas import DataFrame

ALL = "all"
"""Level of questions about the whole session."""


@dataclass(frozen=True)
class ScaleAnswers:
    """A scale of a questionnaire, by level.

    Attributes:
        questionnaire, scale: Names of the questionnaire and the scale.
        score: True for a score of several answers, False for a single question.
        main: True for the score of the questionnaire, which is its first scale. Other scales and
            single questions are described and never tested.
        factor: Factor of the levels; None for a question about the whole session.
        levels: Levels with answers.
        values: (people, levels); nan if missing.
        means, within: See `Summary`.
        differences: Differences of all pairs of levels, within or between people; none for a single
            question.
    """

    questionnaire: str
    scale: str
    score: bool
    main: bool
    factor: ObservedFactor | None
    levels: tuple[str, ...]
    values: np.ndarray
    means: tuple[Estimate, ...]
    within: tuple[Estimate, ...]
    differences: tuple[Difference, ...]

    @property
    def title(self) -> str:
        """Title for people."""
        if self.scale.lower() in (self.questionnaire.lower(), "score", "total", ""):
            return self.questionnaire
        return f"{self.questionnaire}: {self.scale}"


def score_scales(data: StudyData) -> list[ScaleAnswers]:
    """Scores of all questionnaires."""
    table = data.scores.rename(columns={"participant": "ppid", "questionnaire": "instrument"})
    if not {"instrument", "scale", "score", "ppid"} <= set(table.columns):
        return []
    return _each(data, table, "instrument", "scale", "score", True)


def item_scales(data: StudyData) -> list[ScaleAnswers]:
    """Single questions with numerical answers."""
    if not {"ppid", "instrument", "item", "answer"} <= set(data.answers.columns):
        return []
    table = data.answers[data.answers["instrument"] != "demographics"]
    return _each(data, table, "instrument", "item", "answer", False)


def _each(
    data: StudyData, table: DataFrame, form: str, item: str, value: str, score: bool
) -> list[ScaleAnswers]:
    table = table[~table["ppid"].isin(_left_out(data))]
    scales: list[ScaleAnswers] = []
    firsts = table.drop_duplicates(form).set_index(form)[item]
    for (name, scale), rows in table.groupby([form, item], sort=False):
        numbers = to_numbers(rows[value])
        given = rows[value].astype(str).str.strip() != ""
        # A question is numerical only if every answer is a number.
        if not given.any() or numbers[given].isna().any():
            continue
        # The first one, even if nobody answered it.
        main = score and firsts[name] == scale
        for some in _alike(data, rows):
            mine = numbers[some.index].to_numpy(float)
            scales.append(_scale(data, str(name), str(scale), score, main, some, mine))
    return scales


def _alike(data: StudyData, rows: DataFrame) -> list[DataFrame]:
    """Rows about levels of one factor each: where a design was changed in the middle, the same
    questions may be about another factor since then."""
    if _level(data, rows)[0] is not None or "at" in rows.columns:
        return [rows]
    left, some = rows, []
    for factor in reversed(data.factors):
        if factor.column in left.columns:
            about = left[factor.column].isin(factor.levels)
            some.append(left[about])
            left = left[~about]
    return [part for part in (*reversed(some), left) if len(part)]


def _left_out(data: StudyData) -> list[str]:
    """Participants who are excluded, and those with counted trials of which none is used."""
    main = data.trials[(data.trials["counted"] == 1) & (data.trials["practice"] != 1)]
    gone = set(main["ppid"]) - set(data.used["ppid"])
    if "excluded" in data.people.columns:
        gone |= set(data.people.loc[to_numbers(data.people["excluded"]) == 1, "ppid"])
    return sorted(gone)


def _scale(
    data: StudyData,
    name: str,
    scale: str,
    score: bool,
    main: bool,
    rows: DataFrame,
    numbers: np.ndarray,
) -> ScaleAnswers:
    factor, level = _level(data, rows)
    bounds = _bounds(rows)
    levels = tuple(x for x in (factor.levels if factor else (ALL,)) if x in set(level))
    people = list(dict.fromkeys(rows["ppid"]))
    row = {ppid: i for i, ppid in enumerate(people)}
    who = rows["ppid"].to_numpy()
    values = np.full((len(people), len(levels)), np.nan)
    for j, x in enumerate(levels):
        mine = (level == x) & np.isfinite(numbers)
        at = [row[ppid] for ppid in who[mine]]
        count = np.bincount(at, minlength=len(people))
        total = np.bincount(at, numbers[mine], minlength=len(people))
        np.divide(total, count, out=values[:, j], where=count > 0)
    return ScaleAnswers(
        name,
        scale,
        score,
        main,
        factor,
        levels,
        values,
        tuple(mean_interval(list(column)).bounded(*bounds) for column in values.T),
        tuple(e.bounded(*bounds) for e in within_intervals(values)),
        tuple(_differences(factor, levels, values)) if score else (),
    )


def _bounds(rows: DataFrame) -> tuple[float, float]:
    """Lowest and highest possible score; infinite if the table does not say."""
    if not {"score_low", "score_high"} <= set(rows.columns):
        return -np.inf, np.inf
    low, high = to_numbers(rows["score_low"]).min(), to_numbers(rows["score_high"]).max()
    return (low, high) if np.isfinite([low, high]).all() else (-np.inf, np.inf)


def _level(data: StudyData, rows: DataFrame) -> tuple[ObservedFactor | None, np.ndarray]:
    """The innermost factor that the questions are about, and its level in every row."""
    for factor in reversed(data.factors):
        if factor.column in rows.columns and rows[factor.column].isin(factor.levels).all():
            return factor, rows[factor.column].to_numpy()
    if "at" in rows.columns:
        for factor in reversed(data.factors):
            # `encoder=cubic`, or the level's name alone.
            named = (
                rows["at"]
                .str.split(r"[;,] ?", regex=True)
                .map(
                    lambda parts, f=factor: next(
                        (x for p in parts for x in f.levels if p in (x, f"{f.name}={x}")), ""
                    )
                )
            )
            if len(named) and (named != "").all():
                return factor, named.to_numpy()
    return None, np.full(len(rows), ALL)


def _differences(
    factor: ObservedFactor | None, levels: tuple[str, ...], values: np.ndarray
) -> list[Difference]:
    differences = []
    for j in range(len(levels)):
        for k in range(j + 1, len(levels)):
            assert factor is not None
            pair = Pair(factor, levels[j], levels[k], ())
            a, b = values[:, j], values[:, k]
            largest = float(np.nanmax(np.abs([a, b]), initial=0.0))
            if factor.within:
                d = b - a
                d = d[np.isfinite(d)]
                error = float(d.std(ddof=1) / np.sqrt(len(d))) if len(d) > 1 else np.nan
                value = float(d.mean()) if len(d) else np.nan
                counts = Counts(len(d) - 1.0, float(len(d)))
                differences.append(t_difference(pair, value, error, counts, largest))
                continue
            a, b = a[np.isfinite(a)], b[np.isfinite(b)]
            if len(a) < 2 or len(b) < 2:
                continue
            va, vb = a.var(ddof=1) / len(a), b.var(ddof=1) / len(b)
            # Welch's degrees of freedom.
            freedom = (
                (va + vb) ** 2 / (va**2 / (len(a) - 1) + vb**2 / (len(b) - 1))
                if va + vb > 0.0
                else 0.0
            )
            counts = Counts(float(freedom), len(a) * len(b) / (len(a) + len(b)))
            error = float(np.sqrt(va + vb))
            value = float(b.mean() - a.mean())
            differences.append(t_difference(pair, value, error, counts, largest))
    return differences
