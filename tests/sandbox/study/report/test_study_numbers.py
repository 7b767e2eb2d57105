"""What a report computes is what R computes, and no more than the data tell."""

from __future__ import annotations

import json
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.arithmetic import Array
from sandbox.study.report.data import load_study
from sandbox.study.report.make import make_report
from sandbox.study.report.numbers import (
    FEWEST,
    Compared,
    holm,
    interval,
    results,
    sign_flips,
    wilcoxon,
)
from sandbox.study.tables.column import UXF_NAMES
from tests.sandbox.study.report.study_reports import LEAN, Rows, hostile_names, planted, put, write
from tests.support.planted_study import Truth, draw
from tests.support.study_files import rows_of

NOTHING = Truth(people=12, times=(9.0, 9.0), tasks=(1.0,), losses=(0.01, 0.01), repetitions=4)
"""Two levels that are alike."""


def compared(folder: Path, name: str = "time_s") -> Compared:
    found = results(load_study(folder)).of(name)
    assert found is not None
    return found


def test_holm_leaves_out_what_is_not_known() -> None:
    one, none, other = holm([0.01, float("nan"), 0.04])
    assert [one, other] == pytest.approx([0.02, 0.04]) and none != none


def test_the_mean_time_is_that_of_times_of_which_failures_have_the_limit(tmp_path: Path) -> None:
    rows = [{**r, "limit_s": 20.0} for r in planted(tmp_path, Truth(people=6, repetitions=3))]
    put(tmp_path, rows, (*LEAN, "limit_s"))
    one = compared(tmp_path)
    for m in one.cells:
        times: dict[str, list[float]] = {}
        for r in rows:
            if m.name == f"{r['factor_encoder']} / {r['factor_task']}":
                time = float(r["time_s"]) if r["success"] == "1" else 20.0
                times.setdefault(r["ppid"], []).append(time)
        assert m.mean.value == pytest.approx(np.mean([np.mean(own) for own in times.values()]))


def test_everybody_counts_once_however_many_trials(tmp_path: Path) -> None:
    rows = planted(tmp_path / "a")
    put(tmp_path / "a", rows)
    # All of one person's trials are there three times.
    put(tmp_path / "b", [r for r in rows for _ in range(3 if r["ppid"] == "P002" else 1)])
    one, other = (compared(tmp_path / x) for x in "ab")
    assert [m.mean for m in one.cells] == [m.mean for m in other.cells]
    assert [p.estimate for p in one.pairs] == [p.estimate for p in other.pairs]


def test_levels_are_compared_under_equal_circumstances_only(tmp_path: Path) -> None:
    rows = planted(tmp_path / "a")
    # One person did level a at one task alone, the other levels at the other task.
    left = [
        r
        for r in rows
        if r["ppid"] != "P001" or (r["factor_encoder"] == "a") == (r["factor_task"] == "task1")
    ]
    put(tmp_path / "b", left)
    people = {(p.first, p.second): p.people for p in compared(tmp_path / "b").pairs}
    assert people["a", "b"] == people["a", "c"] == 5 and people["b", "c"] == 6


def test_levels_that_nobody_did_both_of_are_compared_as_groups(tmp_path: Path) -> None:
    rows = planted(tmp_path, Truth(people=36, repetitions=2))
    put(tmp_path, [{**r, "factor_encoder": "abc"[int(r["ppid"][1:]) % 3]} for r in rows])
    pairs = [p for p in compared(tmp_path).pairs if p.factor == "encoder"]
    assert {p.people for p in pairs} == {24} and {p.test for p in pairs} == {"Welch"}
    assert all(p.estimate.is_known for p in pairs)


def test_other_names_and_another_order_of_rows_change_nothing(tmp_path: Path) -> None:
    rows = planted(tmp_path / "a")
    put(tmp_path / "b", hostile_names(rows)[::-1])
    one, other = (compared(tmp_path / x) for x in "ab")
    values = [[p.estimate.value for p in c.pairs] for c in (one, other)]
    assert sorted(map(abs, values[0])) == pytest.approx(sorted(map(abs, values[1])))


@pytest.mark.parametrize("people", [2, 3, FEWEST - 1])
def test_few_people_have_dots_and_means_and_no_interval_and_no_test(
    tmp_path: Path, people: int
) -> None:
    planted(tmp_path, Truth(people=people, repetitions=2))
    make_report(tmp_path, tmp_path / "report")
    rows = rows_of(tmp_path / "report/results.csv")
    assert rows and not any(r["low"] or r["high"] or r["p"] for r in rows)
    page = (tmp_path / "report/report.html").read_text(encoding="utf-8")
    assert "p, Holm" not in page and "nothing follows for other people" in page


def test_no_interval_goes_beyond_what_an_outcome_can_be(tmp_path: Path) -> None:
    rng = np.random.default_rng(8)
    rows = planted(tmp_path, Truth(people=7, repetitions=2, losses=(0.2, 1e-9, 1e-9)))
    for r in rows:
        r["grasps"] = int(rng.random() < 0.1)
    put(tmp_path, rows, (*LEAN, "grasps"))
    found = results(load_study(tmp_path), ["grasps"])
    for one in found.compared:
        for m in (*one.cells, *(m for some in one.levels.values() for m in some)):
            if m.mean.is_known:
                assert one.what.low <= m.mean.low <= m.mean.value <= m.mean.high <= one.what.high
        span = one.what.high - one.what.low
        for pair in one.pairs:
            if pair.estimate.is_known:
                assert -span <= pair.estimate.low <= pair.estimate.high <= span


def test_equal_differences_have_no_p_value_interval_or_dz(tmp_path: Path) -> None:
    rows: Rows = [{**r, "success": 1, "held": 1, "status": "held"} for r in planted(tmp_path)]
    for r in rows:
        r["time_s"] = 5.0 + (r["factor_encoder"] == "b") + int(r["ppid"][1:])
    put(tmp_path, rows)
    (pair,) = [p for p in compared(tmp_path).pairs if (p.first, p.second) == ("a", "b")]
    assert pair.estimate.value == pytest.approx(1.0)
    assert not pair.estimate.is_known and pair.p != pair.p and pair.dz != pair.dz


def differences(truth: Truth, seed: int, success: bool = False) -> Array:
    """Differences of a drawn study's people between the second and the first level."""
    drawn = draw(truth, seed)
    held = drawn.status == "held"
    value = held if success else np.where(held, drawn.time, truth.limit)
    own = [np.nanmean(np.where(drawn.level == i, value, np.nan), axis=1) for i in (0, 1)]
    return np.asarray(own[1] - own[0])


def test_where_nothing_differs_one_study_in_twenty_has_a_finding_and_intervals_hold_0() -> None:
    times = [differences(NOTHING, seed) for seed in range(400)]
    covers = sum(e.low <= 0.0 <= e.high for e in map(interval, times))
    assert 0.92 <= covers / 400 <= 0.98
    shares = [differences(NOTHING, seed, success=True) for seed in range(100)]
    # 12 of 100 or fewer, with probability 0.998, if it is one in twenty.
    assert sum(sign_flips(own) < 0.05 for own in shares) <= 12
    ranks = [wilcoxon(np.round(own, 1)) for own in times[:100]]
    assert sum(p < 0.05 for p in ranks) <= 12


def test_intervals_cover_a_difference_that_was_planted() -> None:
    truth = replace(NOTHING, times=(9.0, 6.0))
    whole = differences(replace(truth, people=60_000), 1).mean()
    found = [interval(differences(truth, seed)) for seed in range(400)]
    assert 0.92 <= sum(e.low <= whole <= e.high for e in found) / 400 <= 0.98


def _scores(rows: Rows) -> Rows:
    """A score of everybody under each level."""
    rng = np.random.default_rng(3)
    asked = dict.fromkeys((r["ppid"], r["factor_encoder"]) for r in rows)
    better = {level: 10 * i for i, level in enumerate(dict.fromkeys(level for _, level in asked))}
    return [
        {
            "ppid": ppid,
            "instrument": "sus",
            "scale": "sus",
            "score": int(rng.choice([40, 50, 60, 70])) + better[level],
            "score_low": 0,
            "score_high": 100,
            "factor_encoder": level,
            "place": 1,
        }
        for ppid, level in asked
    ]


def own_names(rows: Rows) -> Rows:
    """Rows with the names of columns that tables have unless those of UXF are asked for."""
    ours = {theirs: name for name, theirs in UXF_NAMES.items()}
    return [{ours.get(name, name): value for name, value in row.items()} for row in rows]


@pytest.mark.needs("r")
@pytest.mark.parametrize("change", [lambda rows: rows, hostile_names, own_names])
def test_models_of_r_stand_beside_the_numbers_of_the_page_on_its_scale(
    tmp_path: Path, change: object
) -> None:
    planned = planted(tmp_path, Truth(people=12))
    rows = change(planned)  # type: ignore[operator]
    put(tmp_path, rows, tuple(n for n in rows[0] if UXF_NAMES.get(n, n) in LEAN))
    scores = own_names(_scores(planned)) if change is own_names else _scores(rows)
    write(tmp_path, "scores.csv", scores)
    folder = tmp_path / "report"
    make_report(tmp_path, folder)
    # The locale of a scheduled job knows no letter beyond ASCII.
    subprocess.run(
        ["env", "LC_ALL=C", "Rscript", "analysis.R"], cwd=folder, check=True, capture_output=True
    )
    found = rows_of(folder / "results_R.csv")
    ours = {
        (one.what.name, p.factor, p.first, p.second): p
        for one in results(load_study(tmp_path)).compared
        for p in one.pairs
    }
    alike = [row for row in found if row["kind"] == "difference"]
    assert {row["outcome"] for row in alike} == {"time_s", "success", "sus"}
    assert len(alike) == len(ours) == 11
    for row in found:
        pair = ours[row["outcome"], row["factor"], row["first"], row["second"]]
        value, width = pair.estimate.value, pair.estimate.high - pair.estimate.low
        if row["kind"] == "difference":
            # Other models of the same data: within a fourth of our interval.
            assert float(row["estimate"]) == pytest.approx(value, abs=width / 4), json.dumps(row)
        elif float(row["p"]) < 0.05:
            assert (float(row["estimate"]) > 1.0) == (value > 0.0), json.dumps(row)
    make_report(tmp_path, folder)
    assert "Beside the models of analysis.R" in (folder / "report.html").read_text(encoding="utf-8")


def test_the_six_decimals_of_a_table_change_no_p_value_of_wilcoxon() -> None:
    rng = np.random.default_rng(7)
    for _ in range(50):
        # Means of six ratings in steps of 5, as of NASA-TLX: many differences are equal.
        first, second = 5.0 * rng.integers(0, 21, (2, 12, 6)).mean(axis=2)
        exact = wilcoxon(second - first)
        assert wilcoxon(np.round(second, 6) - np.round(first, 6)) == pytest.approx(exact, abs=1e-12)
