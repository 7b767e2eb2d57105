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
from encoders.reconstruction.hand_motion import PoseFilter
from encoders.regression.trained import TrainedModel, builtin_capture, builtin_folder
from encoders.regression.training import blocked_predictions
from encoders.validation import FOLDS, error_product, robust_covariance, trial_folds
from models.arithmetic import Array
from models.errors import EncoderError
from models.pose import absolute_pose
from tests.encoders.regression.turning import turned_places, turned_pose
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


def test_every_take_begins_with_the_unsmoothed_pose_and_goes_on_with_smoothed_ones() -> None:
    unsmoothed = estimate(replace(person(), tau=0.0), takes())
    begins = np.concatenate([[True], np.diff(takes().trial) != 0])
    assert begins.sum() == 4
    np.testing.assert_array_equal(estimated()[begins], unsmoothed[begins])
    assert (np.abs(estimated() - unsmoothed)[~begins].max(axis=1) > 0).mean() > 0.9


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


def test_estimating_leaves_the_touches_as_they_were() -> None:
    kept = takes().xy.copy()
    estimate(person(), takes())
    np.testing.assert_array_equal(takes().xy, kept)
    np.testing.assert_array_equal(estimate(person(), takes()), estimated())


def test_on_what_it_was_trained_on_it_is_nearer_than_its_encoder_alone() -> None:
    encoder = absolute_pose(mine().encoder.predict(sparse().u), sparse().leftmost)
    corrected = estimate(PersonEstimate(mine(), 0.0), sparse())
    assert error_product(corrected, sparse().q) < error_product(encoder, sparse().q)


def test_the_packages_data_are_below_five_megabytes() -> None:
    assert sum(p.stat().st_size for p in builtin_folder().rglob("*") if p.is_file()) < 5e6


def test_the_winner_is_the_candidate_with_the_least_validated_error() -> None:
    meta = mine().meta
    corrected = {name: pair[1] for name, pair in meta["validated"].items()}
    assert set(corrected) == set(CANDIDATES)
    assert corrected[meta["winner"]] == min(corrected.values())


def test_what_the_table_says_of_a_candidate_is_what_validation_gives() -> None:
    trained = mine()
    winner = trained.meta["winner"]
    predicted = blocked_predictions(CANDIDATES[winner], sparse())
    plain = 100 * np.rad2deg(error_product(predicted, sparse().relative))
    assert trained.meta["validated"][winner][0] == pytest.approx(plain, abs=1e-3)
    np.testing.assert_array_equal(
        trained.residual_covariance,
        np.float32(robust_covariance(sparse().relative - predicted)),
    )


def test_training_again_gives_the_same_model_and_calls_simulated_only_what_is_marked_so() -> None:
    trained = mine()
    told: list[float] = []
    again = train_person(replace(sparse(), meta={}), "again", told.append)
    assert told == sorted(told) and len(told) == len(CANDIDATES) and 0 < told[0] <= told[-1] <= 1
    assert again.meta["simulated"] is False and trained.meta["simulated"] is True
    assert replace(again, meta=trained.meta).digest == trained.digest
    assert again.correction is not None and trained.correction is not None
    np.testing.assert_array_equal(again.correction.tip_variance, trained.correction.tip_variance)


def test_one_take_alone_is_refused() -> None:
    with pytest.raises(EncoderError, match="2 trials"):
        train_person(takes().select(takes().trial == takes().trial[0]), "mine")


def test_a_person_s_model_is_trained_once_and_anew_for_another_capture_or_a_damaged_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trained: list[int] = []

    def train(capture: Capture, name: str, progress: object = None) -> TrainedModel:
        trained.append(len(capture))
        return replace(mine(), training_u=capture.u, training_pose=capture.relative)

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(person_models, "train_person", train)
    first, again = person_model(sparse()), person_model(sparse())
    assert len(trained) == 1
    u = takes().u[:50]
    np.testing.assert_array_equal(first.encoder.predict(u), again.encoder.predict(u))
    other = sparse().select(sparse().trial != sparse().trial[0])
    person_model(other)
    assert trained == [len(sparse()), len(other)]
    for path in tmp_path.rglob("*.npz"):
        path.write_bytes(b"no model")
    person_model(sparse())
    assert len(trained) == 3


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


@given(
    trials=st.lists(st.integers(0, 12), min_size=2, max_size=80).filter(lambda t: len(set(t)) > 1),
    data=st.data(),
)
def test_the_order_of_frames_does_not_change_their_folds(
    trials: list[int], data: st.DataObject
) -> None:
    trial = np.array(trials)
    order = np.array(data.draw(st.permutations(range(len(trials)))))
    np.testing.assert_array_equal(trial_folds(trial[order]), trial_folds(trial)[order])


def test_folds_are_about_equally_large() -> None:
    sizes = np.bincount(trial_folds(builtin_capture().trial), minlength=FOLDS)
    assert sizes.min() > 0.9 * sizes.max()


@given(a=legal_poses, b=legal_poses, seed=st.integers(0, 2**16))
def test_badness_is_a_product_without_order_direction_or_place(
    a: Array, b: Array, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    q = np.stack([a, b, a, b]) + rng.normal(0, 0.01, (4, 48))
    truth = np.stack([b, a, a, b])
    found = error_product(q, truth)
    order = rng.permutation(4)
    assert error_product(q[order], truth[order]) == pytest.approx(found, rel=1e-9)
    assert error_product(truth, q) == pytest.approx(found, rel=1e-9)
    angle, about = rng.uniform(-3, 3), rng.uniform(-1, 1, 2)
    turned = turned_pose(q, angle, about), turned_pose(truth, angle, about)
    assert error_product(*turned) == pytest.approx(found, rel=1e-9)


@given(a=legal_poses, b=legal_poses, wrist=st.booleans(), joints=st.booleans())
def test_badness_is_zero_where_the_wrist_or_the_joints_are_right_and_nowhere_else(
    a: Array, b: Array, wrist: bool, joints: bool
) -> None:
    """It is a product, so one part that is right hides the other."""
    b = b.copy()
    b[:3], b[6:] = a[:3] + 0.01 * wrist, a[6:] + 0.1 * joints
    assert error_product(a[None], a[None]) == pytest.approx(0.0, abs=1e-12)
    assert (error_product(a[None], b[None]) > 1e-6) == (wrist and joints)


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


@settings(max_examples=15)
@given(
    degrees=st.floats(-30, 30),
    about=st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)).map(np.array),
)
def test_the_filter_is_told_how_the_touches_turned(degrees: float, about: Array) -> None:
    """What it finds from touches alone is the turn about the point that they were turned about."""
    time, step = 0.01 * np.arange(10.0), np.deg2rad(degrees) / 9
    held = takes().xy[int(np.argmax(takes().down.sum(axis=1)))]
    xy = np.stack([turned_places(held, i * step, about) for i in range(10)])
    found = person().estimate(time, np.zeros(10, int), xy)
    unsmoothed = replace(person(), tau=0.0).estimate(time, np.zeros(10, int), xy)
    posture = PoseFilter(person().tau)
    wanted = [posture.step(unsmoothed[0], [0.0, 0.0], 0.0)]
    wanted += [posture.step(q, [0.0, 0.0], 0.01, step, about.tolist()) for q in unsmoothed[1:]]
    np.testing.assert_allclose(found, wanted, atol=1e-9)
