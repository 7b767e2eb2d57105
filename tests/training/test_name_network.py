"""Training of the network that names contacts: its loss and the derivatives of it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from encoders.labels.labelling import hypotheses
from encoders.labels.pair_network import NetworkEvidence, PairNetwork
from training.names import initial_weights, loss_and_slopes

SIZES = {"g": 7, "context": 5, "f": 9, "h": 6}


def drawn_weights() -> dict[str, NDArray[np.float32]]:
    rng = np.random.default_rng(0)
    weights = initial_weights(rng, SIZES)
    return {k: v + rng.normal(0, 0.05, v.shape).astype(np.float32) for k, v in weights.items()}


@pytest.mark.parametrize("count", [2, 3, 5])
def test_the_slopes_of_the_loss_are_its_finite_differences(count: int) -> None:
    rng = np.random.default_rng(count)
    weights, step = {k: v.astype(float) for k, v in drawn_weights().items()}, 1e-5
    xy = rng.normal(0, 0.03, (6, count, 2))
    fingers = np.array([rng.permutation(5)[:count] for _ in range(6)])
    _, slopes = loss_and_slopes(weights, xy, fingers)
    for name, slope in slopes.items():
        place = np.unravel_index(np.argmax(np.abs(slope)), slope.shape)
        ends = []
        for sign in (1, -1):
            moved = {k: v.copy() for k, v in weights.items()}
            moved[name][place] += sign * step
            ends.append(loss_and_slopes(moved, xy, fingers)[0])
        assert (ends[0] - ends[1]) / (2 * step) == pytest.approx(slope[place], rel=1e-3, abs=1e-6)


@pytest.mark.parametrize("count", [2, 3, 4, 5])
def test_a_batch_gets_the_probabilities_that_single_layouts_get(count: int) -> None:
    weights, rng = drawn_weights(), np.random.default_rng(0)
    xy = rng.normal(0, 0.03, (4, count, 2))
    truth = rng.integers(0, len(hypotheses(count)), 4)
    flat = NetworkEvidence(PairNetwork(weights), dict.fromkeys(range(2, 6), 1.0), {})
    single = [flat.log_posterior(one)[row] for one, row in zip(xy, truth, strict=True)]
    loss, _ = loss_and_slopes(weights, xy, hypotheses(count)[truth])
    assert loss == pytest.approx(-np.mean(single), abs=1e-4)
