"""The simulated subject does what the paper's did, within what a hand can do."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from encoders.capture import Capture
from encoders.captures.subject import FROZEN, SEED, simulate
from encoders.captures.subject.configuration import SubjectConfiguration
from encoders.captures.subject.gestures import SETS, smooth_noise, strokes
from encoders.captures.subject.subject import FREEDOMS, PostureSolver, anatomy
from encoders.regression.polynomial import CubicEncoder
from encoders.regression.trained import builtin_capture
from encoders.store import load_capture
from models.errors import InputError
from models.kinematics import Kinematics
from models.pose import violations
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH, Surface
from sandbox.cli.main import main

HAND = Kinematics(ADULT)
QUICK = replace(FROZEN, test_frames=(60, 60, 60, 60))
SIZES = {2: 2500, 3: 2020, 4: 874, 5: 1689}


@pytest.fixture(scope="module")
def training() -> Capture:
    return simulate(FROZEN, SEED, 0)


@pytest.fixture(scope="module")
def later() -> Capture:
    return simulate(FROZEN, SEED, 1)


@pytest.fixture(params=("training", "later"))
def capture(request: pytest.FixtureRequest) -> Capture:
    return request.getfixturevalue(request.param)


def sets_of(capture: Capture) -> set[tuple[int, ...]]:
    return {tuple(np.flatnonzero(row)) for row in np.unique(capture.down, axis=0)}


def tip_heights(capture: Capture) -> np.ndarray:
    return HAND.tips(capture.q)[..., 2]


def test_training_has_the_papers_frames_and_every_set_of_fingers(training: Capture) -> None:
    assert len(training) == 7083
    sizes, counts = np.unique(training.down.sum(axis=1), return_counts=True)
    assert dict(zip(sizes, counts, strict=True)) == SIZES
    assert sets_of(training) == set(SETS) and len(SETS) == 26


def test_a_later_day_has_the_papers_frames_and_no_single_finger(later: Capture) -> None:
    assert len(later) == 2538
    assert set(later.down.sum(axis=1)) == {2, 3, 4, 5}


def test_the_built_in_capture_is_what_the_frozen_subject_does(training: Capture) -> None:
    shipped = builtin_capture()
    np.testing.assert_array_equal(training.ids, shipped.ids)
    moved = np.abs(training.q - shipped.q).max(axis=1) > 1e-4
    assert moved.mean() <= 0.01
    assert shipped.meta["configuration"] == _json(FROZEN) and shipped.meta["seed"] == SEED


def _json(configuration: SubjectConfiguration) -> dict:
    return {k: list(v) if isinstance(v, tuple) else v for k, v in configuration.as_json().items()}


def test_no_joint_leaves_its_range(capture: Capture) -> None:
    assert violations(capture.q, ADULT).sum() == 0


def test_touching_tips_are_on_the_surface_and_lifted_ones_above_it(capture: Capture) -> None:
    z = tip_heights(capture)
    off = np.abs(z[capture.down] - FROZEN.tip_height)
    assert np.median(off) < 0.001 and off.max() < 0.006
    assert z[~capture.down].min() > 0.0
    assert np.median(z[~capture.down]) > FROZEN.tip_height + 0.01


def test_no_knuckle_is_in_the_table(capture: Capture) -> None:
    assert HAND.place(capture.q).joints[..., 2].min() > 0.0


def test_touches_are_on_the_screen_in_whole_dots_and_under_the_fingertips(capture: Capture) -> None:
    xy = capture.xy[capture.down]
    assert (xy >= 0).all() and (xy <= Surface().size).all()
    dots = xy / METRES_PER_INCH * FROZEN.touch_resolution
    np.testing.assert_allclose(dots, np.round(dots), atol=1e-6)
    tips = HAND.tips(capture.q)[capture.down][:, :2] * [1, -1]
    assert np.linalg.norm(xy - tips, axis=1).max() < 0.02


def test_fingers_do_not_overlap(capture: Capture) -> None:
    a, b = np.triu_indices(5, 1)
    distance = np.linalg.norm(capture.xy[:, a] - capture.xy[:, b], axis=2)
    assert np.nanmin(distance) > 0.010


def test_a_contact_keeps_its_id_from_landing_to_lifting_and_no_other_has_it(later: Capture) -> None:
    for i in np.unique(later.ids[later.ids >= 0]):
        frames, fingers = np.nonzero(later.ids == i)
        assert len(set(fingers)) == 1 and len(set(later.trial[frames])) == 1
        np.testing.assert_array_equal(np.diff(frames), 1)
    changed = np.diff(later.down.astype(int), axis=0)[np.diff(later.trial) == 0]
    assert set(np.abs(changed).sum(axis=1)) <= {0, 1, 2}


def test_equal_arguments_give_equal_captures_and_others_do_not() -> None:
    first, again = simulate(QUICK, 3, 1), simulate(QUICK, 3, 1)
    np.testing.assert_array_equal(first.q, again.q)
    np.testing.assert_array_equal(first.xy, again.xy)
    for seed, day in ((4, 1), (3, 2)):
        other = simulate(QUICK, seed, day)
        assert other.q.shape == first.q.shape and np.abs(other.q - first.q).max() > 0.1


def test_no_frame_of_a_later_day_comes_from_the_training(training: Capture, later: Capture) -> None:
    a, b = training.q[:, 6:], later.q[:, 6:]
    nearest = [np.abs(a - row).max(axis=1).min() for row in b[::10]]
    assert min(nearest) > np.deg2rad(0.5)


def test_poses_are_not_a_polynomial_of_the_touches(training: Capture) -> None:
    """Even on the frames it learned from, a cubic with 816 terms cannot follow the wrist."""
    U, Q = training.u, training.relative
    left = CubicEncoder().fit(U, Q).predict(U) - Q
    assert np.linalg.norm(left[:, :3], axis=1).mean() > 0.005


def test_few_components_carry_most_of_the_variance_as_in_the_paper(training: Capture) -> None:
    """Percent in 3, 6, 9 and 12 components (section 3); the subject was calibrated to it."""
    values = np.linalg.eigvalsh(np.cov(training.relative.T))[::-1]
    shares = 100 * np.cumsum(values)[[2, 5, 8, 11]] / values.sum()
    np.testing.assert_allclose(shares, [68, 87, 94, 97], atol=5)


def test_the_solver_ends_where_a_small_change_of_posture_does_not_help() -> None:
    hand = anatomy(np.random.default_rng(0), ADULT, FROZEN)
    solver = PostureSolver(HAND, hand)
    rng = np.random.default_rng(1)
    aim = 0.1 * rng.normal(size=(6, FREEDOMS))
    targets = HAND.tips(aim @ hand.hinges.T) + 0.01 * rng.normal(size=(6, 5, 3))
    precision = np.full((6, 5, 3), 0.001)
    precision[:, 3:] = np.inf
    found = solver.solve(aim, targets, precision)

    def cost(theta: np.ndarray) -> np.ndarray:
        tips = HAND.tips(theta @ hand.hinges.T)
        away = theta - aim
        prior = np.einsum("na,ab,nb->n", away, np.linalg.inv(hand.covariance), away)
        return (((tips - targets) / precision) ** 2).sum(axis=(1, 2)) + prior

    best = cost(found)
    assert (best < cost(aim)).all()
    for _ in range(50):
        assert (cost(found + 1e-3 * rng.normal(size=found.shape)) > best).all()
    tips = HAND.tips(found @ hand.hinges.T)
    assert np.linalg.norm(tips - targets, axis=2)[:, :3].max() < 0.002


def test_a_stroke_is_the_same_at_any_rate_and_so_is_noise() -> None:
    fast, slow = np.arange(0, 4, 0.01), np.arange(0, 4, 0.05)
    for make in (
        lambda t: strokes(np.random.default_rng(2), t, (0.5, 1.0), (0.6, 1.3)),
        lambda t: smooth_noise(np.random.default_rng(2), t, 0.4, (3,)),
    ):
        at_once = make(np.append(fast, 4.0))[:-1]
        np.testing.assert_allclose(at_once[::5], make(np.append(slow, 4.0))[:-1], atol=1e-9)


@pytest.mark.parametrize(("seed", "day"), ((-1, 0), (0, -1)))
def test_negative_seeds_and_days_are_refused(seed: int, day: int) -> None:
    with pytest.raises(InputError, match="0 or more"):
        simulate(FROZEN, seed, day)


def test_the_command_writes_the_capture_and_says_that_it_is_simulated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], later: Capture
) -> None:
    path = tmp_path / "day1.npz"
    assert main(["subject", "--seed", str(SEED), "--day", "1", "--out", str(path)]) == 0
    assert "2,538 frames" in (told := capsys.readouterr().out) and "simulated" in told
    np.testing.assert_allclose(load_capture(path).q, later.q, atol=1e-6)
