"""Prepared encoders give the poses of the plain one."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.input_vector import contact_vectors
from encoders.regression.polynomial import (
    SETS,
    PolynomialEncoder,
    collapse,
)
from models.errors import EncoderError

DEGREES = pytest.mark.parametrize("degree", (1, 2, 3))


def layouts(rng: np.random.Generator, frames: int) -> np.ndarray:
    """(frames, 15) contact vectors of random sets of one to five fingers at random places."""
    xy = rng.uniform(0, 0.15, (frames, 5, 2))
    for i, choice in enumerate(rng.integers(0, len(SETS), frames)):
        xy[i, [f for f in range(5) if f not in SETS[choice]]] = np.nan
    return contact_vectors(xy)[0]


def encoder_of(degree: int, outputs: int, seed: int = 0) -> PolynomialEncoder:
    encoder = PolynomialEncoder(degree)
    terms = {1: 16, 2: 136, 3: 816}[degree]
    return encoder.load(np.random.default_rng(seed).normal(size=(terms, outputs)), 15)


@DEGREES
def test_every_term_is_a_monomial_of_free_coordinates_or_nothing(degree: int) -> None:
    encoder = encoder_of(degree, 1)
    U = layouts(np.random.default_rng(degree), 200)
    for u in U:
        fingers = tuple(np.flatnonzero(u[10:]).tolist())
        origin = next(f for f in fingers if u[2 * f] == u[2 * f + 1] == 0)
        for found in (collapse(fingers, degree), collapse(fingers, degree, origin)):
            expanded = found.terms(u[None])[0, found.monomial] * found.sign
            np.testing.assert_allclose(expanded, encoder.terms(u), rtol=1e-14)


@DEGREES
@pytest.mark.parametrize("outputs", (1, 12, 48, 60))
def test_a_prepared_encoder_gives_the_poses_of_the_plain_one(degree: int, outputs: int) -> None:
    encoder = encoder_of(degree, outputs)
    pose = encoder.for_contacts()
    U = layouts(np.random.default_rng(1), 150)
    expected = encoder.predict(U)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(pose.predict(U), expected, atol=1e-12 * scale)
    np.testing.assert_allclose([pose(u) for u in U], expected, atol=1e-12 * scale)


def test_a_pose_is_not_overwritten_by_the_next() -> None:
    encoder = encoder_of(2, 48)
    pose = encoder.for_contacts()
    U = layouts(np.random.default_rng(2), 2)
    first = pose(U[0])
    kept = first.copy()
    assert not np.array_equal(pose(U[1]), kept)
    np.testing.assert_array_equal(first, kept)


def test_the_common_origin_of_contacts_does_not_matter() -> None:
    encoder = encoder_of(3, 4)
    U = layouts(np.random.default_rng(3), 20)
    U[:, :10][np.repeat(U[:, 10:] == 1, 2, axis=1)] += 0.5
    pose = encoder.for_contacts()
    np.testing.assert_allclose(pose.predict(U), encoder.predict(U), rtol=1e-9)
    np.testing.assert_allclose(pose(U[0]), encoder.predict(U[0]), rtol=1e-9)


@pytest.mark.parametrize(
    "u",
    (
        np.zeros(15),
        np.r_[np.zeros(10), 0.5, 1, 0, 0, 0],
        np.r_[np.zeros(10), np.nan, 1, 0, 0, 0],
        np.zeros(14),
        np.r_[np.zeros(10), np.ones(6)],
        np.zeros((2, 15)),
        np.r_[np.zeros(10), np.ones(5)].reshape(1, 15),
        np.r_[np.zeros(10), np.ones(5)].reshape(15, 1),
        np.r_[np.zeros(10), np.ones(5)].reshape(3, 5),
        1.0,
    ),
)
def test_an_invalid_contact_vector_is_refused(u: np.ndarray) -> None:
    with pytest.raises(EncoderError, match="no contact vectors"):
        encoder_of(2, 3).for_contacts()(u)
