"""Scenes stand still when nobody touches them, and what is no solid finger changes nothing."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.pinch import pinch_poses
from models.errors import SceneError
from models.hand import CONTACT_HAND, SERVOS, Hand
from models.mechanism import Mechanism
from models.objects import Box, Cylinder, SceneObject, Tray, Wrench
from models.scene import CONTROL_PERIOD, Scene, SceneSpec
from models.skeleton import ADULT
from tests.support.simulation import CUBE, TIMESTEPS, pinched, put, run

AWAY = np.concatenate([[0.0, 0.0, 0.30], np.zeros(45)])
"""A pose high above whatever is on the table."""

BOXES = (
    CUBE,
    Box("low", (0.04, 0.02, 0.01), 0.05, (0.12, 0.05, 0.01), -0.4),
    Box("heavy", (0.03, 0.03, 0.03), 0.5, (-0.12, -0.04, 0.03), 1.0),
)


def table_with(*boxes: Box, timestep: float = 0.002) -> tuple[Scene, mujoco.MjData]:
    """Boxes on the table, and a ghost hand high above them."""
    scene = Scene(SceneSpec((Hand(),), boxes, timestep=timestep))
    data = mujoco.MjData(scene.model)
    put(scene, data, AWAY)
    scene.set_solid(0, frozenset())
    return scene, data


def places(scene: Scene, data: mujoco.MjData) -> np.ndarray:
    """(n, 12) m and rotations of all objects."""
    poses = [scene.object_pose(data, b.name) for b in scene.spec.objects]
    return np.array([np.concatenate([p, r.ravel()]) for p, r in poses]).reshape(-1, 12)


def arrays(model: mujoco.MjModel) -> dict[str, np.ndarray]:
    """Copies of all arrays of a model."""
    values = {name: getattr(model, name) for name in dir(model) if not name.startswith("_")}
    return {k: v.copy() for k, v in values.items() if isinstance(v, np.ndarray)}


@pytest.mark.parametrize("timestep", TIMESTEPS)
@pytest.mark.parametrize("count", range(4))
@pytest.mark.parametrize("servo", SERVOS)
def test_a_scene_of_any_number_of_boxes_runs_at_any_timestep_without_a_warning(
    servo: str, count: int, timestep: float
) -> None:
    scene = Scene(SceneSpec((Hand(servo=servo),), BOXES[:count], timestep=timestep))
    data = mujoco.MjData(scene.model)
    put(scene, data, AWAY)
    run(scene, data, 0.5)
    assert scene.model.nv == 48 + 6 * count
    assert data.time == pytest.approx(0.5)
    assert scene.substeps * timestep == pytest.approx(CONTROL_PERIOD)


@pytest.mark.parametrize("timestep", TIMESTEPS)
def test_boxes_on_the_table_stay_where_they_are(timestep: float) -> None:
    scene, data = table_with(*BOXES, timestep=timestep)
    run(scene, data, 0.5)
    before = places(scene, data)
    run(scene, data, 5.0)
    assert np.abs(places(scene, data) - before)[:, :3].max() < 0.00005


@pytest.mark.parametrize("timestep", TIMESTEPS)
@pytest.mark.parametrize("servo", SERVOS)
def test_a_box_between_two_fingers_is_lifted_and_stays_between_them(
    servo: str, timestep: float
) -> None:
    scene, data, closed = pinched(timestep=timestep, servo=servo)
    lifted = closed + 0.05 * np.eye(48)[2]
    for share in np.linspace(0.0, 1.0, 30):
        data.ctrl[:] = closed + share * (lifted - closed)
        run(scene, data, CONTROL_PERIOD)
    run(scene, data, 0.5)
    before = places(scene, data)[0]
    assert before[2] == pytest.approx(CUBE.position[2] + 0.05, abs=0.002)
    run(scene, data, 5.0)
    after = places(scene, data)[0]
    assert np.linalg.norm(after[:3] - before[:3]) < 0.0002
    assert np.rad2deg(np.abs(after[3:] - before[3:]).max()) < 1.0


def boxes_while_a_ghost(passes: bool) -> np.ndarray:
    """(T, n) m and m/s, what the boxes do while a ghost goes through one, or stays away."""
    scene, data = table_with(*BOXES)
    # MuJoCo decides for all bodies at once whether its solver starts from the last step's answer,
    # so that a hand anywhere reaches the last digits of a box; without that, nothing is left.
    scene.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_WARMSTART
    opened, closed = pinch_poses(CUBE, squeeze=0.010)
    inside = np.inf
    states = []
    for pose in (opened, closed, closed + 0.04 * np.eye(48)[0], closed - 0.02 * np.eye(48)[2]):
        data.ctrl[:] = pose if passes else AWAY
        for _ in range(40):
            run(scene, data, CONTROL_PERIOD)
            states.append(np.concatenate([data.qpos[63:], data.qvel[48:]]))
            tip = data.geom("right_index_dip").xpos
            inside = min(inside, *CUBE.clearance(tip[None], *scene.object_pose(data, "box")))
    assert (inside < -0.001) == passes
    return np.array(states)


def test_a_ghost_passes_through_a_box_without_changing_a_bit_of_its_state() -> None:
    np.testing.assert_array_equal(boxes_while_a_ghost(True), boxes_while_a_ghost(False))


@pytest.mark.parametrize("fingers", [frozenset(), frozenset({0, 1}), frozenset(range(5))])
@pytest.mark.parametrize("whole", [False, True])
def test_what_is_solid_changes_bits_of_the_hands_own_bones_and_nothing_else(
    fingers: frozenset[int], whole: bool
) -> None:
    scene = Scene(SceneSpec((Hand("a"), Hand("b")), BOXES))
    before = arrays(scene.model)
    scene.set_solid(1, fingers, whole=whole)
    after = arrays(scene.model)
    different = [n for n in before if not np.array_equal(before[n], after[n])]
    # All bones are compiled as solid.
    assert different == ([] if whole and fingers else ["geom_contype"])
    hand = scene.spec.hands[1]
    outer = ("thumb_mcp", "index_dip", "middle_dip", "ring_dip", "little_dip")
    for bone, link in zip(hand.skeleton.bones, hand.links, strict=True):
        solid = bool(fingers) if whole else bone.name in [outer[f] for f in fingers]
        geom = scene.model.geom(link.geom).id
        assert after["geom_contype"][geom] == (CONTACT_HAND if solid else 0)
    others = [i for i in range(scene.model.ngeom) if not scene.model.geom(i).name.startswith("b_")]
    np.testing.assert_array_equal(before["geom_contype"][others], after["geom_contype"][others])


def test_no_hand_meets_the_table_or_itself() -> None:
    scene, data = table_with()
    tangle = np.concatenate([[0.0, 0.0, 0.01], np.zeros(3), ADULT.lower])
    scene.set_solid(0, frozenset(range(5)), whole=True)
    put(scene, data, tangle)
    run(scene, data, 0.5)
    ring, little = (scene.model.geom(f"right_{name}_pip").id for name in ("ring", "little"))
    apart = mujoco.mj_geomDistance(scene.model, data, ring, little, 1.0, None)
    assert apart < -0.001, "two fingers are meant to be in each other"
    assert data.body("right_index_dip").xpos[2] < -0.02, "and the hand in the table"
    assert data.ncon == 0
    np.testing.assert_allclose(
        data.qpos[scene.qpos_slice(0)], scene.pose_to_qpos(0, tangle), atol=1e-5
    )


@pytest.mark.parametrize(
    "timestep", [0.003, 0.005, 0.0161, 0.032, 1.0, 1e9, 0.0, -0.002, float("nan"), float("inf")]
)
def test_a_timestep_that_does_not_divide_the_control_period_is_refused(timestep: float) -> None:
    with pytest.raises(SceneError, match="whole number of physics steps"):
        Scene(SceneSpec((Hand(),), timestep=timestep))


@given(parts=st.integers(1, 64))
def test_a_timestep_that_divides_the_control_period_is_taken(parts: int) -> None:
    scene = Scene(SceneSpec((), (CUBE,), timestep=CONTROL_PERIOD / parts))
    assert scene.substeps == parts


OBJECTS: tuple[SceneObject, ...] = (
    Box("box", (0.02, 0.02, 0.02), 0.1, (0.0, 0.0, 0.02), friction=0.2),
    Cylinder("pin", 0.01, 0.02, 0.1, (0.1, 0.0, 0.02), friction=0.3),
    Wrench("wrench", 0.1, (0.0, 0.1, 0.01), bolt=0.1),
    Tray("tray", 0.1, (0.0, -0.2, 0.018)),
)
DESK = """<mujoco><worldbody><body name="desk"><geom size=".02" friction=".4"/>
  <body name="lid"><joint range="0 90"/><geom size=".01" friction=".6"/></body>
</body></worldbody></mujoco>"""


def test_of_objects_whose_friction_counts_every_part_goes_before_hand_and_table() -> None:
    objects = (*OBJECTS, *Mechanism("desk", DESK, position=(0.3, 0.0, 0.02)).parts)
    scene = Scene(SceneSpec((Hand(),), objects, own_friction=True))
    model = scene.model
    highest = max(model.geom_priority[g] for g in (*scene.parts(0), model.geom("table").id))
    for body in scene.object_bodies.values():
        assert model.geom_priority[model.geom_bodyid == body].min() > highest
    assert model.geom_friction[model.geom("box").id, 0] == 0.2
    assert model.geom_friction[model.geom("pin").id, 0] == 0.3
