"""The simulated user who stacks: does it, keeps away from neighbours, and moves a real slider."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.objects import Box
from models.surface import Surface
from sandbox.trial.driver import play_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.simulated_user.grasp import Surroundings, roomiest_grasp
from tasks.simulated_user.user import Slider
from tasks.simulated_user.user_hand import Hand
from tasks.stack import Stack
from tasks.user import SeenObject, UserConfiguration

TABLET = Surface().centred_at((0.0, 0.0, Stack.touch_height))
USER = UserConfiguration()
HAND = Hand.draw(USER, 0)


def trial(**options: Any) -> TrialResult:
    chosen = trial_settings(TrialOptions(**options))
    return play_trial(chosen)


@pytest.mark.parametrize("fingers", [2, 3, 5])
def test_the_simulated_user_stacks_two_boxes(fingers: int) -> None:
    result = trial(task="stack", seed=2, fingers=fingers)
    assert result.success and result.final and result.respawned == 0


def test_the_simulated_user_stacks_three_boxes() -> None:
    result = trial(task="stack-three", seed=0)
    assert result.success and result.final


@pytest.mark.parametrize("person", [{"hand": "left"}, {"turn": 180}, {"hand_size": 0.9}])
def test_left_handed_people_at_other_sides_stack_too(person: dict[str, Any]) -> None:
    assert trial(task="stack", seed=0, **person).success


@given(
    seed=st.integers(0, 1_000),
    heights=st.lists(st.floats(-0.1, 0.3), min_size=1, max_size=6),
)
def test_a_slider_stays_on_its_way_and_goes_where_it_should(
    seed: int, heights: list[float]
) -> None:
    slider = Slider(0.18, np.random.default_rng(seed))
    now = 0.0
    for height in heights:
        arrival = slider.move(height, now)
        assert arrival > now
        for t in np.linspace(now, arrival, 20):
            assert 0.0 <= slider.control(float(t)) <= 1.0
        now = arrival
        wanted = np.clip(height, 0.0, 0.18)
        assert abs(slider.height(now) - wanted) < 0.18 * 0.2
        if height <= 0.0:
            assert slider.control(now) == 0.0, "at its lower end it rests"


def seen(
    xy: Sequence[float] | Array, edge: float = 0.05, height: float = 0.025, yaw: float = 0.0
) -> SeenObject:
    c, s = np.cos(yaw), np.sin(yaw)
    shape = Box("box", (edge / 2,) * 3, 0.1, (*xy, height))
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return SeenObject(shape, np.array([*xy, height]), rotation)


@pytest.mark.parametrize("direction", np.linspace(0.0, 2 * np.pi, 8, endpoint=False))
def test_fingers_are_put_where_there_is_room(direction: float) -> None:
    box = seen((0.0, 0.0))
    beside = 0.068 * np.array([np.cos(direction), np.sin(direction)])
    neighbour = seen(beside, yaw=direction)
    grasp = roomiest_grasp(box, 0.0, HAND, Surroundings(TABLET, (neighbour,)))
    places = grasp.places(np.zeros(2), grasp.opening(HAND), HAND)
    points = np.column_stack([places, np.full(len(places), 0.028)])
    room = neighbour.shape.clearance(points, neighbour.position, neighbour.rotation)
    assert room.min() > 0.0


@pytest.mark.parametrize("yaw", np.linspace(-0.7, 0.7, 5))
def test_a_failed_grasp_is_not_tried_again_at_once(yaw: float) -> None:
    box = seen((0.0, 0.0), yaw=yaw)
    first = roomiest_grasp(box, 0.0, HAND, Surroundings(TABLET))
    second = roomiest_grasp(box, 0.0, HAND, Surroundings(TABLET), first)
    assert abs(np.sin(second.axis - first.axis)) > 0.9 or np.cos(second.axis - first.axis) < -0.9


def test_a_grasp_is_chosen_that_fits_on_the_screen_at_the_goal_as_well() -> None:
    width = TABLET.size[0]
    goal = TABLET.to_world([width - 0.030, TABLET.size[1] / 2])[:2]
    grasp = roomiest_grasp(seen((0.0, 0.0)), 0.0, HAND, Surroundings(TABLET, (), goal))
    places = grasp.places(goal, -USER.squeeze, HAND)
    xy = TABLET.to_surface(np.column_stack([places, np.zeros(len(places))]))
    assert np.all(xy > 0.0) and np.all(xy < TABLET.size)


@pytest.mark.full
@pytest.mark.parametrize("task", ["stack", "stack-three"])
def test_random_touches_with_a_random_slider_hardly_ever_stack(task: str) -> None:
    done = [trial(task=task, seed=seed, user="random").success for seed in range(100)]
    assert sum(done) < 5
