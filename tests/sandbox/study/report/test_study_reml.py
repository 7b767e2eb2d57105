"""The fit of the mixed model is the most likely one, also where a variance is zero."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from sandbox.study.report.models.reml import Reml, _batches, _Likelihood, fit_reml

PEOPLE, LEVELS, EACH = 10, 3, 4


def drawn(
    seed: int, person: float = 0.5, person_level: float = 0.3, missing: int = 0
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Design matrix, values, person and level of trials."""
    rng = np.random.default_rng(seed)
    who = np.repeat(np.arange(PEOPLE), LEVELS * EACH)
    level = np.tile(np.repeat(np.arange(LEVELS), EACH), PEOPLE)
    own = rng.normal(0.0, person_level, (PEOPLE, LEVELS))
    y = rng.normal(0.0, person, PEOPLE)[who] + own[who, level] + rng.normal(0.0, 0.4, len(who))
    X = np.column_stack([level == k for k in range(LEVELS)]).astype(float)
    X = np.column_stack([X, rng.normal(size=len(who))])
    keep = rng.permutation(len(who))[missing:]
    return X[keep], y[keep] + 0.2 * level[keep], who[keep], level[keep]


def fitted(*given: np.ndarray) -> Reml:
    X, y, who, level = given
    found = fit_reml(X, y, who, [level])
    assert found is not None and found.converged
    return found


@pytest.mark.parametrize("missing", [0, 17])
def test_the_fit_is_that_of_statsmodels(missing: int) -> None:
    from statsmodels.regression.mixed_linear_model import MixedLM, VCSpec

    X, y, who, level = drawn(3, missing=missing)
    order = np.argsort(who, kind="stable")
    X, y, who, level = X[order], y[order], who[order], level[order]
    found = fitted(X, y, who, level)
    of_person = [level[who == p] for p in range(PEOPLE)]
    seen = [np.unique(levels) for levels in of_person]
    matrices = [
        (levels[:, None] == own[None, :]).astype(float)
        for levels, own in zip(of_person, seen, strict=True)
    ]
    parts = VCSpec(["level"], [[[str(k) for k in own] for own in seen]], [matrices])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = MixedLM(y, X, who, np.ones((len(y), 1)), parts).fit(reml=True)
    assert found.residual == pytest.approx(np.sqrt(theirs.scale), rel=1e-3)
    assert found.deviations[0] == pytest.approx(np.sqrt(np.asarray(theirs.cov_re)[0, 0]), rel=1e-2)
    assert found.deviations[1] == pytest.approx(np.sqrt(theirs.vcomp[0]), rel=1e-2)
    assert found.coefficients == pytest.approx(np.asarray(theirs.fe_params), abs=1e-3)
    errors = np.sqrt(np.diag(found.covariance))
    assert errors == pytest.approx(np.asarray(theirs.bse_fe), rel=1e-2)


def test_the_gradient_is_that_of_finite_differences() -> None:
    X, y, who, level = drawn(4, missing=9)
    likelihood = _Likelihood(X, y, _batches(X, y, who, [level]))
    at = np.array([0.7, 0.3])
    gradient = likelihood.of(at)[1]
    for k, step in enumerate(1e-5 * np.eye(2)):
        slope = (likelihood.of(at + step)[0] - likelihood.of(at - step)[0]) / 2e-5
        assert gradient[k] == pytest.approx(slope, rel=1e-5)


def test_no_other_variances_are_more_likely() -> None:
    for seed in range(6):
        X, y, who, level = drawn(seed, person=0.3 * (seed % 2), person_level=0.2 * (seed % 3))
        found = fitted(X, y, who, level)
        likelihood = _Likelihood(X, y, _batches(X, y, who, [level]))
        best = (found.deviations / found.residual) ** 2
        least = likelihood.of(best)[0]
        for one in (0.0, 0.01, 0.1, 0.5, 2.0):
            for two in (0.0, 0.01, 0.1, 0.5, 2.0):
                assert likelihood.of(np.array([one, two]))[0] >= least - 1e-6


def test_a_variance_that_is_not_there_is_exactly_zero() -> None:
    zeros = sum(fitted(*drawn(seed, person_level=0.0)).deviations[1] == 0.0 for seed in range(20))
    # At the boundary the estimate is zero in about half of all data.
    assert 4 <= zeros <= 16


def test_the_order_of_rows_and_the_unit_of_values_change_nothing() -> None:
    X, y, who, level = drawn(5)
    order = np.random.default_rng(1).permutation(len(y))
    one, two = fitted(X, y, who, level), fitted(X[order], 1e3 * y[order], who[order], level[order])
    assert two.deviations == pytest.approx(1e3 * one.deviations, rel=1e-4)
    assert two.coefficients == pytest.approx(1e3 * one.coefficients, rel=1e-4)
