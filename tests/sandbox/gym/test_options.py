"""Options of an environment: actions, labels, observations, rewards, goals and single trials."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import RescaleAction

from models.arithmetic import Array
from models.errors import InputError
from sandbox.gym import HandSandboxEnv
from sandbox.gym.environment_options import ACTIONS, LABELS, OBSERVED, REWARDS
from sandbox.gym.rewards import ARRIVED, REACH
from sandbox.trial.settings import HandSettings, Settings, encoded
from tasks.variation import Variation
from tests.sandbox.gym.scripted_grip import ScriptedGrip

GRIP = 1e-3 * np.array([[70, 100], [105, 58], [130, 45], [153, 52], [174, 74]])
"""Touches of five fingers, m on the surface, thumb first."""


@pytest.fixture
def env() -> Iterator[HandSandboxEnv]:
    made = HandSandboxEnv(labels="true", observe="all", reward="reach")
    yield made
    made.close()


def touching(fingers: tuple[int, ...]) -> Array:
    rows = [(1.0, *GRIP[f]) if f in fingers else (0.0, 0.0, 0.0) for f in range(5)]
    return np.ravel(rows)


def played(env: Any, seed: int) -> tuple[float, dict[str, Any]]:
    """Sum of rewards and last info of the scripted policy."""
    (surface,) = env.surfaces
    policy, total = ScriptedGrip(surface.size), 0.0
    seen, info = env.reset(seed=seed)
    while "trial" not in info:
        seen, reward, *_, info = env.step(policy(seen))
        total += reward
    return total, info


def complaints(env: Any) -> list[str]:
    """Warnings of Gymnasium's own check."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        rescaled: Any = RescaleAction(env, np.float64(-1.0), np.float64(1.0))
        check_env(rescaled, skip_render_check=True)
    # The check wants to see wrappers, too, which it warns about instead of testing them.
    found = [str(warning.message) for warning in warned]
    return [text for text in found if "is different from the unwrapped version" not in text]


@pytest.mark.parametrize("action", ACTIONS)
@pytest.mark.parametrize("labels", LABELS)
def test_gymnasium_s_own_check_finds_nothing_in_any_combination(action: str, labels: str) -> None:
    for observe, goal in product(((), "all"), (False, True)):
        env = HandSandboxEnv("box-to-goal", action, labels, observe, goal=goal)
        assert not complaints(env)
        env.close()


@pytest.mark.parametrize("reward", REWARDS)
def test_gymnasium_s_own_check_finds_nothing_with_any_reward(reward: str) -> None:
    env = HandSandboxEnv(reward=reward)
    assert not complaints(env)
    env.close()


@pytest.mark.parametrize("options", [{}, {"action": "hand", "labels": "true", "goal": True}])
def test_gymnasium_s_own_check_finds_nothing_in_a_task_for_two_hands(
    options: dict[str, Any],
) -> None:
    env = HandSandboxEnv("carry-together", observe="all", **options)
    assert not complaints(env)
    env.close()


@pytest.mark.parametrize("labels", ["population", "true"])
def test_a_scripted_policy_carries_the_box_to_its_goal(labels: str) -> None:
    env = HandSandboxEnv(labels=labels)
    for seed in (200, 201):
        total, info = played(env, seed)
        assert info["trial"]["status"] == "held" and info["success"]
    assert total > 1.9
    env.close()


def test_true_labels_are_the_slots_and_labels_that_are_found_need_not_be() -> None:
    for labels, expected in (("true", [-1, 1, -1, 3, -1]), ("population", [-1, 0, -1, 1, -1])):
        env = HandSandboxEnv(labels=labels)
        env.reset(seed=2)
        for _ in range(40):
            seen, *_ = env.step(touching((1, 3)))
        assert seen["labels"].tolist() == expected
        env.close()


def test_what_is_asked_for_is_seen_as_the_session_has_it(env: HandSandboxEnv) -> None:
    env.reset(seed=200)
    policy = ScriptedGrip(env.surfaces[0].size)
    seen, phases, pressed = env.reset(seed=200)[0], set(), 0.0
    for _ in range(100):
        before = seen["pose"]
        action = policy(seen)
        seen, *_ = env.step(action)
        plain = {"pose", "tips", "solid", "labels", "objects", "goals", "time"}
        assert set(seen) == {*plain, *OBSERVED}
        down = seen["touches"][:, 0] > 0.5
        assert np.array_equal(seen["touches"][down], action.reshape(5, 3)[down])
        phases.add(int(np.argmax(seen["phase"])))
        assert seen["phase"].sum() == 1.0
        moved = (seen["pose"][:3] - before[:3]) / 0.016
        assert np.allclose(moved, seen["velocities"][:3], atol=0.3)
        pressed = max(pressed, seen["contact"][0, 0])
        assert np.array_equal(seen["commanded"], env._snapshot.hands[0].target)
    assert phases >= {1, 3, 4} and pressed > 0.1
    box = env.session.task.objects[0] if env.session else None
    assert box is not None
    assert seen["properties"][0].tolist() == pytest.approx([box.mass, 0.025, 0.025, 0.025])


def test_a_step_along_the_surface_moves_a_touch_by_its_share_of_the_step() -> None:
    env = HandSandboxEnv(action="delta", observe=["touches"], step=0.01)
    env.reset(seed=1)
    down = np.zeros(15)
    down[3] = 1.0
    first = env.step(down)[0]["touches"][1]
    down[4:6] = 0.5, -1.0
    second = env.step(down)[0]["touches"][1]
    assert second - first == pytest.approx([0.0, 0.005, -0.01])
    env.close()


def test_a_step_along_the_hand_turns_with_the_person() -> None:
    ways = []
    for turn in (0, 180):
        settings = encoded(Settings(hands=(HandSettings(turn=turn),)))
        env = HandSandboxEnv(action="hand", observe=["touches"], settings=settings)
        env.reset(seed=1)
        ahead = np.zeros(15)
        ahead[3] = 1.0
        first = env.step(ahead)[0]["touches"][1, 1:]
        ahead[5] = 1.0
        ways.append(env.step(ahead)[0]["touches"][1, 1:] - first)
        env.close()
    # Ahead of a person at the lower edge is up on the surface.
    assert ways[0][1] < -0.005 and ways[1] == pytest.approx(-ways[0], abs=1e-6)


def test_reaching_for_the_box_is_rewarded_and_going_back_costs_it() -> None:
    env = HandSandboxEnv(labels="true", reward="reach")
    blind = HandSandboxEnv(labels="true", reward="progress")
    earned = []
    for each in (env, blind):
        seen, _ = each.reset(seed=200)
        x, y = seen["objects"][0, :2]
        middle = 0.5 * each.surfaces[0].size + np.array([x, -y])
        near = np.zeros(15)
        for finger, side in enumerate([(-1.0, 0.0), (0.7, -0.7), (1.0, 0.0)]):
            near[3 * finger : 3 * finger + 3] = 1.0, *(middle + 0.04 * np.array(side))
        earned.append([sum(each.step(a)[1] for _ in range(70)) for a in (near, np.zeros(15))])
        each.close()
    assert 0.01 < earned[0][0] < REACH and earned[0][1] < 0.0
    assert earned[1] == pytest.approx([0.0, 0.0], abs=0.02)


def test_a_curriculum_changes_one_trial_and_the_next_is_as_ever(env: HandSandboxEnv) -> None:
    plain, _ = env.reset(seed=4)
    apart = np.linalg.norm(plain["objects"][0, :2] - plain["goals"][0, :2])
    easy, _ = env.reset(seed=4, options={"near": 0.5, "mass": 2.0, "size": 1.2})
    assert np.linalg.norm(easy["objects"][0, :2] - easy["goals"][0, :2]) == pytest.approx(apart / 2)
    assert easy["properties"][0] == pytest.approx(plain["properties"][0] * [2.0, 1.2, 1.2, 1.2])
    again, _ = env.reset(seed=4)
    assert all(np.array_equal(again[name], plain[name]) for name in plain)


@pytest.mark.parametrize(
    ("task", "options"),
    [
        ("box-to-goal", {"easy": True}),
        ("box-to-goal", {"mass": "heavy"}),
        ("box-to-goal", {"near": 1.5}),
        ("stack", {"near": 0.5}),
        ("wrench-turn", {"near": 0.5}),
        ("dial", {"near": 0.5}),
    ],
)
def test_options_of_a_reset_that_cannot_be_are_refused_in_a_line(
    task: str, options: dict[str, Any]
) -> None:
    env = HandSandboxEnv(task)
    with pytest.raises(InputError, match="options=") as error:
        env.reset(seed=1, options=options)
    assert "\n" not in str(error.value)
    env.close()


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"task": "no-such"}, "box-to-goal"),
        ({"observe": ["smell"]}, "all, touches, velocities"),
        ({"goal": True, "reward": "sparse"}, "have their own reward"),
        ({"step": 0.0}, "up to 0.1 m"),
        ({"hand_size": "big"}, "expected a number"),
        ({"variation": Variation(noise=0.001)}, "noise"),
        ({"settings": "mine"}, "a recording's header"),
        ({"encodr": "cubic"}, "action, labels, observe, .* encoder, "),
        ({"names": "told"}, 'Write labels="true"'),
    ],
)
def test_what_cannot_be_made_is_refused_with_what_can(wrong: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says) as error:
        HandSandboxEnv(**wrong)
    assert "\n" not in str(error.value)


NO_GOALS = """
from models import Box
from tasks import CustomTask, judge


class Idle(CustomTask):
    name = "lab-idle"

    @classmethod
    def place(cls, rng, surface):
        return [Box("box", (0.01,) * 3, 0.1, (0.0, 0.0, 0.01))], []

    def measure(self, sensing):
        return judge(0.5, (True, "never"))
"""


def test_a_task_without_goals_has_no_goal_dictionaries(tmp_path: Path) -> None:
    (tmp_path / "idle.py").write_text(NO_GOALS)
    with pytest.raises(InputError, match="no goals") as error:
        HandSandboxEnv(str(tmp_path / "idle.py"), goal=True)
    assert "\n" not in str(error.value)


def test_what_is_wrong_with_an_action_is_said(env: HandSandboxEnv) -> None:
    env.reset(seed=0)
    nan = np.zeros(15)
    nan[4] = np.nan
    for action, says in (
        (np.zeros(14), r"shape \(14,\).*shape \(15,\)"),
        (nan, "action.4.*not finite.*0 to 0.19"),
        (["left"] * 15, "not an array of numbers"),
    ):
        with pytest.raises(InputError, match=says):
            env.step(action)
    env.step(np.zeros(15))


def test_a_goal_dictionary_s_reward_is_that_of_its_goals() -> None:
    made: Any = gymnasium.make("sandbox.gym:hand_sandbox/BoxToGoal-v1", goal=True)
    goals = ["achieved_goal", "desired_goal", "observation"]
    assert sorted(made.unwrapped.observation_space) == sorted(made.observation_space) == goals
    seen, info = made.reset(seed=200)
    for _ in range(3):
        seen, reward, *_, info = made.step(np.zeros(15))
        achieved, desired = seen["achieved_goal"], seen["desired_goal"]
        # Learners look for it in the unwrapped environment.
        assert reward == made.unwrapped.compute_reward(achieved, desired, info) == -1.0
    compute = made.unwrapped.compute_reward
    assert compute(desired + 0.5 * ARRIVED * np.eye(3)[0], desired, info) == 0.0
    many = compute(np.stack([achieved, desired]), np.stack([desired, desired]), [{}, {}])
    assert many.tolist() == [-1.0, 0.0]
    assert made.unwrapped.session is not None
    made.close()
    assert made.unwrapped.session is None


@pytest.mark.needs("robots")
def test_a_robot_s_hand_takes_the_same_actions_and_shows_its_own_joints() -> None:
    env = HandSandboxEnv(robot="shadow", labels="true", observe=["velocities", "commanded"])
    seen, _ = env.reset(seed=200)
    assert len(seen["pose"]) == len(seen["velocities"]) != len(seen["commanded"]) == 48
    assert played(env, 200)[1]["is_success"]
    env.close()


@pytest.mark.needs("opengl")
def test_one_renderer_draws_all_episodes_and_another_one_other_shapes() -> None:
    env = HandSandboxEnv(render_mode="rgb_array", size=(64, 48))
    pictures = []
    for seed in (0, 1):
        env.reset(seed=seed)
        pictures.append(env.render())
    assert env._pictures.made == 1 and np.any(pictures[0] != pictures[1])
    env.reset(seed=1, options={"size": 2.0})
    assert np.any(env.render() != pictures[1]) and env._pictures.made == 2
    env.close()
