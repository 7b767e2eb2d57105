"""A mechanism moves as its description says, is measured as geometry says, and is refused in one
line where it is none."""

from __future__ import annotations

from re import sub
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import InputError
from models.hand import Hand
from models.mechanism import Mechanism
from models.objects import Box
from models.scene import Scene, SceneSpec
from tasks.sensing import Sensing

BOX = '<geom type="box" size=".05 .045 .012"/>'
DESK = """<mujoco><asset>
 <mesh name="wedge" vertex="0 0 0 .02 0 0 0 .02 0 0 0 .02"/>
</asset><worldbody><body>
 <geom type="box" size=".06 .05 .002" pos="0 0 .002"/>
 <body name="drawer" pos="0 0 .02">
  <joint type="slide" axis="0 -1 0" range="0 .06" frictionloss=".5" damping="2" armature=".05"/>
  <geom type="box" size=".05 .045 .012"/>
  <geom type="cylinder" size=".006 .012" pos="0 -.055 .012" euler="30 20 0"/>
  <body name="lid" pos=".01 .05 .03">
   <joint type="hinge" axis="1 0 0" pos="0 .002 .001" range="0 100" frictionloss=".05"
    armature="1e-4"/>
   <geom type="box" size=".06 .05 .002" pos="0 -.05 0"/>
   <geom type="capsule" size=".004 .02" pos=".03 -.05 .008"/>
   <geom type="sphere" size=".006" pos="-.03 -.05 .008"/>
   <geom type="ellipsoid" size=".01 .02 .005" pos="0 -.08 .006"/>
   <geom type="mesh" mesh="wedge" pos="0 -.05 .003"/>
  </body>
 </body>
</body></worldbody></mujoco>"""


def built(**values: Any) -> tuple[Mechanism, Scene, mujoco.MjData]:
    desk = Mechanism("desk", DESK, **values)
    scene = Scene(SceneSpec((Hand(),), desk.parts))
    data = mujoco.MjData(scene.model)
    mujoco.mj_forward(scene.model, data)
    return desk, scene, data


@settings(max_examples=15, deadline=None)
@given(
    out=st.floats(0.0, 0.06),
    opened=st.floats(0.0, 1.7),
    yaw=st.floats(-3.0, 3.0),
    size=st.sampled_from([1.0, 0.5, 2.0]),
)
def test_every_part_starts_where_it_says_and_as_if_its_joint_had_moved_there(
    out: float, opened: float, yaw: float, size: float
) -> None:
    start = {"drawer": size * out, "lid": opened}
    place = {"position": (0.1, -0.05, 0.01), "yaw": yaw, "size": size}
    desk, scene, data = built(**place, start=start)
    _, moved, there = built(**place)
    for name, value in start.items():
        there.joint(f"desk/{name}").qpos[:] = value
    mujoco.mj_forward(moved.model, there)
    for part in desk.parts:
        for found in (scene.object_pose(data, part.name), moved.object_pose(there, part.name)):
            np.testing.assert_allclose(found[0], part.position, atol=1e-8)
            yaw_found = np.arctan2(found[1][1, 0], found[1][0, 0])
            assert yaw_found == pytest.approx(part.yaw, abs=1e-7)
    np.testing.assert_allclose(
        built(**place)[0].part("drawer").placed(size * out)[0],
        desk.part("drawer").position,
        atol=1e-12,
    )
    sensing = Sensing(scene, data)
    assert sensing.joint("desk/drawer").share == pytest.approx(out / 0.06, abs=1e-6)
    assert sensing.joint("desk/lid").position == pytest.approx(opened, abs=1e-6)


@pytest.mark.parametrize("size", [1.0, 0.5, 2.0])
def test_the_lowest_point_of_a_part_is_as_high_as_mujoco_measures_it(size: float) -> None:
    desk = Mechanism("desk", DESK, (0.1, -0.05, 0.01), 0.4, {"lid": 1.1}, size)
    floor = Box("floor", (4.0, 4.0, 0.5), 1.0, (0.0, 0.0, -1.0))
    scene = Scene(SceneSpec((), (*desk.parts, floor)))
    model, data = scene.model, mujoco.MjData(scene.model)
    mujoco.mj_kinematics(model, data)
    top = model.geom("floor").id
    for part in desk.parts:
        geoms = np.flatnonzero(model.geom_bodyid == scene.object_bodies[part.name])
        far = min(mujoco.mj_geomDistance(model, data, g, top, 10.0, None) for g in geoms)
        assert part.lowest == pytest.approx(far - 0.5, abs=2e-5)


@pytest.mark.parametrize("size", [1.0, 0.5, 2.0])
def test_clearance_is_what_mujoco_measures_from_outside(size: float) -> None:
    desk, scene, data = built(yaw=0.4, start={"lid": 1.0}, size=size)
    spec = mujoco.MjSpec.from_string(scene.xml)
    probe = spec.worldbody.add_body(name="ball", mocap=True)
    probe.add_geom(name="ball", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[1e-4, 0.0, 0.0])
    model = spec.compile()
    there = mujoco.MjData(model)
    rng = np.random.default_rng(5)
    points = size * rng.uniform([-0.1, -0.1, 0.0], [0.1, 0.1, 0.15], (60, 3))
    for part in desk.parts:
        body = model.body(part.name).id
        geoms = np.flatnonzero(model.geom_bodyid == body).tolist()
        expected = []
        for point in points:
            there.mocap_pos[0] = point
            mujoco.mj_kinematics(model, there)
            ball = model.geom("ball").id
            far = [mujoco.mj_geomDistance(model, there, g, ball, 1.0, None) for g in geoms]
            expected.append(min(far) + 1e-4)
        measured = part.clearance(points, *scene.object_pose(data, part.name))
        outside = np.array(expected) > 1e-4
        np.testing.assert_allclose(measured[outside], np.array(expected)[outside], atol=3e-5)
        assert np.all(measured[~outside] < 2e-4)
        assert outside.sum() > 30


@pytest.mark.parametrize("where", ['frictionloss=".5" damping="2"', 'frictionloss=".05"'])
@pytest.mark.parametrize("resistance", [1.0, 2.5])
def test_springs_and_dampers_of_higher_order_are_those_of_the_description(
    where: str, resistance: float
) -> None:
    curved = DESK.replace(where, 'frictionloss=".5" stiffness="1 2000 30" damping="2 0 7"')
    alone = mujoco.MjModel.from_xml_string(curved)
    parts = Mechanism("desk", curved, resistance=resistance).parts
    model = Scene(SceneSpec((), parts)).model
    for of_joints in ("jnt_stiffness", "jnt_stiffnesspoly", "dof_damping", "dof_dampingpoly"):
        described = getattr(alone, of_joints)
        assert np.any(described)
        np.testing.assert_allclose(getattr(model, of_joints), resistance * described)


def test_parts_of_one_mechanism_meet_only_through_their_joints_and_never_the_table() -> None:
    scene = Scene(SceneSpec((), Mechanism("desk", DESK, start={"lid": 0.0}).parts))
    data = mujoco.MjData(scene.model)
    for _ in range(20):
        mujoco.mj_step(scene.model, data, 10)
        assert data.ncon == 0


def test_a_box_on_a_fixed_mechanism_rests_on_its_parts_and_not_on_the_table() -> None:
    box = Box("box", (0.01, 0.01, 0.01), 0.1, (0.04, -0.04, 0.046))
    scene = Scene(SceneSpec((), (*Mechanism("desk", DESK).parts, box)))
    data = mujoco.MjData(scene.model)
    mujoco.mj_step(scene.model, data, 300)
    sensing = Sensing(scene, data)
    assert sensing.touching("box", "desk/lid") or sensing.touching("box", "desk/drawer")
    assert not sensing.object("box").on_table


def test_a_free_mechanism_falls_with_all_that_it_carries() -> None:
    free = DESK.replace("<body>", "<body><freejoint/>", 1)
    crate = Mechanism("crate", free, (0.0, 0.0, 0.1))
    scene = Scene(SceneSpec((), crate.parts))
    data = mujoco.MjData(scene.model)
    mujoco.mj_step(scene.model, data, 500)
    low = scene.object_pose(data, "crate")[0][2]
    assert low < 0.01 and Sensing(scene, data).object("crate").on_table
    assert scene.object_pose(data, "crate/drawer")[0][2] == pytest.approx(low + 0.02, abs=0.002)


BASE = '<geom type="box" size=".06 .05 .002" pos="0 0 .002"/>'
MASSLESS = BASE.replace("/>", ' mass="0"/>')


@pytest.mark.parametrize("base", ["", MASSLESS, f"<body>{MASSLESS}</body>"])
def test_a_fixed_base_needs_neither_mass_nor_geoms(base: str) -> None:
    light = Mechanism("desk", DESK.replace(BASE, base))
    heavy = Mechanism("desk", DESK)
    ends = []
    for desk in (light, heavy):
        scene = Scene(SceneSpec((), desk.parts))
        data = mujoco.MjData(scene.model)
        for name in ("desk/drawer", "desk/lid"):
            data.joint(name).qvel[:] = 1.0
        mujoco.mj_step(scene.model, data, 100)
        assert Sensing(scene, data).object("desk").speed == 0.0
        ends.append(data.qpos.copy())
    assert np.any(np.abs(ends[0]) > 0.01)
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


def test_what_moves_needs_a_mass_also_on_a_base_without_one() -> None:
    nothing = DESK.replace(BASE, "").replace("<geom", '<geom mass="0"')
    with pytest.raises(InputError, match=r"mass and inertia of moving .*'(drawer|lid)'"):
        Mechanism("desk", nothing)


DRAWER = '<joint type="slide" axis="0 -1 0" range="0 .06" frictionloss=".5"'


@pytest.mark.parametrize(
    "mjcf",
    [
        "nowhere.xml",
        "<mujoco><worldbody><bdy/></worldbody></mujoco>",
        f"<mujoco><worldbody><body>{BOX}</body><body>{BOX}</body></worldbody></mujoco>",
        DESK.replace('range="0 .06"', ""),
        DESK.replace('range="0 .06"', 'range="0 60"'),
        *(
            sub(f' {part}="[^"]*"', f' {part}="{value}"', DESK, count=1)
            for part in ("damping", "frictionloss", "armature")
            for value in ("-1e-06", "nan")
        ),
        DESK.replace(' name="lid"', ""),
        DESK.replace('type="hinge" axis="1 0 0"', 'type="ball"'),
        DESK.replace(DRAWER, f"{DRAWER}/>{DRAWER}"),
        DESK.replace("</worldbody>", '</worldbody><actuator><motor joint="j"/></actuator>').replace(
            '<joint type="slide"', '<joint name="j" type="slide"'
        ),
    ],
)
def test_what_is_no_mechanism_is_refused_in_one_line(mjcf: str) -> None:
    with pytest.raises(InputError) as refused:
        Mechanism("desk", mjcf)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "values",
    [
        *({"name": name} for name in ("table", "two\nlines")),
        *({"size": 0.0}, {"resistance": -1.0}),
        *({"position": place} for place in ((0.1, 0.2), 0.1)),
        *({"start": start} for start in ({"door": 0.0}, {"drawer": 0.07}, {"lid": 80.0})),
    ],
)
def test_values_out_of_range_are_refused(values: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        Mechanism(**{"name": "desk", "mjcf": DESK, **values})


def test_a_joint_without_end_stops_turns_on_and_has_no_share() -> None:
    wheel = """<mujoco><worldbody><body><geom size=".01"/><body name="wheel" pos="0 0 .03">
      <joint type="hinge" axis="0 0 1" limited="false"/><geom type="cylinder" size=".02 .01"/>
    </body></body></worldbody></mujoco>"""
    stand = Mechanism("stand", wheel)
    scene = Scene(SceneSpec((), stand.parts))
    data = mujoco.MjData(scene.model)
    data.joint("stand/wheel").qvel[:] = 20.0
    mujoco.mj_step(scene.model, data, 500)
    state = Sensing(scene, data).joint("stand/wheel")
    assert state.position > 15.0 and state.joint.range is None
    with pytest.raises(InputError, match=r"no share of its range. Use .position, in rad"):
        _ = state.share


def beside(distance: float, skin: float = 0.0) -> tuple[float, bool, float]:
    """A fingertip at rest above a part, m from its surface: the force between them in N, whether a
    task sees that the finger touches the part, and the height of its surface by its clearance, m.
    """
    mjcf = f"""<mujoco><worldbody><body>
     <geom size=".01" contype="0" conaffinity="0"/><body name="key">
     <joint type="slide" axis="0 0 -1" range="0 .01" armature="1"/>
     <geom type="box" size=".3 .3 .01" margin="{skin}"/></body></body></worldbody></mujoco>"""
    keys = Mechanism("keys", mjcf, (0.0, 0.0, 0.1))
    scene = Scene(SceneSpec((Hand(),), keys.parts))
    scene.set_solid(0, frozenset({1}))
    model, data = scene.model, mujoco.MjData(scene.model)
    height = data.qpos[scene.qpos_slice(0)][2:3]
    height[:] = 0.5
    mujoco.mj_kinematics(model, data)
    (key,) = np.flatnonzero(model.geom_bodyid == model.body("keys/key").id).tolist()
    solid = [geom for geom in scene.parts(0) if model.geom_contype[geom]]
    far = min(mujoco.mj_geomDistance(model, data, geom, key, 1.0, None) for geom in solid)
    height -= far - skin - distance
    mujoco.mj_forward(model, data)
    sensing = Sensing(scene, data)
    force = float(np.linalg.norm(sensing.force("keys/key", "right")))
    told = sensing.fingers("keys/key") == {("right", 1)}
    apart = keys.part("key").clearance([0.0, 0.0, 0.2], np.array([0.0, 0.0, 0.1]), np.eye(3))
    return force, told, 0.2 - float(apart[0]) - 0.1


@pytest.mark.parametrize("skin", [0.0, 0.0005, 0.002])
def test_a_finger_touches_a_part_from_half_a_millimetre_on_and_pushes_it_from_its_surface_on(
    skin: float,
) -> None:
    for distance in (0.00045, 0.00025, 1e-6):
        force, told, _ = beside(distance, skin)
        assert told and force == 0.0
    assert not beside(0.0006, skin)[1]
    force, told, top = beside(-1e-5, skin)
    assert told and force > 0.0
    assert top == pytest.approx(0.01 + skin)


@given(
    axis=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: sum(map(abs, a)) > 0.1),
    place=st.tuples(*[st.floats(-0.05, 0.05)] * 3),
    speed=st.floats(-3.0, 3.0),
)
@settings(max_examples=15)
def test_the_speed_of_a_part_on_a_hinge_is_that_of_its_origin(
    axis: tuple[float, float, float], place: tuple[float, float, float], speed: float
) -> None:
    hinge = f'axis="{" ".join(map(str, axis))}" pos="{" ".join(map(str, place))}" range="-90 90"'
    mjcf = (
        f'<mujoco><worldbody><body>{BOX}<body name="lid" pos="0 0 .3"><joint {hinge}/>{BOX}'
        "</body></body></worldbody></mujoco>"
    )
    parts = Mechanism("case", mjcf).parts
    scene = Scene(SceneSpec((Hand(),), parts))
    data = mujoco.MjData(scene.model)
    data.qvel[scene.model.joint("case/lid").dofadr[0]] = speed
    mujoco.mj_forward(scene.model, data)
    velocity = np.empty(6)
    body = scene.object_bodies["case/lid"]
    mujoco.mj_objectVelocity(scene.model, data, mujoco.mjtObj.mjOBJ_XBODY, body, velocity, 0)
    sensed = Sensing(scene, data).object("case/lid").speed
    assert sensed == pytest.approx(np.linalg.norm(velocity[3:]), abs=1e-9)
