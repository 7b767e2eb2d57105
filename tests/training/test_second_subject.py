"""The second simulated subject keeps to the same protocol as the first, and is made otherwise."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.capture import Capture
from models.kinematics import Kinematics
from models.pose import JOINTS, POSE_SIZE, violations
from models.skeleton import ADULT
from models.surface import Surface
from training.second_subject import FROZEN, SEED, SLENDER, simulate
from training.second_subject.contacts import (
    SETS,
)
from training.second_subject.hand import LAST, ROLL, attitude
from training.second_subject.measurement import Markers
from training.second_subject.reach import reach

ROOT = Path(__file__).resolve().parents[2]
FIRST, SECOND = "encoders.captures.subject", "training.second_subject"
QUICK = replace(FROZEN, training_frames=(120, 120, 60, 48), test_frames=(60, 60, 60, 60))
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


def some_angles(frames: int, seed: int = 0, share: float = 1.0) -> np.ndarray:
    """(frames, 5, 5) angles of fingers within their ranges."""
    low, high = SLENDER.reach_limits
    middle, half = (low + high) / 2, share * (high - low) / 2
    return middle + half * np.random.default_rng(seed).uniform(-1, 1, (frames, 5, 5))


def imported(package: str) -> set[str]:
    """Every module that a package imports, names imported from it included."""
    found = set()
    for file in sorted((ROOT / package.replace(".", "/")).glob("**/*.py")):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{file} hides what it imports behind dots"
                found |= {f"{node.module}.{alias.name}" for alias in node.names}
                found.add(str(node.module))
    assert found
    return found


def test_the_second_subject_shares_no_kinematics_limits_or_rotations_with_the_first() -> None:
    known = imported(SECOND)
    ours = {
        m.split(".")[1]
        for m in known
        if m.startswith("models.") and not m.startswith("models.arithmetic")
    }
    assert ours <= {"errors", "frames", "pose", "surface"}
    others = {m for m in known if m.startswith(("encoders.", "training."))}
    others = {m for m in others if m != SECOND and not m.startswith(f"{SECOND}.")}
    assert others == {"encoders.capture", "encoders.capture.Capture"}


def test_training_has_the_papers_frames_and_every_set_with_every_gesture(training: Capture) -> None:
    sizes, counts = np.unique(training.down.sum(axis=1), return_counts=True)
    assert dict(zip(sizes.tolist(), counts.tolist(), strict=True)) == SIZES
    clips = [
        tuple(training.down[training.trial == t][0].tolist()) for t in np.unique(training.trial)
    ]
    assert len(clips) == 124 and len(set(clips)) == 26 == len(SETS)
    assert {clips.count(fingers) for fingers in set(clips)} == {4, 24}


def test_a_later_day_has_the_papers_frames_and_fingers_that_come_and_go(later: Capture) -> None:
    counts = np.bincount(later.down.sum(axis=1), minlength=6)
    assert counts.tolist() == [0, 0, 640, 720, 430, 748]
    changed = np.diff(later.down.astype(int), axis=0)[np.diff(later.trial) == 0]
    assert set(np.abs(changed).sum(axis=1)) == {0, 1, 2}
    assert (changed > 0).any() and (changed < 0).any()


def test_no_joint_leaves_its_range_nor_that_of_the_other_hand(capture: Capture) -> None:
    lower, upper = SLENDER.joint_limits()
    q = capture.q[:, JOINTS]
    assert (q >= lower - 1e-12).all() and (q <= upper + 1e-12).all()
    assert violations(capture.q, ADULT).sum() == 0


def test_touching_tips_are_on_the_screen_and_lifted_ones_above_it(capture: Capture) -> None:
    z = SLENDER.tips(capture.q)[..., 2]
    off = np.abs(z[capture.down] - FROZEN.tip_height)
    assert np.median(off) < 0.0015 and off.max() < 0.010
    assert np.quantile(z[~capture.down], 0.001) > 0.0
    assert np.median(z[~capture.down]) > FROZEN.tip_height + 0.007


def test_touches_lie_on_the_screen_under_the_fingertips(capture: Capture) -> None:
    xy = capture.xy[capture.down]
    assert (xy > 0).all() and (xy < Surface().size).all()
    under = SLENDER.tips(capture.q)[capture.down][:, :2] * [1, -1]
    assert np.linalg.norm(xy - under, axis=1).max() < 0.010


def test_a_contact_keeps_its_id_from_landing_to_lifting_and_no_other_has_it(later: Capture) -> None:
    for i in np.unique(later.ids[later.ids >= 0]):
        frames, fingers = np.nonzero(later.ids == i)
        assert len(set(fingers)) == 1 and len(set(later.trial[frames])) == 1
        np.testing.assert_array_equal(np.diff(frames), 1)


def test_no_frame_of_a_later_day_comes_from_the_training(training: Capture, later: Capture) -> None:
    a, b = training.q[:, 6:], later.q[::10, 6:]
    assert min(np.abs(a - row).max(axis=1).min() for row in b) > np.deg2rad(0.5)


@pytest.mark.parametrize("day", (0, 1))
def test_equal_arguments_give_equal_captures_and_others_do_not(day: int) -> None:
    first, again = simulate(QUICK, 3, day), simulate(QUICK, 3, day)
    for name in ("time", "trial", "ids", "xy", "q"):
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
    for seed, other_day in ((4, day), (3, day + 2)):
        other = simulate(QUICK, seed, other_day)
        assert other.q.shape != first.q.shape or np.abs(other.q - first.q).max() > 0.1


def test_a_zero_joint_has_the_same_meaning_as_in_the_first_hand() -> None:
    """Fingers point alike at zero but for a few degrees of splay; so angles can be compared."""
    zero = np.zeros((1, POSE_SIZE))
    ours, theirs = SLENDER.chain(zero)[1][0], Kinematics(ADULT).place(zero[0]).rotations
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
    perfect = replace(FROZEN, marker=0.0, palm_marker=0.0, tremble=0.0)
    rng = np.random.default_rng(3)
    q = SLENDER.pose(
        rng.normal(size=(40, 3)),
        attitude(*rng.normal(0, 0.4, (3, 40))),
        some_angles(40, share=0.8),
    )
    measured = Markers(rng, SLENDER, perfect).poses(rng, q)
    np.testing.assert_allclose(measured, q, atol=1e-7)
