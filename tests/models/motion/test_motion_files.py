"""Files of motion capture say what they say in their own terms, and broken ones are refused."""

from __future__ import annotations

import gzip
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.errors import MotionError
from models.motion.asf import AcclaimSkeleton, read_amc, read_asf
from models.motion.bvh import read_bvh
from models.motion.markers import MarkerTracks, read_markers
from models.motion.motion import Motion

BVH = """HIERARCHY
ROOT hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT knee
  {
    OFFSET 0 -40 0
    CHANNELS 3 Yrotation Xrotation Zrotation
    End Site
    {
      OFFSET 0 -30 10
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.02
1 90 2 10 20 30 40 50 60
0 91 0 0 0 0 -170 80 5
"""

ASF = """:version 1.10
:units
  length 0.5
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 90
:bonedata
  begin
    name thigh
    direction 0 -2 0
    length 4
    axis 10 20 30 XYZ
    dof rx rz
  end
  begin
    name shin
    direction 1 -1 0
    length 3
    axis 0 0 -40 XYZ
  end
:hierarchy
  begin
    root thigh
    thigh shin
  end
"""

AMC = """#!a remark
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 10 20 30
thigh 40 50
2
root 0 0 0 -100 60 170
thigh -5 5
"""

TSV = (
    "NO_OF_FRAMES\t4\nNO_OF_MARKERS\t2\nFREQUENCY\t50\nTIME_STAMP\t2030-01-01\n"
    "MARKER_NAMES\ta\tb\nTRAJECTORY_TYPES\tMeasured\tMeasured\n"
    "1.0\t2.0\t3.0\t4.0\t5.0\t6.0\n\t\t\t\t\t\n0\t0\t0\t4.5\t5.5\t6.5\n1\t2\t3\t\t\t\n"
)

SOUND = {"bvh": BVH, "asf": ASF, "amc": AMC, "tsv": TSV}


def read(path: Path) -> Motion | AcclaimSkeleton | MarkerTracks:
    """Whatever a file holds, by the end of its name."""
    kind = path.suffix[1:]
    if kind == "amc":
        skeleton = path.with_name("skeleton.asf")
        skeleton.write_text(ASF)
        return read_amc(path, read_asf(skeleton))
    readers: dict[str, Callable[[Path], Motion | AcclaimSkeleton | MarkerTracks]]
    readers = {"bvh": read_bvh, "asf": read_asf, "tsv": read_markers}
    return readers[kind](path)


def written(folder: Path, kind: str, content: str | bytes) -> Path:
    path = folder / f"file.{kind}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def as_motion(path: Path) -> Motion:
    motion = read(path)
    assert isinstance(motion, Motion)
    return motion


def test_a_bvh_turns_in_the_order_of_its_channels_about_axes_that_turn_along(
    tmp_path: Path,
) -> None:
    motion = read_bvh(written(tmp_path, "bvh", BVH))
    placed = motion.place()
    for t, (hips, knee, at) in enumerate(
        (((10, 20, 30), (40, 50, 60), (1, 90, 2)), ((0, 0, 0), (-170, 80, 5), (0, 91, 0)))
    ):
        above = Rotation.from_euler("ZXY", hips, degrees=True)
        below = above * Rotation.from_euler("YXZ", knee, degrees=True)
        joint = np.array(at) + above.apply([0, -40, 0])
        np.testing.assert_allclose(placed.positions[t, 1], 0.01 * joint, atol=1e-12)
        end = joint + below.apply([0, -30, 10])
        np.testing.assert_allclose(placed.ends[t, 1], 0.01 * end, atol=1e-12)
    np.testing.assert_allclose(motion.time, [0, 0.02])


def test_an_acclaim_bone_turns_about_fixed_axes_of_its_own_frame(tmp_path: Path) -> None:
    placed = as_motion(written(tmp_path, "amc", AMC)).place()
    metre = 0.0254 / 0.5
    rest = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)
    tilt = Rotation.from_euler("z", 90, degrees=True)
    for t, (at, hips, bend) in enumerate(
        (((1, 2, 3), (10, 20, 30), (40, 0, 50)), ((0, 0, 0), (-100, 60, 170), (-5, 0, 5)))
    ):
        root = tilt * Rotation.from_euler("xyz", hips, degrees=True) * tilt.inv()
        thigh = root * rest * Rotation.from_euler("xyz", bend, degrees=True) * rest.inv()
        knee = np.array(at) + thigh.apply([0, -4, 0])
        foot = knee + thigh.apply([3 / np.sqrt(2), -3 / np.sqrt(2), 0])
        np.testing.assert_allclose(placed.ends[t, 1], metre * knee, atol=1e-12)
        np.testing.assert_allclose(placed.ends[t, 2], metre * foot, atol=1e-12)


@pytest.mark.parametrize(
    "content",
    (
        TSV,
        TSV.replace(".", ","),
        gzip.compress(TSV.encode()),
    ),
    ids=("plain", "decimal commas", "packed"),
)
def test_markers_and_frames_that_were_not_seen_are_missing_and_others_keep_their_place(
    tmp_path: Path, content: str | bytes
) -> None:
    tracks = read_markers(written(tmp_path, "tsv", content))
    assert tracks.names == ("a", "b") and not tracks.report
    np.testing.assert_allclose(tracks.time, [0, 0.02, 0.04, 0.06])
    np.testing.assert_allclose(tracks.places[0], [[0.001, 0.002, 0.003], [0.004, 0.005, 0.006]])
    missing = [[False, False], [True, True], [True, False], [False, True]]
    np.testing.assert_array_equal(np.isnan(tracks.places).all(axis=2), missing)


@pytest.mark.parametrize("row", (6, 9))
def test_a_first_or_last_frame_without_a_marker_is_a_frame(tmp_path: Path, row: int) -> None:
    lines = TSV.splitlines()
    lines[row] = "\t" * 5
    tracks = read_markers(written(tmp_path, "tsv", "\n".join(lines) + "\n"))
    assert len(tracks) == 4 and np.isnan(tracks.places[row - 6]).all()


def test_a_real_body_keeps_its_bones_and_its_feet_above_the_floor(shared_data: Path) -> None:
    folder = shared_data / "formats"
    motion = read_amc(folder / "backflip.amc", read_asf(folder / "backflip.asf"))
    assert len(motion) == 247 and len(motion.names) == 31
    places, ends = motion.place().positions, motion.place().ends
    for j, p in enumerate(motion.parents):
        if p >= 0:
            lengths = np.linalg.norm(places[:, j] - places[:, p], axis=1)
            np.testing.assert_allclose(lengths, lengths[0], atol=1e-12)
        if p > 0:
            # Each bone begins where its parent ends.
            np.testing.assert_allclose(places[:, j], ends[:, p], atol=1e-12)
    height = np.nanmax(ends[0, :, 1]) - np.nanmin(ends[0, :, 1])
    assert 1.4 < height < 2.0
    assert -0.02 < np.nanmin(ends[..., 1]) < 0.02


@pytest.mark.parametrize(
    ("kind", "old", "new"),
    (
        ("bvh", "HIERARCHY", "HIERARCH"),
        ("bvh", "Frames: 2", "Frames: 3"),
        ("bvh", "Frame Time: 0.02", "Frame Time: 0"),
        ("bvh", "50 60", "50 nan"),
        ("bvh", "CHANNELS 3", "CHANNELS 4"),
        ("bvh", "JOINT knee", "JOINT hips"),
        ("bvh", "}\nMOTION", "MOTION"),
        ("bvh", "ROOT hips\n{", "ROOT hips\n{\n{"),
        ("asf", ":bonedata", ":bones"),
        ("asf", "length 0.5", "length 0"),
        ("asf", "direction 0 -2 0", "direction 0 0 0"),
        ("asf", "dof rx rz", "dof rx rx"),
        ("asf", "name shin", "name thigh"),
        ("asf", "thigh shin", "thigh foot"),
        ("asf", "orientation 0 0 90", ""),
        ("amc", "thigh 40 50", "thigh 40"),
        ("amc", "thigh 40 50", "thigh 40 50\nthigh 40 50"),
        ("amc", "thigh -5 5", ""),
        ("amc", "\n2\n", "\n3\n"),
        ("amc", "\n2\n", "\n²\n"),
        ("tsv", "NO_OF_FRAMES\t4", "NO_OF_FRAMES\t5"),
        ("tsv", "FREQUENCY\t50", "FREQUENCY\t0"),
        ("tsv", "MARKER_NAMES\ta\tb", "MARKER_NAMES\ta\ta"),
        ("tsv", "5.5\t6.5", "5.5"),
    ),
)
def test_a_file_with_a_wrong_part_is_refused_and_named(
    tmp_path: Path, kind: str, old: str, new: str
) -> None:
    assert SOUND[kind].count(old) == 1 or kind == "amc"
    read(written(tmp_path, kind, SOUND[kind]))
    with pytest.raises(MotionError, match=rf"file\.{kind}"):
        read(written(tmp_path, kind, SOUND[kind].replace(old, new, 1)))


@pytest.mark.parametrize(
    ("old", "new"),
    (
        ("ROOT hips\n{\n", "ROOT hips{"),
        ("End Site\n    {\n      OFFSET 0 -30 10\n    }\n  }", "End Site {OFFSET 0 -30 10}}"),
        ("  JOINT knee\n  {\n    OFFSET 0 -40 0\n", "  JOINT knee { OFFSET 0 -40 0 "),
        ("OFFSET 0 -40 0", "OFFSET 0\n-40\n0"),
        ("Frames: 2\nFrame Time: 0.02", "Frames: 2 Frame Time: 0.02"),
        ("1 90 2 10 20 30 40 50 60", "1 90 2\n10 20 30\n40 50 60"),
    ),
)
def test_a_bvh_consists_of_words_wherever_its_lines_break(
    tmp_path: Path, old: str, new: str
) -> None:
    assert BVH.count(old) == 1
    plain = as_motion(written(tmp_path, "bvh", BVH))
    text = BVH.replace(old, new)
    if old.startswith("1 90"):
        text = text.replace("0 91 0 0 0 0 -170 80 5", "0 91 0\n0 0 0\n-170 80 5")
    other = as_motion(written(tmp_path, "bvh", text))
    assert other.names == plain.names and other.frame_time == plain.frame_time
    np.testing.assert_array_equal(other.shifts, plain.shifts)
    np.testing.assert_array_equal(other.rotations, plain.rotations)
    np.testing.assert_array_equal(other.ends, plain.ends)
    assert not other.report.line()


@pytest.mark.parametrize(
    ("kind", "row"), (("bvh", "0 91 0 0 0 0 -170 80 5\n"), ("tsv", "1\t2\t3\t4\t5\t6\n"))
)
def test_rows_beyond_the_stated_number_are_read_and_reported(
    tmp_path: Path, kind: str, row: str
) -> None:
    before = read(written(tmp_path, kind, SOUND[kind]))
    found = read(written(tmp_path, kind, SOUND[kind] + row))
    assert isinstance(found, Motion | MarkerTracks) and isinstance(before, Motion | MarkerTracks)
    assert len(found) == len(before) + 1
    assert f"states {len(before)} frames and has {len(found)}" in found.report.line()


def test_words_after_the_last_frame_of_a_bvh_are_left_out_and_counted(tmp_path: Path) -> None:
    found = as_motion(written(tmp_path, "bvh", BVH + "# exported by somebody\n"))
    assert len(found) == 2
    assert found.report.left_out.total() == 1


@pytest.mark.parametrize("key", (":SAMPLES-PER-SECOND 30", ":samples-per-second 30"))
def test_an_amc_has_the_rate_that_it_states(tmp_path: Path, key: str) -> None:
    stated = as_motion(written(tmp_path, "amc", AMC.replace(":DEGREES", f"{key}\n:DEGREES")))
    assert stated.frame_time == pytest.approx(1 / 30)
    assert not stated.report.line()
    assert as_motion(written(tmp_path, "amc", AMC)).frame_time == pytest.approx(1 / 120)


@given(first=st.integers(0, 10_000))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=20)
def test_an_amc_that_was_cut_out_of_a_longer_take_begins_at_any_number(
    tmp_path: Path, first: int
) -> None:
    head, frame1, frame2 = re.split(r"\n[12]\n", AMC)
    text = f"{head}\n{first}\n{frame1}\n{first + 1}\n{frame2}"
    found = as_motion(written(tmp_path, "amc", text))
    plain = as_motion(written(tmp_path, "amc", AMC))
    np.testing.assert_array_equal(found.rotations, plain.rotations)
    np.testing.assert_array_equal(found.time, plain.time)


@pytest.mark.parametrize(
    ("encoding", "name"), (("latin-1", "Hüfte"), ("cp932", "右手"), ("utf-8", "右手ü"))
)
@pytest.mark.parametrize(("kind", "old"), (("bvh", "knee"), ("asf", "thigh"), ("tsv", "ES\ta\tb")))
def test_names_in_any_bytes_cost_no_data_and_are_reported(
    tmp_path: Path, kind: str, old: str, encoding: str, name: str
) -> None:
    new = old.replace("a", name) if kind == "tsv" else name
    data = SOUND[kind].replace(old, new).encode(encoding)
    found = read(written(tmp_path, kind, data))
    names = (
        [bone.name for bone in found.bones] if isinstance(found, AcclaimSkeleton) else found.names
    )
    assert name in names
    assert ("not UTF-8" in found.report.line()) == (encoding != "utf-8")


@pytest.mark.parametrize("kind", SOUND)
@pytest.mark.parametrize(
    "content", (b"", b"\n \n", b"\0\1\2\3", b"\xff\xfe\xfd", b"\x1f\x8b\x08 no gzip", b"a\tb\nc")
)
def test_a_file_of_another_kind_is_refused(tmp_path: Path, kind: str, content: bytes) -> None:
    with pytest.raises(MotionError, match=rf"file\.{kind}"):
        read(written(tmp_path, kind, content))


@pytest.mark.parametrize("kind", SOUND)
def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path, kind: str) -> None:
    with pytest.raises(MotionError, match="no such file"):
        read(tmp_path / f"file.{kind}")
    (tmp_path / f"folder.{kind}").mkdir()
    with pytest.raises(MotionError, match="cannot be read"):
        read(tmp_path / f"folder.{kind}")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=80)
@given(kind=st.sampled_from(["bvh", "tsv"]), share=st.floats(0, 1, exclude_max=True))
def test_a_file_that_states_its_frames_is_refused_when_cut_before_its_last_number(
    tmp_path: Path, kind: str, share: float
) -> None:
    text = SOUND[kind].rstrip()
    # A number cut in two is a number still, and nobody can tell.
    last = max(text.rfind(" "), text.rfind("\t"))
    with pytest.raises(MotionError, match="file"):
        read(written(tmp_path, kind, text[: int(share * last)]))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=120)
@given(kind=st.sampled_from(sorted(SOUND)), data=st.data())
def test_damage_gives_finite_numbers_or_our_error_and_never_another(
    tmp_path: Path, kind: str, data: st.DataObject
) -> None:
    text = SOUND[kind]
    at = data.draw(st.integers(0, len(text) - 1))
    put = data.draw(st.text("0123456789.-e{}:\n\t xyzROTJEND", max_size=4))
    try:
        found = read(written(tmp_path, kind, text[:at] + put + text[at + 1 :]))
    except MotionError as error:
        assert "file." in str(error) or "skeleton.asf" in str(error)
    else:
        if isinstance(found, Motion):
            assert np.isfinite(found.shifts).all() and np.isfinite(found.rotations).all()
