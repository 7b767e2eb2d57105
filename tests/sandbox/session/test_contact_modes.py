"""Hands turn solid outside of things only; hard, soft and ghost are switched without a jump."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from encoders.reconstruction.hand_motion import Phase
from encoders.reconstruction.reconstructor import Reconstruction
from models.frames import Contact
from models.hand import Hand
from models.kinematics import Kinematics
from models.objects import Box
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.recording.recording import load_recording
from sandbox.session.collision_gating import (
    GHOST,
    SOFT_IMPULSE,
    SOFT_SOLREF,
    CollisionGate,
    CollisionGatingRules,
)
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.driver import View, play_trial
from sandbox.trial.replay import replay
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from tasks.task import Task
from tests.support.scripted import Script, Touch, box_xy, pinch, run, scripted

MODES = ("hard", "soft", "none")


def squeezing(contact: str = "hard", squeeze: float = 0.008, **settings: Any) -> Session:
    """A session in which thumb and index close on the box from 2 s on, and hold it by 3 s."""
    place: dict[str, Any] = {}

    def touch(now: float) -> Sequence[Contact]:
        return pinch(place["at"], gap, place["yaw"])(now)

    def gap(now: float) -> float:
        width = 0.050 + 2 * 0.008
        return width + 0.012 - (0.012 + 2 * squeeze) * float(np.clip((now - 2.0) / 0.8, 0.0, 1.0))

    session = scripted(touch, seed=4, contact=contact, **settings)
    place["at"], place["yaw"] = box_xy(session), session.task.objects[0].yaw
    run(session, 3.0)
    return session


def box_speed(session: Session) -> float:
    body = session.scene.object_bodies["box"]
    return float(np.linalg.norm(session.data.cvel[body][3:]))


def fastest(session: Session, seconds: float) -> float:
    speed = 0.0
    for _ in range(round(seconds / 0.016)):
        session.advance()
        speed = max(speed, box_speed(session))
    return speed


@pytest.mark.parametrize("before", MODES)
@pytest.mark.parametrize("after", MODES)
def test_a_switch_changes_no_position_and_no_velocity_and_throws_nothing(
    before: str, after: str
) -> None:
    session = squeezing(before)
    assert session.solid(0) == (frozenset() if before == "none" else frozenset({0, 1}))
    old_mode, hash_before = session.contact, session.state_hash
    qpos, qvel = session.data.qpos.copy(), session.data.qvel.copy()
    session.set_contact(after)
    assert session.contact == old_mode and session.state_hash == hash_before
    np.testing.assert_array_equal(session.data.qpos, qpos)
    np.testing.assert_array_equal(session.data.qvel, qvel)
    session.advance()
    assert session.contact == after
    # Fingers that become ghosts go on to where they are told to be, and nothing is thrown.
    assert np.linalg.norm(session.data.qpos[63:66] - qpos[63:66]) < 0.001
    assert fastest(session, 1.0) < 0.2


@pytest.mark.parametrize("before", ["soft", "none"])
def test_a_finger_inside_the_box_stays_a_ghost_when_contacts_become_hard(before: str) -> None:
    """The fingers close further than the box is wide, so that they are deep inside as ghosts."""
    session = squeezing("none", squeeze=0.02)
    session.set_contact(before)
    run(session, 0.5)
    assert session.solid(0) == frozenset()
    start = box_xy(session)
    session.set_contact("hard")
    assert fastest(session, 1.0) < 0.01
    assert session.solid(0) == frozenset()
    np.testing.assert_allclose(box_xy(session), start, atol=1e-3)


def test_soft_fingers_give_way_and_push_with_three_newtons_at_most() -> None:
    def deepest(session: Session) -> tuple[float, float]:
        found = 0.0
        for _ in range(30):
            session.advance()
            for contact in session.data.contact[: session.data.ncon]:
                bodies = session.scene.model.geom_bodyid[list(contact.geom)]
                if 0 not in bodies:
                    found = min(found, float(contact.dist))
        return -found, np.abs(session.data.actuator_force[:3]).max()

    hard, _ = deepest(squeezing("hard"))
    soft, force = deepest(squeezing("soft"))
    assert soft > 2 * hard > 0.0
    assert force <= SOFT_IMPULSE * 60 + 1e-9


def test_hard_again_is_what_it_was_to_the_bit() -> None:
    session = scripted(lambda now: (), seed=1)
    model = session.scene.model
    kept = [
        a.copy()
        for a in (
            model.geom_solref,
            model.geom_solimp,
            model.geom_solmix,
            model.actuator_forcerange,
        )
    ]
    session.set_contact("soft")
    run(session, 0.5)
    assert np.any(np.isclose(model.geom_solref[:, 0], SOFT_SOLREF[0]))
    session.set_contact("hard")
    run(session, 0.5)
    now = (model.geom_solref, model.geom_solimp, model.geom_solmix, model.actuator_forcerange)
    for a, b in zip(kept, now, strict=True):
        np.testing.assert_array_equal(a, b)


class Switching(Script):
    """Touches a box, and has the contact mode changed now and then, as a person does."""

    def __init__(self, touch: Touch, times: Mapping[float, str]) -> None:
        super().__init__(touch)
        self.times = dict(times)

    def mode_requests(self, now: float) -> list[str]:
        due = [t for t in self.times if t <= now + 1e-9]
        return [self.times.pop(t) for t in due]


def test_a_session_with_switches_replays_to_the_bit_with_them(tmp_path: Path) -> None:
    def touch(now: float) -> list[Contact]:
        return [
            Contact(1, 0.06 + 0.03 * np.sin(3 * now), 0.09),
            Contact(2, 0.09 + 0.03 * np.sin(3 * now), 0.06),
        ]

    path = tmp_path / "switched.jsonl"
    times = {1.0: "soft", 2.0: "none", 2.5: "hard", 3.0: "soft", 3.1: "hard"}
    devices = []

    def device(task: Task, surface: Surface) -> Switching:
        devices.append(Switching(touch, times))
        return devices[-1]

    def views(session: Session) -> Sequence[View]:
        def stop(snapshot: Snapshot) -> None:
            devices[0].finished = snapshot.time > 4.0

        return [stop]

    result = play_trial(Settings(seed=4), (device,), views, record=path)
    recording = load_recording(path)
    assert [e.details["mode"] for e in recording.events] == list(times.values())
    session, found = replay(recording)
    assert found.exact and found.complete
    assert TrialResult.of(session).state_hash == result.state_hash
    assert session.contact == "hard"


INTO_THE_BOX, BESIDE_IT = 0.03, 0.09
"""m between thumb and fingers; the box is 50 mm wide."""


def grip(gap: float, contact: str = "hard") -> Session:
    """A hand over the box, its fingers so far apart."""
    empty = scripted(lambda now: (), seed=1)
    at = box_xy(empty)
    empty.close()
    return scripted(pinch(at, lambda now: gap), seed=1, contact=contact)


@pytest.mark.parametrize(("gap", "contact"), [(BESIDE_IT, "hard"), (INTO_THE_BOX, "none")])
def test_a_hand_beside_things_or_one_that_wants_to_pass_through_is_told_nothing(
    gap: float, contact: str
) -> None:
    session = grip(gap, contact)
    for _ in range(5):
        run(session, 0.5)
        assert not session.snapshot().notice


@pytest.mark.parametrize("together", [True, False])
def test_one_finger_inside_a_thing_holds_up_the_others_where_a_hand_becomes_solid_as_a_whole(
    together: bool,
) -> None:
    q = np.zeros(48)
    q[2] = 0.3
    x, y, z = Kinematics(ADULT).tips(q)[1].tolist()
    scene = Scene(SceneSpec((Hand(),), (Box("bead", (0.003,) * 3, 0.01, (x, y, z)),)))
    data = mujoco.MjData(scene.model)
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, q)
    mujoco.mj_forward(scene.model, data)
    gate = CollisionGate(scene, 0, CollisionGatingRules(together=together))
    every = frozenset(range(5))

    def solid(fingers: frozenset[int]) -> frozenset[int]:
        gate.update(data, Reconstruction(q, Phase.DOWN, fingers, None, 1.0, 0.0))
        return gate.fingers

    assert solid(every) == (GHOST if together else every - {1})
    # Without it they are all outside, and then it has to stay out alone.
    assert solid(every - {1}) == every - {1}
    assert solid(every) == every - {1}
    assert solid(GHOST) == GHOST
