"""The CSVs beside the page: all numbers that it shows, and the trials that they are from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from sandbox.study.report.models.analysis import Analysis, MeasureModel, MeasureSummary, adjusted
from sandbox.study.report.models.answers import adjusted as adjusted_scales
from sandbox.study.report.models.censored import Censored
from sandbox.study.report.models.comparisons import Difference, pairs_of
from sandbox.study.report.models.exclusions import endings, flow
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
FILES: dict[str, tuple[Column, ...]] = {
    "means.csv": (
        ("measure", "", "as in trial_results.csv"),
        ("unit", "", "of mean and limits"),
        ("by", "", "condition, or the factor whose levels these are"),
        ("name", "", "of the condition or level"),
        ("people", "", "participants it is from"),
        ("trials", "", "trials it is from"),
        ("mean", "see unit", "over people, each counting once; geometric for logarithmic measures"),
        *INTERVAL,
        (
            "within_low",
            "see unit",
            "lower end of the interval for comparing, without differences between people",
        ),
        ("within_high", "see unit", "upper end of the same"),
    ),
    "comparisons.csv": (
        ("measure", "", "as in trial_results.csv"),
        ("model", "", f"{MIXED}; {CENSORED}; {SHARES}; {GEE}"),
        ("factor", "", "whose levels are compared"),
        ("first", "", "level against which the second is compared"),
        ("second", "", "level"),
        ("kind", "", "ratio, difference or odds ratio: of the second to the first"),
        ("estimate", "see kind", "averaged over the levels of the other factors"),
        *INTERVAL,
        ("error", "", "standard error; of ratios, of their logarithm"),
        ("freedom", "", "degrees of freedom"),
        ("p", "", "for this pair alone"),
        ("p_holm", "", "adjusted for all pairs of this factor"),
    ),
    "models.csv": (
        ("measure", "", "as in trial_results.csv"),
        ("model", "", f"{MIXED}; {CENSORED}"),
        ("term", "", "mean of a condition, change with log2 of the trial, or standard deviation"),
        ("estimate", "", "on the scale of the model: of logarithms, where the measure is one"),
        ("error", "", "standard error"),
    ),
    "contrasts.csv": (
        ("factor", "", "whose levels are compared"),
        ("first", "", "level"),
        ("second", "", "level"),
        ("condition", "", "as in trials.csv"),
        ("weight", "", "of the condition's mean in the difference second - first"),
    ),
    "people.csv": (
        ("ppid", "", "pseudonym"),
        ("measure", "", "as in trial_results.csv"),
        ("condition", "", "as in trials.csv"),
        ("mean", "", "of this person's trials; geometric for logarithmic measures"),
    ),
    "order.csv": (
        ("factor", "", "that has the level"),
        ("level", "", ""),
        ("place", "", "1, 2, ...: place of the level in the order"),
        ("times", "", "how often it was there"),
        ("mean", "s", "completion time, other conditions' differences taken out"),
        *INTERVAL,
    ),
    "learning.csv": (
        ("level", "", "of the first factor"),
        ("first", "", "number of the trial with this level"),
        ("last", "", "the same, where several are put together"),
        ("people", "", "participants it is from"),
        ("mean", "s", "completion time, other conditions' differences taken out"),
        *INTERVAL,
    ),
    "scores.csv": (
        ("questionnaire", "", "its name"),
        ("scale", "", "its scale, or the single question"),
        ("level", "", "that it was asked about"),
        ("people", "", "who answered"),
        ("mean", "", "over people"),
        *INTERVAL,
    ),
    "score_comparisons.csv": (
        ("questionnaire", "", "its name"),
        ("scale", "", "its scale, or the single question"),
        ("first", "", "level"),
        ("second", "", "level"),
        ("estimate", "", "difference of the means, second - first"),
        *INTERVAL,
        ("p", "", "of the t test for this pair alone"),
        ("p_holm", "", "adjusted for all pairs of this scale"),
    ),
    "exclusions.csv": (
        ("step", "", "from everything to what is used"),
        ("participants", "", "left, or taken away with their last trial"),
        ("trials", "", "left, or taken away"),
        ("remains", "0/1", "1: so many are left; 0: so many are taken away"),
    ),
    "endings.csv": (
        ("condition", "", "as in trials.csv"),
        ("ending", "", "success, or the status without one"),
        ("trials", "", "how many"),
    ),
}
"""Every file's columns; the codebook is made of this."""
TRIALS: tuple[Column, ...] = (
    ("condition", "", "levels of all factors"),
    ("position", "", "1, 2, ... of the participant's trials, practice not counted"),
    ("log2_position", "", "its logarithm to base 2, less the mean over all rows"),
    ("censored", "0/1", "1: no success; the time it would have taken is longer than time_s"),
)


def tables(found: Analysis) -> dict[str, bytes]:
    """All files by name."""
    rows = {
        "means.csv": _means(found),
        "comparisons.csv": _comparisons(found),
        "models.csv": _models(found),
        "contrasts.csv": _contrasts(found),
        "people.csv": _people(found),
        "order.csv": [{**vars(p), **_interval(p.mean)} for ps in found.places.values() for p in ps],
        "learning.csv": [{**vars(p), **_interval(p.mean)} for p in found.learning],
        "scores.csv": _scores(found),
        "score_comparisons.csv": _score_comparisons(found),
        "exclusions.csv": [{**vars(s), "step": s.what} for s in flow(found.data)],
        "endings.csv": [
            {"condition": c, "ending": e, "trials": n}
            for c, kinds in endings(found.data).items()
            for e, n in kinds.items()
        ],
    }
    files = {
        name: csv_bytes(rows[name], [c for c, _, _ in columns]) for name, columns in FILES.items()
    }
    names, trials = _trials(found)
    files["trials.csv"] = csv_bytes(trials, names)
    files["codebook.csv"] = _codebook(found, names)
    return files


def csv_bytes(rows: Sequence[Row], columns: Sequence[str]) -> bytes:
    """A table with ten digits of every number, as R, pandas and spreadsheets read it."""
    import pandas as pd

    cells = [
        {k: int(v) if isinstance(v, bool | np.bool_) else v for k, v in row.items()} for row in rows
    ]
    text: str = pd.DataFrame(cells, columns=list(columns), dtype=object).to_csv(
        index=False, lineterminator="\n", float_format="%.10g"
    )
    return text.encode()


def _interval(e: Any) -> Row:
    return {"mean": _known(e.value), "low": _known(e.low), "high": _known(e.high)}


def _known(value: float) -> float | None:
    """Nothing instead of nan or infinity, which are words to a spreadsheet."""
    return float(value) if np.isfinite(value) else None


def _described(found: Analysis) -> Iterable[MeasureSummary]:
    yield from (m.described for m in _modelled(found))
    yield from found.rest


def _modelled(found: Analysis) -> Iterable[MeasureModel]:
    yield from (m for m in (found.time, found.success, *found.asked) if m is not None)


def _means(found: Analysis) -> list[Row]:
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
        for one in _described(found)
        for by, some in (("condition", one.conditions), *one.levels.items())
        for s in some
    ]


def _comparisons(found: Analysis) -> list[Row]:
    rows: list[Row] = []
    for one in _modelled(found):
        what = one.described.what
        kind = "ratio" if what.scale == LOG else "difference"
        rows += _differences(what.name, MIXED, kind, one.differences)
        rows += _shares(what.name, one.shares)
    rows += _differences("time_s", CENSORED, "ratio", found.unseen)
    if not isinstance(found.odds, str):
        rows += _differences("success", GEE, "odds ratio", found.odds)
    return rows


def _differences(measure: str, model: str, kind: str, some: Sequence[Difference]) -> list[Row]:
    change = (lambda x: x) if kind == "difference" else np.exp
    return [
        {
            "measure": measure,
            "model": model,
            "factor": d.pair.factor.name,
            "first": d.pair.first,
            "second": d.pair.second,
            "kind": kind,
            "estimate": _known(change(d.estimate.value)),
            "low": _known(change(d.estimate.low)),
            "high": _known(change(d.estimate.high)),
            "error": _known(d.error),
            "freedom": _known(d.freedom),
            "p": _known(d.p),
            "p_holm": _known(p),
        }
        for d, p in zip(some, adjusted(some), strict=True)
    ]


def _shares(measure: str, some: Sequence[ShareDifference]) -> list[Row]:
    return [
        {
            "measure": measure,
            "model": SHARES,
            "factor": d.pair.factor.name,
            "first": d.pair.first,
            "second": d.pair.second,
            "kind": "difference",
            "estimate": _known(d.estimate.value),
            "low": _known(d.estimate.low),
            "high": _known(d.estimate.high),
            "p": _known(d.p),
            "p_holm": _known(p),
        }
        for d, p in zip(some, adjusted(some), strict=True)
    ]


def _models(found: Analysis) -> list[Row]:
    rows: list[Row] = []
    for one in _modelled(found):
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
    if isinstance(found.censored, Censored):
        about = {"measure": "time_s", "model": CENSORED}
        for i, name in enumerate(found.censored.names):
            unit = np.eye(len(found.censored.names))[i]
            rows.append(
                {
                    **about,
                    "term": name,
                    "estimate": float(found.censored.coefficients[i]),
                    "error": _known(found.censored.error(unit)),
                }
            )
        rows.append({**about, "term": "sd total", "estimate": found.censored.sigma})
    return rows


def _contrasts(found: Analysis) -> list[Row]:
    data = found.data
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


def _people(found: Analysis) -> list[Row]:
    data = found.data
    return [
        {"ppid": ppid, "measure": one.what.name, "condition": name, "mean": one.what.back(value)}
        for one in _described(found)
        for ppid, own in zip(data.ppids, person_means(data, one.what), strict=True)
        for name, value in zip(data.conditions, own, strict=True)
        if np.isfinite(value)
    ]


def _scores(found: Analysis) -> list[Row]:
    return [
        {
            "questionnaire": s.questionnaire,
            "scale": s.scale,
            "level": level,
            "people": int(np.isfinite(s.values[:, j]).sum()),
            **_interval(s.means[j]),
        }
        for s in found.scales
        for j, level in enumerate(s.levels)
    ]


def _score_comparisons(found: Analysis) -> list[Row]:
    return [
        {
            "questionnaire": s.questionnaire,
            "scale": s.scale,
            "first": d.pair.first,
            "second": d.pair.second,
            "estimate": _known(d.estimate.value),
            "low": _known(d.estimate.low),
            "high": _known(d.estimate.high),
            "p": _known(d.p),
            "p_holm": _known(p),
        }
        for s in found.scales
        for d, p in zip(s.differences, adjusted_scales(s), strict=True)
    ]


def _trials(found: Analysis) -> tuple[list[str], list[Row]]:
    data = found.data
    factors = [f.column for f in data.factors]
    first = [n for n in ("ppid", "session_num", "trial_num") if n in data.used.columns]
    measures = [d.what.name for d in _described(found)]
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


def _codebook(found: Analysis, trials: Sequence[str]) -> bytes:
    ours = {n: (u, m) for n, u, m in TRIALS}
    rows: list[Row] = [
        {
            "file": "trials.csv",
            "column": n,
            **dict(
                zip(
                    ("unit", "meaning"),
                    ours.get(n, found.data.codebook.get(n, ("", ""))),
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
