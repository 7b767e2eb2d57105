"""A polynomial encoder finds the law it can express, and says what it cannot do."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from scipy.linalg import lstsq

from encoders.captures.subject.gestures import SETS
from encoders.input_vector import contact_vectors
from encoders.regression.least_squares import ridge_path
from encoders.regression.polynomial import (
    CubicEncoder,
    LinearEncoder,
    PolynomialEncoder,
    QuadraticEncoder,
    monomials,
)
from models.errors import EncoderError

ENCODERS = (LinearEncoder, QuadraticEncoder, CubicEncoder)


def layouts(frames_per_set: int, seed: int = 0) -> np.ndarray:
    """(T, 15) contact vectors of random layouts of all 26 sets of fingers."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 0.15, (len(SETS) * frames_per_set, 5, 2))
    for i, fingers in enumerate(SETS):
        lifted = [f for f in range(5) if f not in fingers]
        xy[i * frames_per_set : (i + 1) * frames_per_set, lifted] = np.nan
    return contact_vectors(xy)[0]


def with_lifted_at(U: np.ndarray, place: tuple[float, float]) -> np.ndarray:
    """The same contact vectors with lifted fingers at another place than (-1, -1)."""
    U = U.copy()
    positions = U[:, :10].reshape(-1, 5, 2)
    positions[U[:, 10:] == 0] = place
    return U


def test_the_numbers_of_terms_are_those_of_the_paper() -> None:
    assert [len(monomials(15, d)) for d in (1, 2, 3)] == [16, 136, 816]


@given(degree=st.integers(1, 3), width=st.integers(1, 6), seed=st.integers(0, 2**16))
def test_every_term_is_the_product_of_its_inputs(degree: int, width: int, seed: int) -> None:
    U = np.random.default_rng(seed).normal(size=(4, width))
    encoder = PolynomialEncoder(degree).fit(U, np.zeros((4, 1)))
    wanted = [np.prod(U[:, list(term)], axis=1) for term in monomials(width, degree)]
    np.testing.assert_allclose(encoder.terms(U), np.transpose(wanted), rtol=1e-12)
    assert len(wanted) == comb(width + degree, degree)


@pytest.mark.parametrize("degree", (1, 2, 3))
def test_a_polynomial_of_the_same_degree_is_recovered_exactly(degree: int) -> None:
    rng = np.random.default_rng(1)
    U = rng.normal(size=(400, 5))
    law = rng.normal(size=(comb(5 + degree, degree), 7))
    encoder = PolynomialEncoder(degree)
    Q = encoder.fit(U, np.zeros((400, 7))).terms(U) @ law
    encoder.fit(U, Q)
    np.testing.assert_allclose(encoder.coef_, law, atol=1e-9)
    unseen = rng.normal(size=(50, 5))
    np.testing.assert_allclose(encoder.predict(unseen), encoder.terms(unseen) @ law, atol=1e-9)


def test_a_quadratic_law_of_contact_vectors_is_predicted_exactly_on_layouts_never_seen() -> None:
    U, unseen = layouts(30), layouts(10, seed=1)
    law = np.random.default_rng(2).normal(size=(136, 48))
    encoder = QuadraticEncoder().fit(U, np.zeros((len(U), 48)))
    encoder.fit(U, encoder.terms(U) @ law)
    np.testing.assert_allclose(encoder.predict(unseen), encoder.terms(unseen) @ law, atol=1e-7)


def test_of_136_quadratic_terms_121_are_independent() -> None:
    """s s = s for 5 flags, and x s = x + 1 - s for 10 coordinates: 15 terms too many."""
    U = layouts(30)
    assert QuadraticEncoder().fit(U, U).rank_ == 121
    assert LinearEncoder().fit(U, U).rank_ == 16


def test_of_816_cubic_terms_591_are_independent() -> None:
    U = layouts(80)
    assert CubicEncoder().fit(U, U[:, :1]).rank_ == 591


def test_without_a_set_of_fingers_the_quadratic_still_knows_all_it_can() -> None:
    U = layouts(30)
    four = U[:, 10:].sum(axis=1) == 4
    only = four & (U[:, 10] == 0)
    assert QuadraticEncoder().fit(U[~only], U[~only]).rank_ == 121


@settings(max_examples=15)
@given(
    place=st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
    encoder=st.sampled_from((LinearEncoder, QuadraticEncoder)),
)
def test_where_lifted_fingers_are_put_does_not_change_a_least_squares_prediction(
    place: tuple[float, float], encoder: type[PolynomialEncoder]
) -> None:
    """Another place is an affine map of the inputs, which the polynomials of a degree absorb."""
    U, unseen = layouts(30), layouts(5, seed=1)
    Q = np.random.default_rng(3).normal(size=(len(U), 4))
    usual = encoder().fit(U, Q).predict(unseen)
    moved = encoder().fit(with_lifted_at(U, place), Q).predict(with_lifted_at(unseen, place))
    np.testing.assert_allclose(moved, usual, atol=1e-7)


def test_with_a_ridge_the_place_of_lifted_fingers_does_matter() -> None:
    U, unseen = layouts(30), layouts(5, seed=1)
    Q = np.random.default_rng(3).normal(size=(len(U), 4)) + U[:, :4] ** 2
    usual = QuadraticEncoder(0.1).fit(U, Q).predict(unseen)
    far = QuadraticEncoder(0.1).fit(with_lifted_at(U, (-5, 5)), Q)
    assert np.abs(far.predict(with_lifted_at(unseen, (-5, 5))) - usual).max() > 1e-3


@pytest.mark.parametrize("encoder", ENCODERS)
@pytest.mark.parametrize(("width", "outputs"), ((3, 12), (15, 60), (24, 48)))
def test_any_number_of_inputs_and_outputs_will_do(
    encoder: type[PolynomialEncoder], width: int, outputs: int
) -> None:
    rng = np.random.default_rng(4)
    U, Q = rng.normal(size=(60, width)), rng.normal(size=(60, outputs))
    fitted = encoder().fit(U, Q)
    assert fitted.predict(U).shape == (60, outputs)
    assert fitted.predict(U[0]).shape == (outputs,)
    np.testing.assert_allclose(fitted.predict(U)[7], fitted.predict(U[7]), atol=1e-9)


def test_least_squares_leaves_nothing_that_its_terms_could_explain() -> None:
    U = layouts(20)
    Q = np.random.default_rng(5).normal(size=(len(U), 3))
    encoder = QuadraticEncoder().fit(U, Q)
    left = Q - encoder.predict(U)
    np.testing.assert_allclose(encoder.terms(U).T @ left / len(U), 0, atol=1e-8)


def test_a_greater_ridge_gives_smaller_coefficients() -> None:
    rng = np.random.default_rng(6)
    U = layouts(10)
    Q = rng.normal(size=(len(U), 2))
    spread = [np.var(QuadraticEncoder(r).fit(U, Q).predict(U)) for r in (0, 1e-3, 1e-1, 10.0)]
    assert spread == sorted(spread, reverse=True)
    endless = QuadraticEncoder(1e9).fit(U, Q).predict(U)
    np.testing.assert_allclose(endless, np.broadcast_to(Q.mean(axis=0), Q.shape), atol=1e-6)


def test_a_ridge_path_equals_separate_fits() -> None:
    U = layouts(10)
    Q = np.random.default_rng(7).normal(size=(len(U), 2))
    ridges = (1e-3, 1.0)
    path = ridge_path(QuadraticEncoder(1.0).fit(U, Q).terms(U), Q, ridges)
    for ridge, coef in zip(ridges, path, strict=True):
        np.testing.assert_allclose(coef, QuadraticEncoder(ridge).fit(U, Q).coef_, atol=1e-9)


@pytest.mark.parametrize("degree", (1, 2, 3))
@pytest.mark.parametrize("kind", ("contacts", "any", "both"))
def test_frames_in_blocks_give_what_all_frames_at_once_give(degree: int, kind: str) -> None:
    """Against the singular values of the whole matrix, which no product has squared."""
    U = layouts(60, seed=degree)
    if kind != "contacts":
        moved = slice(None) if kind == "any" else slice(0, None, 3)
        U[moved] += 0.25 * np.random.default_rng(8).normal(size=U[moved].shape)
    Q = np.random.default_rng(9).normal(size=(len(U), 5)) + U[:, :5] ** 2
    encoder = PolynomialEncoder(degree)
    encoder.fit_blocks((U[i : i + 100], Q[i : i + 100]) for i in range(0, len(U), 100))
    X = encoder.terms(U)
    scale = np.sqrt(np.mean(X * X, axis=0))
    direct, _, rank, _ = lstsq(X / scale, Q, cond=1e-10, lapack_driver="gelsd")
    assert encoder.rank_ == rank
    np.testing.assert_allclose(encoder.predict(U), X / scale @ direct, rtol=0, atol=1e-8)


@pytest.mark.parametrize("ridge", (0.0, 1e-2))
@given(seed=st.integers(0, 2**16), size=st.integers(1, 300))
@settings(max_examples=20)
def test_how_frames_are_cut_into_blocks_changes_nothing(ridge: float, seed: int, size: int) -> None:
    rng = np.random.default_rng(seed)
    U = layouts(8, seed)[rng.permutation(8 * len(SETS))]
    Q = rng.normal(size=(len(U), 3))
    whole = QuadraticEncoder(ridge).fit(U, Q)
    cut = QuadraticEncoder(ridge).fit_blocks(
        (U[i : i + size], Q[i : i + size]) for i in range(0, len(U), size)
    )
    assert cut.rank_ == whole.rank_
    np.testing.assert_allclose(cut.predict(U), whole.predict(U), rtol=0, atol=1e-9)


def test_sets_of_fingers_that_the_training_lacks_are_named() -> None:
    U = layouts(20)
    lacking = (U[:, 10:] == [1, 0, 0, 1, 0]).all(axis=1) | (U[:, 10:] == [0, 1, 1, 1, 1]).all(
        axis=1
    )
    encoder = QuadraticEncoder().fit(U[~lacking], U[~lacking, :4])
    assert encoder.missing_sets_ == ("thumb+ring", "index+middle+ring+little")
    assert QuadraticEncoder().fit(U, U[:, :1]).missing_sets_ == ()
    loaded = QuadraticEncoder().load(encoder.coef_, 15, U[~lacking])
    assert loaded.missing_sets_ == encoder.missing_sets_


def test_an_encoder_that_cannot_tell_what_it_was_trained_on_names_no_set() -> None:
    fitted = LinearEncoder().fit(np.random.default_rng(0).normal(size=(30, 15)), np.zeros((30, 1)))
    for encoder in (fitted, LinearEncoder().load(np.zeros((16, 1)), 15), LinearEncoder()):
        assert encoder.missing_sets_ == ()


@pytest.mark.parametrize("encoder", ENCODERS)
@pytest.mark.parametrize("value", (0.0, 3.0))
def test_inputs_that_never_vary_are_found_and_do_no_harm(
    encoder: type[LinearEncoder | QuadraticEncoder | CubicEncoder], value: float
) -> None:
    rng = np.random.default_rng(10)
    U = rng.normal(size=(400, 4))
    Q = U[:, [0]] - 2 * U[:, [3]]
    fitted = encoder().fit(np.insert(U, 2, value, axis=1), Q)
    assert fitted.constant_inputs_ == (2,)
    assert fitted.rank_ == comb(4 + fitted.degree, fitted.degree)
    np.testing.assert_allclose(fitted.predict(np.insert(U, 2, value, axis=1)), Q, atol=1e-9)
    ridged = encoder(1e-6).fit(np.insert(U, 2, value, axis=1), Q)
    assert np.isfinite(ridged.coef_).all()


def test_blocks_that_do_not_fit_together_are_refused() -> None:
    one, other = np.zeros((3, 4)), np.zeros((3, 5))
    with pytest.raises(EncoderError, match="numbers of columns"):
        LinearEncoder().fit_blocks([(one, one), (other, one)])
    with pytest.raises(EncoderError, match="nothing to learn"):
        LinearEncoder().fit_blocks([])


def test_coefficients_taken_over_predict_alike() -> None:
    U = layouts(5)
    fitted = QuadraticEncoder().fit(U, U @ np.ones((15, 2)))
    loaded = QuadraticEncoder().load(fitted.coef_, 15)
    np.testing.assert_array_equal(loaded.predict(U), fitted.predict(U))
    with pytest.raises(EncoderError, match="816"):
        CubicEncoder().load(fitted.coef_, 15)


@pytest.mark.parametrize(
    ("U", "Q"),
    (
        ([[1.0, np.nan]], [[0.0]]),
        ([[1.0, 2.0]], [[np.inf]]),
        ([[1.0], [2.0]], [[0.0]]),
        ([1.0, 2.0], [[0.0], [0.0]]),
        (np.empty((0, 2)), np.empty((0, 1))),
    ),
)
def test_data_that_cannot_be_learned_from_are_refused(U: ArrayLike, Q: ArrayLike) -> None:
    with pytest.raises(EncoderError):
        QuadraticEncoder().fit(U, Q)


@pytest.mark.parametrize("ridge", (-1.0, np.nan, np.inf))
def test_an_invalid_ridge_is_refused(ridge: float) -> None:
    with pytest.raises(EncoderError, match="ridge"):
        QuadraticEncoder(ridge).fit([[1.0]], [[1.0]])


@pytest.mark.parametrize("degree", (0, 4))
def test_other_degrees_are_refused(degree: int) -> None:
    with pytest.raises(EncoderError, match="1, 2 or 3"):
        PolynomialEncoder(degree).fit([[1.0]], [[1.0]])


def test_an_encoder_reports_finger_sets_that_it_never_learned() -> None:
    with pytest.raises(EncoderError, match="learned nothing"):
        QuadraticEncoder().predict(np.zeros(15))
    with pytest.raises(EncoderError, match="inputs"):
        LinearEncoder().fit([[1.0, 2.0]], [[1.0]]).predict([1.0])
