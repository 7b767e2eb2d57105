"""The hand as glTF, read by another library and bent by what it read."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pygltflib
import pytest
from numpy.typing import NDArray

from models.pose import POSE_SIZE
from models.skeleton import ADULT
from models.skin.skin import Skin, frames
from models.skin.skinned_glb import glb, main, write_glb
from tests.support.node_readers import ask
from training.skin.weights import random_poses


@pytest.fixture(params=[ADULT, ADULT.scaled(1.25).mirrored()], ids=["right", "large left"])
def read(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[Skin, pygltflib.GLTF2]]:
    path = tmp_path / "hand.glb"
    write_glb(path, request.param)
    yield Skin.builtin().fitted(request.param), pygltflib.GLTF2().load(path)


_KINDS = {5126: np.float32, 5121: np.uint8, 5123: np.uint16}
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def _array(file: pygltflib.GLTF2, index: int) -> NDArray[np.generic]:
    accessor = file.accessors[index]
    view = file.bufferViews[accessor.bufferView]
    data = file.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    return np.frombuffer(data, _KINDS[accessor.componentType]).reshape(
        accessor.count, _WIDTHS[accessor.type]
    )


def test_another_reader_of_gltf_bends_the_hand_alike(read: tuple[Skin, pygltflib.GLTF2]) -> None:
    skin, file = read
    (bound,) = file.skins
    q = random_poses(skin.skeleton, 1, 3)[0]
    q[:6] = [0.1, -0.2, 0.3, 0.4, -0.5, 0.6]
    places, turns = frames(skin.skeleton, q)
    joints = np.tile(np.eye(4), (15, 1, 1))
    joints[:, :3, :3], joints[:, :3, 3] = turns, places
    inverse = _array(file, bound.inverseBindMatrices).reshape(15, 4, 4).swapaxes(1, 2)
    moves = joints @ inverse.astype(float)
    names = ["palm", *(b.name for b in skin.skeleton.bones)]
    assert [file.nodes[j].name for j in bound.joints] == names
    expected = skin.at(q)
    for primitive, part in zip(file.meshes[0].primitives, skin.parts, strict=True):
        a = primitive.attributes
        shares = _array(file, a.WEIGHTS_0).astype(float) / 255
        blend = np.einsum("nk,nkij->nij", shares, moves[_array(file, a.JOINTS_0)])
        rest = np.c_[_array(file, a.POSITION), np.ones(len(shares))]
        assert np.abs((blend @ rest[..., None])[:, :3, 0] - expected[part.vertices]).max() < 1e-5
        triangles = _array(file, primitive.indices).reshape(-1, 3)
        assert np.array_equal(triangles, skin.triangles[part.triangles] - part.vertices.start)


def test_the_joints_of_the_file_are_placed_at_the_zero_pose(
    read: tuple[Skin, pygltflib.GLTF2],
) -> None:
    skin, file = read
    places, turns = frames(skin.skeleton, np.zeros(POSE_SIZE))
    for node, place, turn in zip(file.nodes[:15], places, turns, strict=True):
        x, y, z, w = node.rotation
        assert np.allclose(node.translation, place)
        matrix = np.empty(9)
        mujoco.mju_quat2Mat(matrix, np.array([w, x, y, z]))
        assert np.allclose(matrix.reshape(3, 3), turn, atol=1e-9)


def test_the_validator_of_the_standard_accepts_the_file(tmp_path: Path) -> None:
    write_glb(tmp_path / "hand.glb", ADULT)
    found = ask("validate", tmp_path / "hand.glb")
    assert found["errors"] == 0, found["first"]


def test_the_command_writes_the_file_or_says_in_one_line_why_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "hand.glb")]) == 0
    assert (tmp_path / "hand.glb").read_bytes() == glb(Skin.builtin(), "right hand")
    for wrong in ([], ["a.glb", "b.glb"], [str(tmp_path / "nowhere" / "hand.glb")]):
        assert main(wrong) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
