"""The density of layouts is the one it is said to be, and forgets where the hand was."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import null_space
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from encoders.labels.labelling import hypotheses
from encoders.labels.layout_density import (
    KernelShape,
    LayoutDensity,
    Layouts,
    finger_sets,
)
from models.surface import METRES_PER_INCH

COUNTS = st.integers(2, 5)
SHAPES = st.builds(
    KernelShape,
    width=st.floats(0.05, 1.0),
    turn=st.floats(0.0, 0.5),
    size=st.floats(0.0, 0.5),
)


def some_layouts(count: int, rng: np.random.Generator) -> Layouts:
    parts = rng.normal(0, 1.5, (2, len(finger_sets(count)), 3, count))
    z = parts[0] + 1j * parts[1]
    return z - z.mean(axis=2, keepdims=True)


def by_definition(z: np.ndarray, layouts: Layouts, shape: KernelShape, count: int) -> np.ndarray:
    """Every labelling's density as a sum of normal densities of real vectors without a middle."""
    middle = np.zeros((2, 2 * count))
    middle[0, :count] = middle[1, count:] = 1.0
    basis = null_space(middle)
    found = []
    for labels in hypotheses(count):
        order = np.argsort(labels)
        number = finger_sets(count).index(tuple(np.sort(labels)))
        x = np.concatenate([z[order].real, z[order].imag]) @ basis
        kernels = []
        for layout in layouts[number]:
            size = np.concatenate([layout.real, layout.imag]) @ basis
            turn = np.concatenate([-layout.imag, layout.real]) @ basis
            covariance = (
                shape.width**2 * np.eye(len(x))
                + shape.size**2 * np.outer(size, size)
                + shape.turn**2 * np.outer(turn, turn)
            )
            kernels.append(multivariate_normal.logpdf(x, size, covariance))
        found.append(logsumexp(kernels) - np.log(len(kernels)))
    return np.array(found)


@given(seed=st.integers(0, 2**32 - 1), count=COUNTS, shape=SHAPES)
def test_it_is_a_sum_of_normal_densities_stretched_along_turn_and_size(
    seed: int, count: int, shape: KernelShape
) -> None:
    rng = np.random.default_rng(seed)
    layouts = some_layouts(count, rng)
    # Near one of them, so that the comparison is about numbers that matter.
    z = layouts[0, 0] + shape.width * (rng.normal(size=count) + 1j * rng.normal(size=count))
    xy = np.column_stack([z.real, z.imag]) * METRES_PER_INCH
    found = LayoutDensity({count: layouts}, {count: shape}).log_density(xy)
    expected = by_definition(z, layouts, shape, count)
    # Single precision spends its seven digits on the largest of the terms that cancel.
    largest = np.sum(np.abs(layouts) ** 2, axis=2).max()
    scale = 1.0 + (np.sum(np.abs(z) ** 2) + largest) / shape.width**2
    assert found == pytest.approx(expected, rel=1e-4, abs=1e-5 * scale)


@given(
    seed=st.integers(0, 2**32 - 1),
    count=COUNTS,
    shift=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)),
)
def test_where_on_the_surface_the_hand_is_does_not_matter(
    seed: int, count: int, shift: tuple[float, float]
) -> None:
    rng = np.random.default_rng(seed)
    density = LayoutDensity({count: some_layouts(count, rng)}, {count: KernelShape()})
    xy = rng.uniform(0, 0.1, (count, 2))
    here, there = density.log_density(xy), density.log_density(xy + np.array(shift))
    assert there == pytest.approx(here, rel=1e-4, abs=1e-2)


@given(seed=st.integers(0, 2**32 - 1), count=COUNTS)
def test_contacts_in_another_order_have_their_labels_in_that_order(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    density = LayoutDensity({count: some_layouts(count, rng)}, {count: KernelShape()})
    xy, order = rng.uniform(0, 0.1, (count, 2)), rng.permutation(count)
    row_of = {tuple(labels): row for row, labels in enumerate(hypotheses(count).tolist())}
    moved = [row_of[tuple(labels[order])] for labels in hypotheses(count)]
    found = density.log_density(xy[order])[moved]
    assert found == pytest.approx(density.log_density(xy), rel=1e-4, abs=1e-2)
