"""A robot's hand puts its fingertips where a person's are, within its limits, with equal bits."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from encoders import builtin_capture
from models.arithmetic import Array
from models.errors import InputError
from models.frames import FINGERS
from models.hand import Hand, SceneHand
from models.pose import POSE_SIZE
from models.robot.mapping import RobotMapping, find_robot, load_mapping
from models.robot.mapping_fit import fit_mapping, volume
from models.robot.robot_hand import RobotHand
from models.robot.robot_model import RobotModel
from models.rotations import exp
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from tests.models.robot.hinge_hand import TIPS, edited, hinge_hand
from tests.support.simulation import no_warning


@pytest.fixture(scope="module")
def mapping(tmp_path_factory: pytest.TempPathFactory) -> RobotMapping:
    path = hinge_hand(tmp_path_factory.mktemp("robot"))
    fitted = fit_mapping(path, TIPS, model=path.name).mapping
    path.with_suffix(".toml").write_text(fitted.as_toml())
    return find_robot(str(path))


def people_s_poses(count: int) -> Array:
    """(count, 48) poses of the simulated subject, far from each other."""
    q = builtin_capture().q
    return q[:: len(q) // count][:count]


def held_tips(hand: RobotHand, q: Array) -> Array:
    """(5, 3) m, fingertips of the hand in a scene, by the bodies and lengths of its links."""
    scene = Scene(SceneSpec((hand,)))
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.pose_to_qpos(0, q)
    mujoco.mj_forward(scene.model, data)
    last = {link.finger: link for link in hand.links}
    ends = [
        data.body(link.body).xpos + link.length * data.body(link.body).xmat[1::3]
        for link in last.values()
    ]
    return np.array(ends)


def test_its_fingertips_in_a_scene_are_where_the_retargeter_says(mapping: RobotMapping) -> None:
    hand = RobotHand("right", mapping)
    retargeter = hand.retargeter()
    for q in people_s_poses(10):
        retargeter.reset()
        retargeter.follow(q)
        off = np.linalg.norm(held_tips(hand, q) - hand.tips_of()(q), axis=1)
        assert np.allclose(off, retargeter.off, atol=1e-6)


@pytest.mark.needs("robots")
@pytest.mark.parametrize("robot", ["shadow", "adroit"])
def test_tips_of_hands_known_by_name_are_within_5_mm(robot: str) -> None:
    hand = RobotHand("right", find_robot(robot))
    retargeter, off = hand.retargeter(), []
    for q in people_s_poses(300):
        retargeter.reset()
        retargeter.follow(q)
        off.append(retargeter.off)
    assert np.percentile(np.array(off), 95) < 0.005


def test_couplings_in_a_row_lead_to_the_joint_that_follows_no_other(tmp_path: Path) -> None:
    rows = """<equality>
        <joint joint1="index_dip" joint2="index_pip" polycoef="0 .8 0 0 0"/>
        <joint joint1="middle_pip" joint2="middle_mcp" polycoef="0 0 0 0 0"/>
        <joint joint1="index_mcp" joint2="index_dip" polycoef="0 2.5 0 0 0"/>
        <joint joint1="index_pip" joint2="index_mcp" polycoef="0 .5 0 0 0"/>
      </equality>"""
    path = hinge_hand(tmp_path, extra=rows)
    assert fit_mapping(path, TIPS, model=path.name).mapping.coupled == {
        "index_dip": ("index_pip", pytest.approx(0.8)),
        "index_mcp": ("index_pip", pytest.approx(2.0)),
    }


def test_a_finger_that_cannot_reach_its_touch_is_named(mapping: RobotMapping) -> None:
    giant = RobotHand("right", mapping, ADULT.scaled(3.0), 1.0)
    retargeter = giant.retargeter()
    retargeter.follow(np.zeros(POSE_SIZE), {1, 4})
    assert retargeter.missed and retargeter.missed <= {1, 4}
    own = RobotHand("right", mapping).retargeter()
    own.follow(np.zeros(POSE_SIZE), {1, 4})
    assert own.missed == frozenset()


def test_a_movement_gives_the_same_bits_whatever_else_is_followed(mapping: RobotMapping) -> None:
    poses = people_s_poses(20)
    hand, other = RobotHand("right", mapping), RobotHand("right", mapping)
    follow, again, disturbing = hand.follower(), other.follower(), hand.follower()
    for i, q in enumerate(poses):
        one = follow(q, {0, 1})
        disturbing(poses[-1 - i], {2, 3})
        hand.joint_positions(poses[0])
        assert one.tobytes() == again(q, {0, 1}).tobytes()


def test_a_hand_that_moves_as_a_whole_keeps_its_fingers(mapping: RobotMapping) -> None:
    hand = RobotHand("right", mapping)
    q = np.zeros(POSE_SIZE)
    moved = q.copy()
    moved[:3] = 0.1, -0.05, 0.2
    here, there = hand.joint_positions(q), hand.joint_positions(moved)
    assert np.allclose(there[:3] - here[:3], moved[:3], atol=1e-6)
    assert np.allclose(here[3:], there[3:], atol=1e-6)


def test_servos_give_no_more_than_the_robot_s_own(mapping: RobotMapping) -> None:
    hand = RobotHand("right", mapping)
    scene = Scene(SceneSpec((hand,)))
    assert scene.model.actuator("right_index_pip").forcerange.tolist() == [-0.7, 0.7]
    weak = Scene(SceneSpec((replace(hand, impulse=0.005),)))
    assert weak.model.actuator("right_index_pip").forcerange[1] == pytest.approx(0.3)


def test_it_stands_in_a_scene_beside_ours_and_weighs_nothing(mapping: RobotMapping) -> None:
    hands: tuple[SceneHand, ...] = (RobotHand("robot", mapping), Hand("right"))
    scene = Scene(SceneSpec(hands))
    data = mujoco.MjData(scene.model)
    q = np.zeros(POSE_SIZE)
    q[2] = 0.2
    for i, hand in enumerate(hands):
        data.qpos[scene.qpos_slice(i)] = scene.pose_to_qpos(i, q)
        data.ctrl[scene.control_slice(i)] = hand.controls(q)
    mujoco.mj_forward(scene.model, data)
    still = data.qpos.copy()
    mujoco.mj_step(scene.model, data, 200)
    no_warning(data)
    assert np.allclose(data.qpos, still, atol=2e-3)


def test_the_side_of_a_hand_depends_on_no_size_place_turn_or_length_and_changes_in_a_mirror() -> (
    None
):
    across = np.array([-0.03, -0.01, 0.01, 0.03])[:, None] * np.array([1.0, 0.0, 0.0])
    # Knuckles, and tips of straight and of bent fingers of a right hand.
    right = np.array([[0.0, 0.0, 0.0], [0.0, 0.09, 0.0], [0.0, 0.03, -0.06]])[:, None] + across
    moved = 1.7 * right @ exp(np.array([0.4, -1.2, 2.0])).T + [0.3, 0.1, -0.2]
    assert volume(*moved) == pytest.approx(volume(*right)) and volume(*right) > 0
    assert volume(*(right * [-1.0, 1.0, 1.0])) == pytest.approx(-volume(*right))
    longer = right[:1] + [[[1.0]], [[1.4]], [[1.4]]] * (right - right[:1])
    assert volume(*longer) == pytest.approx(volume(*right))


@pytest.mark.parametrize("fingers", [3, 4, 5])
@pytest.mark.parametrize("side", ["right", "left"])
def test_the_side_is_found_and_a_hand_with_fewer_fingers_lacks_the_last_ones(
    fingers: int, side: str, tmp_path: Path
) -> None:
    path = hinge_hand(tmp_path, side, tips=fingers)
    fitted = fit_mapping(path, TIPS[:fingers])
    assert fitted.mapping.side == side and fitted.other_side > 5 * fitted.side
    assert fingers < 5 or fitted.mirrored > 2 * fitted.shape
    path.with_suffix(".toml").write_text(fitted.mapping.as_toml())
    person = ADULT if side == "right" else ADULT.mirrored()
    hand = RobotHand(side, find_robot(str(path)), person)
    assert {link.finger for link in hand.links} == set(range(fingers))
    retargeter = hand.retargeter()
    retargeter.follow(np.zeros(POSE_SIZE), {0, 1, 4})
    assert retargeter.missed == {4} - set(range(fingers)) and len(retargeter.off) == fingers
    retargeter.follow(np.zeros(POSE_SIZE), {0, 1})
    assert retargeter.missed == frozenset()
    q = np.zeros(POSE_SIZE)
    off = np.linalg.norm(held_tips(hand, q) - hand.tips_of()(q)[:fingers], axis=1)
    assert off.max() < 0.005


def test_hands_of_mujoco_menagerie_are_looked_for_where_robot_descriptions_keeps_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(tmp_path))
    for robot, file in (("allegro", "wonik_allegro"), ("leap", "leap_hand")):
        mapping = find_robot(robot)
        with pytest.raises(InputError, match=f"git clone .* {tmp_path}/mujoco_menagerie"):
            _ = mapping.path
        model = tmp_path / "mujoco_menagerie" / file / "right_hand.xml"
        model.parent.mkdir(parents=True)
        model.write_text("<mujoco/>")
        assert mapping.path == model


def test_a_mapping_is_read_as_it_was_written(mapping: RobotMapping, tmp_path: Path) -> None:
    file = tmp_path / "again.toml"
    file.write_text(mapping.as_toml())
    again = load_mapping(file)
    assert replace(again, file=mapping.file).as_toml() == mapping.as_toml()


def test_another_model_or_mapping_has_another_digest(mapping: RobotMapping, tmp_path: Path) -> None:
    hand = RobotHand("right", mapping)
    assert hand.digest == RobotHand("left too", mapping).digest
    longer = replace(mapping, scales=(1.5, *mapping.scales[1:]))
    assert RobotHand("right", longer).digest != hand.digest
    path = hinge_hand(tmp_path)
    path.write_text(path.read_text().replace('range="0 95"', 'range="0 94"', 1))
    other = replace(mapping, file=str(path.with_suffix(".toml")))
    assert RobotHand("right", other).digest != hand.digest


@pytest.mark.needs("robots")
@pytest.mark.parametrize("robot", ["shadow", "adroit"])
def test_the_mappings_that_ship_are_those_of_the_fit(robot: str) -> None:
    ships = find_robot(robot)
    fit = fit_mapping(ships.path, ships.tips, model=ships.model)
    assert fit.other_side > 5 * fit.side
    fitted = fit.mapping
    assert np.allclose(fitted.offset, ships.offset, atol=1e-4)
    assert np.allclose(fitted.turn, ships.turn, atol=1e-3)
    assert (fitted.scales, fitted.radii, fitted.side) == (ships.scales, ships.radii, ships.side)
    assert fitted.coupled == {
        name: (other, pytest.approx(ratio)) for name, (other, ratio) in ships.coupled.items()
    }


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"thumb_tip", ', ""),
        ('palm = "palm"', 'palm = "fist"'),
        ("index_tip", "index_top"),
        ('side = "right"', 'side = "upper"'),
        ("tips = [", "tips = "),
        ("scales = [", 'scales = ["long", '),
        ("right_hinges.xml", "wrong_hinges.xml"),
        ("right_hinges.xml", "no_such_hands:hand.xml"),
        ("radii = [", "places = [[0, 0, 0]]\nradii = ["),
        ("offset = [", "offset = [nan, 0, 0]\n#"),
        ("turn = [", 'coupled.ring_dip = ["ring_pip", 0.0]\nturn = ['),
    ],
)
def test_a_wrong_mapping_is_one_clear_error(
    old: str, new: str, mapping: RobotMapping, tmp_path: Path
) -> None:
    file = hinge_hand(tmp_path).with_suffix(".toml")
    file.write_text(mapping.as_toml())
    with pytest.raises(InputError) as error:
        _ = RobotHand("right", find_robot(str(edited(file, (old, new))))).robot
    assert "\n" not in str(error.value)


def test_a_robot_whose_bodies_and_joints_have_names_of_ours_is_the_same_hand(
    mapping: RobotMapping, tmp_path: Path
) -> None:
    path = hinge_hand(tmp_path)
    links = [
        (f'"{finger}_{old}"', f'"{finger}_{new}"')
        for old, new in (("near", "link0"), ("middle", "link1"), ("far", "link2"))
        for finger in FINGERS
    ]
    edited(path, *links, ('"index_spread"', '"root"'), ('"ring_spread"', '"root_x"'))
    named = fit_mapping(path, TIPS, model=path.name).mapping
    ours, theirs = RobotHand("right", named), RobotHand("right", mapping)
    for q in people_s_poses(3):
        # The other mapping was read from a file of nine digits.
        np.testing.assert_allclose(held_tips(ours, q), held_tips(theirs, q), atol=1e-8)


def test_a_joint_s_greatest_torque_is_that_of_all_its_actuators_within_its_own_limit(
    tmp_path: Path,
) -> None:
    motors = (
        ("index_mcp", 'gear="5" forcerange="-1 1"'),
        ("ring_pip", 'forcerange="-2 0.1"'),
        ("middle_mcp", 'forcerange="-1 1"'),
        ("middle_mcp", 'gear="-2" forcerange="0 1"'),
        ("ring_mcp", 'forcerange="-1 1"'),
        ("ring_mcp", ""),
        ("thumb_mcp", 'gear="2" ctrlrange="-.5 1.5"'),
    )
    extra = "".join(f'<motor joint="{joint}" {said}/>' for joint, said in motors)
    path = edited(
        hinge_hand(tmp_path, extra=f"<actuator>{extra}</actuator>"),
        ('name="little_mcp"', 'name="little_mcp" actuatorfrcrange="-.3 .3"'),
    )
    robot = RobotModel(path, "palm", TIPS)
    torque = dict(zip(robot.joint_names(), robot.force_limits(), strict=True))
    assert {name: value for name, value in torque.items() if np.isfinite(value)} == {
        "thumb_mcp": 3.0,
        "index_mcp": 5.0,
        "index_pip": 0.7,
        "ring_pip": 2.0,
        "middle_mcp": 3.0,
        "little_mcp": 0.3,
    }


@pytest.mark.parametrize(
    ("changes", "tips"),
    [
        ([], TIPS[:2]),
        ([], (*TIPS, TIPS[0])),
        ([], (TIPS[0], TIPS[1], TIPS[1])),
        ([('<site name="index_tip"', "<site")], TIPS),
        ([('range="0 90"', 'range="90 0"')], TIPS),
        ([('<body name="palm">', "<body>")], TIPS),
    ],
)
def test_models_that_are_no_hands_are_refused(
    changes: list[tuple[str, str]], tips: tuple[str, ...], tmp_path: Path
) -> None:
    path = edited(hinge_hand(tmp_path), *changes)
    with pytest.raises(InputError):
        fit_mapping(path, tips)
    path.write_text("no model")
    for read in (lambda: fit_mapping(path, TIPS), lambda: find_robot(str(path))):
        with pytest.raises(InputError):
            read()
