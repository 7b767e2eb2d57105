"""What fingers press with is read from contacts, how near their limit servos are from servos."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from models.frames import Contact
from models.hand import SERVOS, Hand
from models.scene import Scene, SceneSpec
from sandbox.session.contact_forces import FingerLoads
from sandbox.session.messages import FingerLoad, HandLoad
from tests.support.scripted import box_xy, scripted
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


def test_a_grip_stores_what_its_fingers_press_against_each_other() -> None:
    scene, data, _ = pinched()
    thumb, index, *others = FingerLoads(scene).read(data)[0].fingers
    # A box at rest between two fingers: what one presses, the other presses back.
    for finger in (thumb, index):
        assert 0.8 * finger.pressing <= finger.stored <= finger.force
    assert all(finger.stored == 0.0 for finger in others)


def test_a_finger_that_pushes_alone_stores_nothing() -> None:
    session = scripted(lambda now: (), seed=1)
    at = box_xy(session)
    session.close()
    # From beside the box into its place, at 3 cm a second.
    session = scripted(
        lambda now: [
            Contact(1, float(at[0]) - 0.07 + 0.03 * max(now - 1.0, 0.0), float(at[1]), label=1)
        ],
        seed=1,
    )
    pushed = 0.0
    while session.time < 3.0:
        session.advance()
        (load,) = session.loads()
        pushed = max(pushed, load.fingers[1].force)
        assert load.fingers[1].stored == 0.0
    assert pushed > 0.1


@pytest.mark.parametrize(("share", "full"), [(0.5, False), (1.0, True)])
def test_the_limit_is_told_at_fingers_that_touch_something(share: float, full: bool) -> None:
    touching, idle = FingerLoad(force=3.0, used=share), FingerLoad(used=1.0)
    load = HandLoad((touching, *[idle] * 4), 0.0)
    assert load.full == ({0} if full else set())
    assert HandLoad((touching, *[FingerLoad()] * 4), share).full == ({0} if full else set())


def test_forces_are_those_that_mujoco_reads_from_its_contacts() -> None:
    scene, data, _ = pinched()
    assert data.ncon
    force = np.zeros(6)
    for contact in range(data.ncon):
        mujoco.mj_contactForce(scene.model, data, contact, force)
        np.testing.assert_array_equal(FingerLoads(scene).forces(data).of(contact), force[:3])
