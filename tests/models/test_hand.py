"""The hand of 48 degrees of freedom is that of the kinematics, and its servos keep their limit."""

from __future__ import annotations

from functools import cache
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arithmetic import Array
from models.errors import SceneError
from models.hand import CALM_ARMATURE, IMPULSE_PERIOD, IMPULSE_PROFILES, SERVOS, Hand
from models.kinematics import Kinematics
from models.pose import POSE_SIZE, mirrored
from models.rotations import geodesic_angle, quaternion_log
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from tests.support.simulation import TIMESTEPS, legal_poses, no_warning, put, random_pose, run
from tools.make_hand import HAND_FILE, hand_xml

MIRROR = np.diag([-1.0, 1.0, 1.0])
THUMB_MCP = 9
"""Component of the pose: flexion of the thumb's outer joint."""


def hand_scene(timestep: float = 0.002, **options: Any) -> tuple[Scene, mujoco.MjData]:
    scene = Scene(SceneSpec((Hand(**options),), timestep=timestep))
    return scene, mujoco.MjData(scene.model)


def simulated_pose(scene: Scene, data: mujoco.MjData) -> np.ndarray:
    """(48,) the pose that the simulated hand is in."""
    qpos = data.qpos[scene.qpos_slice(0)]
    return np.concatenate([qpos[:3], quaternion_log(qpos[3:].reshape(15, 4)).ravel()])


def test_the_file_is_the_hand_that_its_command_writes_and_its_hand_stays_at_rest_alone() -> None:
    assert HAND_FILE.read_text(encoding="utf-8") == hand_xml(Hand())
    model = mujoco.MjModel.from_xml_path(str(HAND_FILE))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, round(1.0 / model.opt.timestep))
    no_warning(data)
    assert np.abs(data.qpos - model.qpos0).max() < 1e-6
    assert np.abs(data.qvel).max() < 1e-6


@pytest.mark.parametrize("servo", SERVOS)
def test_what_one_component_commands_is_where_that_component_goes(servo: str) -> None:
    for component in range(POSE_SIZE):
        scene, data = hand_scene(timestep=0.004, servo=servo)
        command = np.zeros(POSE_SIZE)
        command[component] = 0.1
        data.ctrl[:] = command
        run(scene, data, 0.6)
        np.testing.assert_allclose(simulated_pose(scene, data), command, atol=2e-4)


@given(q=legal_poses, left=st.booleans())
@settings(max_examples=50)
def test_kinematics_and_mujoco_agree_where_every_bone_is(q: Array, left: bool) -> None:
    scene, data = hand_scene_once(left)
    skeleton = scene.spec.hands[0].skeleton
    q = mirrored(q) if left else q
    put(scene, data, q)
    mujoco.mj_kinematics(scene.model, data)
    placement = Kinematics(skeleton).place(q)
    links = scene.spec.hands[0].links
    places = [data.body(link.body).xpos for link in links]
    np.testing.assert_allclose(places, placement.joints, atol=1e-9, rtol=0)
    for bone, link, rotation in zip(skeleton.bones, links, placement.rotations, strict=True):
        body = data.body(link.body)
        np.testing.assert_allclose(body.xmat.reshape(3, 3), rotation, atol=1e-8, rtol=0)
        if bone.name.endswith(("dip", "thumb_mcp")):
            tip = body.xpos + bone.length * rotation[:, 1]
            np.testing.assert_allclose(placement.tips[bone.finger], tip, atol=1e-9, rtol=0)


@cache
def hand_scene_once(left: bool) -> tuple[Scene, mujoco.MjData]:
    """One compiled scene for all examples; what is read from it depends on `qpos` alone."""
    return hand_scene(skeleton=ADULT.mirrored() if left else ADULT)


@pytest.mark.parametrize("timestep", TIMESTEPS)
@pytest.mark.parametrize("servo", SERVOS)
def test_both_kinds_of_servo_bring_the_hand_into_any_legal_pose_and_hold_it(
    servo: str, timestep: float
) -> None:
    rng = np.random.default_rng(5)
    scene, data = hand_scene(timestep, servo=servo)
    for _ in range(5):
        q = random_pose(rng)
        data.ctrl[:] = q
        run(scene, data, 1.0)
        reached = simulated_pose(scene, data)
        assert np.abs(reached[:3] - q[:3]).max() < 1e-4
        off = geodesic_angle(reached[3:].reshape(15, 3), q[3:].reshape(15, 3))
        assert np.rad2deg(off.max()) < 0.1
        assert np.abs(data.qvel).max() < 0.02


TINY = 0.0005
"""N s and N m s, so little that the weakest finger joint needs more."""


def torques(scene: Scene, data: mujoco.MjData) -> np.ndarray:
    """(18,) or (46,) N or N m, what each servo gives now: the norm of its outputs."""
    m = scene.model
    return np.array(
        [
            np.linalg.norm(data.actuator_force[start : start + n])
            for start, n in zip(m.actuator_outadr, m.actuator_outnum, strict=True)
        ]
    )


def far_away(rng: np.random.Generator) -> np.ndarray:
    """Controls that no hand can follow: metres and radians from where it is, in all directions."""
    target = rng.uniform(1.5, 1.7, POSE_SIZE) * rng.choice([-1.0, 1.0], POSE_SIZE)
    target[:3] *= 10.0
    return target


@pytest.mark.parametrize("timestep", TIMESTEPS)
@pytest.mark.parametrize("impulse", [*IMPULSE_PROFILES.values(), TINY])
@pytest.mark.parametrize("servo", SERVOS)
def test_no_servo_exceeds_its_impulse_limit_and_saturated_ones_reach_it(
    servo: str, impulse: float, timestep: float
) -> None:
    scene, data = hand_scene(timestep, servo=servo, impulse=impulse)
    limit = impulse / IMPULSE_PERIOD
    model = scene.model
    rng = np.random.default_rng(3)
    greatest = np.zeros(model.nactuator)
    wanted = np.zeros(model.nactuator)
    for _ in range(4):
        mujoco.mj_resetData(model, data)
        data.ctrl[:] = far_away(rng)
        # At rest a servo asks for its stiffness times what it is off.
        mujoco.mj_forward(model, data)
        starts = zip(model.actuator_outadr, model.actuator_outnum, strict=True)
        off = [np.linalg.norm(data.ctrl[start : start + n]) for start, n in starts]
        wanted = np.maximum(wanted, model.actuator_gainprm[:, 0] * off)
        for _ in range(round(0.05 / timestep)):
            mujoco.mj_step(model, data)
            greatest = np.maximum(greatest, torques(scene, data))
    no_warning(data)
    assert greatest.max() <= limit * (1 + 1e-12)
    saturated = wanted > 1.01 * limit
    np.testing.assert_allclose(greatest[saturated], limit, rtol=1e-12)
    # `paper` binds for nobody but a root that is metres off, `safe` for the root and the strongest
    # finger joints, the tiny one for all.
    assert saturated[:3].all()
    assert saturated.all() == (impulse == TINY)


@pytest.mark.parametrize("servo", SERVOS)
def test_a_heavy_finger_that_breaks_free_goes_half_as_far_at_first_and_ends_at_the_same_place(
    servo: str,
) -> None:
    ways = []
    for armature in (1.0, CALM_ARMATURE):
        scene, data = hand_scene(servo=servo, finger_armature=armature)
        data.ctrl[THUMB_MCP] = -0.2
        for steps in (2, 400):
            mujoco.mj_step(scene.model, data, steps)
            ways.append(simulated_pose(scene, data)[THUMB_MCP])
    far, end, calm, same = ways
    assert 0.5 * far < calm < 0.0
    assert same == pytest.approx(end, abs=1e-5) and end == pytest.approx(-0.2, abs=1e-3)


@given(q=legal_poses)
@settings(max_examples=50)
def test_a_mirrored_pose_is_the_left_hands_pose(q: Array) -> None:
    np.testing.assert_array_equal(mirrored(mirrored(q)), q)
    right = Kinematics(ADULT).place(q)
    left = Kinematics(ADULT.mirrored()).place(mirrored(q))
    np.testing.assert_allclose(left.tips, right.tips @ MIRROR, atol=1e-12)
    np.testing.assert_allclose(left.joints, right.joints @ MIRROR, atol=1e-12)
    np.testing.assert_allclose(left.rotations, MIRROR @ right.rotations @ MIRROR, atol=1e-12)
    joints, skeleton = mirrored(q)[6:], ADULT.mirrored()
    assert np.all(joints >= skeleton.lower - 1e-12) and np.all(joints <= skeleton.upper + 1e-12)


def test_both_hands_weigh_the_same_and_lie_in_a_mirror_in_mujoco() -> None:
    left, right = (hand_scene(skeleton=s)[0].model for s in (ADULT.mirrored(), ADULT))
    np.testing.assert_allclose(left.body_mass, right.body_mass, rtol=1e-9)
    np.testing.assert_allclose(left.body_inertia, right.body_inertia, rtol=1e-6)
    np.testing.assert_allclose(left.geom_size, right.geom_size, atol=1e-9)
    np.testing.assert_allclose(left.body_pos, right.body_pos @ MIRROR, atol=1e-9)


@pytest.mark.parametrize("impulse", [0.0, -1.0, float("nan"), float("inf")])
def test_an_impossible_hand_is_refused(impulse: float) -> None:
    with pytest.raises(SceneError):
        Hand(impulse=impulse)
    with pytest.raises(SceneError):
        Hand(servo="velocity")
