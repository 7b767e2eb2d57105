"""The hand that Bullet gets is ours, as MuJoCo's own reader of URDF sees it."""

import mujoco
import numpy as np
import pytest

from benchmarks.bullet import trajectory
from benchmarks.bullet_hand import LIGHT_MASS, hand_urdf
from models.hand import Hand
from models.kinematics import Kinematics
from models.rotations import quaternion_exp
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT

HANDS = {
    "right": Hand(),
    "left": Hand(skeleton=ADULT.mirrored()),
    "large": Hand(skeleton=ADULT.scaled(1.2)),
}


def qpos_of(q: np.ndarray) -> np.ndarray:
    return np.concatenate([q[:3], quaternion_exp(q[3:].reshape(15, 3)).ravel()])


def mass_matrix(model: mujoco.MjModel, q: np.ndarray) -> np.ndarray:
    data = mujoco.MjData(model)
    data.qpos[:] = qpos_of(q)
    mujoco.mj_forward(model, data)
    dense = np.empty((model.nv, model.nv))
    mujoco.mju_sym2dense(dense, data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
    return dense


@pytest.mark.parametrize("name", HANDS)
def test_the_joints_of_the_urdf_hand_lie_where_our_kinematics_puts_them(name: str) -> None:
    hand = HANDS[name]
    model = mujoco.MjModel.from_xml_string(hand_urdf(hand))
    data = mujoco.MjData(model)
    bones = [model.body(bone.name).id for bone in hand.skeleton.bones]
    for q in trajectory(3)[::40]:
        data.qpos[:] = qpos_of(q)
        mujoco.mj_kinematics(model, data)
        placed = Kinematics(hand.skeleton).place(q)
        assert np.allclose(data.xpos[bones], placed.joints, rtol=0, atol=1e-9)
        assert np.allclose(data.xmat[bones].reshape(-1, 3, 3), placed.rotations, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", HANDS)
def test_the_urdf_hand_resists_every_acceleration_as_ours_does_but_for_the_armature_of_its_bones(
    name: str,
) -> None:
    hand = HANDS[name]
    urdf = mujoco.MjModel.from_xml_string(hand_urdf(hand))
    our = Scene(SceneSpec((hand,))).model
    armature = np.zeros(our.nv)
    armature[6:] = our.dof_armature[6:]
    assert armature[6:].min() > 0
    # The carriages between the slides weigh next to nothing, and no more than that is between.
    for q in trajectory(4)[::150]:
        difference = mass_matrix(our, q) - mass_matrix(urdf, q) - np.diag(armature)
        assert np.abs(difference).max() < 3 * LIGHT_MASS


def test_the_loaded_hand_differs_by_the_armature_of_each_bone_and_nothing_else() -> None:
    plain, loaded = (mujoco.MjModel.from_xml_string(hand_urdf(Hand(), x)) for x in (False, True))
    for bone in ADULT.bones:
        added = loaded.body(bone.name).inertia - plain.body(bone.name).inertia
        assert np.allclose(added, bone.armature, rtol=1e-6)
    assert np.array_equal(loaded.body_mass, plain.body_mass)
