"""Layouts of a person's five fingers are evidence about fewer fingers, by their density."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import null_space
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from encoders.labels.belief import (
    MOST,
    KernelShape,
    LayoutDensity,
    Layouts,
    OwnLayouts,
    builtin_population_belief,
)
from encoders.labels.labelling import finger_sets, hypotheses, true_row
from models.arithmetic import Array
from models.errors import EncoderError
from models.surface import METRES_PER_INCH

COUNTS = st.integers(2, 5)
SHAPES = st.builds(
    KernelShape,
    width=st.floats(0.05, 1.0),
    turn=st.floats(0.0, 0.5),
    size=st.floats(0.0, 0.5),
)
HAND = 1e-3 * np.array([[0, 0], [35, -42], [60, -55], [83, -48], [104, -26]])


@pytest.mark.parametrize("fingers", [(0, 1), (1, 2), (0, 1, 2), (1, 2, 3), (0, 2, 3, 4)])
def test_a_part_of_a_known_layout_is_named_by_it(fingers: tuple[int, ...]) -> None:
    own = OwnLayouts(HAND[None])
    evidence = own.log_evidence(HAND[list(fingers)])
    assert evidence.argmax() == true_row(np.array(fingers))
    assert evidence.shape == (len(hypotheses(len(fingers))),)


def test_the_same_posture_is_kept_once_and_the_oldest_makes_room() -> None:
    own = OwnLayouts().with_new(HAND)
    assert own.with_new(HAND + 0.05) is own
    for angle in np.linspace(0.1, 6.2, 2 * MOST):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned = HAND @ turn
        own = own.with_new(turned)
    assert len(own) == MOST
    assert np.allclose(own.layouts[-1], OwnLayouts(turned[None]).layouts[0])


def test_a_restart_forgets_the_layouts_learned_since_the_beginning() -> None:
    belief = builtin_population_belief(OwnLayouts(HAND[None]))
    belief.assign({f: (x, 1.2 * y) for f, (x, y) in enumerate(HAND.tolist())}, {})
    assert len(belief.own) == 2
    belief.restart()
    assert len(belief.own) == 1


@pytest.mark.parametrize(
    "layouts",
    [
        np.zeros((1, 5, 2)),
        HAND[None] * 9,
        np.full((1, 5, 2), np.nan),
        np.zeros((4, 2)),
        HAND[None] * [-1, 1],
    ],
    ids=["one spot", "too far apart", "not finite", "four fingers", "the other hand"],
)
def test_layouts_that_no_hand_has_are_refused(layouts: Array) -> None:
    with pytest.raises(EncoderError):
        OwnLayouts(layouts)


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
    found = LayoutDensity(layouts, shape).log_density(xy)
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
def test_contacts_elsewhere_in_another_order_have_their_labels_in_that_order(
    seed: int, count: int, shift: tuple[float, float]
) -> None:
    rng = np.random.default_rng(seed)
    density = LayoutDensity(some_layouts(count, rng), KernelShape())
    xy, order = rng.uniform(0, 0.1, (count, 2)), rng.permutation(count)
    row_of = {tuple(labels): row for row, labels in enumerate(hypotheses(count).tolist())}
    moved = [row_of[tuple(labels[order])] for labels in hypotheses(count)]
    found = density.log_density(xy[order] + np.array(shift))[moved]
    assert found == pytest.approx(density.log_density(xy), rel=1e-4, abs=1e-2)
