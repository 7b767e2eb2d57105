"""CSV files of the report: all numbers of the page, and the trials that they come from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from sandbox.study.report.models.analysis import Analysis, MeasureModel, MeasureSummary
from sandbox.study.report.models.censored import Censored
from sandbox.study.report.models.comparisons import Difference, Pair, pairs_of
from sandbox.study.report.models.exclusions import endings, flow
from sandbox.study.report.models.family import CONFIRMATORY, EXPLORATORY, Family
from sandbox.study.report.models.intervals import Estimate
from sandbox.study.report.models.mixed import Mixed
from sandbox.study.report.models.quantities import LOG
from sandbox.study.report.models.success import ShareDifference
from sandbox.study.report.models.summaries import person_means

Row = dict[str, Any]

MIXED, CENSORED, SHARES, GEE = "mixed model", "with unseen times", "shares of trials", "GEE"

Column = tuple[str, str, str]
"""Name, unit, meaning."""
INTERVAL: tuple[Column, ...] = (
    ("low", "", "lower end of the 95 % interval"),
    ("high", "", "upper end of the 95 % interval"),
)
EFFECT: tuple[Column, ...] = (
    (
        "sd",
        "",
        "standard deviation over people of the difference; for ratios, that of their logarithm; of "
        "two groups, that within groups",
    ),
    ("dz", "", "difference, for ratios of logarithms, divided by sd; of two groups, Cohen's d"),
)
TEST: tuple[Column, ...] = (
    ("role", "", "confirmatory: tested; exploratory: an estimate with its interval, not tested"),
    ("p", "", "p value of this test alone; empty if exploratory"),
    ("p_holm", "", "p value adjusted for all tests of the study (Holm); empty if exploratory"),
)
FILES: dict[str, tuple[Column, ...]] = {
    "means.csv": (
        ("measure", "", "as in trial_results.csv"),
        ("unit", "", "unit of the mean and of the intervals"),
        ("by", "", "condition, or the name of a factor"),
        ("name", "", "name of the condition, or of the level of the factor"),
        ("people", "", "number of participants"),
        ("trials", "", "number of trials"),
        (
            "mean",
            "see unit",
            "mean over people with equal weights; geometric for logarithmic measures",
        ),
        *INTERVAL,
        (
            "within_low",
            "see unit",
            "lower end of the 95 % interval for comparisons, without differences between people",
        ),
        ("within_high", "see unit", "upper end of this interval"),
    ),
    "comparisons.csv": (
        ("measure", "", "as in trial_results.csv"),
        ("model", "", f"{MIXED}; {CENSORED}; {SHARES}; {GEE}"),
        ("factor", "", "factor whose levels are compared"),
        ("first", "", "first level, the reference"),
        ("second", "", "second level"),
        ("kind", "", "ratio, difference or odds ratio, of the second level to the first"),
        ("estimate", "see kind", "estimate, averaged over the levels of the other factors"),
        *INTERVAL,
        ("error", "", "standard error; for ratios, that of their logarithm"),
        ("freedom", "", "degrees of freedom"),
        *EFFECT,
        *TEST,
    ),
    "interactions.csv": (
        ("measure", "", "as in trial_results.csv"),
        (
            "kind",
            "",
            "simple effect: at one level of another factor; interaction: difference of two simple "
            "effects; both are exploratory",
        ),
        ("factor", "", "factor whose levels are compared"),
        ("first", "", "first level, the reference"),
        ("second", "", "second level"),
        ("other", "", "the other factor"),
        ("at", "", "its level"),
        ("against", "", "its level whose simple effect is subtracted, or by which it is divided"),
        ("estimate", "", "ratio for logarithmic measures, otherwise difference"),
        *INTERVAL,
    ),
    "models.csv": (
        ("measure", "", "as in trial_results.csv"),
        ("model", "", f"{MIXED}; {CENSORED}"),
        ("term", "", "mean of a condition, change with log2 of the trial, or standard deviation"),
        (
            "estimate",
            "",
            "estimate on the scale of the model, which is logarithmic for logarithmic measures",
        ),
        ("error", "", "standard error"),
    ),
    "contrasts.csv": (
        ("factor", "", "factor whose levels are compared"),
        ("first", "", "first level, the reference"),
        ("second", "", "second level"),
        ("condition", "", "as in trials.csv"),
        ("weight", "", "weight of the condition's mean in the difference second - first"),
    ),
    "people.csv": (
        ("ppid", "", "pseudonym"),
        ("measure", "", "as in trial_results.csv"),
        ("condition", "", "as in trials.csv"),
        ("mean", "", "mean over this person's trials; geometric for logarithmic measures"),
    ),
    "order.csv": (
        ("factor", "", "factor of the level"),
        ("level", "", "level"),
        ("place", "", "1, 2, ...: position of the level in the order"),
        ("times", "", "number of times that the level was at this position"),
        ("mean", "s", "completion time, without the differences between the other conditions"),
        *INTERVAL,
    ),
    "learning.csv": (
        ("level", "", "level of the first factor"),
        ("first", "", "first trial of the point, counted over the trials with this level"),
        ("last", "", "last trial of the point, where several trials are averaged"),
        ("people", "", "number of participants"),
        ("mean", "s", "completion time, without the differences between the other conditions"),
        *INTERVAL,
    ),
    "scores.csv": (
        ("questionnaire", "", "name of the questionnaire"),
        ("scale", "", "scale of the questionnaire, or a single question"),
        ("factor", "", "factor of the level; empty for questions about the whole session"),
        ("level", "", "level that the questions were about"),
        ("people", "", "number of participants who answered"),
        ("mean", "", "mean over people"),
        *INTERVAL,
    ),
    "score_comparisons.csv": (
        ("questionnaire", "", "name of the questionnaire"),
        ("scale", "", "scale of the questionnaire, or a single question"),
        ("factor", "", "factor of the levels"),
        ("first", "", "first level, the reference"),
        ("second", "", "second level"),
        ("estimate", "", "difference of the means, second - first"),
        *INTERVAL,
        *EFFECT,
        *TEST,
    ),
    "exclusions.csv": (
        ("step", "", "step from all data to the data used"),
        (
            "participants",
            "",
            "number of participants who remain, or who are removed with their last trial",
        ),
        ("trials", "", "number of trials that remain, or that are removed"),
        ("remains", "0/1", "1: the numbers remain; 0: the numbers are removed"),
    ),
    "endings.csv": (
        ("condition", "", "as in trials.csv"),
        ("ending", "", "success, or the status at the end of the trial"),
        ("trials", "", "number of trials"),
    ),
}
"""Columns of every file; the codebook is made from it."""
TRIALS: tuple[Column, ...] = (
    ("condition", "", "levels of all factors"),
    (
        "position",
        "",
        "number of the trial of this participant, from 1, without practice; in its session, where "
        "sessions are compared",
    ),
    ("log2_position", "", "logarithm of position to base 2, minus its mean over all rows"),
    ("censored", "0/1", "1: no success, so that the completion time is longer than time_s"),
)


def tables(analysis: Analysis) -> dict[str, bytes]:
    """Contents of all files by name."""
    rows = {
        "means.csv": _means(analysis),
        "comparisons.csv": _comparisons(analysis),
        "interactions.csv": _interactions(analysis),
        "models.csv": _models(analysis),
        "contrasts.csv": _contrasts(analysis),
        "people.csv": _people(analysis),
        "order.csv": [
            {**vars(p), **_interval(p.mean)} for ps in analysis.places.values() for p in ps
        ],
        "learning.csv": [{**vars(p), **_interval(p.mean)} for p in analysis.learning],
        "scores.csv": _scores(analysis),
        "score_comparisons.csv": _score_comparisons(analysis),
        "exclusions.csv": [
            *_withdrawn(analysis),
            *({**vars(s), "step": s.what} for s in flow(analysis.data)),
        ],
        "endings.csv": [
            {"condition": c, "ending": e, "trials": n}
            for c, kinds in endings(analysis.data).items()
            for e, n in kinds.items()
        ],
    }
    files = {
        name: csv_bytes(rows[name], [c for c, _, _ in columns]) for name, columns in FILES.items()
    }
    names, trials = _trials(analysis)
    files["trials.csv"] = csv_bytes(trials, names)
    files["codebook.csv"] = _codebook(analysis, names)
    return files


def _withdrawn(analysis: Analysis) -> list[Row]:
    """Row on people who withdrew; none if the study's folder does not tell."""
    count = analysis.data.withdrawn
    if count is None:
        return []
    step = "withdrew, in no other number"
    return [{"step": step, "participants": count, "trials": 0, "remains": False}]


def csv_bytes(rows: Sequence[Row], columns: Sequence[str]) -> bytes:
    """A table as CSV, with ten digits of every number."""
    import pandas as pd

    cells = [{k: _cell(v) for k, v in row.items()} for row in rows]
    text: str = pd.DataFrame(cells, columns=list(columns), dtype=object).to_csv(
        index=False, lineterminator="\n"
    )
    return text.encode()


def _cell(value: Any) -> Any:
    if isinstance(value, bool | np.bool_):
        return int(value)
    # The digits after the tenth differ from machine to machine.
    return float(f"{value:.10g}") if isinstance(value, float) else value


def _interval(estimate: Estimate) -> Row:
    return {
        "mean": _known(estimate.value),
        "low": _known(estimate.low),
        "high": _known(estimate.high),
    }


def _known(value: float) -> float | None:
    """A finite number; None for nan and infinity, which spreadsheets read as text."""
    return float(value) if np.isfinite(value) else None


def _described(analysis: Analysis) -> Iterable[MeasureSummary]:
    yield from (m.described for m in _modelled(analysis))
    yield from analysis.rest


def _modelled(analysis: Analysis) -> Iterable[MeasureModel]:
    yield from (m for m in (analysis.time, analysis.success, *analysis.asked) if m is not None)


def _means(analysis: Analysis) -> list[Row]:
    return [
        {
            "measure": one.what.name,
            "unit": one.what.unit,
            "by": by,
            "name": s.name,
            "people": s.people,
            "trials": s.trials,
            **_interval(s.mean),
            "within_low": _known(s.within.low),
            "within_high": _known(s.within.high),
        }
        for one in _described(analysis)
        for by, some in (("condition", one.conditions), *one.levels.items())
        for s in some
    ]


def _comparisons(analysis: Analysis) -> list[Row]:
    rows: list[Row] = []
    family = analysis.family
    for one in _modelled(analysis):
        what = one.described.what
        kind = "ratio" if what.scale == LOG else "difference"
        # Of two models of completion time, one is tested.
        tested = what.name != "time_s" or not analysis.with_unseen
        rows += _differences(what.name, MIXED, kind, one.differences, family if tested else None)
        rows += [
            {"measure": what.name, "model": SHARES, "kind": "difference"}
            | _pair_cells(d.pair, d.estimate)
            | _effect_cells(d)
            | _test_cells(family, what.name, d.pair)
            for d in one.shares
        ]
    tested_by = family if analysis.with_unseen else None
    rows += _differences("time_s", CENSORED, "ratio", analysis.unseen, tested_by)
    if not isinstance(analysis.odds, str):
        rows += _differences("success", GEE, "odds ratio", analysis.odds, None)
    return rows


def _differences(
    measure: str, model: str, kind: str, some: Sequence[Difference], family: Family | None
) -> list[Row]:
    change = (lambda x: x) if kind == "difference" else np.exp
    return [
        {
            "measure": measure,
            "model": model,
            "kind": kind,
            "error": _known(d.error),
            "freedom": _known(d.freedom),
            **_pair_cells(d.pair, d.estimate.mapped(change)),
            # A log odds ratio is not an average of people's own.
            **({} if model == GEE else _effect_cells(d)),
            **_test_cells(family, measure, d.pair),
        }
        for d in some
    ]


def _pair_cells(pair: Pair, estimate: Estimate) -> Row:
    """Cells of a comparison between two levels;"""
    return {
        "factor": pair.factor.name,
        "first": pair.first,
        "second": pair.second,
        "estimate": _known(estimate.value),
        "low": _known(estimate.low),
        "high": _known(estimate.high),
    }


def _effect_cells(d: Difference | ShareDifference) -> Row:
    """Standard deviation of a difference over people, and standardised effect."""
    return {"sd": _known(d.spread), "dz": _known(d.size)}


def _test_cells(family: Family | None, outcome: str, pair: Pair) -> Row:
    """Role and p values of a comparison; without a family it is exploratory."""
    test = family.test(outcome, pair) if family else None
    if test is None:
        return {"role": EXPLORATORY}
    return {"role": CONFIRMATORY, "p": _known(test.p), "p_holm": _known(test.p_holm)}


def _interactions(analysis: Analysis) -> list[Row]:
    return [
        {
            "measure": one.described.what.name,
            "kind": d.kind,
            **_pair_cells(d.pair, d.estimate.mapped(one.described.what.back)),
            "other": d.other.name,
            "at": d.pair.at,
            "against": d.against,
        }
        for one in _modelled(analysis)
        for d in one.dependences
    ]


def _models(analysis: Analysis) -> list[Row]:
    rows: list[Row] = []
    for one in _modelled(analysis):
        if isinstance(one.model, Mixed):
            about = {"measure": one.described.what.name, "model": MIXED}
            errors = np.sqrt(np.diag(one.model.covariance))
            rows += [
                {**about, "term": n, "estimate": float(v), "error": float(e)}
                for n, v, e in zip(one.model.names, one.model.coefficients, errors, strict=True)
            ]
            rows += [
                {**about, "term": f"sd {k}", "estimate": v} for k, v in one.model.spreads.items()
            ]
    if isinstance(analysis.censored, Censored):
        about = {"measure": "time_s", "model": CENSORED}
        for i, name in enumerate(analysis.censored.names):
            unit = np.eye(len(analysis.censored.names))[i]
            rows.append(
                {
                    **about,
                    "term": name,
                    "estimate": float(analysis.censored.coefficients[i]),
                    "error": _known(analysis.censored.error(unit)),
                }
            )
        rows.append({**about, "term": "sd total", "estimate": analysis.censored.sigma})
    return rows


def _contrasts(analysis: Analysis) -> list[Row]:
    data = analysis.data
    return [
        {
            "factor": pair.factor.name,
            "first": pair.first,
            "second": pair.second,
            "condition": data.conditions[i],
            "weight": float(w),
        }
        for pair in pairs_of(data)
        for i, w in enumerate(pair.weights(len(data.conditions)))
        if w
    ]


def _people(analysis: Analysis) -> list[Row]:
    data = analysis.data
    return [
        {"ppid": ppid, "measure": one.what.name, "condition": name, "mean": one.what.back(value)}
        for one in _described(analysis)
        for ppid, own in zip(data.ppids, person_means(data, one.what), strict=True)
        for name, value in zip(data.conditions, own, strict=True)
        if np.isfinite(value)
    ]


def _scores(analysis: Analysis) -> list[Row]:
    return [
        {
            "questionnaire": s.questionnaire,
            "scale": s.scale,
            "factor": s.factor.name if s.factor else "",
            "level": level,
            "people": int(np.isfinite(s.values[:, j]).sum()),
            **_interval(s.means[j]),
        }
        for s in analysis.scales
        for j, level in enumerate(s.levels)
    ]


def _score_comparisons(analysis: Analysis) -> list[Row]:
    return [
        {
            "questionnaire": s.questionnaire,
            "scale": s.scale,
            **_pair_cells(d.pair, d.estimate),
            **_effect_cells(d),
            **_test_cells(analysis.family if s.main else None, s.questionnaire, d.pair),
        }
        for s in analysis.scales
        for d in s.differences
    ]


def _trials(analysis: Analysis) -> tuple[list[str], list[Row]]:
    data = analysis.data
    factors = [f.column for f in data.factors]
    first = [n for n in ("ppid", "session_num", "trial_num") if n in data.used.columns]
    measures = [d.what.name for d in _described(analysis)]
    names = list(
        dict.fromkeys(
            [
                *first,
                *factors,
                *(n for n, _, _ in TRIALS),
                "success",
                "time_s",
                *[n for n in ("status",) if n in data.used.columns],
                *measures,
            ]
        )
    )
    table = data.used.assign(log2_position=np.log2(data.used["position"].astype(float)))
    if len(table):
        table["log2_position"] -= table["log2_position"].mean()
    whole = ("session_num", "trial_num", "success")
    rows = []
    for row in table[names].to_dict("records"):
        row |= {n: int(row[n]) for n in whole if n in row and row[n] == row[n]}
        row["time_s"] = _known(row["time_s"])
        rows.append(
            {
                k: (None if v != v else f"{v:.10g}" if isinstance(v, float) else v)
                for k, v in row.items()
            }
        )
    return names, rows


def _codebook(analysis: Analysis, trials: Sequence[str]) -> bytes:
    ours = {n: (u, m) for n, u, m in TRIALS}
    rows: list[Row] = [
        {
            "file": "trials.csv",
            "column": n,
            **dict(
                zip(
                    ("unit", "meaning"),
                    ours.get(n, analysis.data.codebook.get(n, ("", ""))),
                    strict=True,
                )
            ),
        }
        for n in trials
    ]
    rows += [
        {"file": file, "column": n, "unit": u, "meaning": m}
        for file, columns in FILES.items()
        for n, u, m in columns
    ]
    return csv_bytes(rows, ("file", "column", "unit", "meaning"))
