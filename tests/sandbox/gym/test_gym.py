"""Gymnasium's environments: an episode is a trial, the same to the bit, whatever the options."""

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
from gymnasium.wrappers import FlattenObservation, RescaleAction

from models.arithmetic import Array
from models.errors import InputError
from models.frames import Contact, TouchFrame
from models.rotations import exp
from models.skeleton import ADULT
from sandbox.cli.main import main
from sandbox.gym import HandSandboxEnv, register_task
from sandbox.gym.environment_options import ACTIONS, LABELS, REWARDS
from sandbox.gym.rewards import ARRIVED, REACH
from sandbox.recording.recording import RecordedInput, Recording, load_recording
from sandbox.trial.settings import HandSettings, Settings, encoded
from tasks.registry import TASKS, hands_of
from tasks.variation import Variation

BOX = "sandbox.gym:hand_sandbox/BoxToGoal-v1"
TWO = "sandbox.gym:hand_sandbox/CarryTogether-v1"
MUG = str(Path(__file__).parents[3] / "examples" / "push_the_mug.py")


def contacts_of(told: RecordedInput) -> tuple[Contact, ...]:
    assert isinstance(told.frame, TouchFrame)
    return told.frame.contacts


@pytest.fixture
def env() -> Iterator[HandSandboxEnv]:
    made = HandSandboxEnv()
    yield made
    made.close()


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    path = tmp_path_factory.mktemp("gym") / "run.jsonl"
    assert main(["run", "box-to-goal", "--seed", "3", "--record", str(path)]) == 0
    return load_recording(path)


class Slots:
    """The touches of a recording as actions: every contact keeps the slot it came into."""

    def __init__(self) -> None:
        self.ids: list[int | None] = [None] * 5

    def action(self, contacts: Any) -> np.ndarray:
        here = {c.id: c for c in contacts}
        self.ids = [i if i in here else None for i in self.ids]
        for new in sorted(set(here) - set(self.ids)):
            self.ids[self.ids.index(None)] = new
        rows = [(0.0, 0.0, 0.0) if i is None else (1.0, here[i].x, here[i].y) for i in self.ids]
        return np.ravel(rows)


def play(env: Any, actions: Any, seed: int) -> list[Any]:
    found = [env.reset(seed=seed)]
    found += [env.step(action) for action in actions]
    return found


def actions(env: Any, count: int, seed: int = 0) -> list[Any]:
    env.action_space.seed(seed)
    return [env.action_space.sample() for _ in range(count)]


def hashes(steps: list[Any]) -> list[str]:
    return [step[-1]["state_hash"] for step in steps]


def test_every_task_has_one_id_with_its_version() -> None:
    for task in TASKS.values():
        name = "".join(part.capitalize() for part in task.name.split("-"))
        assert gymnasium.spec(f"hand_sandbox/{name}-v{task.version}").kwargs == {"task": task.name}
    ours = [id for id in gymnasium.registry if id.startswith("hand_sandbox/")]
    assert len({gymnasium.spec(id).kwargs["task"] for id in ours}) == len(ours)


@pytest.mark.parametrize("action", ["touch", "pose"])
def test_every_task_takes_steps_and_shows_all_its_objects_and_goals(action: str) -> None:
    for name, task in TASKS.items():
        env = HandSandboxEnv(name, action)
        lifts = action == "touch" and task.lift_range > 0
        each = {"touch": 15, "pose": 53}[action] + lifts
        assert env.action_space.shape == (each * hands_of(task),)
        for seen in (env.reset(seed=1)[0], env.step(actions(env, 1)[0])[0]):
            assert seen in env.observation_space
            assert len(seen["objects"]) == len(env.session.task.objects)
            assert len(seen["goals"]) == len(env.session.task.goals)
        env.close()


def test_a_recorded_run_s_touches_give_its_states_and_its_score(
    env: HandSandboxEnv, recording: Recording
) -> None:
    assert recording.end is not None
    expected = {i.step: i.state_hash for i in recording.inputs[0]}
    slots, over = Slots(), False
    _, info = env.reset(seed=3)
    for recorded in recording.inputs[0]:
        assert not over
        assert info["state_hash"] == expected[env.session.step]
        _, _, terminated, truncated, info = env.step(slots.action(contacts_of(recorded)))
        over = terminated or truncated
    assert terminated and not truncated
    result = recording.end["result"]
    assert info["trial"] == {name: result[name] for name in info["trial"]}
    assert info["trial"]["success"] and info["state_hash"] == result["state_hash"]


def test_two_hands_touches_of_a_recorded_run_give_its_states_and_its_score(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    both = ["--device", "simulated", "--device", "simulated"]
    assert main(["run", "carry-together", "--seed", "3", *both, "--record", str(path)]) == 0
    recording = load_recording(path)
    assert recording.end is not None
    assert [i.step for i in recording.inputs[0]] == [i.step for i in recording.inputs[1]]
    env: Any = gymnasium.make(TWO)
    slots = [Slots(), Slots()]
    seen, info = env.reset(seed=3)
    pairs: Any = zip(recording.inputs[0], recording.inputs[1], strict=True)
    for inputs in pairs:
        assert {i.state_hash for i in inputs} == {info["state_hash"]}
        action = [
            [*hand.action(contacts_of(i)), i.frame.lift or 0.0]
            for hand, i in zip(slots, inputs, strict=True)
        ]
        seen, _, terminated, _, info = env.step(np.ravel(action))
    assert terminated
    assert info["state_hash"] == recording.end["result"]["state_hash"]
    assert info["trial"]["success"] is recording.end["result"]["success"] is True
    hands = env.unwrapped._snapshot.hands
    for i, hand in enumerate(hands):
        assert np.array_equal(seen["tips"][i], hand.tips)
        assert np.array_equal(seen["pose"][i][:3], env.unwrapped.session.data.qpos[63 * i :][:3])
    env.close()


def test_each_of_two_hands_does_what_its_own_half_of_an_action_says() -> None:
    env = gymnasium.make(TWO, action="pose")
    seen, _ = env.reset(seed=1)
    action = np.concatenate([np.concatenate([pose, np.zeros(5)]) for pose in seen["pose"]])
    moved = action.copy()
    moved[53:56] += (0.0, 0.03, 0.02)
    for _ in range(60):
        after, *_ = env.step(moved)
    assert after["pose"][0][:3] == pytest.approx(seen["pose"][0][:3], abs=0.001)
    assert after["pose"][1][:3] == pytest.approx(moved[53:56], abs=0.002)
    env.close()


@pytest.mark.parametrize("action", ["touch", "pose"])
def test_equal_seeds_and_actions_give_equal_episodes_and_others_do_not(action: str) -> None:
    env = gymnasium.make(BOX, action=action)
    chosen = actions(env, 30)
    first, again, other = play(env, chosen, 5), play(env, chosen, 5), play(env, chosen, 6)
    for a, b in zip(first, again, strict=True):
        assert all(np.array_equal(a[0][name], b[0][name]) for name in a[0])
    assert hashes(first) == hashes(again)
    assert not set(hashes(first)) & set(hashes(other))
    env.close()


def test_the_seed_is_the_trial_s_and_without_one_the_next_is_drawn_from_it(
    env: HandSandboxEnv,
) -> None:
    assert env.reset(seed=7)[1]["seed"] == 7
    following = [env.reset()[1]["seed"] for _ in range(3)]
    assert len({7, *following}) == 4
    env.reset(seed=7)
    assert [env.reset()[1]["seed"] for _ in range(3)] == following


def test_what_an_episode_gains_is_the_progress_made_and_success(
    env: HandSandboxEnv, recording: Recording
) -> None:
    sparse = HandSandboxEnv(reward="sparse")
    totals = []
    for each in (env, sparse):
        slots = Slots()
        each.reset(seed=3)
        inputs = recording.inputs[0]
        totals.append(sum(each.step(slots.action(contacts_of(i)))[1] for i in inputs))
    # A box starts with no progress, and the trial ends with all of it.
    assert totals == pytest.approx([2.0, 1.0])


def test_time_ends_an_episode_without_terminating_it_and_then_it_is_over(
    env: HandSandboxEnv,
) -> None:
    env.reset(seed=0)
    nothing = np.zeros(env.action_space.shape)
    steps = 0
    while True:
        _, _, terminated, truncated, info = env.step(nothing)
        steps += 1
        assert not terminated
        if truncated:
            break
    assert info["trial"]["status"] == "timeout"
    assert steps * 0.016 == pytest.approx(info["trial"]["time_s"], abs=0.02)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(nothing)


def test_an_observation_is_what_the_session_knows(recording: Recording) -> None:
    env, slots = HandSandboxEnv(observe="all"), Slots()
    seen, _ = env.reset(seed=3)
    labelled, phases, pressed = 0, set[int](), 0.0
    for recorded in recording.inputs[0][:200]:
        before, action = seen["pose"], slots.action(contacts_of(recorded))
        seen, *_ = env.step(action)
        session, hand = env.session, env._snapshot.hands[0]
        assert seen in env.observation_space
        assert np.array_equal(seen["tips"], hand.tips)
        assert np.array_equal(seen["commanded"], hand.target)
        assert set(np.flatnonzero(seen["solid"])) == hand.solid
        position, rotation = session.scene.object_pose(session.data, "box")
        assert np.array_equal(seen["objects"][0, :3], position)
        w, x, y, z = seen["objects"][0, 3:7]
        turn = 2 * np.arctan2(np.linalg.norm([x, y, z]), w)
        assert np.trace(rotation) == pytest.approx(1 + 2 * np.cos(turn))
        goal = session.task.goals[0]
        assert seen["goals"][0, :3] == pytest.approx(goal.position)
        assert np.sin(seen["goals"][0, 3] - goal.yaw) == pytest.approx(0.0, abs=1e-12)
        assert seen["time"][0] == pytest.approx(session.time)
        assert np.allclose((seen["pose"] - before)[:3] / 0.016, seen["velocities"][:3], atol=0.3)
        down = seen["touches"][:, 0] > 0.5
        assert np.array_equal(seen["touches"][down], action.reshape(5, 3)[down])
        named = seen["labels"][seen["labels"] >= 0]
        assert len(set(named)) == len(named)
        labelled = max(labelled, len(named))
        for slot, id in enumerate(slots.ids):
            assert id is not None or seen["labels"][slot] == -1
        assert seen["phase"].sum() == 1.0
        phases.add(int(np.argmax(seen["phase"])))
        pressed = max(pressed, seen["contact"][0, 0])
    assert labelled == 3 and phases >= {1, 3, 4} and pressed > 0.1
    box = session.task.objects[0]
    assert seen["properties"][0].tolist() == pytest.approx([box.mass, 0.025, 0.025, 0.025])


def test_velocities_are_what_positions_change_by(env: HandSandboxEnv, recording: Recording) -> None:
    slots = Slots()
    env.reset(seed=3)
    states = []
    for recorded in recording.inputs[0]:
        states.append(env.step(slots.action(contacts_of(recorded)))[0]["objects"][0])
    rows = np.array(states)
    moved = np.diff(rows[:, :3], axis=0) / 0.016
    between = 0.5 * (rows[1:, 7:10] + rows[:-1, 7:10])
    assert np.abs(moved).max() > 0.05
    assert np.median(np.abs(moved - between).max(axis=1)) < 0.002


def test_later_steps_leave_earlier_observations_alone(env: HandSandboxEnv) -> None:
    first, _ = env.reset(seed=1)
    kept = {name: values.copy() for name, values in first.items()}
    for action in actions(env, 5):
        env.step(action)
    assert all(np.array_equal(kept[name], first[name]) for name in kept)


def test_a_hand_told_a_pose_goes_there_no_faster_than_any_and_grips_nothing_it_should_not(
    env: HandSandboxEnv,
) -> None:
    env = HandSandboxEnv(action="pose")
    seen, _ = env.reset(seed=2)
    start = seen["pose"]
    goal = start.copy()
    goal[:3] += (0.05, 0.02, 0.03)
    goal[6:] = 0.5 * (ADULT.lower + ADULT.upper)
    solid = np.zeros(5)
    for step in range(80):
        seen, *_ = env.step(np.concatenate([goal, solid]))
        if step == 1:
            assert np.linalg.norm(seen["pose"][:3] - start[:3]) < 0.032
    assert seen["pose"][:3] == pytest.approx(goal[:3], abs=0.002)
    for a, b in zip(seen["pose"][3:].reshape(15, 3), goal[3:].reshape(15, 3), strict=True):
        assert np.allclose(exp(a), exp(b), atol=0.05)
    assert not seen["solid"].any()
    seen, *_ = env.step(np.concatenate([goal, [1, 1, 0, 0, 0]]))
    assert seen["solid"].tolist() == [1, 1, 0, 0, 0]


def test_a_slot_that_touches_again_is_another_contact(env: HandSandboxEnv) -> None:
    env.reset(seed=0)
    touch = np.zeros(15)
    touch[:3] = (1.0, 0.05, 0.05)
    ids = []
    for action in (touch, touch, np.zeros(15), touch):
        env.step(action)
        ids.append(env._hands[0].touch_ids[0])
    assert ids == [0, 0, None, 1]


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_environments_side_by_side_are_those_one_after_another(mode: str) -> None:
    options: dict[str, Any] = {"labels": "true", "observe": ["touches"]}
    side: Any = gymnasium.make_vec(BOX, 2, mode, **options)
    one = gymnasium.make(BOX, **options)
    chosen = actions(one, 8)
    side.reset(seed=[4, 9])
    for action in chosen:
        seen, _, _, _, info = side.step(np.stack([action, action]))
    for number, seed in enumerate((4, 9)):
        alone = play(one, chosen, seed)[-1]
        assert info["state_hash"][number] == alone[-1]["state_hash"]
        assert all(np.array_equal(seen[name][number], alone[0][name]) for name in seen)
    side.close()
    one.close()


def test_a_lab_s_task_in_a_file_has_an_id_and_plays() -> None:
    id = register_task(MUG)
    assert id == "hand_sandbox/MyLabPushTheMug-v1"
    env = FlattenObservation(gymnasium.make(id))
    seen, info = env.reset(seed=1)
    assert seen.shape == env.observation_space.shape
    assert info["seed"] == 1
    env.step(env.action_space.sample())
    env.close()


@pytest.mark.needs("opengl")
def test_a_picture_is_drawn_only_when_it_is_asked_for() -> None:
    env: Any = gymnasium.make(BOX, render_mode="rgb_array", size=(64, 48))
    env.reset(seed=0)
    assert env.unwrapped._pictures.made == 0
    picture = env.render()
    assert picture.shape == (48, 64, 3) and picture.dtype == np.uint8
    assert picture.std() > 1.0
    env.close()
    assert HandSandboxEnv().render() is None


def test_a_task_with_the_id_of_another_one_is_refused_and_the_same_one_is_not(
    tmp_path: Path,
) -> None:
    text = Path(MUG).read_text(encoding="utf-8").replace("my-lab-push-the-mug", "lab-ids")
    one, other = tmp_path / "one.py", tmp_path / "other.py"
    one.write_text(text)
    other.write_text(text)
    id = register_task(str(one))
    # The same by another name of its place, and after its file was edited.
    one.write_text(text.replace("0.20", "0.25"))
    assert register_task(str(one)) == register_task(f"{one}:PushTheMug") == id
    link = tmp_path / "link.py"
    link.symlink_to(one)
    assert register_task(str(link)) == id
    with pytest.raises(InputError, match=r"other\.py: the id .*belongs to another task.*one\.py"):
        register_task(str(other))
    assert gymnasium.spec(id).kwargs["task"] == str(one)
    # Another name can give the same id.
    places = [tmp_path / f"{name}.py" for name in ("lab-ids-2", "lab-ids2")]
    for place in places:
        place.write_text(text.replace("lab-ids", place.stem))
    assert register_task(str(places[0])) == "hand_sandbox/LabIds2-v1"
    before = set(gymnasium.registry)
    with pytest.raises(InputError, match="LabIds2-v1 belongs to another task"):
        register_task(str(places[1]))
    assert set(gymnasium.registry) == before


HEAPS = """
from models import Box
from tasks import CustomTask, Goal, judge


class Heap(CustomTask):
    name = "lab-heap"

    @classmethod
    def place(cls, rng, surface):
        places = [(0.04 * i - 0.05, 0.0, 0.01) for i in range(int(rng.integers(1, 4)))]
        boxes = [Box(f"box {i}", (0.01,) * 3, 0.1, place) for i, place in enumerate(places)]
        return boxes, [Goal(box.name, (*box.position[:1], 0.03, 0.01), 0.0) for box in boxes]

    def measure(self, sensing):
        return judge(0.5, (True, "never"))
"""


def test_a_trial_with_another_number_of_objects_is_refused_and_no_object_is_seen_twice(
    tmp_path: Path,
) -> None:
    (tmp_path / "heap.py").write_text(HEAPS)
    env: Any = gymnasium.make(register_task(str(tmp_path / "heap.py")))
    most, refused = env.observation_space["objects"].shape[0], 0
    for seed in range(6):
        try:
            seen, _ = env.reset(seed=seed)
        except InputError as error:
            assert "lab-heap, seed" in str(error) and "the number of objects" in str(error)
            assert "\n" not in str(error)
            with pytest.raises(gymnasium.error.ResetNeeded):
                env.unwrapped.step(env.action_space.sample())
            refused += 1
            continue
        assert len(env.unwrapped.session.task.objects) == len(seen["objects"]) == most
    assert 0 < refused < 6
    env.close()


GRIP = 1e-3 * np.array([[70, 100], [105, 58], [130, 45], [153, 52], [174, 74]])
"""Touches of five fingers, m on the surface, thumb first."""


def touching(fingers: tuple[int, ...]) -> Array:
    rows = [(1.0, *GRIP[f]) if f in fingers else (0.0, 0.0, 0.0) for f in range(5)]
    return np.ravel(rows)


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


def test_true_labels_are_the_slots_and_labels_that_are_found_need_not_be() -> None:
    for labels, expected in (("true", [-1, 1, -1, 3, -1]), ("population", [-1, 0, -1, 1, -1])):
        env = HandSandboxEnv(labels=labels)
        env.reset(seed=2)
        for _ in range(40):
            seen, *_ = env.step(touching((1, 3)))
        assert seen["labels"].tolist() == expected
        env.close()


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


def test_a_curriculum_changes_one_trial_and_the_next_is_as_ever() -> None:
    env = HandSandboxEnv(observe=["properties"])
    plain, _ = env.reset(seed=4)
    apart = np.linalg.norm(plain["objects"][0, :2] - plain["goals"][0, :2])
    easy, _ = env.reset(seed=4, options={"near": 0.5, "mass": 2.0, "size": 1.2})
    assert np.linalg.norm(easy["objects"][0, :2] - easy["goals"][0, :2]) == pytest.approx(apart / 2)
    assert easy["properties"][0] == pytest.approx(plain["properties"][0] * [2.0, 1.2, 1.2, 1.2])
    again, _ = env.reset(seed=4)
    assert all(np.array_equal(again[name], plain[name]) for name in plain)
    env.close()


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
    start = seen["pose"]
    for _ in range(40):
        seen, *_ = env.step(touching((0, 1, 2)))
    assert seen in env.observation_space and not np.allclose(seen["pose"], start, atol=0.01)
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
