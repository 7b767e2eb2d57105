"""A hand that is written for other programs and read again is where it was, in every format."""

from __future__ import annotations

import resource
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial.transform import Rotation

from models.arithmetic import Array
from models.errors import MotionError
from models.motion.armature import (
    ORDERS,
    Y_UP,
    Z_UP,
    Armature,
    Keys,
    chunks,
)
from models.motion.asf import AmcWriter, read_amc, read_asf
from models.motion.bvh import BvhWriter, read_bvh
from models.motion.c3d import C3dWriter
from models.motion.euler import ContinuousEuler, angles_of
from models.motion.gltf import GltfWriter
from models.motion.motion import Motion, rotations_of_angles
from models.motion.output import AtomicFile, MotionWriter
from models.motion.points import HandPoints, PointsCsvWriter
from models.motion.sampling import Poses, Sampler, slerp
from models.motion.vicon_v import VWriter, motion_of, read_v
from models.motion.vsk import read_vsk
from models.rotations import quaternion_to_matrix
from models.skeleton import ADULT, Skeleton
from tests.support.motion_poses import (
    last_joints,
    legal,
    motions,
    moving,
    points_of,
    written,
)

CLOSE = 1e-6
"""m."""


def read_back(kind: str, paths: list[Path]) -> Motion:
    if kind == "bvh":
        return read_bvh(paths[0])
    if kind == "amc":
        return read_amc(paths[1], read_asf(paths[0]))
    return motion_of(paths[0], read_vsk(paths[1]), read_v(paths[0]))


def assert_same(motion: Motion, skeleton: Skeleton, q: Array, up: Array) -> None:
    """Joints and fingertips of a motion are those of poses, `up` turned."""
    armature = Armature(skeleton)
    joints, tips = points_of(skeleton, q)
    placed = motion.place()
    names = [n for n in armature.names if n in motion.names]
    assert len(names) >= 14
    ours = [armature.names.index(n) for n in names]
    theirs = [motion.index(n) for n in names]
    assert np.abs(placed.positions[:, theirs] - joints[:, ours] @ up.T).max() < CLOSE
    if "index_tip" in motion.names:
        marks = [motion.index(f"{f}_tip") for f in ("thumb", "index", "middle", "ring", "little")]
        found = placed.positions[:, marks]
    else:
        found = placed.ends[:, [motion.index(armature.names[j]) for j in last_joints(armature)]]
    assert np.abs(found - tips @ up.T).max() < CLOSE


@settings(max_examples=65)
@given(
    drawn=motions,
    kind=st.sampled_from([*(f"bvh {order}" for order in ORDERS), "amc", "v"]),
    rate=st.sampled_from([24.0, 60.0, 62.5]),
)
def test_a_hand_comes_back_from_its_file_within_a_micrometre(
    drawn: tuple[Skeleton, Array], kind: str, rate: float
) -> None:
    skeleton, q = drawn
    kind, _, order = kind.partition(" ")
    writers: dict[str, Callable[..., MotionWriter]]
    writers = {"bvh": partial(BvhWriter, order=order), "amc": AmcWriter, "v": VWriter}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"hand.{kind}"
        motion = read_back(kind, written(lambda a: writers[kind](path, a, rate), skeleton, q))
    assert_same(motion, skeleton, q, Z_UP if kind == "v" else Y_UP)
    assert len(motion) == len(q) and abs(motion.frame_time * rate - 1) < 1e-6


def test_two_writers_of_one_file_leave_the_whole_file_of_the_one_that_ends_last(
    tmp_path: Path,
) -> None:
    path, link = tmp_path / "x.bvh", tmp_path / "link.bvh"
    link.symlink_to(path)
    first, second = AtomicFile(path), AtomicFile(link)
    first.write(b"1" * 20_000)
    second.write(b"2" * 50)
    second.complete()
    second.commit()
    assert path.read_bytes() == b"2" * 50 and link.is_symlink()
    first.write(b"1" * 20_000)
    first.complete()
    first.commit()
    assert path.read_bytes() == b"1" * 40_000
    assert sorted(tmp_path.iterdir()) == [link, path]


def test_points_come_back_from_a_table_within_a_micrometre(tmp_path: Path) -> None:
    q = legal(ADULT, 700, 1)
    points = HandPoints([Armature(ADULT)], ["right"], joints=True)
    written(lambda a: PointsCsvWriter(tmp_path / "p.csv", points, 60), ADULT, q)
    head, *_ = (tmp_path / "p.csv").read_text().splitlines()
    assert head.startswith("time,wrist_x,wrist_y,wrist_z,thumb_cmc_x,")
    table = np.loadtxt(tmp_path / "p.csv", delimiter=",", skiprows=1)
    joints, tips = points_of(ADULT, q)
    wanted = np.concatenate([joints, tips], axis=1).reshape(len(q), -1)
    assert np.abs(table[:, 1:] - wanted).max() < CLOSE
    np.testing.assert_allclose(table[:, 0], np.arange(700) / 60, atol=1e-9)


def test_the_first_angle_of_a_finger_is_its_flexion_and_the_last_its_spread() -> None:
    armature = Armature(ADULT)
    for order in ("ZXY", "XYZ", "ZYX", "XZY"):
        q = np.zeros((3, 48))
        q[1, armature.names.index("index_pip") * 3 + 3] = -0.3  # flexes by 0.3 rad
        q[2, armature.names.index("index_mcp") * 3 + 5] = 0.2  # spreads by 0.2 rad
        _, turns = armature.relative(armature.keys(q), armature.zero(order), Y_UP)
        angles = angles_of(turns, order)
        moved = angles[1] - angles[0]
        pip, mcp = armature.names.index("index_pip"), armature.names.index("index_mcp")
        np.testing.assert_allclose(moved[pip], [-0.3, 0, 0], atol=1e-12)
        assert np.abs(np.delete(moved, pip, axis=0)).max() < 1e-12
        spread = np.abs(angles[2, mcp] - angles[0, mcp])
        # The knuckle is bent by 30 degrees at rest, and spreads about an axis that turns with it.
        assert spread[2] > 0.15 and spread[0] < 0.05


@pytest.mark.parametrize("order", ORDERS)
def test_angles_that_pass_through_a_pole_are_those_they_were_made_of(order: str) -> None:
    t = np.linspace(0, 6, 3000)
    angles = np.stack([3 * t, 1.7 * np.sin(1.3 * t), 0.5 * t * t], axis=-1)[:, None]
    turns = rotations_of_angles(angles, order.lower(), fixed=False)
    euler = ContinuousEuler(order)
    found = np.concatenate([euler.angles(part) for part in np.array_split(turns, 7)])
    assert np.abs(angles[:, 0, 1]).max() > 1.65
    np.testing.assert_allclose(found, angles, atol=1e-9)
    steps = np.abs(np.diff(found[:, 0], axis=0)).max(axis=1)
    assert euler.biggest_step == steps.max() and euler.biggest_at == (steps.argmax() + 1, 0)


turns_of_outer_axes = st.floats(-2 * np.pi, 2 * np.pi) | st.sampled_from(
    [k * np.pi / 2 for k in range(-4, 5)]
)


def about(axis: int, sine: float, cosine: float) -> Array:
    """Matrix of a turn about an axis of the world: 0 is X, 1 is Y, 2 is Z."""
    turn, (j, k) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
    turn[j, j] = turn[k, k] = cosine
    turn[k, j], turn[j, k] = sine, -sine
    return turn


def turned_by(order: str, first: float, middle: tuple[float, float], last: float) -> Array:
    """Matrix of three turns; the middle one as its sine and cosine, which may be exactly 0."""
    a, b, c = ("XYZ".index(letter) for letter in order)
    outer = about(a, np.sin(first), np.cos(first)), about(c, np.sin(last), np.cos(last))
    return outer[0] @ about(b, *middle) @ outer[1]


@given(
    order=st.sampled_from(ORDERS),
    first=turns_of_outer_axes,
    last=turns_of_outer_axes,
    cosine=st.just(0.0) | st.floats(-17, -2).map(lambda power: 10**power),
    signs=st.tuples(st.sampled_from((1, -1)), st.sampled_from((1, -1))),
    before=st.tuples(*[st.floats(-10, 10)] * 3),
    errors=hnp.arrays(float, (3, 3), elements=st.floats(-1e-8, 1e-8)),
)
@example("XYZ", 0.5, 1.0, 1e-7, (1, 1), (0.1, 0.2, 0.3), np.zeros((3, 3)))
@example("ZXY", 0.5, 1.0, 2e-7, (-1, 1), (0.1, 0.2, 0.3), np.array([[1e-8, -1e-8, 1e-8]] * 3))
def test_angles_give_back_the_turn_at_and_near_a_pole(
    order: str,
    first: float,
    last: float,
    cosine: float,
    signs: tuple[int, int],
    before: tuple[float, float, float],
    errors: Array,
) -> None:
    middle = signs[0] * np.sqrt(1 - cosine**2), signs[1] * cosine
    turn = turned_by(order, first, middle, last)
    previous = turned_by(order, before[0], (np.sin(before[1]), np.cos(before[1])), before[2])
    for matrix in (turn, turn + errors):
        # Below POLE the middle angle is the pole's own: 2e-7 in an element.
        alone = angles_of(matrix, order)
        following = ContinuousEuler(order).angles(np.stack([previous, matrix])[:, None])[1, 0]
        for a, b, c in (alone, following):
            again = turned_by(order, a, (np.sin(b), np.cos(b)), c)
            np.testing.assert_allclose(again, turn, atol=4e-7)


WRITERS = {
    "bvh": lambda folder, a: BvhWriter(folder / "hand.bvh", a, 60.0),
    "amc": lambda folder, a: AmcWriter(folder / "hand.amc", a, 60.0),
    "v": lambda folder, a: VWriter(folder / "hand.v", a, 60.0),
    "glb": lambda folder, a: GltfWriter(folder / "hand.glb", (a,), 60.0),
    "c3d": lambda folder, a: C3dWriter(folder / "hand.c3d", HandPoints([a], ["right"]), 60.0),
    "csv": lambda folder, a: PointsCsvWriter(folder / "hand.csv", HandPoints([a], ["right"]), 60.0),
}


@pytest.mark.parametrize("kind", WRITERS)
def test_a_file_is_the_same_to_the_bit_however_its_keys_come(tmp_path: Path, kind: str) -> None:
    armature = Armature(ADULT)
    q = moving(ADULT, 300, 3)
    contents = []
    for name, parts in (("one", 1), ("many", 37), ("single", 300)):
        folder = tmp_path / name
        folder.mkdir()
        with WRITERS[kind](folder, armature) as writer:
            for part in np.array_split(q, parts):
                writer.write(armature.keys(part))
        contents.append([p.read_bytes() for p in writer.paths])
    assert contents[0] == contents[1] == contents[2]


@pytest.mark.parametrize("kind", WRITERS)
def test_a_file_that_is_there_stays_as_it_is_until_the_new_one_is_whole(
    tmp_path: Path, kind: str
) -> None:
    armature = Armature(ADULT)
    keys = armature.keys(moving(ADULT, 9, 3))
    with pytest.raises(MotionError, match="no motion to write"), WRITERS[kind](tmp_path, armature):
        pass
    with pytest.raises(ZeroDivisionError), WRITERS[kind](tmp_path, armature) as writer:
        for path in writer.paths:
            path.write_text("old")
        writer.write(keys)
        _ = 1 / 0
    assert sorted(tmp_path.iterdir()) == sorted(writer.paths)
    assert all(path.read_text() == "old" for path in writer.paths)
    with WRITERS[kind](tmp_path, armature) as writer:
        writer.write(keys)
    assert all(path.read_bytes() != b"old" for path in writer.paths)


@contextmanager
def room_for(size: int) -> Iterator[None]:
    """No file can become larger than so many bytes, as on a disk that is nearly full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("kind", WRITERS)
def test_a_full_disk_is_reported_and_no_file_is_left(tmp_path: Path, kind: str) -> None:
    q = moving(ADULT, 300, 3)
    whole = [p.stat().st_size for p in written(lambda a: WRITERS[kind](tmp_path, a), ADULT, q)]
    for share in (0.02, 0.5, 0.98):
        folder = tmp_path / f"{share}"
        folder.mkdir()
        with (
            pytest.raises(MotionError, match=r"cannot be written here.*File too large"),
            room_for(int(share * max(whole))),
        ):
            written(lambda a, folder=folder: WRITERS[kind](folder, a), ADULT, q)  # type: ignore[misc]
        assert not list(folder.iterdir())


@settings(max_examples=30)
@given(
    count=st.integers(2, 60),
    rate=st.sampled_from([10.0, 60.0, 62.5, 240.0]),
    splits=st.integers(1, 9),
    seed=st.integers(0, 99),
)
def test_keys_are_evenly_spaced_whatever_portions_the_poses_come_in(
    count: int, rate: float, splits: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    time = np.cumsum(rng.uniform(0.005, 0.03, count)) + 3.0
    turns = Rotation.random(count * 15, random_state=seed).as_quat()[:, [3, 0, 1, 2]]
    poses = Poses(time, rng.normal(size=(count, 1, 3)), turns.reshape(count, 1, 15, 4))
    armature = Armature(ADULT)

    def keys_in(portions: int) -> Keys:
        sampler = Sampler((armature,), rate)
        found = []
        for part in np.array_split(np.arange(count), portions):
            keys = sampler.add(Poses(*(p[part] for p in poses)))
            if keys is not None:
                found.append(keys[0])
        return Keys(*(np.concatenate(parts) for parts in zip(*found, strict=True)))

    whole, split = keys_in(1), keys_in(splits)
    np.testing.assert_array_equal(whole.root, split.root)
    np.testing.assert_array_equal(whole.turns, split.turns)
    assert len(whole.root) == int(np.floor((time[-1] - time[0]) * rate + 1e-6)) + 1
    np.testing.assert_allclose(whole.root[0], poses.root[0, 0], atol=1e-12)
    np.testing.assert_allclose(whole.turns[0, 0], quaternion_to_matrix(turns[0]), atol=1e-9)


def test_a_key_at_the_moment_of_a_pose_is_that_pose() -> None:
    q = moving(ADULT, 50, 5, rate=62.5)
    armature = Armature(ADULT)
    turns = Rotation.from_rotvec(q[:, 3:].reshape(-1, 3)).as_quat()[:, [3, 0, 1, 2]]
    poses = Poses(0.3 + np.arange(50) / 62.5, q[:, None, :3], turns.reshape(50, 1, 15, 4))
    (keys,) = Sampler((armature,), 62.5).add(poses)
    wanted = armature.keys(q)
    np.testing.assert_allclose(keys.root, wanted.root, atol=1e-9)
    np.testing.assert_allclose(keys.turns, wanted.turns, atol=1e-9)


@given(ends=hnp.arrays(float, (2, 3), elements=st.floats(-3, 3)), share=st.floats(0, 1))
def test_between_two_turns_the_way_is_even_and_short(ends: Array, share: float) -> None:
    one, two = Rotation.from_rotvec(ends)
    a, b = (r.as_quat()[[3, 0, 1, 2]] for r in (one, two))
    between = slerp(a, b, np.array([share]))
    between = Rotation.from_quat(between[[1, 2, 3, 0]])
    whole = (one.inv() * two).magnitude()
    if whole < 3.1:  # beyond, both ways are as short
        assert abs((one.inv() * between).magnitude() - share * whole) < 1e-6
        assert abs((between.inv() * two).magnitude() - (1 - share) * whole) < 1e-6


@pytest.mark.parametrize(
    ("time", "says"),
    (
        ([0.0, 0.1, 0.1], "does not increase"),
        ([0.0, 0.1, 86_400.1], r"86400 s without a pose, 0\.10 s after"),
    ),
)
def test_time_that_stands_still_or_leaps_by_a_day_is_refused(time: list[float], says: str) -> None:
    turns = np.tile([1.0, 0, 0, 0], (3, 1, 15, 1))
    with pytest.raises(MotionError, match=says):
        Sampler((Armature(ADULT),), 60).add(Poses(np.array(time), np.zeros((3, 1, 3)), turns))


def test_what_is_no_frame_rate_is_refused() -> None:
    for rate in (0, -1, float("nan"), float("inf"), 1e9):
        with pytest.raises(MotionError, match="not a frame rate"):
            Sampler((Armature(ADULT),), rate)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("seed", range(3))
def test_angles_never_jump_in_any_order(order: str, seed: int) -> None:
    armature = Armature(ADULT)
    q = moving(ADULT, 600, seed)
    euler = ContinuousEuler(order)
    angles = np.concatenate(
        [
            euler.angles(armature.relative(k, armature.zero(order), Y_UP)[1])
            for k in chunks(armature, q)
        ]
    )
    # Joints swing through at most 110 degrees 1.5 times a second: 9 degrees a frame at most, in
    # rotation vectors; Euler angles of the same motion move faster, but nowhere near a half turn.
    assert np.rad2deg(np.abs(np.diff(angles[:, 1:], axis=0)).max()) < 25
    assert np.rad2deg(np.abs(np.diff(angles[:, 0], axis=0)).max()) < 25
    assert euler.biggest_step == np.abs(np.diff(angles, axis=0)).max()
    moment, joint = euler.biggest_at
    assert np.abs(angles[moment, joint] - angles[moment - 1, joint]).max() == euler.biggest_step
