"""Objects that leave the workspace come back at rest; what is within reach is left alone."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from models.arithmetic import Array
from models.frames import Contact
from models.objects import Box
from models.scene import CONTROL_PERIOD
from models.surface import Surface
from sandbox.recording.recording import load_recording
from sandbox.session.collision_avoidance import HandDistances
from sandbox.session.messages import Snapshot
from sandbox.session.respawn import AWAY, BESIDE_GOAL, Respawn
from sandbox.session.session import Session
from sandbox.trial.driver import View, play_trial
from sandbox.trial.replay import replay
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from tasks.task import Task
from tests.support.scripted import Script, run, scripted


def idle(task: str = "box-to-goal", seed: int = 1) -> Session:
    return scripted(lambda now: (), task=task, seed=seed)


def joint(session: Session, name: str) -> tuple[int, int]:
    found = session.scene.model.joint(name)
    return int(found.qposadr[0]), int(found.dofadr[0])


def place(session: Session, name: str) -> np.ndarray:
    return session.scene.object_pose(session.data, name)[0]


@pytest.mark.parametrize("task", ["box-to-goal", "wrench-slide"])
@pytest.mark.parametrize(
    "away",
    [(0.6, 0.0, 0.03), (-0.05, 3.0, 0.4), (0.0, 0.0, -0.2), (0.0, 0.0, 40.0)],
)
def test_an_object_out_of_reach_comes_back_to_its_start_at_rest_and_is_counted(
    task: str, away: tuple[float, float, float]
) -> None:
    session = idle(task)
    thing = session.task.objects[0]
    q, v = joint(session, thing.name)
    session.data.qpos[q : q + 3] = away
    session.data.qvel[v : v + 6] = [1.0, -2.0, 3.0, 20.0, 0.0, 5.0]
    run(session, AWAY - 0.1)
    assert session.respawned == 0
    run(session, 0.15)
    assert session.respawned == 1 and TrialResult.of(session).respawned == 1
    assert thing.name in session.snapshot().notice
    np.testing.assert_allclose(place(session, thing.name), thing.position, atol=1e-3)
    run(session, 0.3)
    assert np.abs(session.data.qvel[v : v + 6]).max() < 1e-3
    run(session, 2.5)
    assert session.respawned == 1 and not session.snapshot().notice


def test_an_object_that_fingers_can_still_reach_is_left_where_it_is() -> None:
    session = idle()
    q, _ = joint(session, "box")
    surface = session.rigs[0].reconstructor.surface
    # Its middle is off the surface; a finger at the border touches it all the same.
    xy = surface.to_world([surface.size[0] + 0.02, surface.size[1] / 2])[:2]
    session.data.qpos[q : q + 2] = xy
    run(session, 2.0)
    assert session.respawned == 0
    np.testing.assert_allclose(place(session, "box")[:2], xy, atol=1e-3)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_before_an_upright_surface_a_box_that_sticks_out_over_a_side_comes_back(
    side: float,
) -> None:
    session = idle("stack-vertical")
    q, _ = joint(session, "second")
    surface = session.rigs[0].reconstructor.surface
    middle = surface.to_world(surface.size / 2)[0]
    half = surface.size[0] / 2
    box = session.task.objects[1]
    assert isinstance(box, Box)
    session.data.qpos[joint(session, "base")[0]] = middle - side * 0.05
    session.data.qpos[q] = middle + side * (half - box.half_size[0] - 0.001)
    run(session, 1.0)
    assert session.respawned == 0
    # A little over the side, and as a whole.
    for times, beyond in enumerate((0.001, 2.0 * box.half_size[0])):
        session.data.qpos[q] = middle + side * (half - box.half_size[0] + beyond)
        run(session, 1.0)
        assert session.respawned == times + 1
        assert abs(place(session, "second")[0] - middle) < half - box.half_size[0]


def test_where_a_finger_is_in_the_way_the_nearest_free_place_is_taken() -> None:
    where: dict[str, Any] = {}
    session = scripted(
        lambda now: [Contact(1, where["start"][0], where["start"][1], label=1)], seed=1
    )
    surface = session.rigs[0].reconstructor.surface
    box = session.task.objects[0]
    where["start"] = surface.to_surface(box.position).tolist()
    q, _ = joint(session, "box")
    session.data.qpos[q : q + 3] = [0.8, 0.8, 0.025]
    # The finger is at its touch a second later; the box has been away all the time.
    session._respawn._away["box"] = -62
    run(session, 1.6)
    assert session.respawned == 1 and session.solid(0) == frozenset({1})
    run(session, 0.5)
    at = place(session, "box")
    far = np.linalg.norm(at - box.position)
    assert 0.02 < far < 0.08
    assert np.all(np.abs(session.data.qvel[-6:]) < 1e-3)
    tip = session.tips(0, session.data)[1]
    assert box.clearance(tip[None], at, session.scene.object_pose(session.data, "box")[1])[0] > 0.01


def test_nothing_is_put_back_into_the_palm_of_a_hand_that_is_solid_all_over() -> None:
    """It was put there, where no fingertip was near, and pressed 18 mm into the table."""
    where: dict[str, Any] = {"contacts": []}
    session = scripted(lambda now: where["contacts"], seed=1, solid="hand")
    surface, box = session.rigs[0].reconstructor.surface, session.task.objects[0]
    q, _ = joint(session, "box")
    session.data.qpos[q : q + 3] = [0.8, 0.8, 0.025]
    x, y = surface.to_surface(box.position)
    # Thumb and index are far beyond the box's place, and the palm is over it.
    where["contacts"] = [Contact(1, x - 0.05, y - 0.06, label=0), Contact(2, x, y - 0.08, label=1)]
    session._respawn._away["box"] = -62
    run(session, 1.45)
    assert session.respawned == 0 and session.solid(0) >= {0, 1}
    parts = HandDistances(session.scene, 0)
    while not session.respawned:
        session.advance()
    near = parts.near(session.data)
    assert not [far for far in near.distances if far < 0.004]


@pytest.mark.parametrize("both", [False, True])
def test_an_object_comes_back_beside_what_stands_in_its_place(both: bool) -> None:
    """The first one's place is taken by the second, which is away itself where both are."""
    session = idle("stack")
    first, second = session.task.objects[:2]
    assert isinstance(first, Box) and isinstance(second, Box)
    (a, _), (b, _) = joint(session, first.name), joint(session, second.name)
    session.data.qpos[a : a + 3] = (0.8, 0.8, 0.025)
    session.data.qpos[b : b + 3] = (0.8, -0.8, 0.025) if both else first.position
    run(session, AWAY + 0.1)
    assert session.respawned == 1 + both
    run(session, 0.5)
    at, other = place(session, first.name), place(session, second.name)
    np.testing.assert_allclose(other, second.position if both else first.position, atol=1e-3)
    assert np.linalg.norm(at[:2] - first.position[:2]) < (1e-3 if both else 0.12)
    assert at[2] == pytest.approx(first.position[2], abs=1e-3), "it stands on the table"
    # Whatever way they are turned, they do not touch.
    reach = np.linalg.norm(first.half_size) + np.linalg.norm(second.half_size)
    assert both or np.linalg.norm(at - other) > reach


class Flinging(Script):
    """Pinches the box so that it slips, again and again."""

    def __init__(self, at: Array) -> None:
        super().__init__(self.wipe)
        self.at = at

    def wipe(self, now: float) -> list[Contact]:
        # From beside the box quickly through it and on over the border.
        way = np.clip((now % 2.0 - 0.8) / 0.2, 0.0, 1.0)
        x, y = self.at[0] - 0.045 + 0.20 * way, self.at[1]
        return [Contact(int(now // 2), x, y)] if now % 2.0 < 1.6 else []


def test_a_trial_in_which_things_come_back_replays_to_the_bit(tmp_path: Path) -> None:
    path = tmp_path / "flung.jsonl"
    devices = []

    def device(task: Task, surface: Surface) -> Flinging:
        devices.append(Flinging(surface.to_surface(task.objects[0].position)))
        return devices[-1]

    def views(session: Session) -> Sequence[View]:
        def stop(snapshot: Snapshot) -> None:
            devices[0].finished = session.respawned > 0 or snapshot.time > 15.0

        return [stop]

    result = play_trial(Settings(seed=4), (device,), views, record=path)
    assert result.respawned == 1
    recording = load_recording(path)
    assert [e.what for e in recording.events] == ["respawn"]
    session, found = replay(recording)
    assert found.exact and found.complete
    assert session.respawned == 1 and session.state_hash == result.state_hash
    assert json.dumps(result.as_json())


@pytest.mark.parametrize("task", ["stack-three", "slalom", "books", "insert", "gather"])
@pytest.mark.parametrize("seed", [1, 2])
def test_what_leaves_alone_comes_back_to_its_own_start_however_near_its_neighbours_are(
    task: str, seed: int
) -> None:
    """Its start was passed over where a ball around a neighbour was near."""
    for thing in idle(task, seed).task.objects:
        session = idle(task, seed)
        if thing.name not in {place.name for place in session._respawn._objects}:
            continue
        at, _ = joint(session, thing.name)
        session.data.qpos[at : at + 3] = 0.6, 0.0, 0.3
        mujoco.mj_forward(session.scene.model, session.data)
        run(session, AWAY + 2 * CONTROL_PERIOD)
        if session.over:  # A book that left has lost the trial.
            continue
        assert session.respawned == 1
        np.testing.assert_allclose(place(session, thing.name), thing.position, atol=2e-3)


@pytest.mark.parametrize("seed", range(1, 7))
def test_nobody_gains_by_throwing_a_thing_off_the_table(seed: int) -> None:
    """A die whose start is taken comes back outside of the ring."""
    session = idle("gather", seed)
    goals = [np.array(goal.position[:2]) for goal in session.task.goals]
    one, other = session.task.objects[:2]
    at, _ = joint(session, one.name)
    session.data.qpos[at : at + 3] = 0.6, 0.0, 0.3
    there, _ = joint(session, other.name)
    session.data.qpos[there : there + 2] = one.position[:2]
    mujoco.mj_forward(session.scene.model, session.data)
    run(session, AWAY + 2 * CONTROL_PERIOD)
    assert session.respawned == 1
    now, start = place(session, one.name)[:2], np.array(one.position[:2])
    assert np.linalg.norm(now - start) > 0.005
    before, after = (min(float(np.linalg.norm(p - g)) for g in goals) for p in (start, now))
    assert after > min(before, BESIDE_GOAL) - 1e-3
    assert session.scorer.score.progress == 0.0


LAB = """
from models import Mechanism
from tasks import CustomTask, judge

XML = '''<mujoco><worldbody><body>{free}
  <geom type="box" size=".02 .02 .01" mass=".1"/>
  <body name="arm"><joint type="slide" axis="1 0 0" {ends} frictionloss=".01"/>
    <geom type="box" size=".01 .01 .01" pos=".035 0 0" mass=".02"/></body>
</body></worldbody></mujoco>'''


class Cab(CustomTask):
    name = "test-cab"

    @classmethod
    def place(cls, rng, surface):
        return Mechanism("cab", XML, (0.0, 0.0, 0.0101)).parts, []

    def measure(self, sensing):
        return judge(0.0, (True, "never"))
"""


def cab(folder: Path, free: str, ends: str) -> Session:
    """A session with a base that carries an arm on a slide."""
    file = folder / "cab.py"
    file.write_text(LAB.replace("{free}", free).replace("{ends}", ends))
    return idle(f"{file}:Cab")


def test_a_mechanism_comes_back_with_all_it_carries_at_rest_and_clear_of_hands(
    tmp_path: Path,
) -> None:
    session = cab(tmp_path, "<freejoint/>", 'range="0 .08"')
    base, _ = joint(session, "cab")
    arm, arm_speed = joint(session, "cab/arm")
    session.data.qpos[base : base + 3] = 0.6, 0.0, 0.0101
    session.data.qpos[arm] = 0.08
    session.data.qvel[arm_speed] = -1.0
    mujoco.mj_forward(session.scene.model, session.data)
    respawn = Respawn(session.scene, [session.rigs[0].reconstructor.surface])
    where_the_arm_would_be = np.array([[0.115, 0.0, 0.0101]]), np.array([0.008])
    while not respawn.step(session.data, lambda: where_the_arm_would_be):
        pass
    mujoco.mj_forward(session.scene.model, session.data)
    assert session.data.qvel[arm_speed] == 0.0
    middles, radii = where_the_arm_would_be
    assert float(session.scene.clearance(session.data, middles)[0] - radii[0]) > 0.0


def test_a_mechanism_of_which_a_part_can_be_reached_is_left_where_it_is(tmp_path: Path) -> None:
    session = cab(tmp_path, "<freejoint/>", 'range="0 .08"')
    left = float(session.rigs[0].reconstructor.surface.corner[0])
    base, _ = joint(session, "cab")
    arm, _ = joint(session, "cab/arm")
    session.data.qpos[base] = left - 0.045
    session.data.qpos[arm] = 0.08
    mujoco.mj_forward(session.scene.model, session.data)
    run(session, AWAY + 0.2)
    assert session.respawned == 0


def test_what_slides_without_an_end_comes_back(tmp_path: Path) -> None:
    session = cab(tmp_path, "", 'limited="false"')
    arm, speed = joint(session, "cab/arm")
    session.data.qvel[speed] = 3.0
    run(session, 4.0)
    assert session.respawned == 1
    assert abs(session.data.qpos[arm]) < 0.01
