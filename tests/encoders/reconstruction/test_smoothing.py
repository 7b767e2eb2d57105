"""The filter slows a change of posture, and nothing that the touches do together."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.reconstruction.hand_motion import PoseFilter, rigid_motion
from models.arithmetic import Array
from models.rotations import exp, geodesic_angle, unwrap_near
from tests.encoders.regression.turning import turned_places, turned_pose
from tests.support.simulation import legal_poses

TAU, DT = 0.10, 0.016
STILL = (0.0, 0.0)

shifts = st.tuples(st.floats(-0.05, 0.05), st.floats(-0.05, 0.05)).map(np.array)
steps = st.floats(0.001, 0.5)
points = st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)).map(np.array)
angles = st.floats(-3.0, 3.0)
seeds = st.integers(0, 2**16)


def dragged(q: np.ndarray, carried: np.ndarray) -> np.ndarray:
    """A pose after the touches moved on the surface, whose y points down."""
    q = q.copy()
    q[0] += carried[0]
    q[1] -= carried[1]
    return q


def started(q: np.ndarray, tau: float = TAU) -> PoseFilter:
    pose_filter = PoseFilter(tau)
    np.testing.assert_array_equal(pose_filter.step(q, STILL, 0.0), q)
    return pose_filter


@given(a=legal_poses, b=legal_poses, moves=st.lists(shifts, min_size=1, max_size=8))
def test_posture_settles_alike_whether_or_not_the_hand_is_dragged(
    a: Array, b: Array, moves: list[Array]
) -> None:
    still, moving = started(a), started(a)
    target, way = b, np.array(STILL)
    for move in moves:
        target, way = dragged(target, move), way + move
        smoothed = moving.step(target, move.tolist(), DT)
        np.testing.assert_allclose(smoothed, dragged(still.step(b, STILL, DT), way), atol=1e-12)


@given(a=legal_poses, b=legal_poses, dt=steps, tau=st.sampled_from([0.0, TAU]))
def test_every_step_ends_between_where_it_was_and_where_it_is_going(
    a: Array, b: Array, dt: float, tau: float
) -> None:
    b[3:6] = unwrap_near(b[3:6], a[3:6])
    smoothed = started(a, tau).step(b, STILL, dt)
    share = 1.0 - np.exp(-dt / tau) if tau else 1.0
    np.testing.assert_allclose(smoothed, a + share * (b - a), atol=1e-12)


@given(a=legal_poses, b=legal_poses, c=legal_poses)
def test_after_a_reset_the_next_pose_passes_unchanged(a: Array, b: Array, c: Array) -> None:
    pose_filter = started(a)
    pose_filter.step(b, STILL, DT)
    pose_filter.reset()
    np.testing.assert_array_equal(pose_filter.step(c, STILL, DT), c)


@pytest.mark.parametrize("axis", range(3))
def test_a_turn_past_half_a_circle_goes_the_short_way_round(axis: int) -> None:
    before, beyond = np.zeros(48), np.zeros(48)
    before[3 + axis] = np.deg2rad(175.0)
    beyond[3 + axis] = np.deg2rad(-175.0)
    pose_filter = started(before)
    for _ in range(40):
        last = pose_filter.step(beyond, STILL, DT)
        # Ten degrees the short way, 350 the long one.
        assert geodesic_angle(last[3:6], before[3:6]) < np.deg2rad(10.0) + 1e-9
    assert geodesic_angle(last[3:6], beyond[3:6]) < np.deg2rad(0.1)


@given(q=legal_poses, b=legal_poses)
def test_neither_what_goes_in_nor_what_came_out_is_touched_afterwards(q: Array, b: Array) -> None:
    given_first, given_then = q.copy(), b.copy()
    pose_filter = PoseFilter(TAU)
    first = pose_filter.step(given_first, STILL, DT)
    then = pose_filter.step(given_then, [0.01, 0.02], DT)
    kept = then.copy()
    pose_filter.step(given_then, [0.03, 0.01], DT)
    np.testing.assert_array_equal(given_first, q)
    np.testing.assert_array_equal(given_then, b)
    np.testing.assert_array_equal(first, q)
    np.testing.assert_array_equal(then, kept)


def places(seed: int, fingers: int = 5) -> np.ndarray:
    """(5, 2) m touches of some fingers, NaN for the others."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 0.2, (5, 2))
    xy[rng.permutation(5)[fingers:]] = np.nan
    return xy


@given(seed=seeds, fingers=st.integers(2, 5), angle=angles, about=points, shift=points)
def test_a_rigid_motion_is_found_exactly(
    seed: int, fingers: int, angle: float, about: Array, shift: Array
) -> None:
    before = places(seed, fingers)
    motion = rigid_motion(before, turned_places(before, angle, about) + shift)
    assert motion.turn == pytest.approx(angle, abs=1e-9)
    # The same motion: it carries any other point of the surface to where it belongs.
    point = np.array([0.03, -0.11])
    carried = turned_places(point, motion.turn, motion.about) + motion.carried
    np.testing.assert_allclose(carried, turned_places(point, angle, about) + shift, atol=1e-9)
    np.testing.assert_allclose(motion.about, np.nanmean(before, axis=0), atol=1e-12)


@given(seed=seeds, angle=st.floats(-1.0, 1.0))
def test_of_all_turns_the_found_one_leaves_the_least(seed: int, angle: float) -> None:
    before = places(seed)
    noise = np.random.default_rng(seed).normal(0, 0.005, (5, 2))
    after = turned_places(before, angle, STILL) + noise
    motion = rigid_motion(before, after)

    def left(turn: float) -> float:
        moved = turned_places(before, turn, motion.about) + motion.carried
        return float(np.sum((after - moved) ** 2))

    assert all(left(motion.turn) <= left(motion.turn + d) for d in (-0.1, -1e-3, 1e-3, 0.1, np.pi))


@given(seed=seeds, angle=angles, lost=st.integers(0, 4), gone=st.integers(0, 4))
def test_touches_that_come_or_go_take_no_part(
    seed: int, angle: float, lost: int, gone: int
) -> None:
    before = places(seed)
    after = turned_places(before, angle, STILL)
    both = [f for f in range(5) if f not in (lost, gone)]
    before[lost], after[gone] = np.nan, np.nan
    found, wanted = rigid_motion(before, after), rigid_motion(before[both], after[both])
    for part, same in zip(found, wanted, strict=True):
        np.testing.assert_array_equal(part, same)


@given(seed=seeds, shift=points)
def test_one_touch_moves_but_does_not_turn_and_none_does_neither(seed: int, shift: Array) -> None:
    one = rigid_motion(places(seed, 1), places(seed, 1) + shift)
    assert one.turn == 0
    np.testing.assert_allclose(one.carried, shift, atol=1e-12)
    for before, after in ((places(0, 0), places(1)), (places(1), places(0, 0))):
        none = rigid_motion(before, after)
        assert none.turn == 0
        np.testing.assert_array_equal(none.carried, 0)


def test_counterclockwise_on_the_screen_is_a_positive_turn() -> None:
    right, up = [[0.0, 0.0], [0.1, 0.0]], [[0.0, 0.0], [0.0, -0.1]]
    assert rigid_motion(right, up).turn == pytest.approx(np.pi / 2)


motions = st.tuples(angles, points, shifts)


@given(q=legal_poses, seed=seeds, moves=st.lists(motions, min_size=1, max_size=8), dt=steps)
def test_a_hand_that_turns_with_its_touches_has_no_lag(
    q: Array, seed: int, moves: list[tuple[float, Array, Array]], dt: float
) -> None:
    """Turned and dragged about any points; the motion is read off the touches alone."""
    pose_filter, xy = started(q), places(seed)
    for angle, about, shift in moves:
        q = dragged(turned_pose(q, angle, about), shift)
        later = turned_places(xy, angle, about) + shift
        motion = rigid_motion(xy, later)
        smoothed = pose_filter.step(q, motion.carried, dt, motion.turn, motion.about)
        np.testing.assert_allclose(smoothed[:3], q[:3], atol=1e-9)
        np.testing.assert_allclose(exp(smoothed[3:6]), exp(q[3:6]), atol=1e-9)
        np.testing.assert_allclose(smoothed[6:], q[6:], atol=1e-9)
        xy = later
