"""Someone who plays with wrenches: where they grasp, how far they turn, and that they succeed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.objects import HANDLE, JAW, Wrench
from models.person import Person
from models.rotations import exp
from models.surface import Surface
from sandbox.trial.driver import play_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks import registry
from tasks.simulated_user.grasp import within_comfort
from tasks.simulated_user.handling import WrenchHandling, handling_of
from tasks.simulated_user.user_hand import Hand
from tasks.simulated_user.view import Seat
from tasks.task import Goal
from tasks.user import SeenObject, Sight, UserConfiguration

"""m, about a fingertip's radius."""
TASKS = ("wrench-turn", "wrench-slide")
yaws = st.floats(-np.pi, np.pi)
turns = st.floats(-np.deg2rad(90), np.deg2rad(90))
fingers = st.integers(2, 5)
bolts = st.sampled_from([None, 0.05])


def seen(yaw: float, bolt: float | None = None, x: float = 0.01, y: float = -0.02) -> SeenObject:
    place = np.array([x, y, 0.012])
    return SeenObject(Wrench("wrench", 0.1, tuple(place), yaw, bolt), place, exp([0.0, 0.0, yaw]))


def wrench_handling(wrench: SeenObject) -> WrenchHandling:
    assert isinstance(wrench.shape, Wrench)
    return WrenchHandling(wrench.shape)


def wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


@given(yaw=yaws, turn=turns, n=fingers, bolt=bolts)
def test_every_turn_is_made_in_three_grasps_without_a_wrist_that_is_broken(
    yaw: float, turn: float, n: int, bolt: float
) -> None:
    hand = Hand.draw(UserConfiguration(fingers=n), 0)
    handling = wrench_handling(seen(0.0, bolt))
    left = turn
    for _ in range(3):
        wrench = seen(yaw, bolt)
        grasp = handling.grasp(wrench, left, hand)
        made = handling.reach(wrench, grasp, left, hand)
        assert abs(made) <= abs(left) + 1e-12
        assert made * left >= 0.0
        for angle in (yaw, yaw + made):
            off = wrapped(grasp.axis_on(angle) - hand.natural_axis)
            assert abs(off) < np.deg2rad(101), np.rad2deg(off)
        yaw, left = yaw + made, left - made
    assert abs(left) < 1e-9


@given(axis=yaws, turn=turns)
def test_a_wrist_turned_too_far_may_turn_back_but_no_further(axis: float, turn: float) -> None:
    hand = Hand.draw(UserConfiguration(), 0)
    now = wrapped(axis - hand.natural_axis)
    after = now + within_comfort(axis, turn, hand)
    assert abs(after) <= max(abs(now), np.deg2rad(95.0)) + 1e-9
    if turn * now < 0 and abs(turn) < abs(now):
        assert after == pytest.approx(now + turn)


@given(yaw=yaws, turn=st.floats(0.1, 1.5), way=st.sampled_from([-1, 1]), bolt=bolts)
def test_two_fingers_close_so_that_the_handle_begins_to_turn_the_right_way(
    yaw: float, turn: float, way: int, bolt: float
) -> None:
    hand = Hand.draw(UserConfiguration(fingers=2), 0)
    wrench = seen(yaw, bolt)
    grasp = handling_of(wrench.shape).grasp(wrench, way * turn, hand)
    middle = grasp.middle(wrench)
    thumb, index = grasp.places(middle, 0.0, hand)
    along = np.array([np.cos(grasp.axis), np.sin(grasp.axis)])
    moment = sum(
        float((p - middle)[0] * f[1] - (p - middle)[1] * f[0])
        for p, f in ((thumb, along), (index, -along))
    )
    assert way * moment > 0.01


@given(
    yaw=yaws,
    x=st.floats(-0.05, 0.05),
    y=st.floats(-0.05, 0.05),
    hand=st.sampled_from(["left", "right"]),
    turn=st.sampled_from([0, 90, 180, 270]),
)
def test_from_every_seat_the_jaws_are_where_they_are_drawn(
    yaw: float, x: float, y: float, hand: str, turn: int
) -> None:
    seat = Seat(Person(hand=hand, turn=turn), Surface().centred_at((0.0, 0.0, 0.006)))
    wrench = seen(yaw, None, x, y)
    goal = Goal("wrench", tuple(wrench.position), yaw)
    sight = seat.sight(Sight(0.0, {}, True, {"wrench": wrench}, (goal,), False))
    shown = sight.objects["wrench"]
    for local in ([JAW, 0.0, 0.0], [HANDLE[1], 0.0, 0.008]):
        world = wrench.position + wrench.rotation @ local
        np.testing.assert_allclose(
            shown.position + shown.rotation @ local, seat.point(world), atol=1e-12
        )
    assert np.linalg.det(shown.rotation) == pytest.approx(1.0)
    assert np.cos(sight.goals[0].yaw - shown.yaw) == pytest.approx(1.0)


def play(task: str, seed: int, **options: Any) -> TrialResult:
    chosen = trial_settings(TrialOptions(task=task, seed=seed, **options))
    return play_trial(chosen)


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("n", [2, 3, 5])
def test_the_simulated_user_succeeds_by_touch_alone(task: str, n: int) -> None:
    result = play(task, 3, fingers=n)
    assert result.success, result.reason
    assert result.task_version == registry.find_task(task).version


@pytest.mark.parametrize("task", TASKS)
def test_a_left_hand_from_another_seat_succeeds_as_well(task: str) -> None:
    assert play(task, 1, hand="left", turn=90).success


@pytest.mark.full
@pytest.mark.parametrize(("task", "least"), [("wrench-turn", 39), ("wrench-slide", 38)])
@pytest.mark.parametrize("n", [2, 3, 5])
def test_nearly_all_of_forty_trials_succeed(task: str, least: int, n: int) -> None:
    assert sum(play(task, seed, fingers=n).success for seed in range(40)) >= least


@pytest.mark.full
@pytest.mark.parametrize(
    ("task", "user"),
    [
        ("wrench-slide", "idle"),
        ("wrench-slide", "random"),
        ("wrench-turn", "idle"),
        ("wrench-turn", "random"),
    ],
)
def test_control_users_succeed_in_under_5_of_100_trials(task: str, user: str) -> None:
    assert sum(play(task, seed, user=user).success for seed in range(100)) < 5
