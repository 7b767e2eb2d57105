"""A polynomial encoder finds the law it can express, and says what it cannot do."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
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


@given(degree=st.integers(1, 3), width=st.integers(1, 6), seed=st.integers(0, 2**16))
def test_every_term_is_the_product_of_its_inputs(degree: int, width: int, seed: int) -> None:
    U = np.random.default_rng(seed).normal(size=(4, width))
    encoder = PolynomialEncoder(degree).fit(U, np.zeros((4, 1)))
    wanted = [np.prod(U[:, list(term)], axis=1) for term in monomials(width, degree)]
    np.testing.assert_allclose(encoder.terms(U), np.transpose(wanted), rtol=1e-12)
    assert len(wanted) == comb(width + degree, degree)
    # 16, 136 and 816 terms of contact vectors, as in the paper.
    assert len(monomials(15, degree)) == (16, 136, 816)[degree - 1]


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


@pytest.mark.parametrize(
    ("encoder", "rank"), ((LinearEncoder, 16), (QuadraticEncoder, 121), (CubicEncoder, 591))
)
def test_of_136_quadratic_terms_121_are_independent(
    encoder: type[LinearEncoder | QuadraticEncoder | CubicEncoder], rank: int
) -> None:
    """s s = s for 5 flags, and x s = x + 1 - s for 10 coordinates: 15 terms too many."""
    U = layouts(80)
    assert encoder().fit(U, U[:, :1]).rank_ == rank


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


def test_sets_of_fingers_that_the_training_lacks_are_named() -> None:
    U = layouts(20)
    lacking = np.isin(U[:, 10:] @ [1, 2, 4, 8, 16], (1 + 8, 2 + 4 + 8 + 16))
    encoder = QuadraticEncoder().fit(U[~lacking], U[~lacking, :4])
    assert encoder.missing_sets_ == ("thumb+ring", "index+middle+ring+little")
    assert QuadraticEncoder().fit(U, U[:, :1]).missing_sets_ == ()
    loaded = QuadraticEncoder().load(encoder.coef_, 15, U[~lacking])
    np.testing.assert_array_equal(loaded.predict(U), encoder.predict(U))
    assert loaded.missing_sets_ == encoder.missing_sets_


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
    with pytest.raises(EncoderError):
        LinearEncoder().fit_blocks([(one, one), (other, one)])
    with pytest.raises(EncoderError):
        LinearEncoder().fit_blocks([])


@pytest.mark.parametrize(
    ("degree", "ridge"), ((2, -1.0), (2, np.nan), (2, np.inf), (0, 0.0), (4, 0.0))
)
def test_an_invalid_degree_or_ridge_is_refused(degree: int, ridge: float) -> None:
    with pytest.raises(EncoderError):
        PolynomialEncoder(degree, ridge).fit([[1.0]], [[1.0]])


def loaded(degree: int, outputs: int) -> PolynomialEncoder:
    """An encoder of contact vectors with any coefficients."""
    coef = np.random.default_rng(0).normal(size=(len(monomials(15, degree)), outputs))
    return PolynomialEncoder(degree).load(coef, 15)


@pytest.mark.parametrize("shift", (0.0, 0.5))
@pytest.mark.parametrize(("degree", "outputs"), ((1, 1), (1, 60), (2, 12), (2, 48), (3, 48)))
def test_an_encoder_prepared_for_contacts_gives_the_poses_of_the_plain_one(
    degree: int, outputs: int, shift: float
) -> None:
    encoder, U = loaded(degree, outputs), layouts(4)
    # The common origin of the contacts does not matter.
    U[:, :10][np.repeat(U[:, 10:] == 1, 2, axis=1)] += shift
    pose, expected = encoder.for_contacts(), encoder.predict(U)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(pose.predict(U), expected, atol=1e-12 * scale)
    found = [pose(u) for u in U]
    np.testing.assert_allclose(found, expected, atol=1e-12 * scale)


@pytest.mark.parametrize(
    "u",
    (
        np.zeros(15),
        np.r_[np.zeros(10), 0.5, 1, 0, 0, 0],
        np.r_[np.zeros(10), np.nan, 1, 0, 0, 0],
        np.r_[np.zeros(10), np.ones(6)],
        np.r_[np.zeros(10), np.ones(5)].reshape(1, 15),
        np.r_[np.zeros(10), np.ones(5)].reshape(3, 5),
        1.0,
    ),
)
def test_a_prepared_encoder_refuses_what_is_no_contact_vector(u: np.ndarray) -> None:
    with pytest.raises(EncoderError, match="no contact vectors"):
        loaded(2, 3).for_contacts()(u)
