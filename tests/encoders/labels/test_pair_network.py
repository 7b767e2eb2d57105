"""The network that names contacts: its symmetries and its file."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from encoders.labels.belief import from_weights, load_population_belief
from encoders.labels.labelling import hypotheses
from encoders.labels.pair_network import NetworkEvidence, PairNetwork
from models.errors import EncoderError
from tests.support.npz_files import rewritten
from training.names import initial_weights

SIZES = {"g": 7, "context": 5, "f": 9, "h": 6}


def drawn_weights(seed: int = 0) -> dict[str, NDArray[np.float32]]:
    rng = np.random.default_rng(seed)
    weights = initial_weights(rng, SIZES)
    return {k: v + rng.normal(0, 0.05, v.shape).astype(np.float32) for k, v in weights.items()}


@given(st.integers(2, 5), st.integers(0, 1000))
@settings(max_examples=30, deadline=None)
def test_probabilities_follow_the_contacts_whatever_their_order_and_place(
    count: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    evidence = NetworkEvidence(PairNetwork(drawn_weights()), dict.fromkeys(range(2, 6), 1.0))
    xy = rng.normal(0, 0.03, (count, 2))
    order = rng.permutation(count)
    before = evidence.log_posterior(xy)
    after = evidence.log_posterior(xy[order] + rng.normal(0, 0.1, 2))
    row = {tuple(labels): i for i, labels in enumerate(hypotheses(count).tolist())}
    same = [row[tuple(labels[list(order)])] for labels in hypotheses(count)]
    assert np.allclose(after[same], before, atol=1e-9)
    assert np.exp(before).sum() == pytest.approx(1.0)


def test_a_stored_belief_is_the_same_belief(tmp_path: Path) -> None:
    belief = from_weights(drawn_weights(), "people")
    belief.save(tmp_path / "names.npz")
    back = load_population_belief(tmp_path / "names.npz")
    xy = np.random.default_rng(1).normal(0, 0.03, (3, 2))
    assert back.digest == belief.digest
    assert np.array_equal(back.evidence.log_posterior(xy), belief.evidence.log_posterior(xy))


@pytest.mark.parametrize(
    "damage",
    [lambda f2: None, lambda f2: f2[:-1], lambda f2: f2 * np.nan],
    ids=["missing", "shape", "nan"],
)
def test_a_wrong_file_is_one_clear_error(tmp_path: Path, damage: Callable[[Any], Any]) -> None:
    path, weights = tmp_path / "names.npz", drawn_weights()
    from_weights(weights, "people").save(path)
    rewritten(path, f2=damage(weights["f2"]))
    with pytest.raises(EncoderError):
        load_population_belief(path)
