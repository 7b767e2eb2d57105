"""Standardised effects, simple effects and interactions, singular fits, and intervals at bounds."""

from __future__ import annotations

from dataclasses import replace
from math import log
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from sandbox.study.report.models.analysis import analyse
from sandbox.study.report.models.answers import _differences
from sandbox.study.report.models.comparisons import Counts, Pair, t_difference, titles_of
from sandbox.study.report.models.data import ObservedFactor, StudyData, load_study
from sandbox.study.report.models.interactions import INTERACTION, SIMPLE
from sandbox.study.report.models.intervals import mean_interval, share, within_intervals
from sandbox.study.report.models.mixed import Mixed
from sandbox.study.report.models.success import success_differences
from tests.sandbox.study.report.study_reports import LEAN, planted, put, report, rows_of
from tests.support.planted_study import Truth

EVERY = Truth(people=12, times=(10.0, 8.5), repetitions=2, losses=(1e-9, 1e-9), limit=3600.0)


def study(folder: Path, truth: Truth = EVERY, seed: int = 1) -> StudyData:
    planted(folder, truth, seed)
    return load_study(folder)


def test_dz_is_that_of_the_paired_t_test(tmp_path: Path) -> None:
    data = study(tmp_path)
    found = analyse(data)
    (d,) = (d for d in found.leading if d.pair.factor.name == "encoder")
    means = (
        data.used.assign(y=np.log(data.used["time_s"]))
        .pivot_table(index="ppid", columns="factor_encoder", values="y")
        .diff(axis=1)["b"]
    )
    assert d.spread == pytest.approx(means.std(), rel=0.1)
    assert d.size == pytest.approx(means.mean() / means.std(), rel=0.1)
    assert d.size == pytest.approx(d.estimate.value / d.error / np.sqrt(12))
    page = report(tmp_path)
    (row,) = (
        r
        for r in rows_of(tmp_path / "report" / "comparisons.csv")
        if r["model"] == "mixed model" and r["factor"] == "encoder"
    )
    assert float(row["dz"]) == pytest.approx(d.size) and float(row["sd"]) == pytest.approx(d.spread)
    assert "SD, log dz p p, Holm" in page.text


def test_between_groups_the_standardised_effect_is_cohens_d(tmp_path: Path) -> None:
    rows = planted(tmp_path, replace(EVERY, repetitions=4))
    rows = [r for r in rows if (int(r["ppid"][1:]) % 3 == 0) == (r["factor_encoder"] == "a")]
    put(tmp_path, rows)
    data = load_study(tmp_path)
    (d,) = (d for d in analyse(data).leading if d.pair.factor.name == "encoder")
    y = data.used.assign(y=np.log(data.used["time_s"])).groupby(["factor_encoder", "ppid"])["y"]
    a, b = (y.mean()[level] for level in "ab")
    pooled = np.sqrt(((len(a) - 1) * a.var() + (len(b) - 1) * b.var()) / (len(a) + len(b) - 2))
    # The first level is the one that appears first.
    assert abs(d.size) == pytest.approx(abs(b.mean() - a.mean()) / pooled, rel=0.05)


def test_an_interaction_that_was_planted_is_in_its_interval_and_others_are_near_0(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path, replace(EVERY, people=24))
    for r in rows:
        if (r["factor_encoder"], r["factor_task"]) == ("b", "task2"):
            r["time_s"] = float(r["time_s"]) * 1.6
    put(tmp_path, rows)
    found = analyse(load_study(tmp_path))
    assert found.time is not None
    told = {(d.kind, d.pair.at): d.estimate for d in found.time.dependences}
    assert set(told) == {(SIMPLE, "task1"), (SIMPLE, "task2"), (INTERACTION, "task2")}
    both = told[INTERACTION, "task2"]
    assert both.value == pytest.approx(told[SIMPLE, "task2"].value - told[SIMPLE, "task1"].value)
    assert both.low < log(1.6) < both.high and both.low > 0.0
    assert told[SIMPLE, "task1"].low < log(0.85) < told[SIMPLE, "task1"].high
    shares = {d.kind: d.estimate for d in found.success.dependences} if found.success else {}
    assert shares[INTERACTION].low < 0.0 < shares[INTERACTION].high
    report(tmp_path)
    rows = rows_of(tmp_path / "report" / "interactions.csv")
    (row,) = (r for r in rows if (r["measure"], r["kind"]) == ("time_s", INTERACTION))
    assert (row["at"], row["against"]) == ("task2", "task1")
    assert float(row["estimate"]) == pytest.approx(np.exp(both.value))


def test_a_nested_factor_has_no_interaction(tmp_path: Path) -> None:
    rows = planted(tmp_path)
    for r in rows:
        r["factor_task"] = f"{r['factor_encoder']}-{r['factor_task']}"
    put(tmp_path, rows)
    found = analyse(load_study(tmp_path))
    assert found.time is not None and not found.time.dependences


def test_levels_that_one_group_alone_did_are_compared_by_the_people_of_that_group(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path, replace(EVERY, repetitions=4))
    for r in rows:
        r["factor_task"] = "outer" if int(r["ppid"][1:]) % 3 else "other"
        r["factor_encoder"] = f"{r['factor_encoder']} {r['factor_task']}"
    put(tmp_path, rows)
    found = analyse(load_study(tmp_path))
    inner = {d.pair.title: d for d in found.leading if d.pair.factor.name == "encoder"}
    assert {title: d.freedom for title, d in inner.items()} == {
        "b outer against a outer": 7.0,
        "b other against a other": 3.0,
    }


def test_simple_effects_and_interactions_count_only_people_whose_measure_is_known(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path, EVERY)
    for r in rows:
        r["label_recovery_s"] = "" if int(r["ppid"][1:]) > 4 else r["time_s"]
    put(tmp_path, rows, (*LEAN, "label_recovery_s"))
    asked = ["label_recovery_s"]
    some = analyse(load_study(tmp_path), asked).asked[0]
    put(tmp_path, [r for r in rows if int(r["ppid"][1:]) <= 4], (*LEAN, "label_recovery_s"))
    alone = analyse(load_study(tmp_path), asked).asked[0]
    assert len(some.dependences) == 3
    for one, same in zip(some.dependences, alone.dependences, strict=True):
        assert (one.kind, one.pair.title) == (same.kind, same.pair.title)
        assert (one.estimate.low, one.estimate.high) == pytest.approx(
            (same.estimate.low, same.estimate.high)
        )


def test_a_singular_fit_is_said_to_be_one(tmp_path: Path) -> None:
    data = study(tmp_path, replace(EVERY, person_level=0.0, person=0.3, people=8), 3)
    found = analyse(data)
    assert found.time is not None and isinstance(found.time.model, Mixed)
    model = found.time.model
    assert model.singular
    assert all(model.spreads[name] == 0.0 for name in model.singular)
    assert "the fit is singular" in report(tmp_path).text


def test_a_spread_that_is_there_is_not_singular(tmp_path: Path) -> None:
    found = analyse(study(tmp_path, replace(EVERY, person=0.5, person_level=0.5, repetitions=4)))
    assert found.time is not None and isinstance(found.time.model, Mixed)
    assert not {"person", "person x encoder"} & set(found.time.model.singular)


def test_the_interval_for_comparing_shares_is_wilsons_near_the_bounds(tmp_path: Path) -> None:
    found = analyse(study(tmp_path))
    assert found.success is not None
    for s in found.success.described.conditions:
        # 24 trials of which each succeeded.
        low, high = s.within.low, s.within.high
        assert (s.within.value, high) == (1.0, 1.0)
        assert low == pytest.approx(
            stats.binomtest(24, 24).proportion_ci(method="wilson").low, abs=0.03
        )
        assert low == s.mean.low


def test_without_differences_between_people_an_interval_of_shares_is_narrower() -> None:
    own = [0.2, 0.4, 0.6, 0.8, 0.9]
    wide, narrow = share(own, [10] * 5), share(own, [10] * 5, deviation=0.05)
    assert wide.low < narrow.low < narrow.value < narrow.high < wide.high
    # Never narrower than by so many independent trials.
    assert narrow.effective == 50


def test_equal_values_have_no_interval() -> None:
    one = mean_interval([3.0, 3.0, 3.0])
    assert one.value == 3.0 and np.isnan([one.low, one.high]).all()
    pair = Pair(ObservedFactor("f", ("a", "b"), True), "a", "b", ())
    d = t_difference(pair, 1.0, 0.0, Counts(2.0, 3.0))
    assert np.isnan([d.estimate.low, d.estimate.high, d.p]).all()


@given(
    own=st.lists(st.integers(0, 900), min_size=2, max_size=8),
    step=st.integers(-300, 300),
    parts=st.sampled_from([1, 6, 15]),
)
def test_differences_that_rounding_alone_makes_unequal_have_no_p_value_interval_or_dz(
    own: list[int], step: int, parts: int
) -> None:
    values = np.array([[round(x / parts, 6), round((x + step) / parts, 6)] for x in own])
    (d,) = _differences(ObservedFactor("f", ("a", "b"), True), ("a", "b"), values)
    assert d.estimate.value == pytest.approx(step / parts, abs=2e-6)
    assert np.isnan([d.p, d.estimate.low, d.estimate.high, d.size]).all()
    assert all(np.isnan([e.low, e.high]).all() for e in within_intervals(values))


def test_groups_that_rounding_alone_makes_unequal_have_no_p_value_interval_or_dz() -> None:
    values = np.array([[0.1 + 0.2, np.nan], [0.3, np.nan], [np.nan, 0.7], [np.nan, 0.700001]])
    (d,) = _differences(ObservedFactor("f", ("a", "b"), False), ("a", "b"), values)
    assert np.isnan([d.p, d.estimate.low, d.estimate.high, d.size]).all()
    one = mean_interval([0.1 + 0.2, 0.3, 0.300001])
    assert np.isnan([one.low, one.high]).all()


def test_a_spread_beyond_rounding_has_a_p_value_an_interval_and_dz() -> None:
    values = np.array([[10.0, 20.0], [10.0, 20.0], [10.0, 20.0001]])
    (d,) = _differences(ObservedFactor("f", ("a", "b"), True), ("a", "b"), values)
    assert np.isfinite([d.p, d.estimate.low, d.estimate.high, d.size]).all()


def test_equal_differences_of_a_measure_have_no_p_value_interval_or_dz(tmp_path: Path) -> None:
    rows = planted(tmp_path, replace(EVERY, people=6, repetitions=2))
    for r in rows:
        own = 40 + int(r["ppid"][1:]) / 7 + 40 / 3 * "abc".index(r["factor_encoder"])
        r["palm_sparc"] = f"{-own:.6f}"
    put(tmp_path, rows, (*LEAN, "palm_sparc"))
    (asked,) = analyse(load_study(tmp_path), ["palm_sparc"]).asked
    for d in asked.differences:
        assert np.isnan([d.p, d.estimate.low, d.estimate.high, d.size]).all()


def test_equal_differences_of_shares_have_no_dz(tmp_path: Path) -> None:
    rows = planted(tmp_path, replace(EVERY, people=6, repetitions=3, tasks=(1.0,)))
    for r in rows:
        # Of three trials each, some people succeed in one and two, the others in two and three.
        won = 1 + int(r["ppid"][1:]) % 2 + ("abc".index(r["factor_encoder"]) == 1)
        r["success"] = int(int(r["repetition"]) <= won)
    put(tmp_path, rows)
    (d,) = success_differences(load_study(tmp_path))
    assert d.estimate.value == pytest.approx(1 / 3)
    assert d.spread == 0.0 and np.isnan(d.size)


def test_a_spread_is_told_where_nearly_all_did_both_levels_and_not_where_few_did(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path / "all", replace(EVERY, repetitions=4))
    people = sorted({r["ppid"] for r in rows})
    for folder, missing in (("most", people[:1]), ("few", people[:8])):
        some = [r for r in rows if r["ppid"] not in missing or r["factor_encoder"] == "a"]
        put(tmp_path / folder, some)
        data = load_study(tmp_path / folder)
        (d,) = (d for d in analyse(data).leading if d.pair.factor.name == "encoder")
        # Who did one level only tells nothing of how differences vary over people.
        assert d.freedom == len(people) - len(missing) - 1
        if folder == "few":
            assert np.isnan(d.spread) and np.isnan(d.size) and d.p > 0.0
            continue
        y = data.used.assign(y=np.log(data.used["time_s"]))
        own = y.pivot_table(index="ppid", columns="factor_encoder", values="y").diff(axis=1)["b"]
        assert d.spread == pytest.approx(own.std(), rel=0.15)


def test_levels_that_nobody_did_both_of_are_compared_as_groups(tmp_path: Path) -> None:
    rows = planted(tmp_path, replace(EVERY, repetitions=4))
    a, b = "ab"
    kept = [
        {**r, "factor_encoder": a if int(r["ppid"][1:]) % 2 else b}
        for r in rows
        if r["factor_encoder"] == (a if int(r["ppid"][1:]) % 2 else b)
    ]
    # One person with both makes it a factor within people, and then is left out of this pair.
    rest = [{**r, "factor_encoder": "c"} for r in kept if r["ppid"] in ("P001", "P002")]
    put(tmp_path, [*kept, *rest])
    (d,) = (d for d in analyse(load_study(tmp_path)).leading if d.pair.title == "b against a")
    assert d.pair.factor.within and d.freedom == EVERY.people - 2
    assert "nobody did both" in report(tmp_path).text


def test_what_is_learned_from_one_session_to_the_next_is_the_difference_between_them(
    tmp_path: Path,
) -> None:
    rng, rows = np.random.default_rng(3), []
    for person in range(10):
        own, done = rng.normal(0.0, 0.2), 0
        for session in (1, 2):
            for trial in range(1, 13):
                done += 1
                time = 12.0 * done**-0.25 * np.exp(own + rng.normal(0.0, 0.1))
                row = dict.fromkeys(LEAN, "") | {
                    "ppid": f"P{person:03d}",
                    "session_num": session,
                    "trial_num": trial,
                    "counted": 1,
                    "practice": 0,
                    "excluded": 0,
                    "success": 1,
                    "time_s": float(time),
                    "factor_encoder": "cubic",
                }
                rows.append(row)
    put(tmp_path, rows)
    (d,) = analyse(load_study(tmp_path)).leading
    means = [
        float(np.mean([-0.25 * log(i) for i in span])) for span in (range(1, 13), range(13, 25))
    ]
    assert d.pair.title == "session 2 against session 1"
    assert d.estimate.low < means[1] - means[0] < d.estimate.high < 0.0


def test_the_spread_of_a_factor_inside_of_groups_is_that_of_the_people_who_did_it(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path, replace(EVERY, people=16, repetitions=4))
    tasks = sorted({r["factor_task"] for r in rows})
    kept = []
    for row in rows:
        group = int(row["ppid"][1:]) % 2
        if row["factor_task"] == tasks[group]:
            kept.append({**row, "factor_encoder": row["factor_encoder"] + str(group)})
    put(tmp_path, kept)
    data = load_study(tmp_path)
    found = [d for d in analyse(data).leading if d.pair.factor.name == "encoder"]
    assert len(found) == 2
    y = data.used.assign(y=np.log(data.used["time_s"]))
    own = y.pivot_table(index="ppid", columns="factor_encoder", values="y")
    for d in found:
        assert d.people.effective == 8.0
        assert d.spread == pytest.approx((own[d.pair.second] - own[d.pair.first]).std(), rel=0.4)


def test_levels_of_two_factors_with_the_same_names_are_told_apart(tmp_path: Path) -> None:
    rows = planted(tmp_path)
    encoders = sorted({r["factor_encoder"] for r in rows})[:2]
    tasks = sorted({r["factor_task"] for r in rows})
    named = dict(zip((*encoders, *tasks), ("off", "on") * 2, strict=True))
    put(
        tmp_path,
        [
            {
                **r,
                "factor_encoder": named[r["factor_encoder"]],
                "factor_task": named[r["factor_task"]],
            }
            for r in rows
            if r["factor_encoder"] in encoders
        ],
    )
    leading = analyse(load_study(tmp_path)).leading
    assert len({d.pair.title for d in leading}) == 1
    titles = titles_of(leading)
    assert len(set(titles)) == len(titles) == 2 and all("factor" not in t for t in titles)
    page = report(tmp_path)
    assert all(page.text.count(title) >= 1 for title in titles)
