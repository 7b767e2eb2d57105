"""Intervals cover, and the Copas test finds what is overfitted and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.capture import Capture
from encoders.evaluation.copas import RULES, copas, verdict
from encoders.evaluation.methods import MeanEncoder
from encoders.evaluation.result_values import block_interval, standard_error
from encoders.regression.polynomial import LinearEncoder, PolynomialEncoder
from encoders.regression.trained import builtin_capture
from models.errors import EncoderError


@pytest.fixture(scope="module")
def capture() -> Capture:
    """Every fortieth frame of the built-in capture: all takes."""
    return builtin_capture().select(np.arange(0, len(builtin_capture()), 40))


def test_an_interval_over_takes_covers_where_independent_frames_do_not() -> None:
    """Takes of 50 frames that differ by more than their frames do."""
    covered, believed = 0, 0
    for seed in range(200):
        rng = np.random.default_rng(seed)
        block = np.repeat(np.arange(30), 50)
        values = 5.0 + rng.normal(size=30)[block] + 0.5 * rng.normal(size=len(block))
        low, high = block_interval(values, block, 400, seed)
        covered += low <= 5.0 <= high
        believed += abs(values.mean() - 5.0) <= 1.96 * standard_error(values)
    assert covered >= 0.87 * 200
    assert believed < 0.5 * 200


def test_equal_values_leave_no_doubt_and_no_values_or_one_block_leave_no_interval() -> None:
    assert block_interval(np.full(9, 2.5), np.arange(9) // 3) == (2.5, 2.5)
    assert standard_error(np.full(9, 2.5)) == 0
    assert np.isnan(block_interval(np.empty(0), np.empty(0, int))).all()
    assert np.isnan(block_interval(np.arange(5.0), np.zeros(5, int))).all()


def test_on_random_frames_the_copas_test_sees_that_noise_was_fitted() -> None:
    rng = np.random.default_rng(0)
    U, Q = rng.normal(size=(300, 8)), rng.normal(size=(300, 20))
    test = copas(lambda: PolynomialEncoder(2), U, Q, np.arange(300) // 10, blocked=False, folds=5)
    assert test.median_slope < 0.5
    for rule in ("f_test", "t_test"):
        assert test.count(rule) > 0.8 * 20


def test_a_true_law_with_plenty_of_data_is_not_called_overfitted() -> None:
    rng = np.random.default_rng(1)
    U = rng.normal(size=(4000, 4))
    Q = U @ rng.normal(size=(4, 40)) + rng.normal(size=(4000, 40))
    for blocked in (False, True):
        test = copas(LinearEncoder, U, Q, np.arange(4000) // 20, blocked, folds=5)
        assert test.median_slope == pytest.approx(1.0, abs=0.02)
        for rule in RULES:
            assert test.count(rule) < 0.12 * 40, (rule, blocked)


def test_where_takes_move_together_only_the_clustered_rule_keeps_its_level() -> None:
    """Predictions and errors of 12 takes of 40 frames, all frames of a take nearly alike."""
    rng = np.random.default_rng(3)
    outputs, trial = 400, np.repeat(np.arange(12), 40)
    predicted = rng.normal(size=(12, outputs))[trial]
    y = predicted + rng.normal(size=(12, outputs))[trial]
    found = verdict(y, predicted, trial)
    assert found.overfitted["t_test"].mean() > 0.3
    assert found.overfitted["clustered"].mean() < 0.15


def test_predictions_that_never_vary_have_no_slope_and_are_not_counted(capture: Capture) -> None:
    test = copas(MeanEncoder, capture.u, capture.relative, capture.trial, blocked=True, folds=4)
    assert np.isnan(test.median_slope)
    assert all(test.count(rule) == 0 for rule in RULES)


def test_one_take_has_no_folds(capture: Capture) -> None:
    one = capture.select(capture.trial == capture.trial[0])
    with pytest.raises(EncoderError, match="several trials"):
        copas(LinearEncoder, one.u, one.relative, one.trial, blocked=True)
