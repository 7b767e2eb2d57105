"""Both simulated subjects play the paper's script, within what a hand can do, and share nothing
else."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.capture import Capture, load_capture
from encoders.captures import subject as first
from encoders.captures.subject.gestures import smooth_noise, strokes
from encoders.captures.subject.subject import FREEDOMS, PostureSolver, anatomy
from encoders.regression.polynomial import CubicEncoder
from encoders.regression.trained import builtin_capture
from models.errors import InputError
from models.kinematics import Kinematics
from models.pose import JOINTS, POSE_SIZE, violations
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH, Surface
from sandbox.cli.main import main
from training import second_subject as second
from training.second_subject import SLENDER
from training.second_subject.hand import LAST, ROLL, attitude
from training.second_subject.placing import reach
from training.second_subject.session import Markers

ROOT = Path(__file__).resolve().parents[2]
HAND = Kinematics(ADULT)


@dataclass(frozen=True)
class Generator:
    """A generator of captures, and how well its touches and its measured poses agree.

    Attributes:
        package: Functions and settings of the generator.
        tips: Fingertips (T, 5, 3) m of poses (T, 48).
        resting, farthest: Median and greatest height (m) of a touching tip above a resting one.
        lifted: Median height (m) of a lifted tip above a resting one.
        sunk: Share of lifted tips that errors of markers put into the screen.
        under: Greatest distance (m) of a touch from its fingertip.
    """

    package: Any
    tips: Callable[[np.ndarray], np.ndarray]
    resting: float
    farthest: float
    lifted: float
    sunk: float
    under: float


GENERATORS = {
    "first": Generator(first, HAND.tips, 0.001, 0.006, 0.010, 0.0, 0.020),
    "second": Generator(second, SLENDER.tips, 0.0015, 0.010, 0.007, 0.001, 0.010),
}
BOTH = pytest.mark.parametrize("name", GENERATORS)
DAYS = pytest.mark.parametrize(("name", "day"), [(n, d) for n in GENERATORS for d in (0, 1)])


@cache
def capture_of(name: str, day: int) -> Capture:
    package = GENERATORS[name].package
    return package.simulate(package.FROZEN, package.SEED, day)


@BOTH
def test_training_has_the_papers_frames_and_every_set_of_fingers(name: str) -> None:
    training = capture_of(name, 0)
    sizes, counts = np.unique(training.down.sum(axis=1), return_counts=True)
    paper = {2: 2500, 3: 2020, 4: 874, 5: 1689}
    assert dict(zip(sizes.tolist(), counts.tolist(), strict=True)) == paper
    assert len(np.unique(training.down, axis=0)) == 26


@BOTH
def test_a_later_day_has_the_papers_frames_and_fingers_that_come_and_go(name: str) -> None:
    later = capture_of(name, 1)
    assert np.bincount(later.down.sum(axis=1)).tolist() == [0, 0, 640, 720, 430, 748]
    changed = np.diff(later.down.astype(int), axis=0)[np.diff(later.trial) == 0]
    assert set(np.abs(changed).sum(axis=1)) == {0, 1, 2}
    assert (changed > 0).any() and (changed < 0).any()


@DAYS
def test_no_joint_leaves_its_range(name: str, day: int) -> None:
    assert violations(capture_of(name, day).q, ADULT).sum() == 0


@DAYS
def test_touching_tips_are_on_the_screen_and_lifted_ones_above_it(name: str, day: int) -> None:
    capture, own = capture_of(name, day), GENERATORS[name]
    z, resting = own.tips(capture.q)[..., 2], own.package.FROZEN.tip_height
    off = np.abs(z[capture.down] - resting)
    assert np.median(off) < own.resting and off.max() < own.farthest
    assert np.quantile(z[~capture.down], own.sunk) > 0.0
    assert np.median(z[~capture.down]) > resting + own.lifted


@DAYS
def test_touches_lie_on_the_screen_under_the_fingertips(name: str, day: int) -> None:
    capture, own = capture_of(name, day), GENERATORS[name]
    xy = capture.xy[capture.down]
    assert (xy > 0).all() and (xy < Surface().size).all()
    under = own.tips(capture.q)[capture.down][:, :2] * [1, -1]
    assert np.linalg.norm(xy - under, axis=1).max() < own.under


@BOTH
def test_a_contact_keeps_its_id_from_landing_to_lifting_and_no_other_has_it(name: str) -> None:
    later = capture_of(name, 1)
    for i in np.unique(later.ids[later.ids >= 0]):
        frames, fingers = np.nonzero(later.ids == i)
        assert len(set(fingers)) == 1 and len(set(later.trial[frames])) == 1
        np.testing.assert_array_equal(np.diff(frames), 1)


@BOTH
def test_no_frame_of_a_later_day_comes_from_the_training(name: str) -> None:
    a, b = capture_of(name, 0).q[:, 6:], capture_of(name, 1).q[::10, 6:]
    assert min(np.abs(a - row).max(axis=1).min() for row in b) > np.deg2rad(0.5)


@BOTH
def test_equal_arguments_give_equal_captures_and_others_do_not(name: str) -> None:
    package = GENERATORS[name].package
    quick = replace(package.FROZEN, test_frames=(60, 60, 60, 60))
    one, again = (package.simulate(quick, 3, 1) for _ in range(2))
    for array in ("time", "trial", "ids", "xy", "q"):
        np.testing.assert_array_equal(getattr(one, array), getattr(again, array))
    for seed, day in ((4, 1), (3, 2)):
        other = package.simulate(quick, seed, day)
        assert other.q.shape != one.q.shape or np.abs(other.q - one.q).max() > 0.1


@BOTH
@pytest.mark.parametrize(("seed", "day"), ((-1, 0), (0, -1)))
def test_negative_seeds_and_days_are_refused(name: str, seed: int, day: int) -> None:
    package = GENERATORS[name].package
    with pytest.raises(InputError, match="0 or more"):
        package.simulate(package.FROZEN, seed, day)


# --- the first subject


def test_the_built_in_capture_is_what_the_frozen_subject_does() -> None:
    training, shipped = capture_of("first", 0), builtin_capture()
    np.testing.assert_array_equal(training.ids, shipped.ids)
    moved = np.abs(training.q - shipped.q).max(axis=1) > 1e-4
    assert moved.mean() <= 0.01
    frozen = {k: list(v) if isinstance(v, tuple) else v for k, v in first.FROZEN.as_json().items()}
    assert shipped.meta["configuration"] == frozen and shipped.meta["seed"] == first.SEED


@pytest.mark.parametrize("day", (0, 1))
def test_no_knuckle_is_in_the_table_and_fingers_do_not_overlap(day: int) -> None:
    capture = capture_of("first", day)
    assert HAND.place(capture.q).joints[..., 2].min() > 0.0
    a, b = np.triu_indices(5, 1)
    assert np.nanmin(np.linalg.norm(capture.xy[:, a] - capture.xy[:, b], axis=2)) > 0.010
    # A screen reports whole dots.
    dots = capture.xy[capture.down] / METRES_PER_INCH * first.FROZEN.touch_resolution
    np.testing.assert_allclose(dots, np.round(dots), atol=1e-6)


def test_poses_are_not_a_polynomial_of_the_touches() -> None:
    """Even on the frames it learned from, a cubic with 816 terms cannot follow the wrist."""
    U, Q = capture_of("first", 0).u, capture_of("first", 0).relative
    left = CubicEncoder().fit(U, Q).predict(U) - Q
    assert np.linalg.norm(left[:, :3], axis=1).mean() > 0.005


def test_few_components_carry_most_of_the_variance_as_in_the_paper() -> None:
    """Percent in 3, 6, 9 and 12 components (section 3); the subject was calibrated to it."""
    values = np.linalg.eigvalsh(np.cov(capture_of("first", 0).relative.T))[::-1]
    shares = 100 * np.cumsum(values)[[2, 5, 8, 11]] / values.sum()
    np.testing.assert_allclose(shares, [68, 87, 94, 97], atol=5)


def test_the_solver_ends_where_a_small_change_of_posture_does_not_help() -> None:
    hand = anatomy(np.random.default_rng(0), ADULT, first.FROZEN)
    rng = np.random.default_rng(1)
    aim = 0.1 * rng.normal(size=(6, FREEDOMS))
    targets = HAND.tips(aim @ hand.hinges.T) + 0.01 * rng.normal(size=(6, 5, 3))
    precision = np.full((6, 5, 3), 0.001)
    precision[:, 3:] = np.inf
    found = PostureSolver(HAND, hand).solve(aim, targets, precision)

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


def test_the_command_writes_the_capture_and_says_that_it_is_simulated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "day1.npz"
    assert main(["subject", "--seed", str(first.SEED), "--day", "1", "--out", str(path)]) == 0
    assert "simulated" in capsys.readouterr().out
    np.testing.assert_allclose(load_capture(path).q, capture_of("first", 1).q, atol=1e-6)


# --- the second subject


def some_angles(frames: int, seed: int = 0, share: float = 1.0) -> np.ndarray:
    """(frames, 5, 5) angles of fingers within their ranges."""
    low, high = SLENDER.reach_limits
    middle, half = (low + high) / 2, share * (high - low) / 2
    return middle + half * np.random.default_rng(seed).uniform(-1, 1, (frames, 5, 5))


def test_the_second_subject_shares_no_kinematics_limits_or_rotations_with_the_first() -> None:
    known = set()
    for file in (ROOT / "training" / "second_subject").glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                known |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{file} hides what it imports behind dots"
                known.add(str(node.module))
    ours = {m for m in known if m.startswith(("models.", "encoders.", "training."))}
    types = {"arithmetic", "errors", "frames", "pose", "surface"}
    assert "encoders.capture" in ours
    assert ours <= {"encoders.capture", *(f"models.{name}" for name in types)} | {
        m for m in ours if m.startswith("training.second_subject.")
    }


def test_the_second_subject_does_every_gesture_with_every_set_of_fingers() -> None:
    training = capture_of("second", 0)
    clips = [
        tuple(training.down[training.trial == t][0].tolist()) for t in np.unique(training.trial)
    ]
    assert {clips.count(fingers) for fingers in set(clips)} == {4, 24}


@pytest.mark.parametrize("day", (0, 1))
def test_no_joint_of_the_second_hand_leaves_its_own_range(day: int) -> None:
    lower, upper = SLENDER.joint_limits()
    q = capture_of("second", day).q[:, JOINTS]
    assert (q >= lower - 1e-12).all() and (q <= upper + 1e-12).all()


def test_a_zero_joint_has_the_same_meaning_as_in_the_first_hand() -> None:
    """Fingers point alike at zero but for a few degrees of splay; so angles can be compared."""
    zero = np.zeros((1, POSE_SIZE))
    ours, theirs = SLENDER.chain(zero)[1][0], HAND.place(zero[0]).rotations
    alike = (ours[..., 1] * theirs[..., 1]).sum(axis=-1)
    assert np.rad2deg(np.arccos(np.clip(alike, -1, 1)))[2:].max() < 3.0


def test_the_fingertips_closed_form_is_the_chain_of_bones() -> None:
    angles = some_angles(50)
    rng = np.random.default_rng(1)
    root, turn = rng.normal(size=(50, 3)), attitude(*rng.normal(0, 0.5, (3, 50)))
    q = SLENDER.pose(root, turn, angles)
    wanted = (turn[:, None] @ SLENDER.tips_in_palm(angles)[..., None])[..., 0] + root[:, None]
    np.testing.assert_allclose(SLENDER.tips(q), wanted, atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**16))
def test_a_finger_finds_every_point_that_it_can_touch(seed: int) -> None:
    angles = some_angles(20, seed, share=0.95)
    # A joint bent backwards reaches what it reaches bent forwards, and only the latter is found.
    angles[..., LAST] = np.abs(angles[..., LAST])
    goal = SLENDER.tips_in_palm(angles)
    local = np.einsum("fji,nfj->nfi", SLENDER.saddle, goal - SLENDER.knuckle)
    start = np.zeros_like(angles)
    start[..., [ROLL, LAST]] = angles[..., [ROLL, LAST]]
    found = SLENDER.tips_in_palm(reach(SLENDER, goal, start))
    ahead = local[..., 1] > 0.012
    assert np.linalg.norm(found - goal, axis=2)[ahead].max() < 1e-4


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**16), scale=st.floats(0.01, 10.0))
def test_a_finger_stays_in_its_range_whatever_it_reaches_for(seed: int, scale: float) -> None:
    goal = scale * np.random.default_rng(seed).normal(size=(10, 5, 3))
    found = reach(SLENDER, goal, some_angles(10, seed))
    low, high = SLENDER.reach_limits
    assert np.isfinite(found).all()
    assert (found >= low - 1e-9).all() and (found <= high + 1e-9).all()


def test_perfect_markers_measure_the_true_pose() -> None:
    perfect = replace(second.FROZEN, marker=0.0, palm_marker=0.0, tremble=0.0)
    rng = np.random.default_rng(3)
    turn = attitude(*rng.normal(0, 0.4, (3, 40)))
    q = SLENDER.pose(rng.normal(size=(40, 3)), turn, some_angles(40, share=0.8))
    measured = Markers(rng, SLENDER, perfect).poses(rng, q)
    np.testing.assert_allclose(measured, q, atol=1e-7)
