"""The skin: that it is a sound surface, and bends without folding.

An independent reader: MuJoCo's own skinning.
"""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from models.arithmetic import Array
from models.hand import Hand
from models.kinematics import Kinematics
from models.motion.gltf import glb, main
from models.pose import POSE_SIZE, mirrored
from models.rotations import exp, quaternion_to_matrix
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT, Skeleton
from models.skin.skin import FULL, Skin, frames, normals_of
from sandbox.views.hand_appearance import skinned_model
from tests.support.node_readers import ask
from training.skin.field import HandField
from training.skin.mesh import edges_of, volume
from training.skin.weights import folds, random_poses

OTHERS = (ADULT.mirrored(), ADULT.scaled(0.7), ADULT.scaled(1.25).mirrored())
seeds = st.integers(0, 2**32 - 1)


@cache
def builtin() -> Skin:
    return Skin.builtin()


def flesh(skeleton: Skeleton = ADULT) -> tuple[Array, NDArray[np.int64], Array]:
    """Vertices, triangles and shares of the skin proper."""
    skin = builtin().fitted(skeleton)
    part = skin.part("skin")
    return skin.rest[part.vertices], skin.triangles[part.triangles], skin.shares[part.vertices]


def pose(seed: int, skeleton: Skeleton = ADULT) -> Array:
    """A random legal pose somewhere in the world."""
    q = random_poses(skeleton, 1, seed)[0]
    q[:6] = np.random.default_rng(seed + 1).uniform(-1.0, 1.0, 6)
    return q


def test_the_skin_is_one_closed_body_and_faces_outwards() -> None:
    rest, triangles, _ = flesh()
    edges = edges_of(triangles)
    assert len(rest) - len(edges) + len(triangles) == 2
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    assert len(np.unique(directed, axis=0)) == len(directed) == 2 * len(edges)
    links = coo_matrix((np.ones(len(edges)), edges.T), shape=(len(rest),) * 2)
    assert connected_components(links, directed=False)[0] == 1
    assert 2.5e-4 < volume(rest, triangles) < 5e-4
    assert np.all(np.sum(normals_of(rest, triangles) * HandField().normal(rest), axis=1) > 0.3)


def test_shares_sum_to_one_exactly_and_unused_places_name_the_palm() -> None:
    skin = builtin()
    assert np.all(skin.weights.astype(int).sum(axis=1) == FULL)
    assert not skin.bones[skin.weights == 0].any()


def test_the_pads_are_where_the_simulated_fingers_touch() -> None:
    rest, _, _ = flesh()
    places, turns = frames(ADULT, np.zeros(POSE_SIZE))
    for i, bone in enumerate(ADULT.bones):
        if i + 1 < len(ADULT.bones) and ADULT.bones[i + 1].finger == bone.finger:
            continue
        local = (rest - places[i + 1]) @ turns[i + 1]
        tip = np.array([0.0, bone.length, 0.0])
        away = np.linalg.norm(local - tip, axis=1) - bone.radius
        pad = (local[:, 2] < -0.2 * bone.radius) & (local[:, 1] > bone.length)
        pad &= away < 0.004
        assert pad.sum() > 8
        assert np.abs(away[pad]).max() < 0.0015


@given(seeds)
@settings(max_examples=15, deadline=None)
def test_bones_that_move_together_carry_the_skin_along_unchanged(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn, shift = exp(rng.normal(size=3)), rng.normal(size=3)
    skin = builtin()
    places, turns = frames(ADULT, np.zeros(POSE_SIZE))
    moved = skin.posed(places @ turn.T + shift, turn @ turns)
    assert np.allclose(moved, skin.rest @ turn.T + shift, atol=1e-12)


@pytest.mark.parametrize("skeleton", [ADULT, *OTHERS], ids=lambda s: f"{s.name} {s.side}")
def test_mujoco_bends_it_alike(skeleton: Skeleton) -> None:
    scene = Scene(SceneSpec((Hand(skeleton=skeleton),)))
    model, looks = skinned_model(scene)
    look = looks[0]
    data, view = mujoco.MjData(model), mujoco.MjvScene(model, 1000)
    for seed in range(4):
        q = pose(seed, skeleton)
        data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, q)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mjv_updateScene(
            model,
            data,
            mujoco.MjvOption(),
            None,
            mujoco.MjvCamera(),
            mujoco.mjtCatBit.mjCAT_ALL,
            view,
        )
        expected = look.skin.at(q)
        for name, number in look.parts.items():
            start, count = view.skinvertadr[number], view.skinvertnum[number]
            drawn = view.skinvert.reshape(-1, 3)[start : start + count]
            assert np.abs(drawn - expected[look.skin.part(name).vertices]).max() < 1e-6


@pytest.mark.parametrize(
    ("skeleton", "count"),
    [
        (ADULT, 40),
        *((other, 15) for other in OTHERS[1:]),
        pytest.param(ADULT, 1000, marks=pytest.mark.full),
    ],
)
def test_no_triangle_folds_over_in_random_legal_poses(skeleton: Skeleton, count: int) -> None:
    assert not folds(skeleton, *flesh(skeleton), random_poses(skeleton, count, 1)).any()


@given(seeds)
@settings(max_examples=15, deadline=None)
def test_a_left_hand_is_the_right_one_in_a_mirror(seed: int) -> None:
    q = pose(seed)
    left = builtin().fitted(ADULT.mirrored())
    right = builtin().at(q)
    assert np.allclose(left.at(mirrored(q)), right * [-1.0, 1.0, 1.0], atol=1e-12)
    part = left.part("skin")
    assert volume(left.rest[part.vertices], left.triangles[part.triangles]) > 0


@given(st.floats(0.6, 1.6), seeds)
@settings(max_examples=15, deadline=None)
def test_a_larger_hand_has_the_same_skin_larger(factor: float, seed: int) -> None:
    q = pose(seed)
    large = q.copy()
    large[:3] *= factor
    skin = builtin().fitted(ADULT.scaled(factor))
    assert np.allclose(skin.at(large), factor * builtin().at(q), atol=1e-12)


def test_longer_fingers_get_longer_skin_and_the_palm_keeps_its_own() -> None:
    bones = tuple(
        replace(b, length=1.2 * b.length, anchor=(b.anchor[0], 1.2 * b.anchor[1], b.anchor[2]))
        if b.finger == 2 and not b.name.endswith("mcp")
        else b
        for b in ADULT.bones
    )
    longer = Skeleton("longer", bones, ADULT.palm_radius)
    skin = builtin().fitted(longer)
    palm = skin.shares[:, 0] > 0.999
    assert palm.sum() > 1000 and np.allclose(skin.rest[palm], builtin().rest[palm], atol=1e-9)
    tip = Kinematics(longer).tips(np.zeros(POSE_SIZE))[2]
    assert np.linalg.norm(skin.rest - tip, axis=1).min() < 0.010
    assert not folds(longer, *flesh(longer), random_poses(longer, 15, 3)).any()


def test_its_command_writes_a_sound_gltf_file_or_one_line_of_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "hand.glb")]) == 0
    found = ask("validate", tmp_path / "hand.glb")
    assert found["errors"] == 0, found["first"]
    for wrong in ([], ["a.glb", "b.glb"], [str(tmp_path / "nowhere" / "hand.glb")]):
        assert main(wrong) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1


def test_the_joints_of_its_file_are_the_bones_at_the_zero_pose_and_bound_there() -> None:
    content = glb(builtin())
    (length,) = struct.unpack_from("<I", content, 12)
    file = json.loads(content[20 : 20 + length])
    (bound,) = file["skins"]
    joints = [file["nodes"][i] for i in bound["joints"]]
    assert [joint["name"] for joint in joints] == ["palm", *(b.name for b in ADULT.bones)]
    view = file["bufferViews"][file["accessors"][bound["inverseBindMatrices"]]["bufferView"]]
    inverse = np.frombuffer(content, "<f4", 15 * 16, 28 + length + view["byteOffset"])
    places, turns = frames(ADULT, np.zeros(POSE_SIZE))
    for joint, back, place, turn in zip(
        joints, inverse.reshape(15, 4, 4), places, turns, strict=True
    ):
        x, y, z, w = joint["rotation"]
        assert np.allclose(joint["translation"], place)
        assert np.allclose(quaternion_to_matrix([w, x, y, z]), turn)
        # Column by column: the joint's place is the origin of its own frame.
        assert np.allclose([*place, 1.0] @ back, [0.0, 0.0, 0.0, 1.0], atol=1e-6)
        assert np.allclose(back[:3, :3], turn, atol=1e-6)
