"""What fingers press with is read from contacts, how near their limit servos are from servos."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from models.hand import SERVOS, Hand
from models.scene import Scene, SceneSpec
from sandbox.session.finger_loads import FingerLoads
from tests.sandbox.session.test_collision_gating import BESIDE_IT, grip
from tests.support.scripted import run
from tests.support.simulation import pinched, put, random_pose


@pytest.mark.parametrize("servo", SERVOS)
def test_fingers_press_what_they_hold_and_nothing_else(servo: str) -> None:
    scene, data, _ = pinched(servo=servo)
    thumb, index, *others = FingerLoads(scene).read(data)[0].fingers
    for finger in (thumb, index):
        assert finger.force > 0.1
        assert finger.pressing <= finger.force <= finger.pressing + finger.sideways
    # The box is at rest between them.
    assert thumb.pressing == pytest.approx(index.pressing, rel=0.2)
    assert all(f.force == f.pressing == f.sideways == 0.0 for f in others)


def test_a_session_tells_the_loads_of_its_hands() -> None:
    session = grip(BESIDE_IT)
    run(session, 1.0)
    (load,) = session.loads()
    assert all(finger.force == 0.0 for finger in load.fingers)
    assert not load.at_limit


@pytest.mark.parametrize(("impulse", "full"), [(100.0, False), (0.0005, True)])
def test_a_weak_hand_that_cannot_follow_is_at_its_limit(impulse: float, full: bool) -> None:
    scene = Scene(SceneSpec((Hand(impulse=impulse),)))
    data = mujoco.MjData(scene.model)
    rng = np.random.default_rng(3)
    put(scene, data, random_pose(rng))
    data.ctrl[:] = random_pose(rng)
    mujoco.mj_step(scene.model, data)
    (load,) = FingerLoads(scene).read(data)
    assert load.at_limit is full
    assert 0.0 < load.used <= 1.0
    assert all(0.0 < finger.used <= 1.0 for finger in load.fingers)
