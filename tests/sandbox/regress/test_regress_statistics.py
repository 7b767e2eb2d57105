"""The statistics of regression runs are the published ones, and promise what they keep."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import rankdata, wilcoxon

from sandbox.regress.statistics import (
    ALPHA,
    POWER,
    fewest_losses,
    holm,
    mcnemar,
    mean_change,
    noticeable_drop,
    noticeable_shift,
    power,
    signed_rank,
    typical_change,
    wilson,
)

differences = st.lists(st.floats(-3.0, 3.0).map(lambda x: round(x, 1)), min_size=1, max_size=9)

p_values = st.dictionaries(st.text(max_size=3), st.floats(0.0, 1.0), max_size=8)


@given(lost=st.integers(0, 60), won=st.integers(0, 60))
def test_mcnemar_counts_coins_that_show_at_least_as_many_heads(lost: int, won: int) -> None:
    pairs = lost + won
    counted = Fraction(sum(comb(pairs, k) for k in range(lost, pairs + 1)), 2**pairs)
    assert mcnemar(lost, won) == pytest.approx(float(counted), rel=1e-9)


@given(differences)
def test_the_signed_rank_test_counts_all_signs(values: list[float]) -> None:
    """Every choice of signs of the differences is as likely, and equal ones share their rank."""
    left = [v for v in values if v]
    ranks = rankdata(np.abs(left)) if left else np.zeros(0)
    observed = sum(r for r, v in zip(ranks, left, strict=True) if v > 0)
    sums = [
        sum(r for r, up in zip(ranks, signs, strict=True) if up)
        for signs in product((False, True), repeat=len(left))
    ]
    expected = np.mean([s >= observed - 1e-9 for s in sums])
    assert signed_rank(values) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    ("pairs", "method", "close"), [(30, "exact", 1e-9), (400, "exact", 1e-9), (450, "approx", 0.02)]
)
def test_the_signed_rank_test_of_many_pairs_is_that_of_scipy(
    pairs: int, method: str, close: float
) -> None:
    values = np.random.default_rng(0).normal(0.1, 1.0, pairs)
    theirs = wilcoxon(values, alternative="greater", method=method).pvalue
    assert signed_rank(values) == pytest.approx(theirs, rel=close)


def test_the_interval_of_a_mean_holds_it_in_nineteen_of_twenty_samples() -> None:
    rng = np.random.default_rng(0)
    inside = [
        low <= 0.3 <= high
        for _, low, high in (mean_change(rng.normal(0.3, 1, 20)) for _ in range(2000))
    ]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.02)


def test_a_noticeable_shift_is_noticed_four_times_in_five() -> None:
    rng = np.random.default_rng(0)
    for scales in ((1.0,), (0.1, 1.0, 3.0)):
        shift = noticeable_shift([s * rng.normal(0, 1, 100) for s in scales], 60, ALPHA / 4)
        n = 60 // len(scales)
        samples = ([rng.normal(shift, s, n) for s in scales] for _ in range(500))
        noticed = [signed_rank(*some) <= ALPHA / 4 for some in samples]
        assert np.mean(noticed) == pytest.approx(POWER, abs=0.08)


def test_samples_that_scatter_little_count_as_much_as_others() -> None:
    """Ranked as one sample, the scatter of the second hides that all of the first are positive."""
    steady, wild = np.linspace(0.01, 0.02, 12), np.array([-3.0, 2.0, -1.0, 4.0, -5.0, 1.5])
    assert signed_rank(steady, wild) < 0.01 < signed_rank(np.concatenate([steady, wild]))


@given(samples=st.lists(differences, min_size=1, max_size=3))
def test_a_typical_change_has_the_sign_for_which_the_ranks_speak(
    samples: list[list[float]],
) -> None:
    change, low, high = typical_change(*samples)
    for_loss = signed_rank(*samples)
    for_gain = signed_rank(*(np.negative(each) for each in samples))
    assert low <= change <= high
    assert change >= 0.0 or for_loss >= for_gain
    assert change <= 0.0 or for_gain >= for_loss


def test_a_typical_change_is_the_shift_and_its_interval_has_it_nineteen_times_in_twenty() -> None:
    rng = np.random.default_rng(0)
    found = [typical_change(rng.normal(0.3, 1.0, 50), rng.normal(0.3, 1.0, 30)) for _ in range(500)]
    assert np.mean([change for change, _, _ in found]) == pytest.approx(0.3, abs=0.02)
    assert np.mean([low <= 0.3 <= high for _, low, high in found]) == pytest.approx(0.95, abs=0.02)
    # A third of the pairs do not differ.
    assert typical_change([0.2, 0.2, 0.0])[0] == pytest.approx(0.4 / 3)


def test_the_wilson_interval_is_the_published_one() -> None:
    # Newcombe (1998), Statistics in Medicine 17, table I: 81 of 263 and 0 of 20, method 3.
    assert np.allclose(wilson(81, 263), (0.2553, 0.3662), atol=5e-5)
    assert np.allclose(wilson(0, 20), (0.0, 0.1611), atol=5e-5)
    assert wilson(0, 0) == (0.0, 1.0)


@given(p_values)
def test_holm_rejects_what_stepping_down_rejects_and_keeps_the_order(
    values: dict[str, float],
) -> None:
    adjusted = holm(values)
    assert list(adjusted) == list(values)
    in_order = [adjusted[name] for name in sorted(values, key=values.__getitem__)]
    assert in_order == sorted(in_order)
    assert all(value <= adjusted[name] <= 1.0 for name, value in values.items())
    rejected = set()
    for i, name in enumerate(sorted(values, key=values.__getitem__)):
        # Equality is left to rounding.
        if values[name] * (len(values) - i) > ALPHA * (1 + 1e-12):
            break
        if values[name] * (len(values) - i) < ALPHA * (1 - 1e-12):
            rejected.add(name)
    assert rejected <= {name for name, p in adjusted.items() if p <= ALPHA}
    assert all(values[name] <= ALPHA for name, p in adjusted.items() if p <= ALPHA)


@pytest.mark.parametrize("tests", range(1, 7))
def test_the_fewest_losses_are_significant_and_one_less_are_not(tests: int) -> None:
    losses = fewest_losses(ALPHA / tests)
    assert tests * 0.5**losses <= ALPHA < tests * 0.5 ** (losses - 1)


@pytest.mark.parametrize(("pairs", "win", "tests"), [(120, 0.0, 1), (120, 0.03, 2), (40, 0.05, 1)])
def test_the_noise_floor_is_where_simulated_runs_are_caught_four_times_in_five(
    pairs: int, win: float, tests: int
) -> None:
    drop = noticeable_drop(pairs, win, ALPHA / tests)
    kinds = np.random.default_rng(0).multinomial(
        pairs, [win + drop, win, 1 - 2 * win - drop], size=4000
    )
    caught = np.mean([tests * mcnemar(lost, won) <= ALPHA for lost, won, _ in kinds])
    assert caught == pytest.approx(POWER, abs=4 * np.sqrt(POWER * (1 - POWER) / 4000))


@settings(max_examples=20, deadline=None)
@given(rate=st.floats(0.0, 0.5), pairs=st.integers(1, 150), tests=st.integers(1, 4))
def test_where_nothing_got_worse_a_loss_is_hardly_ever_called(
    rate: float, pairs: int, tests: int
) -> None:
    assert power(pairs, rate, rate, ALPHA / tests) <= ALPHA / tests + 1e-9
