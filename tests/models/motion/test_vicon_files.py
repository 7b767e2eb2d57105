"""Vicon's skeletons and motion are read as they are meant, and broken ones are refused."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.errors import MotionError
from models.motion.vicon_v import VWriter, motion_of, read_v
from models.motion.vsk import JOINTS, ViconSkeleton, read_vsk
from models.skeleton import ADULT
from tests.support.motion_poses import moving, written

VSK = """<?xml version="1.0" standalone="yes"?>
<KinematicModel>
  <Parameters>
    <Parameter NAME="Upper" VALUE="300" />
  </Parameters>
  <Skeleton>
    <Segment NAME="Root" POSITION="0 0 0" ORIENTATION="0 0 0">
      <JointFree />
      <Segment NAME="Arm" POSITION="Upper -Upper 5" ORIENTATION="0 0 1.5707963267948966">
        <JointBall />
        <Segment NAME="Hand" POSITION="0 0 100">
          <JointHinge AXIS="1 0 0" />
        </Segment>
      </Segment>
    </Segment>
  </Skeleton>
  <MarkerSet>
    <Markers>
      <Marker NAME="MARK" SEGMENT="Hand" POSITION="10 0 Upper" />
    </Markers>
  </MarkerSet>
</KinematicModel>
"""


def skeleton(folder: Path, text: str = VSK) -> ViconSkeleton:
    path = folder / "file.vsk"
    path.write_text(text)
    return read_vsk(path)


def motion_bytes(
    labels: list[str], frames: list[list[float]], *, rate: float = 100.0, other: bool = True
) -> bytes:
    """A V file, built by hand; with a section and records of no concern to anybody here."""

    def text(value: str) -> bytes:
        return bytes([len(value) + 1]) + value.encode() + b"\0"

    body = struct.pack("<H", 7) + text("numbers") + struct.pack("<BBdH", 6, 8, rate, len(labels))
    body += b"".join(map(text, labels))
    group = struct.pack("<H", len(body)) + body + b"\0\0"
    out = b"V#" + struct.pack("<h", 1)
    if other:
        out += struct.pack("<I28s", 11, b"PARAMETERS") + b"never read."
    out += struct.pack("<I28s", len(group), b"DATAGROUP") + group + bytes(32)
    for n, frame in enumerate(frames, start=1):
        if other:
            out += struct.pack("<HHI", 6 + 4, 9, n) + b"junk"
        values = struct.pack(f"<{len(frame)}d", *frame)
        out += struct.pack("<HHI", 6 + len(values), 7, n) + values
    return out


LABELS = [f"Anna:Root <a-{c}>" for c in "XYZ"] + [f"Anna:Root <t-{c}>" for c in "XYZ"]
LABELS += [f"Anna:Arm <a-{c}>" for c in "XYZ"]
FRAMES: list[list[float]] = [
    [0.1, 0.2, 0.3, 10, 20, 30, -0.5, 0.4, 0.9],
    [0, 0, 0, 0, 0, 0, 0, 0, 0],
]


def test_a_skeleton_has_its_segments_where_its_parameters_put_them(tmp_path: Path) -> None:
    found = skeleton(tmp_path)
    assert found.names == ["Root", "Arm", "Hand"] and found.parents == [-1, 0, 1]
    np.testing.assert_allclose(found.positions[1], [0.3, -0.3, 0.005])
    np.testing.assert_allclose(found.frames[1] @ [1, 0, 0], [0, 1, 0], atol=1e-12)
    segment, at = found.markers["MARK"]
    assert found.names[segment] == "Hand"
    np.testing.assert_allclose(at, [0.01, 0, 0.3])
    assert found.freedoms == 6 + 3 + 1


def test_a_genuine_skeleton_is_a_person(shared_data: Path) -> None:
    found = read_vsk(shared_data / "formats" / "Yuting.vsk")
    assert len(found.names) == 30 and len(found.markers) == 53
    assert found.freedoms == 6 + 18 * 3 + 6 and set(found.joints) <= set(JOINTS)
    legs = [found.positions[found.names.index(n)] for n in ("LeftLeg", "RightLeg")]
    np.testing.assert_allclose(legs[0], [0, -0.395701, 0])
    np.testing.assert_allclose(legs[0], legs[1])


def test_a_motion_turns_segments_by_rotation_vectors_after_their_rest(tmp_path: Path) -> None:
    path = tmp_path / "file.v"
    path.write_bytes(motion_bytes(LABELS, FRAMES))
    motion = motion_of(path, skeleton(tmp_path), read_v(path))
    assert motion.names == ("Root", "Arm", "Hand", "MARK") and motion.frame_time == 0.01
    placed = motion.place().positions
    for t, values in enumerate(FRAMES):
        root = Rotation.from_rotvec(values[:3])
        arm = root * Rotation.from_euler("z", 90, degrees=True) * Rotation.from_rotvec(values[6:])
        at = np.array(values[3:6]) / 1000 + root.apply([0.3, -0.3, 0.005])
        np.testing.assert_allclose(placed[t, 1], at, atol=1e-12)
        hand = at + arm.apply([0, 0, 0.1])
        np.testing.assert_allclose(placed[t, 2], hand, atol=1e-12)
        np.testing.assert_allclose(placed[t, 3], hand + arm.apply([0.01, 0, 0.3]), atol=1e-12)


def test_frames_that_a_recorder_left_out_move_no_later_frame_in_time(tmp_path: Path) -> None:
    path = tmp_path / "file.v"
    data = motion_bytes(LABELS, [*FRAMES, *FRAMES], other=False)
    record = 8 + 8 * len(LABELS)
    # The second of four frames is missing.
    path.write_bytes(data[: -3 * record] + data[-2 * record :])
    motion = motion_of(path, skeleton(tmp_path), read_v(path))
    np.testing.assert_allclose(motion.time, [0.0, 0.02, 0.03], atol=1e-12)


def test_rotation_vectors_of_a_wrist_that_turns_round_and_round_do_not_jump(tmp_path: Path) -> None:
    q = moving(ADULT, 600, 1)
    path, skeleton = written(lambda a: VWriter(tmp_path / "h.v", a, 60), ADULT, q)
    values = read_v(path).values
    assert np.abs(q[:, 5]).max() > 2 * np.pi
    assert np.abs(np.diff(values[:, :3], axis=0)).max() < 0.5
    assert len(read_v(path).labels) == read_vsk(skeleton).freedoms == 48


@pytest.mark.parametrize(
    ("old", "new"),
    (
        ("KinematicModel", "Model"),
        ("</KinematicModel>", ""),
        ('NAME="Arm"', 'NAME="Root"'),
        ('"Upper -Upper 5"', '"Upper -Upper"'),
        ('"Upper -Upper 5"', '"Upper -Lower 5"'),
        ('VALUE="300"', 'VALUE="long"'),
        ("<JointBall />", ""),
        ("<JointBall />", "<JointBall /><JointFree />"),
        ('SEGMENT="Hand"', 'SEGMENT="Foot"'),
        ('standalone="yes"?>', 'standalone="yes"?><!DOCTYPE a [<!ENTITY b "c">]>'),
    ),
)
def test_a_skeleton_with_a_wrong_part_is_refused_and_named(
    tmp_path: Path, old: str, new: str
) -> None:
    assert old in VSK
    text = VSK.replace(old, new) if old == "KinematicModel" else VSK.replace(old, new, 1)
    with pytest.raises(MotionError, match=r"file\.vsk"):
        skeleton(tmp_path, text)


def test_segments_inside_one_another_without_end_are_refused(tmp_path: Path) -> None:
    inside = "".join(f'<Segment NAME="s{i}"><JointBall />' for i in range(500))
    text = f"<KinematicModel><Skeleton>{inside}{'</Segment>' * 500}</Skeleton></KinematicModel>"
    with pytest.raises(MotionError, match="nested too deeply"):
        skeleton(tmp_path, text)


def test_a_motion_of_another_skeleton_or_of_two_at_once_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "file.v"
    other = [label.replace("Root", "Hips").replace("Arm", "Leg") for label in LABELS]
    path.write_bytes(motion_bytes(other, FRAMES))
    with pytest.raises(MotionError, match="none of the skeleton"):
        motion_of(path, skeleton(tmp_path), read_v(path))
    twice = [*LABELS, *(label.replace("Anna", "Bert") for label in LABELS)]
    path.write_bytes(motion_bytes(twice, [frame * 2 for frame in FRAMES]))
    with pytest.raises(MotionError, match="two subjects"):
        motion_of(path, skeleton(tmp_path), read_v(path))


SHORT = motion_bytes(LABELS, FRAMES[:1], other=False)


@pytest.mark.parametrize(
    "content",
    (
        *(SHORT[: int(share * len(SHORT))] for share in np.linspace(0, 0.999, 25)),
        *(motion_bytes(LABELS, [[value] * 9]) for value in (np.nan, np.inf, 1e200)),
        motion_bytes(LABELS, []),
        *(b"RIFF....", b"V#\2\0" + bytes(64), bytes(99)),
    ),
)
def test_what_is_cut_short_not_finite_or_no_motion_is_refused(
    tmp_path: Path, content: bytes
) -> None:
    path = tmp_path / "file.v"
    with pytest.raises(MotionError, match="no such file"):
        read_v(path)
    path.write_bytes(content)
    with pytest.raises(MotionError, match=r"file\.v"):
        read_v(path)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=150)
@given(data=st.data())
def test_a_damaged_motion_gives_finite_numbers_or_our_error_and_never_another(
    tmp_path: Path, data: st.DataObject
) -> None:
    content = bytearray(motion_bytes(LABELS, FRAMES))
    for _ in range(data.draw(st.integers(1, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "file.v"
    path.write_bytes(content)
    try:
        found = read_v(path)
        motion = motion_of(path, skeleton(tmp_path), found)
    except MotionError as error:
        assert "file." in str(error)
    else:
        assert np.isfinite(motion.shifts).all() and np.isfinite(motion.rotations).all()
