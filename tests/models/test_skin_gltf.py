"""The hand as glTF, read by another library and bent by what it read."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pygltflib
import pytest
from numpy.typing import NDArray

from models.errors import InputError
from models.pose import POSE_SIZE
from models.skeleton import ADULT
from models.skin.skin import Skin, frames
from models.skin.skinned_glb import glb, main, write_glb
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


def test_what_the_standard_asks_of_the_file_holds(read: tuple[Skin, pygltflib.GLTF2]) -> None:
    _, file = read
    assert all(view.byteOffset % 4 == 0 for view in file.bufferViews)
    assert file.buffers[0].byteLength == len(file.binary_blob())
    for primitive in file.meshes[0].primitives:
        accessor = file.accessors[primitive.attributes.POSITION]
        positions = _array(file, primitive.attributes.POSITION)
        assert np.array_equal(accessor.min, positions.min(axis=0).astype(float))
        assert np.array_equal(accessor.max, positions.max(axis=0).astype(float))
        normals = _array(file, primitive.attributes.NORMAL)
        assert np.allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-5)
        assert np.all(_array(file, primitive.attributes.WEIGHTS_0).astype(int).sum(axis=1) == 255)


def test_the_same_hand_gives_the_same_file() -> None:
    assert glb(Skin.builtin()) == glb(Skin.builtin())


def test_a_place_that_cannot_be_written_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_glb(tmp_path / "nowhere" / "hand.glb", ADULT)


def test_the_command_writes_the_file_or_says_in_one_line_why_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "hand.glb")]) == 0
    assert (tmp_path / "hand.glb").read_bytes() == glb(Skin.builtin(), "right hand")
    for wrong in ([], ["a.glb", "b.glb"], [str(tmp_path / "nowhere" / "hand.glb")]):
        assert main(wrong) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
