"""Trials from Python: what comes back, what it is equal to, and what is refused."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from models import Contact, InputError, Kinematics, TouchFrame
from models.objects import Box
from models.skeleton import ADULT
from models.surface import Surface
from sandbox import (
    TouchDevice,
    TrialRun,
    export_motion,
    load_recording,
    replay_recording,
    run_trial,
)
from tasks import CustomTask, Goal, judge, two_places
from tasks.sensing import Sensing
from tasks.task import Measure


class Still(CustomTask):
    """A box that nobody has to move, for a fifth of a second."""

    name = "test-still"
    time_limit = 0.2
    hold_time = 0.05

    @classmethod
    def place(cls, rng: np.random.Generator, surface: Surface) -> tuple[list[Box], list[Goal]]:
        start, end = two_places(rng, surface)
        box = Box("it", (0.02, 0.02, 0.02), 0.1, (start[0], start[1], 0.02))
        return [box], [Goal("it", (end[0], end[1], 0.02), 0.0)]

    def measure(self, sensing: Sensing) -> Measure:
        return judge(0.5, (True, "never"))


class OneFinger(TouchDevice):
    """A finger that moves along a line from the start on."""

    time = 0.0

    def poll(self, now: float) -> list[TouchFrame]:
        frames = []
        while self.time <= now:
            contact = Contact(7, 0.05 + 0.1 * self.time, 0.04, label=1)
            frames.append(TouchFrame(self.time, (contact,)))
            self.time += 1 / 60
        return frames


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[TrialRun, Path]:
    path = tmp_path_factory.mktemp("trial") / "run.jsonl"
    return run_trial(seed=3, record=path), path


def test_a_trial_that_diverges_at_once_brings_its_score(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "sandbox.session.session.state_error", lambda scene, data: "the state is not finite"
    )
    run = run_trial(seed=3)
    assert run.result["status"] == "diverged" and "not finite" in run.score.reason
    assert run.trajectories.hands[0].q.shape == (len(run.trajectories.time), 48)


def test_a_trial_brings_its_score_and_everything_that_moved(
    recorded: tuple[TrialRun, Path],
) -> None:
    run, _ = recorded
    moved = run.trajectories
    T = len(moved.time)
    assert run.success and run.result["success"] and run.result["seed"] == 3
    assert run.state_hash == run.result["state_hash"]
    assert np.allclose(np.diff(moved.time), 0.016) and moved.step.shape == (T,)
    assert moved.objects["box"].position.shape == (T, 3)
    assert moved.objects["box"].rotation.shape == (T, 3, 3)
    assert moved.hands[0].q.shape == moved.hands[0].commanded.shape == (T, 48)
    assert moved.hands[0].solid.any() and not moved.hands[0].solid.all()
    assert set(moved.touches.finger) <= {-1, 0, 1, 2, 3, 4}


def test_the_simulated_pose_and_the_simulated_fingertips_agree(
    recorded: tuple[TrialRun, Path],
) -> None:
    hand = recorded[0].trajectories.hands[0]
    tips = Kinematics(ADULT).place(hand.q).tips
    # Bodies are one physics step older than joint positions: between the last two poses.
    step = np.linalg.norm(np.diff(tips, axis=0), axis=2)
    off = np.linalg.norm(tips - hand.tips, axis=2)[1:]
    assert np.all(off < step / 2 + 1e-4) and off.max() > 0


def test_a_replay_is_the_same_trial_to_the_bit(recorded: tuple[TrialRun, Path]) -> None:
    run, path = recorded
    again = replay_recording(path)
    assert again.verification.exact and again.verification.complete
    assert again.state_hash == run.state_hash and again.score == run.score
    assert np.array_equal(again.trajectories.hands[0].q, run.trajectories.hands[0].q)
    assert np.array_equal(again.trajectories.touches.xy, run.trajectories.touches.xy)


def test_a_recording_is_a_device_and_brings_its_task_and_seed(
    recorded: tuple[TrialRun, Path],
) -> None:
    again = run_trial(device=str(recorded[1]), trajectories=False)
    assert again.state_hash == recorded[0].state_hash and again.trajectories is None


def test_tables_tell_what_the_arrays_tell(recorded: tuple[TrialRun, Path], tmp_path: Path) -> None:
    moved = recorded[0].trajectories
    objects, hands, touches = moved.write_csv(tmp_path / "new")
    rows = list(csv.DictReader(objects.open()))
    assert len(rows) == len(moved.time)
    last = [float(rows[-1][f"box_{axis}"]) for axis in "xyz"]
    assert np.allclose(last, moved.objects["box"].position[-1], atol=1e-9)
    turn = [float(rows[-1][f"box_q{part}"]) for part in "wxyz"]
    assert np.allclose(turn, moved.objects["box"].quaternion[-1], atol=1e-9)
    row = list(csv.DictReader(hands.open()))[-1]
    assert float(row["q_position_x"]) == pytest.approx(moved.hands[0].q[-1, 0], abs=1e-9)
    assert sum(1 for _ in touches.open()) == len(moved.touches.time) + 1


def test_a_device_class_is_opened_and_its_touches_come_back() -> None:
    run = run_trial(Still, device=OneFinger)
    touches = run.trajectories.touches
    assert set(touches.contact) == {7} and set(touches.hand) == {0}
    assert np.allclose(touches.xy[-1], (0.05 + 0.1 * 0.19, 0.04), atol=0.004)
    assert run.result["settings"]["device"]["name"] == "from Python" and run.score.reason == "never"


@pytest.mark.needs("opengl")
def test_pictures_come_fifteen_times_a_second_and_a_film_is_written(tmp_path: Path) -> None:
    run = run_trial(Still, user="idle", pictures=(160, 90), film=tmp_path / "film.gif")
    assert run.pictures.shape == (1 + math.floor(0.208 * 15), 90, 160, 3)
    assert run.pictures.dtype == np.uint8 and run.pictures.std() > 1
    assert (tmp_path / "film.gif").stat().st_size > 0


def test_a_recording_is_never_overwritten(recorded: tuple[TrialRun, Path]) -> None:
    with pytest.raises(InputError, match="exists already"):
        run_trial(Still, user="idle", record=recorded[1])


def test_a_recording_that_breaks_off_is_exported_with_a_warning(
    recorded: tuple[TrialRun, Path], tmp_path: Path
) -> None:
    lines = recorded[1].read_bytes().splitlines(keepends=True)
    broken = tmp_path / "broken.jsonl"
    broken.write_bytes(b"".join(lines[:-1]))
    assert load_recording(broken).damage
    with pytest.warns(UserWarning, match="breaks off"):
        export_motion(broken, tmp_path / "hand.csv")


def test_the_turn_of_a_knob_is_the_one_that_its_pose_has_and_goes_on_beyond_a_whole_turn(
    tmp_path: Path,
) -> None:
    moved = run_trial("dial", seed=3).trajectories
    (name,) = moved.joints
    knob = moved.joints[name]
    assert (name, knob.joint.kind, knob.joint.unit) == ("dial/knob", "hinge", "rad")
    turn = moved.objects[name].rotation
    yaw = np.unwrap(np.arctan2(turn[:, 1, 0], turn[:, 0, 0]))
    apart = (yaw - yaw[0]) - (knob.position - knob.position[0])
    # The pose is one physics step older than the joint.
    assert np.abs(apart).max() < 0.05 and np.ptp(knob.position) > np.deg2rad(200.0)
    moved.write_csv(tmp_path)
    with (tmp_path / "objects.csv").open() as file:
        told = [float(row["dial/knob_hinge_rad"]) for row in csv.DictReader(file)]
    assert told == pytest.approx(knob.position.tolist(), abs=1e-9)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"sed": 3}, "Did you mean seed?"),
        ({"seed": "3"}, "seed: not a value of this option"),
        ({"correction": "no"}, "correction: not a value of this option"),
        ({"vary": {"size": 0.8}}, 'such as vary="size=0.8,latency=100"'),
        ({"encoder": object()}, "save_model"),
    ],
    ids=lambda v: v if isinstance(v, str) else None,
)
def test_an_option_of_another_type_is_one_clear_line(options: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=re.escape(says)) as refused:
        run_trial("box-to-goal", **{"seed": 0, **options})
    assert "\n" not in str(refused.value)


def test_numbers_of_numpy_paths_and_lists_are_options_too(tmp_path: Path) -> None:
    options: dict[str, Any] = {"fingers": np.int64(2), "hand_size": np.float32(1.0)}
    done = run_trial("box-to-goal", cast(int, np.int64(3)), ghost_until_clear=False, **options)
    assert done.result["seed"] == 3 and done.score.status
