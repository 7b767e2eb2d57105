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
from encoders.regression.polynomial import CubicEncoder
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import JOINTS, POSE_SIZE, violations
from models.skeleton import ADULT
from models.surface import Surface
from training.second_subject import FROZEN, SEED, SLENDER, simulate
from training.second_subject.contacts import (
    SETS,
    closeness,
    contact_ids,
    free_play,
    preferences,
)
from training.second_subject.grips import knots, path
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


def test_it_says_what_it_is(capture: Capture) -> None:
    assert capture.meta["simulated"] is True
    assert capture.meta["subject"] == f"second simulated {SEED}"
    assert capture.meta["skeleton"] == SLENDER.name != ADULT.name
    assert capture.meta["configuration"] == FROZEN.as_json()


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


def test_fingertips_keep_apart_and_thumb_and_index_open_wide(capture: Capture) -> None:
    a, b = np.triu_indices(5, 1)
    distance = np.linalg.norm(capture.xy[:, a] - capture.xy[:, b], axis=2)
    assert np.nanmin(distance) > 0.010 and np.nanquantile(distance, 0.001) > 0.012
    opening = distance[:, 0]
    widest = 0.1 if capture.meta["day"] == 0 else 0.07
    assert np.nanmin(opening) < 0.025 and np.nanmax(opening) > widest


def test_layouts_turn_by_more_than_a_quarter(training: Capture) -> None:
    assert np.ptp(training.q[:, 5]) > np.pi / 2


def test_a_contact_keeps_its_id_from_landing_to_lifting_and_no_other_has_it(later: Capture) -> None:
    for i in np.unique(later.ids[later.ids >= 0]):
        frames, fingers = np.nonzero(later.ids == i)
        assert len(set(fingers)) == 1 and len(set(later.trial[frames])) == 1
        np.testing.assert_array_equal(np.diff(frames), 1)


def test_takes_follow_each_other_in_time(capture: Capture) -> None:
    assert (np.diff(capture.time) > 0).all()
    assert set(np.diff(capture.trial)) == {0, 1}


def test_poses_are_not_a_polynomial_of_the_touches(training: Capture) -> None:
    """Even on the frames it learned from, a cubic with 816 terms cannot follow the wrist."""
    U, Q = training.u, training.relative
    left = CubicEncoder().fit(U, Q).predict(U) - Q
    assert np.linalg.norm(left[:, :3], axis=1).mean() > 0.005


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


def test_the_hand_has_other_proportions_than_the_first() -> None:
    def shape(knuckles: np.ndarray, lengths: np.ndarray) -> np.ndarray:
        """Finger length by palm length, palm width by palm length, thumb by index."""
        palm = knuckles[2, 1]
        width = knuckles[4, 0] - knuckles[1, 0]
        return np.array([*(lengths[1:] / palm), width / palm, lengths[0] / lengths[1]])

    knuckles = np.array([ADULT.bones[i].anchor for i in ADULT.first_bone])
    lengths = np.array([sum(b.length for b in ADULT.bones if b.finger == f) for f in range(5)])
    ratio = shape(SLENDER.knuckle, SLENDER.bones.sum(axis=1)) / shape(knuckles, lengths)
    assert (ratio[:4] > 1.08).all() and (ratio[:4] < 1.2).all()
    assert ratio[4] < 0.95 and abs(ratio[5] - 1) > 0.01


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


def test_bones_keep_their_lengths_and_join(training: Capture) -> None:
    places, rotations, tips = SLENDER.chain(training.q[::500])
    np.testing.assert_allclose(np.linalg.det(rotations), 1.0, atol=1e-9)
    last = SLENDER.last_bone
    reach_of_last = np.linalg.norm(tips - places[:, last], axis=2)
    ends = np.array([SLENDER.bones[0, 1], *SLENDER.bones[1:, 2]])
    np.testing.assert_allclose(reach_of_last, np.tile(ends, (len(tips), 1)), atol=1e-12)


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


def test_keyframes_are_met_and_never_overshot() -> None:
    rng = np.random.default_rng(2)
    moments = knots(rng, 4.0, (0.3, 0.8))
    assert moments[0] <= 0.0 and moments[-1] >= 4.0
    values = rng.normal(size=(len(moments), 3))
    np.testing.assert_allclose(path(moments, moments, values), values, atol=1e-12)
    way = path(np.linspace(moments[0], moments[-1], 500), moments, values)
    assert (way <= values.max(axis=0) + 1e-12).all() and (way >= values.min(axis=0) - 1e-12).all()


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


def test_markers_of_another_day_shift_joints_by_degrees_and_fingertips_by_millimetres() -> None:
    rng = np.random.default_rng(4)
    q = SLENDER.pose(np.zeros((40, 3)), attitude(*np.zeros((3, 40))), some_angles(40, share=0.5))
    one, other = (Markers(rng, SLENDER, FROZEN).poses(rng, q) for _ in range(2))
    shift = np.abs((one - other)[:, JOINTS].mean(axis=0))
    assert np.deg2rad(0.3) < shift.mean() < np.deg2rad(5)
    moved = np.linalg.norm(SLENDER.tips(one) - SLENDER.tips(other), axis=2)
    assert 0.0003 < np.median(moved) < 0.01


def test_a_finger_comes_down_before_it_touches_and_is_down_while_it_does() -> None:
    down = np.zeros((60, len(FINGERS)), bool)
    down[20:40, 1] = True
    close = closeness(down, 30.0, 0.18)
    assert (close[down] == 1.0).all()
    assert (np.diff(close[:21, 1]) >= 0).all() and (np.diff(close[39:, 1]) <= 0).all()
    assert 0 < close[18, 1] < 1 and close[10, 1] == 0.0 and (close[:, 0] == 0.0).all()


def test_ids_are_new_at_every_landing_and_go_on_from_take_to_take() -> None:
    down = np.array([[1, 1, 0, 0, 0], [1, 0, 0, 0, 0], [1, 1, 1, 0, 0]], bool)
    ids, free = contact_ids(down, 7)
    np.testing.assert_array_equal(
        ids, [[7, 8, -1, -1, -1], [7, -1, -1, -1, -1], [7, 9, 10, -1, -1]]
    )
    assert free == 11


def test_subjects_have_individual_preferences() -> None:
    several = np.array([preferences(np.random.default_rng(s), FROZEN.taste) for s in range(200)])
    assert (several > 0).all()
    thumb_and_index = np.flatnonzero((SETS == [1, 1, 0, 0, 0]).all(axis=1))[0]
    ring_and_little = np.flatnonzero((SETS == [0, 0, 0, 1, 1]).all(axis=1))[0]
    assert np.median(several[:, thumb_and_index]) > 5 * np.median(several[:, ring_and_little])
    assert len({int(row.argmax()) for row in several}) > 3


def test_free_play_uses_up_the_days_frames_whatever_they_are() -> None:
    odd = replace(FROZEN, test_frames=(61, 7, 0, 100))
    takes = free_play(np.random.default_rng(5), np.ones(len(SETS)), odd)
    down = np.concatenate([take.down for take in takes])
    assert np.bincount(down.sum(axis=1), minlength=6).tolist() == [0, 0, 61, 7, 0, 100]
