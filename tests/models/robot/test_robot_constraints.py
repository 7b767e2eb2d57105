"""A robot's hand in a scene is the one in its model, and what it has otherwise is named."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from models.errors import InputError
from models.frames import FINGERS
from models.robot.constraints import coupling_laws
from models.robot.mapping import find_robot
from models.robot.mapping_fit import MappingFit, fit_mapping
from models.robot.robot_hand import RobotHand
from models.robot.robot_model import RobotModel
from tests.models.robot.hinge_hand import TIPS, edited, hinge_hand
from tests.support.robot_tips import greatest_distance


def fitted(path: Path, hand: str = "") -> MappingFit:
    return fit_mapping(path, TIPS, model=path.name, hand=hand)


@given(zeros=st.lists(st.floats(-1.5, 1.5), min_size=3, max_size=3))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=10)
def test_fingertips_are_where_the_model_has_them_whatever_the_zero_and_place_of_joints(
    zeros: list[float], tmp_path: Path
) -> None:
    path = edited(
        hinge_hand(tmp_path),
        *(
            (f'name="{name}"', f'name="{name}" ref="{np.rad2deg(zero):.9g}"')
            for name, zero in zip(("index_mcp", "thumb_pip", "ring_spread"), zeros, strict=True)
        ),
        ('name="index_dip"', 'name="index_dip" pos="0 -.004 .002"'),
        ('name="ring_far" pos="0 .028 0"', 'name="ring_far" pos="0 .028 0" euler="5 20 3"'),
    )
    hand = RobotHand("right", fitted(path, "right").mapping)
    assert greatest_distance(hand, 30) < 1e-6


@given(
    law=st.lists(st.floats(-0.3, 0.3), min_size=5, max_size=5),
    zeros=st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)),
)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=15)
def test_a_coupling_is_the_curve_that_mujoco_holds_the_joints_on(
    law: list[float], zeros: tuple[float, float], tmp_path: Path
) -> None:
    coupling = " ".join(f"{c:.9g}" for c in law)
    joints = f'joint1="index_dip" joint2="index_pip" polycoef="{coupling}"'
    path = edited(
        hinge_hand(tmp_path, extra=f"<equality><joint {joints}/></equality>"),
        ('name="index_dip"', f'name="index_dip" ref="{np.rad2deg(zeros[0]):.9g}"'),
        ('name="index_pip"', f'name="index_pip" ref="{np.rad2deg(zeros[1]):.9g}"'),
    )
    robot = RobotModel(path, "palm", TIPS)
    ((follower, other, found),) = coupling_laws(robot)
    assert (follower, other) == ("index_dip", "index_pip")
    data = mujoco.MjData(robot.model)
    for angle in np.linspace(0.0, 1.6, 7):
        data.joint("index_pip").qpos = angle
        data.joint("index_dip").qpos = sum(c * angle**i for i, c in enumerate(found))
        mujoco.mj_forward(robot.model, data)
        assert data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY] == (
            pytest.approx(0.0, abs=1e-8)
        )


@pytest.mark.parametrize(
    ("coupling", "angle"),
    (
        (
            '<equality><joint joint1="index_dip" joint2="index_pip" polycoef=".2 .1 .4 0 0"/>'
            "</equality>",
            lambda pip: 0.2 + 0.1 * pip + 0.4 * pip**2,
        ),
        (
            '<tendon><fixed name="t" limited="true" range=".299 .301">'
            '<joint joint="index_dip" coef="1"/><joint joint="index_pip" coef="-.5"/>'
            "</fixed></tendon>",
            lambda pip: 0.3 + 0.5 * pip,
        ),
    ),
)
def test_a_hand_moves_along_its_couplings_and_within_its_ranges(
    coupling: str, angle: Callable[[float], float], tmp_path: Path
) -> None:
    result = fitted(hinge_hand(tmp_path, extra=coupling))
    assert result.not_followed == ()
    hand = RobotHand("right", result.mapping)
    names, limits = hand.robot.joint_names(), hand.robot.limits()
    dip, pip = names.index("index_dip"), names.index("index_pip")
    retargeter, seen = hand.retargeter(), []
    rng = np.random.default_rng(3)
    for _ in range(30):
        q = np.zeros(48)
        q[6:] = rng.uniform(hand.person.lower, hand.person.upper)
        angles = retargeter.follow(q)[7:]
        assert angles[dip] == pytest.approx(angle(angles[pip]), abs=1e-8)
        assert np.all(angles >= limits[:, 0] - 2e-6) and np.all(angles <= limits[:, 1] + 2e-6)
        seen.append(angles[pip])
    assert np.ptp(seen) > 0.2


def test_an_equality_that_is_switched_off_couples_nothing(tmp_path: Path) -> None:
    path = hinge_hand(
        tmp_path,
        extra='<equality><joint joint1="index_dip" joint2="index_pip" active="false"/></equality>',
    )
    result = fitted(path)
    assert not result.mapping.coupled and result.not_followed == ()


@pytest.mark.parametrize(
    ("extra", "named"),
    (
        (
            '<equality><connect body1="index_far" body2="middle_far" anchor="0 0 0"/></equality>',
            "closed loops: index_far with middle_far",
        ),
        (
            '<equality><weld body1="index_far" body2="middle_far"/></equality>',
            "closed loops: index_far with middle_far",
        ),
        (
            '<equality><joint joint1="ring_dip"/></equality>',
            "joints held by an equality: ring_dip",
        ),
        (
            '<tendon><fixed name="wide" limited="true" range="0 1">'
            '<joint joint="ring_dip" coef="1"/><joint joint="ring_pip" coef="1"/></fixed></tendon>',
            "ranges of tendons: wide",
        ),
        (
            '<tendon><fixed name="soft" stiffness="3"><joint joint="ring_dip" coef="1"/>'
            "</fixed></tendon>",
            "springs of tendons: soft",
        ),
        (
            '<actuator><motor name="jet" site="ring_tip" gear="0 0 1 0 0 0"/></actuator>',
            "limits of actuators: jet",
        ),
    ),
)
def test_a_constraint_that_a_scene_does_not_have_is_named(
    extra: str, named: str, tmp_path: Path
) -> None:
    assert fitted(hinge_hand(tmp_path, extra=extra)).not_followed == (named,)


@pytest.mark.parametrize("kind", ("tendon", "both"))
def test_motors_on_tendons_limit_the_joints_that_they_pull(kind: str, tmp_path: Path) -> None:
    motors = '<motor tendon="pair" gear="2" forcerange="-3 3"/>'
    if kind == "both":
        motors += '<motor joint="ring_pip" forcerange="-1 1"/>'
    path = hinge_hand(
        tmp_path,
        extra='<tendon><fixed name="pair"><joint joint="ring_dip" coef=".5"/>'
        f'<joint joint="ring_pip" coef="-1"/></fixed></tendon><actuator>{motors}</actuator>',
    )
    robot = RobotModel(path, "palm", TIPS)
    torque = dict(zip(robot.joint_names(), robot.force_limits(), strict=True))
    assert torque["ring_dip"] == 3.0
    assert torque["ring_pip"] == (7.0 if kind == "both" else 6.0)


@pytest.mark.parametrize("side", ("right", "left"))
def test_the_side_of_a_hand_without_ranges_is_given_and_not_guessed(
    side: str, tmp_path: Path
) -> None:
    ranges = ('range="-25 25"', 'range="0 90"', 'range="0 95"', 'range="0 80"')
    path = edited(hinge_hand(tmp_path, side=side), *((part, "") for part in ranges))
    with pytest.raises(InputError, match="--hand right or --hand left"):
        fitted(path)
    mapping = fitted(path, side).mapping
    assert mapping.side == side
    assert all(map(np.isfinite, (*mapping.offset, *mapping.turn, *mapping.scales)))


@pytest.mark.parametrize("side", ("right", "left"))
@pytest.mark.parametrize("order", [(4, 3, 2, 1), (3, 2, 1), (1, 3, 2, 4), (2, 1)])
def test_fingertips_in_another_order_are_no_hand_of_the_other_side(
    side: str, order: tuple[int, ...], tmp_path: Path
) -> None:
    path = hinge_hand(tmp_path, side=side)
    tips = (TIPS[0], *(TIPS[finger] for finger in order))
    right = ",".join((TIPS[0], *(TIPS[finger] for finger in sorted(order))))
    with pytest.raises(InputError, match=f"another order.*--tips {right}"):
        fit_mapping(path, tips)
    assert fit_mapping(path, right.split(",")).mapping.side == side
    assert fit_mapping(path, tips, hand=side).mapping.side == side


def test_a_palm_in_the_world_is_the_same_hand(tmp_path: Path) -> None:
    own = fitted(hinge_hand(tmp_path)).mapping
    bodies = ('<body name="arm">', '<joint name="elbow" axis="1 0 0"/>', '<body name="palm">')
    ends = ("      </body>\n    </body>\n  </worldbody>", "  </worldbody>")
    world = fitted(edited(hinge_hand(tmp_path), *((part, "") for part in bodies), ends)).mapping
    assert world.palm == "world" and world.side == own.side
    np.testing.assert_allclose(world.turn, own.turn, atol=1e-6)
    assert greatest_distance(RobotHand("right", world), 30) < 1e-6


@pytest.mark.parametrize(
    ("factor", "unit"), ((1000.0, "millimetres"), (100.0, "centimetres"), (1 / 0.0254, "inches"))
)
def test_a_hand_in_another_unit_is_refused_with_the_unit(
    factor: float, unit: str, tmp_path: Path
) -> None:
    spec = mujoco.MjSpec.from_file(str(hinge_hand(tmp_path)))
    for body in spec.bodies:
        body.pos *= factor
        for geom in body.geoms:
            geom.pos *= factor
            geom.size *= factor
            geom.fromto *= factor
        for site in body.sites:
            site.pos *= factor
    spec.compile()
    path = tmp_path / "large.xml"
    path.write_text(spec.to_xml(), encoding="utf-8")
    with pytest.raises(InputError, match=f"lengths that no hand has.*{unit}"):
        fitted(path)


_INERTIAL = (
    '<inertial><mass value=".02"/>'
    '<inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def urdf_hand(folder: Path) -> Path:
    """Five fingers of three joints, the last following the middle one; palm and tips are fixed
    links."""
    bases = ("-.03 .03 -.008", "-.028 .09 0", "-.005 .093 0", ".018 .09 0", ".038 .08 0")
    parts = [
        f'<link name="base">{_INERTIAL}</link><link name="palm">{_INERTIAL}</link>'
        '<joint name="mount" type="fixed"><parent link="base"/><child link="palm"/></joint>'
    ]
    for label, base in zip(FINGERS, bases, strict=True):
        turn = ' rpy="-.43 0 .7"' if label == "thumb" else ""
        above, places = "palm", (f'xyz="{base}"{turn}', 'xyz="0 .045 0"', 'xyz="0 .028 0"')
        for link, place in zip(("near", "middle", "far"), places, strict=True):
            mimic = f'<mimic joint="{label}_middle" multiplier=".7" offset=".1"/>'
            parts.append(
                f'<link name="{label}_{link}_link">{_INERTIAL}</link>'
                f'<joint name="{label}_{link}" type="revolute"><parent link="{above}"/>'
                f'<child link="{label}_{link}_link"/><origin {place}/><axis xyz="-1 0 0"/>'
                '<limit lower="0" upper="1.5" effort=".5" velocity="3"/>'
                f"{mimic if link == 'far' else ''}</joint>"
            )
            above = f"{label}_{link}_link"
        parts.append(
            f'<link name="{label}_tip"/><joint name="{label}_end" type="fixed">'
            f'<parent link="{above}"/><child link="{label}_tip"/><origin xyz="0 .022 0"/></joint>'
        )
    path = folder / "hand.urdf"
    path.write_text(f'<robot name="hand">{"".join(parts)}</robot>', encoding="utf-8")
    return path


def test_a_urdf_keeps_its_fixed_links_and_follows_mimic_with_its_offset(tmp_path: Path) -> None:
    path = urdf_hand(tmp_path)
    result = fitted(path)
    assert result.mapping.palm == "palm" and result.mapping.side == "right"
    assert result.mapping.coupled["index_far"] == ("index_middle", pytest.approx((0.1, 0.7)))
    assert result.not_followed == ()
    path.with_suffix(".toml").write_text(result.mapping.as_toml(), encoding="utf-8")
    hand = RobotHand("right", find_robot(str(path)))
    assert greatest_distance(hand, 50) < 1e-6
    assert max(hand.robot.force_limits()) == 0.5


def test_a_urdf_with_inertias_that_no_body_can_have_is_read_and_they_are_named(
    tmp_path: Path,
) -> None:
    link, wrong = f'<link name="ring_far_link">{_INERTIAL}', _INERTIAL.replace("1e-5", "4e-5", 1)
    result = fitted(edited(urdf_hand(tmp_path), (link, link.replace(_INERTIAL, wrong))))
    assert result.not_followed == (
        "inertias that no body can have, made equal about all axes: ring_far_link",
    )
    assert greatest_distance(RobotHand("right", result.mapping), 30) < 1e-6


_SHAPE = '<{0}><geometry><mesh filename="{1}"/></geometry></{0}>'


@pytest.mark.parametrize(
    "file", ["package://some_robot/meshes/far.stl", "meshes/far.glb", "far.dae"]
)
@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_a_urdf_whose_shapes_cannot_be_read_is_read_without_them_and_they_are_named(
    file: str, kind: str, tmp_path: Path
) -> None:
    link = '<link name="index_far_link">'
    result = fitted(edited(urdf_hand(tmp_path), (link, link + _SHAPE.format(kind, file))))
    # MuJoCo itself leaves out what is only seen.
    names = ("shapes in files that MuJoCo cannot read: index_far_link",)
    assert result.not_followed == (names if kind == "collision" else ())
    assert greatest_distance(RobotHand("right", result.mapping), 30) < 1e-6


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ('joint="index_middle"', 'joint="nobody"', "warnings of MuJoCo: <mimic> on joint"),
        ('joint="index_middle"', 'joint="mount"', "warnings of MuJoCo: <mimic> on joint"),
        ('name="ring_far" type="revolute"', 'name="ring_far" type="planar"', "ring_far"),
        # MuJoCo drops the second name, so that the first joint follows two.
        ('name="ring_far"', 'name="index_far"', "couplings of joints: index_far with ring"),
        ('index_middle" multiplier=".7"', 'index_middle" multiplier="0"', "couplings of joints"),
    ],
)
def test_mimics_that_are_not_followed_are_named(
    old: str, new: str, named: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = edited(urdf_hand(tmp_path), (old, new))
    assert any(named in part for part in fitted(path).not_followed)
    assert capfd.readouterr().err == ""


def test_ranges_that_are_degrees_taken_for_radians_or_the_other_way_round_are_refused(
    tmp_path: Path,
) -> None:
    path = edited(urdf_hand(tmp_path), ('upper="1.5"', 'upper="86"'))
    with pytest.raises(InputError, match=r"got '86 rad as the median'.*written in degrees"):
        fitted(path)
    path = edited(
        hinge_hand(tmp_path),
        *((f'range="0 {most}"', f'range="0 {np.deg2rad(most):.4f}"') for most in (80, 90, 95)),
    )
    with pytest.raises(InputError, match="written in radians"):
        fitted(path)
