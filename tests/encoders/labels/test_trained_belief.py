"""What a belief has learned: trained, kept in a file, and refused when it is damaged."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import encoders.labels.belief_training as training
from encoders.labels.belief import builtin_trained_belief
from encoders.labels.label_evidence import even_prior, natural_prior
from encoders.labels.layout_density import finger_sets
from encoders.labels.trained_belief import TrainedBelief, capture_digest, load_belief
from encoders.regression.trained import builtin_capture
from models.errors import EncoderError

Contacts = dict[int, tuple[float, float]]

SEEDS = st.integers(0, 2**32 - 1)


@cache
def shipped() -> TrainedBelief:
    return builtin_trained_belief()


def test_a_belief_comes_back_from_its_file_as_it_was(tmp_path: Path) -> None:
    shipped().save(tmp_path / "belief.npz")
    back = load_belief(tmp_path / "belief.npz")
    assert back.digest == shipped().digest
    assert back.to_arrays().keys() == shipped().to_arrays().keys()
    capture = builtin_capture()
    for frame in range(0, len(capture), 701):
        xy = capture.xy[frame, capture.down[frame]]
        assert np.array_equal(back.evidence.log_posterior(xy), shipped().evidence.log_posterior(xy))


def test_a_freshly_trained_belief_decides_like_its_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trained = quickly_trained(monkeypatch)
    trained.save(tmp_path / "belief.npz")
    back = load_belief(tmp_path / "belief.npz")
    capture = builtin_capture()
    for frame in range(0, len(capture), 701):
        xy = capture.xy[frame, capture.down[frame]]
        assert np.array_equal(back.evidence.log_posterior(xy), trained.evidence.log_posterior(xy))


def test_the_same_capture_gives_the_same_belief(monkeypatch: pytest.MonkeyPatch) -> None:
    assert quickly_trained(monkeypatch).digest == quickly_trained(monkeypatch).digest


def quickly_trained(monkeypatch: pytest.MonkeyPatch) -> TrainedBelief:
    """Trained on part of the capture, with little to choose from."""
    choices = {"width": (0.1,), "turn": (0.1,), "size": (0.05, 0.1)}
    monkeypatch.setattr(training, "SHAPES", choices)
    monkeypatch.setattr(training, "JUDGED_FRAMES", 30)
    monkeypatch.setattr(training, "STAYS", (0.4,))
    monkeypatch.setattr(training, "ETAS", (1.0,))
    capture = builtin_capture()
    return training.train_belief(capture.select(np.arange(0, len(capture), 6)))[0]


def test_the_shipped_belief_was_trained_on_the_shipped_capture() -> None:
    assert shipped().capture_digest == capture_digest(builtin_capture()), (
        "belief.npz is of another capture: run `python -m encoders.labels.belief_training`"
    )


@pytest.mark.full
def test_training_makes_the_shipped_belief_again() -> None:
    trained, _ = training.train_belief(builtin_capture())
    assert trained.evidence.shapes == shipped().evidence.shapes
    assert (trained.eta, trained.stay) == (shipped().eta, shipped().stay)
    for name, array in trained.to_arrays().items():
        assert np.array_equal(array, shipped().to_arrays()[name]), name


def test_a_capture_s_digest_notices_a_finger_moved_by_a_hair() -> None:
    capture = builtin_capture().select(np.arange(100))
    xy = capture.xy.copy()
    xy[50, np.flatnonzero(capture.down[50])[0], 0] += 1e-5
    other = type(capture)(capture.time, capture.trial, capture.ids, xy, capture.q, capture.meta)
    assert capture_digest(other) != capture_digest(capture)


@pytest.mark.parametrize("lacking", ["trials", "a finger set"])
def test_a_capture_that_cannot_teach_is_refused(lacking: str) -> None:
    capture = builtin_capture()
    if lacking == "trials":
        kept = np.flatnonzero(np.isin(capture.trial, np.unique(capture.trial)[:3]))
    else:
        kept = np.flatnonzero(~capture.down[:, 3:].all(axis=1))
    with pytest.raises(EncoderError):
        training.train_belief(capture.select(kept))


Damage = Callable[[dict[str, Any], dict[str, np.ndarray]], object]

DAMAGES: dict[str, Damage] = {
    "another version": lambda h, a: h.update(schema=1),
    "no version": lambda h, a: h.pop("schema"),
    "no eta": lambda h, a: h.pop("eta"),
    "eta above one": lambda h, a: h.update(eta=1.5),
    "no stay": lambda h, a: h.pop("stay"),
    "stay below nothing": lambda h, a: h.update(stay=-0.1),
    "eta in words": lambda h, a: h.update(eta="much"),
    "shapes that are a list": lambda h, a: h.update(shapes=[0.1]),
    "no shape for four": lambda h, a: h["shapes"].pop("4"),
    "a kernel without width": lambda h, a: h["shapes"]["2"].update(width=0.0),
    "a kernel with a colour": lambda h, a: h["shapes"]["3"].update(colour=1.0),
    "no order": lambda h, a: h.pop("order"),
    "order of two": lambda h, a: h["order"].update({"2": 0.5}),
    "order without exception": lambda h, a: h["order"].update({"4": 1.0}),
    "layouts cut short": lambda h, a: a.update(layout_3=a["layout_3"][:5]),
    "layouts that are not finite": lambda h, a: a["layout_2"].fill(np.nan),
    "layouts of one number": lambda h, a: a.update(layout_5=np.array(1.0)),
    "no layouts": lambda h, a: a.update(layout_4=a["layout_4"][:, :0]),
    "a prior in words": lambda h, a: a.update(prior_2=np.array(["a"] * 10)),
    "no prior": lambda h, a: a.pop("prior_1"),
    "a prior of too much": lambda h, a: a.update(prior_3=2 * a["prior_3"]),
    "a prior that rules out": lambda h, a: a.update(prior_2=np.eye(10)[0]),
}
"""Changes of the header and the arrays of a sound belief, after which it must be refused."""


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES.keys())
def test_damaged_arrays_are_refused(damage: Damage) -> None:
    header, arrays = json.loads(json.dumps(shipped().header)), shipped().to_arrays()
    damage(header, arrays)
    with pytest.raises(EncoderError):
        TrainedBelief.from_arrays(header, arrays)


@given(cut=st.floats(0.0, 0.999))
def test_a_file_cut_short_is_refused(cut: float, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("belief") / "belief.npz"
    shipped().save(path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(cut * len(whole))])
    with pytest.raises(EncoderError, match="damaged"):
        load_belief(path)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(EncoderError, match="no such file"):
        load_belief(tmp_path / "belief.npz")


def test_priors_are_probabilities_and_the_natural_one_prefers_the_thumb_and_its_neighbours() -> (
    None
):
    for prior in (even_prior(), natural_prior()):
        assert {k: len(p) for k, p in prior.items()} == {1: 5, 2: 10, 3: 10, 4: 5, 5: 1}
        assert all(p.sum() == pytest.approx(1.0) for p in prior.values())
    for count in (2, 3, 4):
        assert finger_sets(count)[natural_prior()[count].argmax()] == tuple(range(count))
        assert len(set(even_prior()[count])) == 1
