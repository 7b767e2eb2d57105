"""The report's models and intervals against what is known: published examples, planted truths."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from sandbox.study.report.models.censored import Censored, censored_differences, fit_censored, tobit
from sandbox.study.report.models.comparisons import pairs_of
from sandbox.study.report.models.data import StudyData, load_study
from sandbox.study.report.models.intervals import (
    Share,
    design_effect,
    difference,
    holm,
    mean_interval,
    share,
    within_intervals,
)
from sandbox.study.report.models.mixed import Mixed, fit_mixed, mixed_differences
from sandbox.study.report.models.order import balanced, neighbours, places
from sandbox.study.report.models.quantities import quantity, rows_with
from sandbox.study.report.models.success import group_test, sign_test, success_differences
from sandbox.study.report.models.summaries import median_with_unseen, summaries
from tests.support.planted_study import Truth, draw, true_success, write_study
from tests.support.study_coverage import SCENARIOS, SEEN, SHARES, TIMES, studies

EVERY = SCENARIOS["effects, every trial succeeds"]
FEW = replace(Truth(), people=12, repetitions=2)
NONE = replace(SCENARIOS["no effects"], people=12, repetitions=2)


def study(folder: Path, truth: Truth, seed: int = 0) -> StudyData:
    write_study(folder, truth, seed)
    return load_study(folder)


def test_wilsons_interval_of_one_persons_trials_is_the_published_one() -> None:
    # Newcombe 1998, table I: 81 of 263.
    found = share([81 / 263], [263])
    assert (found.low, found.high) == pytest.approx((0.2553, 0.3662), abs=5e-5)


def test_the_difference_of_two_shares_is_newcombes_published_example() -> None:
    # Newcombe 1998, method 10, example (a): 56/70 - 48/80.
    a, b = share([56 / 70], [70]), share([48 / 80], [80])
    found = difference(a, b)
    assert (found.low, found.high) == pytest.approx((0.0524, 0.3339), abs=5e-5)


def test_holm_is_the_textbooks() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert np.isnan(holm([float("nan"), 0.01])[0])
    assert holm([float("nan"), 0.01])[1] == 0.01


def test_intervals_for_comparing_two_conditions_are_those_of_the_paired_t_test() -> None:
    rng = np.random.default_rng(1)
    table = rng.normal(size=(11, 1)) * 5 + rng.normal(size=(11, 2))
    low, high = stats.ttest_rel(table[:, 1], table[:, 0]).confidence_interval()
    for e in within_intervals(table):
        assert (e.high - e.low) * np.sqrt(2) == pytest.approx(high - low)


def test_intervals_for_comparing_are_those_of_each_group_alone() -> None:
    rng = np.random.default_rng(1)
    first, second = (rng.normal(size=(n, 1)) * 5 + rng.normal(size=(n, 3)) for n in (6, 7))
    nothing = np.full((6, 3), np.nan), np.full((7, 3), np.nan)
    table = np.vstack([np.hstack([first, nothing[0]]), np.hstack([nothing[1], second])])
    found = within_intervals(table)
    assert found == [*within_intervals(first), *within_intervals(second)]
    own = mean_interval(first[:, 0].tolist())
    # The means of people who differ much are far less certain than the differences.
    assert found[0].high - found[0].low < 0.5 * (own.high - own.low)


def test_intervals_for_comparing_of_people_with_one_condition_are_those_of_their_means() -> None:
    table = np.array([[1.0, np.nan], [2.0, np.nan], [np.nan, 3.0], [np.nan, 5.0]])
    assert within_intervals(table) == [mean_interval([1.0, 2.0]), mean_interval([3.0, 5.0])]


def test_intervals_for_comparing_are_not_known_where_one_person_has_all_conditions() -> None:
    for e in within_intervals(np.array([[1.0, 2.0], [2.0, np.nan], [3.0, np.nan]])):
        assert np.isfinite(e.value) and np.isnan([e.low, e.high]).all()


def test_a_mean_of_one_person_has_no_interval() -> None:
    assert mean_interval([3.0]).value == 3.0
    assert np.isnan(mean_interval([3.0]).low)
    assert np.isnan(mean_interval([]).value)


rates = st.lists(st.tuples(st.integers(0, 12), st.integers(1, 12)), min_size=1, max_size=30).map(
    lambda some: [(min(a, b) / b, b) for a, b in some]
)


@given(rates, rates, st.floats(-1, 1))
def test_intervals_of_shares_hold_their_value_and_are_never_of_width_zero(
    first: list[tuple[float, int]], second: list[tuple[float, int]], correlation: float
) -> None:
    a, b = (share([r for r, _ in x], [n for _, n in x]) for x in (first, second))
    for one in (a, b):
        assert 0.0 <= one.low <= one.value <= one.high <= 1.0
        assert one.high - one.low > 0.0
        assert 0.0 < one.effective <= sum(n for _, n in (first if one is a else second))
    d = difference(a, b, correlation)
    assert -1.0 <= d.low <= d.value + 1e-12 and d.value - 1e-12 <= d.high <= 1.0
    if abs(correlation) < 0.99:
        assert d.high > d.low
    back = difference(b, a, correlation)
    assert (back.low, back.high) == pytest.approx((-d.high, -d.low))


def test_trials_of_people_who_are_all_alike_count_whole() -> None:
    rng = np.random.default_rng(2)
    own = rng.binomial(10, 0.7, 400) / 10
    assert design_effect(list(own), [10] * 400) == pytest.approx(1.0, abs=0.15)
    # Everybody always or never: as many trials as people.
    own = (rng.uniform(size=400) < 0.7).astype(float)
    assert share(list(own), [10] * 400).effective == pytest.approx(400, rel=0.01)


def test_the_sign_test_counts_all_signs() -> None:
    assert sign_test(np.array([0.1, 0.2, 0.3, 0.4, 0.5])) == 2 / 32
    assert sign_test(np.array([1.0, -1.0])) == 1.0
    assert sign_test(np.zeros(5)) == 1.0
    assert np.isnan(sign_test(np.array([1.0])))
    d = np.array([3.0, 1.0, -2.0, 0.5])
    count = sum(abs(np.dot(s, d)) >= abs(d.sum()) for s in product((-1, 1), repeat=4))
    assert sign_test(d) == count / 16


def test_groups_that_are_apart_are_found_and_equal_ones_are_not() -> None:
    assert group_test(np.zeros(8), np.ones(8)) < 0.001
    assert group_test(np.ones(8), np.ones(8)) == 1.0


def test_without_unseen_times_the_censored_model_is_least_squares() -> None:
    rng = np.random.default_rng(3)
    X = np.column_stack([np.ones(80), rng.normal(size=(80, 2))])
    y = X @ [1.0, 2.0, -3.0] + rng.normal(size=80)
    theta = tobit(X, y, np.ones(80, bool))
    assert theta is not None
    least, rest, *_ = np.linalg.lstsq(X, y, rcond=None)
    assert theta[:3] / theta[3] == pytest.approx(least)
    assert 1 / theta[3] == pytest.approx(np.sqrt(rest[0] / 80))


@given(st.integers(0, 10**6), st.floats(0.05, 0.8))
@settings(max_examples=40, deadline=None)
def test_the_censored_model_finds_the_one_maximum(seed: int, censored: float) -> None:
    from scipy.optimize import minimize
    from scipy.special import log_ndtr

    rng = np.random.default_rng(seed)
    X = np.column_stack([np.ones(60), rng.normal(size=60)])
    y = X @ [2.0, 0.5] + rng.normal(size=60)
    limit = np.quantile(y, 1 - censored)
    seen, y = y < limit, np.minimum(y, limit)
    theta = tobit(X, y, seen)
    assert theta is not None

    def minus(p: np.ndarray) -> float:
        z = (y - X @ p[:2]) / np.exp(p[2])
        return -float((-0.5 * z[seen] ** 2 - p[2]).sum() + log_ndtr(-z[~seen]).sum())

    mine = np.array([*(theta[:2] / theta[2]), -np.log(theta[2])])
    best = minimize(minus, mine + 0.1, method="Nelder-Mead", options={"fatol": 1e-9}).fun
    assert minus(mine) <= best + 1e-6


def test_a_balanced_study_is_compared_as_by_the_paired_t_test(tmp_path: Path) -> None:
    data = study(
        tmp_path, replace(EVERY, people=12, times=(10.0, 8.0), person=1.0, person_level=0.4)
    )
    rows, y = rows_with(data, quantity(data, "time_s"))
    model = fit_mixed(data, rows, y)
    assert isinstance(model, Mixed)
    for d in mixed_differences(data, rows, model):
        if d.pair.factor.name != "encoder":
            continue
        means = rows.assign(y=y).pivot_table(index="ppid", columns="factor_encoder", values="y")
        t = stats.ttest_rel(means[d.pair.second], means[d.pair.first])
        assert d.freedom == 11
        assert d.estimate.value == pytest.approx(
            float((means[d.pair.second] - means[d.pair.first]).mean()), abs=0.01
        )
        low, high = t.confidence_interval()
        assert d.estimate.high - d.estimate.low == pytest.approx(high - low, rel=0.03)


def test_spreads_that_were_planted_are_found(tmp_path: Path) -> None:
    truth = replace(EVERY, people=60, repetitions=3)
    data = study(tmp_path, truth)
    rows, y = rows_with(data, quantity(data, "time_s"))
    model = fit_mixed(data, rows, y)
    assert isinstance(model, Mixed)
    assert model.spreads["residual"] == pytest.approx(truth.residual, rel=0.05)
    assert model.spreads["person x encoder"] == pytest.approx(truth.person_level, rel=0.25)
    assert model.spreads["person"] == pytest.approx(truth.person, rel=0.3)
    assert model.spreads["person x task"] < 0.1


def test_leaving_out_what_did_not_succeed_hides_an_effect_and_the_censored_model_does_not(
    tmp_path: Path,
) -> None:
    truth = replace(Truth(), people=60, losses=(1e-9,) * 3, limit=12.0)
    data = study(tmp_path, truth)
    rows, y = rows_with(data, quantity(data, "time_s"))
    model, whole = fit_mixed(data, rows, y), fit_censored(data)
    assert isinstance(model, Mixed) and isinstance(whole, Censored)
    told = [
        next(d.estimate.value for d in some if (d.pair.first, d.pair.second) == ("a", "c"))
        for some in (mixed_differences(data, rows, model), censored_differences(data, whole))
    ]
    assert told[1] == pytest.approx(truth.log_ratio(0, 2), abs=0.08)
    assert told[0] > 0.75 * truth.log_ratio(0, 2)


def test_what_is_planted_is_what_is_drawn() -> None:
    assert true_success(EVERY, 100) == [1.0, 1.0, 1.0]
    truth = replace(EVERY, person=0.0, person_level=0.0, residual=0.0, practice=0.0)
    drawn = draw(truth, 0)
    expected = np.array(truth.times)[drawn.level] * np.array(truth.tasks)[drawn.task]
    assert drawn.time == pytest.approx(expected)


def test_planted_orders_are_balanced_and_said_to_be(tmp_path: Path) -> None:
    data = study(tmp_path, replace(EVERY, people=12, repetitions=1))
    encoder = data.factor("encoder")
    found = places(data, quantity(data, "time_s"), encoder)
    assert balanced(found, encoder)
    assert len(set(neighbours(data, encoder).values())) == 1
    odd = study(tmp_path, replace(EVERY, people=4, repetitions=1))
    assert not balanced(places(odd, quantity(odd, "time_s"), encoder), encoder)


def test_levels_are_compared_under_equal_circumstances_only(tmp_path: Path) -> None:
    data = study(tmp_path, replace(EVERY, people=4, repetitions=1))
    half = data.used[
        ~((data.used["factor_encoder"] == "b") & (data.used["factor_task"] == "task2"))
    ]
    for pair in pairs_of(replace(data, used=half)):
        names = {data.conditions[i] for both in pair.cells for i in both}
        assert "b / task2" not in names
        if pair.factor.name == "encoder" and "b" in (pair.first, pair.second):
            assert len(pair.cells) == 1
        assert sum(pair.weights(6)) == pytest.approx(0.0)


def test_other_names_and_another_order_of_rows_change_nothing(tmp_path: Path) -> None:
    data = study(tmp_path, Truth(people=8, repetitions=2))
    path = tmp_path / "trial_results.csv"
    head, *lines = path.read_text().splitlines()
    shuffled = [lines[i] for i in np.random.default_rng(4).permutation(len(lines))]
    path.write_text("\n".join([head, *shuffled]) + "\n")
    again = load_study(tmp_path)
    before, after = (
        {(s.pair.first, s.pair.second): s.estimate for s in success_differences(d)}
        for d in (data, again)
    )
    for (first, second), e in before.items():
        # Levels come in order of appearance where no codebook tells.
        other = after.get((first, second)) or after[second, first]
        sign = 1.0 if (first, second) in after else -1.0
        assert sign * other.value == pytest.approx(e.value)
        assert other.high - other.low == pytest.approx(e.high - e.low)


def test_a_median_knows_of_trials_without_success(tmp_path: Path) -> None:
    data = study(tmp_path, EVERY)
    used = data.used.assign(censored=False, time_s=3.0, cell=0)
    assert median_with_unseen(replace(data, used=used), 0) == 3.0
    most = used.assign(censored=np.arange(len(used)) % 3 > 0)
    assert median_with_unseen(replace(data, used=most), 0) == float("inf")


def test_everybody_counts_once_however_many_trials(tmp_path: Path) -> None:
    data = study(tmp_path, replace(EVERY, people=4, repetitions=2))
    what = quantity(data, "time_s")
    before = [s.mean.value for s in summaries(data, what)]
    twice = data.used.loc[data.used.index.repeat(np.where(data.used["ppid"] == "P001", 3, 1))]
    after = summaries(replace(data, used=twice.reset_index(drop=True)), what)
    assert [s.mean.value for s in after] == pytest.approx(before)


def test_a_share_is_one_number_with_its_limits() -> None:
    nobody = share([], [])
    assert isinstance(nobody, Share) and np.isnan(nobody.value)


def test_intervals_cover_what_was_planted() -> None:
    covers = {TIMES: 0, SHARES: 0}
    for told in studies(FEW, 40, mixed=False):
        for what in covers:
            covers[what] += bool(told[what].covers)
    assert min(covers.values()) >= 35


def test_where_nothing_was_planted_little_is_found() -> None:
    found = {TIMES: 0, SHARES: 0}
    for told in studies(NONE, 40, mixed=False):
        for what in found:
            found[what] += told[what].found
    assert max(found.values()) <= 6


@pytest.mark.full
def test_of_a_hundred_studies_ninety_or_more_cover_what_was_planted() -> None:
    covers = {TIMES: 0, SHARES: 0}
    for told in studies(Truth(), 100, mixed=False):
        for what in covers:
            covers[what] += bool(told[what].covers)
    assert min(covers.values()) >= 90
    seen = sum(bool(told[SEEN].covers) for told in studies(EVERY, 100))
    assert seen >= 90
