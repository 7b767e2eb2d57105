"""The estimate of a person's pose: what it forgets, what it came from, and how it was chosen."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.capture import Capture
from encoders.evaluation import person_model as person_models
from encoders.evaluation.person_model import (
    CANDIDATES,
    PersonEstimate,
    person_model,
    train_person,
)
from encoders.regression.trained import TrainedModel, builtin_capture
from encoders.regression.training import blocked_predictions
from encoders.validation import FOLDS, error_product, robust_covariance, trial_folds
from models.arithmetic import Array
from models.pose import absolute_pose
from tests.encoders.regression.turning import turned_pose
from tests.support.simulation import legal_poses


@cache
def takes() -> Capture:
    """Whole takes, at the capture's rate."""
    capture = builtin_capture()
    return capture.select(np.isin(capture.trial, np.unique(capture.trial)[:4]))


@cache
def sparse() -> Capture:
    """A third of all takes, quickly learned."""
    capture = builtin_capture()
    return capture.select(np.flatnonzero(capture.trial % 3 == 0)[::20])


@cache
def mine() -> TrainedModel:
    return train_person(sparse(), "mine")


@cache
def person() -> PersonEstimate:
    return PersonEstimate(mine())


def estimate(person: PersonEstimate, capture: Capture) -> np.ndarray:
    return person.estimate(capture.time, capture.trial, capture.xy)


@cache
def estimated() -> np.ndarray:
    return estimate(person(), takes())


@settings(max_examples=10)
@given(
    chosen=st.sets(
        st.deferred(lambda: st.sampled_from(np.unique(takes().trial).tolist())), min_size=1
    )
)
def test_a_takes_poses_do_not_depend_on_other_takes(chosen: set[int]) -> None:
    part = np.isin(takes().trial, list(chosen))
    np.testing.assert_allclose(
        estimate(person(), takes().select(part)), estimated()[part], atol=1e-9
    )


@settings(max_examples=10)
@given(first=st.deferred(lambda: st.integers(0, len(takes()) - 1)))
def test_poses_do_not_depend_on_what_comes_later(first: int) -> None:
    part = np.arange(first + 1)
    np.testing.assert_allclose(
        estimate(person(), takes().select(part)), estimated()[part], atol=1e-9
    )


def test_without_a_filter_every_frame_is_encoded_and_corrected_by_itself() -> None:
    unsmoothed = estimate(replace(person(), tau=0.0), takes())
    model = person().model
    wanted = absolute_pose(model.encoder.predict(takes().u), takes().leftmost)
    assert model.correction is not None
    np.testing.assert_array_equal(unsmoothed, model.correction.correct(wanted, takes().xy))
    bare = estimate(PersonEstimate(replace(model, correction=None), 0.0), takes())
    np.testing.assert_array_equal(bare, wanted)


@settings(max_examples=10)
@given(shift=st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)))
def test_where_on_the_surface_the_hand_is_does_not_matter(shift: tuple[float, float]) -> None:
    moved = estimated().copy()
    moved[:, :2] += [shift[0], -shift[1]]
    found = person().estimate(takes().time, takes().trial, takes().xy + shift)
    np.testing.assert_allclose(found, moved, atol=1e-7)


def test_a_person_s_model_is_trained_once_and_anew_for_a_damaged_file_or_another_capture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trained: list[int] = []

    def train(capture: Capture, name: str, progress: object = None) -> TrainedModel:
        trained.append(len(capture))
        return mine()

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(person_models, "train_person", train)
    assert person_model(sparse()).digest == person_model(sparse()).digest == mine().digest
    assert len(trained) == 1
    (path,) = tmp_path.rglob("*.npz")
    path.write_bytes(b"no model")
    assert person_model(sparse()).digest == mine().digest and len(trained) == 2
    person_model(takes())
    assert trained == [len(sparse()), len(sparse()), len(takes())]


def test_the_winner_is_the_candidate_with_the_least_validated_error() -> None:
    corrected = {name: pair[1] for name, pair in mine().meta["validated"].items()}
    assert corrected.keys() == CANDIDATES.keys()
    assert corrected[mine().meta["winner"]] == min(corrected.values())


@given(a=legal_poses, b=legal_poses, seed=st.integers(0, 2**16))
def test_the_error_product_is_symmetric_and_without_order_direction_or_place(
    a: Array, b: Array, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    q = np.stack([a, b, a, b]) + rng.normal(0, 0.01, (4, 48))
    truth, order = np.stack([b, a, a, b]), rng.permutation(4)
    angle, about = rng.uniform(-3, 3), rng.uniform(-1, 1, 2)
    for one, other in (
        (q[order], truth[order]),
        (truth, q),
        (turned_pose(q, angle, about), turned_pose(truth, angle, about)),
    ):
        assert error_product(one, other) == pytest.approx(error_product(q, truth), rel=1e-9)


def test_predictions_of_a_take_are_made_without_it() -> None:
    """The take's own poses may be anything: its predictions stay what they were."""
    take = sparse().trial == sparse().trial[50]
    strange = sparse().q.copy()
    strange[take] += np.linspace(-1, 1, 48)
    make = CANDIDATES["quadratic, ridge 0.03"]
    before = blocked_predictions(make, sparse())
    after = blocked_predictions(make, replace(sparse(), q=strange))
    fold = trial_folds(sparse().trial)
    same = fold == fold[50]
    np.testing.assert_array_equal(after[same], before[same])
    assert np.abs(after - before)[~same].max(axis=1).min() > 0


@given(
    trials=st.lists(st.integers(0, 12), min_size=2, max_size=80).filter(lambda t: len(set(t)) > 1)
)
def test_folds_never_split_a_trial_and_leave_something_to_learn_from(trials: list[int]) -> None:
    trial = np.array(trials)
    fold = trial_folds(trial)
    assert fold.shape == trial.shape and fold.min() >= 0 and fold.max() < FOLDS
    assert all(len(set(fold[trial == t])) == 1 for t in trials)
    assert len(set(fold)) == min(FOLDS, len(set(trials)))


@given(seed=st.integers(0, 2**16))
def test_the_robust_covariance_is_one_and_no_frame_rules_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mixed = rng.normal(size=(6, 6))
    errors = rng.normal(size=(400, 6)) @ mixed.T
    C = robust_covariance(errors)
    np.testing.assert_allclose(C, C.T, atol=1e-12)
    assert np.linalg.eigvalsh(C).min() > 0
    # Tame errors are taken as they are, up to the few that are far out.
    np.testing.assert_allclose(np.diag(C), np.mean(errors**2, axis=0), rtol=0.05)
    order = rng.permutation(400)
    np.testing.assert_allclose(robust_covariance(errors[order]), C, rtol=1e-9, atol=1e-12)
    errors[0] *= 1e6
    assert np.trace(robust_covariance(errors)) < 1.5 * np.trace(C)
