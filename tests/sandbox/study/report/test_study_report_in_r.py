"""R, with lme4, survival and geepack, finds the differences that the report finds."""

from __future__ import annotations

import csv
import math
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sandbox.study.report.make import make_report
from tests.sandbox.study.report.study_reports import (
    LEAN,
    Rows,
    hostile_names,
    planted,
    put,
    rows_of,
)
from tests.support.planted_study import Truth

LOGARITHMS = ("time_s", "object_path_m", "success")
"""Measures whose differences the report tells as ratios, and R as their logarithms."""
TIGHT, LOOSE = 1e-3, 0.02
"""Tolerance, in standard errors, of the same model fitted by another program, and of generalised
estimating equations, where programs stop at other steps."""


def plain(rows: Rows) -> Rows:
    return rows


def numbered(rows: Rows) -> Rows:
    return [{**r, "factor_encoder": "abc".index(r["factor_encoder"]) + 1} for r in rows]


def between_people(rows: Rows) -> Rows:
    return [{**r, "factor_encoder": "abc"[int(r["ppid"][1:]) % 3]} for r in rows]


def mixed(rows: Rows) -> Rows:
    return [{**r, "factor_task": "xy"[int(r["ppid"][1:]) % 2]} for r in rows]


def nested(rows: Rows) -> Rows:
    return [{**r, "factor_task": f"{r['factor_encoder']}-{r['factor_task']}"} for r in rows]


def times_missing(rows: Rows) -> Rows:
    return [{**r, "time_s": ""} for r in rows]


def with_paths(rows: Rows) -> Rows:
    rng = np.random.default_rng(3)
    return [{**r, "object_path_m": float(np.exp(0.3 * rng.normal()))} for r in rows]


Key = tuple[str, ...]


def differences(path: Path) -> dict[Key, dict[str, str]]:
    """Rows of a table of comparisons, by what they compare."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    names = ("measure", "model", "factor", "first", "second")
    return {tuple(row[name] for name in names): row for row in rows}


@pytest.mark.needs("r")
@pytest.mark.parametrize(
    "change",
    [
        plain,
        numbered,
        between_people,
        mixed,
        nested,
        times_missing,
        with_paths,
        hostile_names,
    ],
)
def test_r_finds_the_same_differences_and_intervals(
    tmp_path: Path, change: Callable[[Rows], Rows]
) -> None:
    rows = change(planted(tmp_path, Truth(people=12)))
    put(tmp_path, rows, (*LEAN, "object_path_m") if change is with_paths else LEAN)
    folder = tmp_path / "report"
    make_report(tmp_path, folder, ["object_path_m"] if change is with_paths else [])
    # The locale of a scheduled job knows no letter beyond ASCII.
    run = subprocess.run(
        ["Rscript", "analysis.R"],
        check=False,
        cwd=folder,
        env={**os.environ, "LC_ALL": "C"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    ours, theirs = (differences(folder / n) for n in ("comparisons.csv", "comparisons_R.csv"))
    modelled = {k for k in ours if k[1] in ("mixed model", "with unseen times", "GEE")}
    assert theirs.keys() == modelled and len(modelled) >= 3
    assert {k[0] for k in modelled} >= ({"object_path_m"} if change is with_paths else set())
    for key in modelled:
        measure, model = key[:2]
        assert measure in LOGARITHMS
        low, value, high = (math.log(float(ours[key][n])) for n in ("low", "estimate", "high"))
        found = [float(theirs[key][n]) for n in ("low", "estimate", "high")]
        error = float(theirs[key]["error"])
        assert float(ours[key]["freedom"]) == float(theirs[key]["freedom"])
        if model == "GEE":
            # The report's errors, of Mancl and DeRouen, are larger than those of geepack.
            assert found[1] == pytest.approx(value, abs=LOOSE * error)
            assert high - low > found[2] - found[0]
        else:
            assert found == pytest.approx([low, value, high], abs=TIGHT * error)


def test_the_script_is_ascii_whatever_levels_are_called(tmp_path: Path) -> None:
    put(tmp_path, hostile_names(planted(tmp_path)))
    make_report(tmp_path, tmp_path / "report", [])
    assert (tmp_path / "report" / "analysis.R").read_bytes().isascii()
    assert any("ü" in row["factor_encoder"] for row in rows_of(tmp_path / "trial_results.csv"))
