"""Other people's programs read our motion files, and find the hand where it was."""

from __future__ import annotations

import warnings
from pathlib import Path

import bvhio
import c3d
import numpy as np
import pyacclaim
import pytest

from models.arithmetic import Array
from models.motion.armature import ORDERS, Y_UP, Armature
from models.motion.asf import AmcWriter
from models.motion.bvh import BvhWriter
from models.motion.c3d import MOST, C3dWriter
from models.motion.gltf import GltfWriter
from models.motion.points import HandPoints
from models.skeleton import ADULT, Skeleton
from models.skin.skin import Skin
from tests.support.motion_poses import HANDS, last_joints, legal, moving, points_of, written
from tests.support.node_readers import ask

FRAMES = (0, 3, 17, 39)
INCH = 0.0254


@pytest.mark.parametrize("hand", HANDS)
@pytest.mark.parametrize("order", ORDERS)
def test_bvhio_and_three_js_find_every_joint_of_a_bvh(
    tmp_path: Path, hand: str, order: str
) -> None:
    skeleton = HANDS[hand]
    q = legal(skeleton, 40, 7)
    (path,) = written(lambda a: BvhWriter(tmp_path / "h.bvh", a, 60.0, order), skeleton, q)
    joints, _ = points_of(skeleton, q)
    root, three = bvhio.readAsHierarchy(str(path)), ask("bvh", path, *FRAMES)
    assert bvhio.readAsBvh(str(path)).FrameCount == three["frames"] == 40
    for frame, places in zip(FRAMES, three["places"], strict=True):
        root.loadPose(frame)
        found = {j.Name: np.array(j.PositionWorld) for j, _, _ in root.layout()}
        # In single precision, in centimetres.
        for i, name in enumerate(Armature(skeleton).names):
            wanted = 100 * Y_UP @ joints[frame, i]
            assert np.abs(found[name] - wanted).max() < 1e-4, (frame, name)
            assert np.abs(np.array(places[name]) - wanted).max() < 1e-4, (frame, name)


@pytest.mark.parametrize("hand", HANDS)
def test_pyacclaim_finds_every_bones_end_of_an_amc(tmp_path: Path, hand: str) -> None:
    skeleton = HANDS[hand]
    q = legal(skeleton, 41, 9)  # it leaves out the last frame
    asf, amc = written(lambda a: AmcWriter(tmp_path / "h.amc", a, 60.0), skeleton, q)
    armature = Armature(skeleton)
    joints, tips = points_of(skeleton, q)
    read = pyacclaim.loadASF(str(asf), verbose=False)
    frames = pyacclaim.loadAMC(read, str(amc))
    assert len(frames) == 40
    last = last_joints(armature)
    for frame in FRAMES:
        read["bones"]["root"].set_pose(frames[frame])
        for j, name in enumerate(armature.names[1:], start=1):
            end = (
                tips[frame, last.index(j)] if j in last else joints[frame, armature.children[j][0]]
            )
            found = INCH * read["bones"][name].global_coordinate
            assert np.abs(found - Y_UP @ end).max() < 1e-6, (frame, name)


@pytest.fixture(scope="module")
def two_hands(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Skeleton], list[Array]]:
    """A .glb of two hands, their skeletons and poses."""
    path = tmp_path_factory.mktemp("glb") / "hands.glb"
    skeletons = [HANDS["right"], HANDS["large left"]]
    poses = [moving(s, 90, 10 + i) for i, s in enumerate(skeletons)]
    armatures = tuple(Armature(s) for s in skeletons)
    with GltfWriter(path, armatures, 60.0, ("right", "left")) as writer:
        for a in range(0, 90, 25):
            keys = (m.keys(q[a : a + 25]) for m, q in zip(armatures, poses, strict=True))
            writer.write(*keys)
    return path, skeletons, poses


def test_the_validator_accepts_a_glb(two_hands: tuple[Path, list[Skeleton], list[Array]]) -> None:
    said = ask("validate", two_hands[0])
    assert (said["errors"], said["warnings"], said["infos"]) == (0, 0, 0), said["first"]


def test_three_js_moves_joints_and_skin_of_a_glb_as_we_do(
    two_hands: tuple[Path, list[Skeleton], list[Array]],
) -> None:
    path, skeletons, poses = two_hands
    frames = (0, 11, 60, 89)
    said = ask("glb", path, *(f / 60 for f in frames))
    assert abs(said["duration"] - 89 / 60) < 1e-6
    for frame, moment in zip(frames, said["moments"], strict=True):
        for name, skeleton, q in zip(("right", "left"), skeletons, poses, strict=True):
            joints, _ = points_of(skeleton, q[frame : frame + 1])
            for i, joint in enumerate(Armature(skeleton).names):
                found = np.array(moment["places"][f"{name}_{joint}"])
                # In single precision, of keys and of their times.
                assert np.abs(found - Y_UP @ joints[0, i]).max() < 2e-6, (frame, joint)
            skin = Skin.builtin().fitted(skeleton)
            posed = skin.at(q[frame]) @ Y_UP.T
            for part, number in zip(skin.parts, range(1, 99), strict=False):
                found = np.array(moment["skin"][f"{name}_{number}"])
                assert np.abs(found - posed[part.vertices][::50]).max() < 2e-5, part.name


@pytest.mark.needs("ezc3d")
@pytest.mark.parametrize("joints", (True, False))
def test_ezc3d_and_c3d_find_every_point_of_a_c3d(tmp_path: Path, joints: bool) -> None:
    import ezc3d

    hands = [HANDS["right"], HANDS["large left"]]
    poses = [legal(s, 120, 20 + i) for i, s in enumerate(hands)]
    armatures = [Armature(s) for s in hands]
    points = HandPoints(armatures, ["right", "left"], joints, (0, 1, 4))
    with C3dWriter(tmp_path / "h.c3d", points, 62.5) as writer:
        writer.write(*(a.keys(q) for a, q in zip(armatures, poses, strict=True)))
    parts = []
    for skeleton, q in zip(hands, poses, strict=True):
        places, tips = points_of(skeleton, q)
        kept = [0] + [j for j, b in enumerate(skeleton.bones, 1) if b.finger in (0, 1, 4)]
        parts += [places[:, kept if joints else []], tips[:, [0, 1, 4]]]
    wanted = np.concatenate(parts, axis=1)
    labels = points.labels
    assert len(labels) == wanted.shape[1] and labels[-1] == "left_little_tip"
    read = ezc3d.c3d(str(tmp_path / "h.c3d"))
    about = read["parameters"]["POINT"]
    assert about["LABELS"]["value"] == labels and about["UNITS"]["value"] == ["mm"]
    assert about["RATE"]["value"] == [62.5] and read["header"]["points"]["last_frame"] == 119
    found = read["data"]["points"][:3].transpose(2, 1, 0) / 1000
    assert np.abs(found - wanted).max() < 1e-6
    with open(tmp_path / "h.c3d", "rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that there is no analog data
        other = c3d.Reader(file)
        assert [label.strip() for label in other.point_labels] == labels
        assert other.point_rate == 62.5
        found = np.array([frame[:, :3] for _, frame, _ in other.read_frames()]) / 1000
    assert np.abs(found - wanted).max() < 1e-6


@pytest.mark.needs("ezc3d")
def test_a_c3d_of_more_frames_than_16_bits_count_is_still_whole(tmp_path: Path) -> None:
    import ezc3d

    count = MOST + 1000
    points = HandPoints([Armature(ADULT)], ["right"], fingers=(1,))
    q = np.tile(legal(ADULT, 1, 3), (count, 1))
    q[:, 0] = np.linspace(0, 1, count)
    written(lambda a: C3dWriter(tmp_path / "long.c3d", points, 120.0), ADULT, q)
    read = ezc3d.c3d(str(tmp_path / "long.c3d"))
    assert read["data"]["points"].shape == (4, 1, count)
    assert abs(read["data"]["points"][0, 0, -1] - read["data"]["points"][0, 0, 0] - 1000) < 1e-2
