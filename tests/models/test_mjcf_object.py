"""A thing from MJCF is in a scene what its description says, and is measured as geometry says."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import tostring

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from models.arithmetic import Array
from models.errors import InputError
from models.hand import Hand
from models.mechanism import Mechanism
from models.mjcf_object import MjcfObject, described_files
from models.objects import mjcf_text
from models.scene import Scene, SceneSpec

SPHERE = '<geom type="sphere" size=".03"/>'
CAPSULE = '<geom type="capsule" size=".02 .03"/>'
BLOCK = '<geom type="box" size=".02 .03 .01"/>'
MESH_BLOCK = '<geom type="mesh" mesh="block"/>'
BLOCK_ASSET = (
    '<mesh name="block" vertex=".02 .03 .01 -.02 .03 .01 .02 -.03 .01 -.02 -.03 .01 '
    '.02 .03 -.01 -.02 .03 -.01 .02 -.03 -.01 -.02 -.03 -.01"/>'
)

TETRAHEDRON = """v 0 0 0
v .02 0 0
v 0 .02 0
v 0 0 .02
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
"""
"""A mesh as OBJ."""


def mjcf(inside: str, asset: str = "") -> str:
    return f"<mujoco><asset>{asset}</asset><worldbody><body>{inside}</body></worldbody></mujoco>"


def from_block(points: np.ndarray) -> np.ndarray:
    far = np.abs(points) - (0.02, 0.03, 0.01)
    return np.linalg.norm(np.maximum(far, 0), axis=1) + np.minimum(far.max(axis=1), 0)


def from_capsule(points: np.ndarray) -> np.ndarray:
    rest = points.copy()
    rest[:, 2] -= np.clip(rest[:, 2], -0.03, 0.03)
    return np.linalg.norm(rest, axis=1) - 0.02


KNOWN = {
    "sphere": (mjcf(SPHERE), lambda p: np.linalg.norm(p, axis=1) - 0.03),
    "capsule": (mjcf(CAPSULE), from_capsule),
    "box": (mjcf(BLOCK), from_block),
    "mesh": (mjcf(MESH_BLOCK, BLOCK_ASSET), from_block),
    "two": (
        mjcf(BLOCK + f'<body pos="0 0 0">{CAPSULE}</body>'),
        lambda p: np.minimum(from_block(p), from_capsule(p)),
    ),
}

POINTS = hnp.arrays(float, (4, 3), elements=st.floats(-0.08, 0.08))
TURNS = hnp.arrays(float, 4, elements=st.floats(-1, 1)).filter(lambda q: np.linalg.norm(q) > 0.1)


@pytest.mark.parametrize("shape", KNOWN)
@given(local=POINTS, turn=TURNS, size=st.sampled_from([1.0, 0.5, 2.0]))
def test_clearance_is_the_distance_that_geometry_gives(
    shape: str, local: Array, turn: Array, size: float
) -> None:
    text, distance = KNOWN[shape]
    thing = MjcfObject("thing", text, 0.1, size=size)
    flat = np.empty(9)
    mujoco.mju_quat2Mat(flat, turn / np.linalg.norm(turn))
    rotation, position = flat.reshape(3, 3), np.array([0.1, -0.2, 0.05])
    found = thing.clearance(size * local @ rotation.T + position, position, rotation)
    expected = size * distance(local)
    # Far inside a hull MuJoCo may name another way out than the nearest; outside it is exact.
    outside = expected > 0
    assert found[outside] == pytest.approx(expected[outside], abs=2e-5)
    assert np.all(found[~outside] < 2e-5)
    if shape in ("sphere", "box"):
        assert found == pytest.approx(expected, abs=2e-5)


@pytest.mark.parametrize("size", [1.0, 1.5])
def test_in_a_scene_it_is_the_body_that_was_described(size: float) -> None:
    inside = (
        '<geom type="cylinder" size=".02 .03" friction=".7"/><body pos=".04 0 .01" euler="0 90 10">'
        f'{BLOCK}<geom type="mesh" mesh="block" pos="0 .05 0" euler="20 30 40"/></body>'
    )
    thing = MjcfObject("thing", mjcf(inside, BLOCK_ASSET), 0.2, (0.1, 0.0, 0.3), 0.7, size=size)
    model = Scene(SceneSpec((Hand(),), (thing,))).model
    text = mjcf("<freejoint/>" + inside, BLOCK_ASSET)
    alone = mujoco.MjModel.from_xml_string(text)
    body = model.body("thing").id
    assert model.body_mass[body] == pytest.approx(0.2)
    # Two bodies there, one here: what they weigh and how they turn is compared as a whole.
    both = []
    for m, first in ((model, body), (alone, 1)):
        data = mujoco.MjData(m)
        start = m.jnt_qposadr[m.body_jntadr[first]]
        data.qpos[start : start + 7] = (0, 0, 0, 1, 0, 0, 0)
        mujoco.mj_forward(m, data)
        mass = m.body_subtreemass[first]
        dof = m.body_dofadr[first]
        full = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, data, full)
        inertia = full[dof : dof + 6, dof : dof + 6] / mass
        both.append((data.subtree_com[first], inertia))
    scale = np.repeat([1.0, size], 3)
    assert both[0][0] == pytest.approx(size * both[1][0])
    assert np.allclose(both[0][1], np.outer(scale, scale) * both[1][1], atol=1e-9)
    first = next(g for g in range(model.ngeom) if model.geom_bodyid[g] == body)
    assert model.geom_friction[first, 0] == pytest.approx(0.7)


@pytest.mark.parametrize("shape", KNOWN)
@pytest.mark.parametrize("size", [1.0, 1.7])
def test_on_the_table_it_rests_where_it_was_put(shape: str, size: float) -> None:
    thing = MjcfObject.on_table("thing", KNOWN[shape][0], 0.1, (0.03, 0.02), 0.4).scaled(size)
    scene = Scene(SceneSpec((), (thing,)))
    data = mujoco.MjData(scene.model)
    mujoco.mj_step(scene.model, data, 250)
    height = {"two": 0.05, "sphere": 0.03, "capsule": 0.05}.get(shape, 0.01)
    position, _ = scene.object_pose(data, "thing")
    assert position == pytest.approx((0.03, 0.02, size * height), abs=5e-4)


def test_a_visible_geom_without_collisions_is_not_solid() -> None:
    ghost = '<geom type="sphere" size=".2" contype="0" conaffinity="0"/>'
    thing = MjcfObject("thing", mjcf(SPHERE + ghost), 0.1)
    assert thing.clearance([[0.1, 0, 0]], np.zeros(3), np.eye(3)) == pytest.approx(0.07)
    assert thing.height == pytest.approx(0.03)
    model = Scene(SceneSpec((), (thing,))).model
    assert sorted(model.geom_contype[model.geom_bodyid == model.body("thing").id]) == [0, 6]


def test_a_file_with_its_mesh_beside_it_is_the_same_from_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tip.obj").write_text(TETRAHEDRON)
    path = tmp_path / "thing.xml"
    floor = '<geom type="plane" size="1 1 .1"/><light pos="0 0 1"/>'
    text = mjcf('<geom type="mesh" mesh="tip"/>', '<mesh name="tip" file="tip.obj"/>')
    path.write_text(text.replace("<worldbody>", f"<worldbody>{floor}"))
    monkeypatch.chdir("/")
    thing = MjcfObject("thing", path, 0.1)
    below = [[0.003, 0.003, -0.03]]
    assert thing.clearance(below, np.zeros(3), np.eye(3)) == pytest.approx(0.03, abs=1e-6)
    assert b"file" not in b"".join(map(tostring, thing.assets()))
    assert Scene(SceneSpec((), (thing,))).model.nmesh == 1


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<mujoco>", "cannot read"),
        (mjcf(""), "cannot read|nothing of it"),
        (mjcf('<geom type="mesh" mesh="none"/>'), "cannot read"),
        ("<mujoco><worldbody/></mujoco>", "one rigid body"),
        (mjcf(SPHERE).replace("</worldbody>", f"<body>{SPHERE}</body></worldbody>"), "one rigid"),
        (mjcf('<joint type="slide"/>' + SPHERE), "one rigid body .*joints: 1.*use Mechanism"),
        (mjcf('<geom size=".1" contype="0" conaffinity="0"/>'), "has no solid geom"),
        ("/no/such/file.xml", "no such file"),
    ],
)
def test_a_description_without_one_rigid_body_is_refused_with_a_one_line_error(
    text: str, says: str
) -> None:
    with pytest.raises(InputError, match=says) as error:
        MjcfObject("thing", text, 0.1)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "more",
    [
        '<contact><exclude body1="mug" body2="handle"/></contact>',
        '<sensor><framepos objtype="body" objname="handle"/></sensor>',
        '<contact><pair geom1="a" geom2="b"/></contact>',
    ],
)
def test_bodies_that_are_welded_are_one_whatever_else_names_them(more: str) -> None:
    welded = """<worldbody><body name="mug"><geom name="a" size=".02"/>
      <body name="handle" pos=".03 0 0"><geom name="b" size=".01"/></body></body></worldbody>"""
    plain, named = (
        MjcfObject("thing", f"<mujoco>{welded}{text}</mujoco>", 0.1) for text in ("", more)
    )
    assert tostring(named.body()) == tostring(plain.body())


def test_files_of_a_model_within_a_description_are_its_files_too(tmp_path: Path) -> None:
    (tmp_path / "inner" / "shapes").mkdir(parents=True)
    files = [tmp_path / "outer.xml", tmp_path / "inner/inner.xml", tmp_path / "inner/shapes/b.obj"]
    files[0].write_text(
        '<mujoco><asset><model name="in" file="inner/inner.xml"/></asset><worldbody><body>'
        f'{SPHERE}<attach model="in" body="part" prefix="in_"/></body></worldbody></mujoco>'
    )
    text = mjcf(MESH_BLOCK, '<mesh name="block" file="b.obj"/>').replace(
        "<mujoco>", '<mujoco><compiler meshdir="shapes"/>'
    )
    files[1].write_text(text.replace("<body", '<body name="part"'))
    files[2].write_text(TETRAHEDRON)
    MjcfObject("thing", files[0], 0.1)
    assert described_files(files[0]) == files
    # Folders of another machine, which MuJoCo is told to leave out.
    files[1].write_text(
        text.replace("shapes", 'shapes" strippath="true').replace("b.obj", "/x/b.obj")
    )
    MjcfObject("thing", files[1], 0.1)
    assert described_files(files[1]) == files[1:]


@pytest.mark.parametrize("kind", [Mechanism, partial(MjcfObject, mass=0.1)])
@pytest.mark.parametrize(
    ("inside", "file"),
    [
        ('<mesh name="a" file="a.obj"/>', "meshes/a.obj"),
        ('<texture name="a" type="2d" file="a.png"/>', "pictures/a.png"),
    ],
)
def test_a_file_that_a_description_lacks_is_named_with_the_folder_where_it_was_looked_for(
    kind: Callable[..., Any], inside: str, file: str, tmp_path: Path
) -> None:
    path = tmp_path / "thing.xml"
    folders = '<compiler meshdir="meshes" texturedir="pictures"/>'
    path.write_text(mjcf(SPHERE, inside).replace("<asset>", f"{folders}<asset>"))
    with pytest.raises(InputError) as refused:
        kind("thing", path)
    assert str(path) in str(refused.value) and file in str(refused.value)


@pytest.mark.parametrize(
    "wrong",
    [
        *({"mass": mass} for mass in (0.0, np.nan)),
        *({"name": name} for name in ("", "table")),
        *({"size": -1.0}, {"position": (0, 0)}),
    ],
)
def test_impossible_objects_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        MjcfObject(**{"name": "thing", "mjcf": mjcf(SPHERE), "mass": 0.1, **wrong})


@pytest.mark.parametrize("bits", ((2, 2), (1, 0), (0, 4), (2, 4), (-(2**31), 0)))
def test_any_collision_bit_makes_a_geom_solid(bits: tuple[int, int]) -> None:
    text = BLOCK.replace("/>", f' contype="{bits[0]}" conaffinity="{bits[1]}"/>')
    plain, other = (MjcfObject("thing", mjcf(part), 0.1) for part in (BLOCK, text))
    assert tostring(plain.body()) == tostring(other.body())


@pytest.mark.parametrize("shape", ['type="box" size=".02 .03 .01"', 'type="mesh" mesh="far"'])
@given(x=st.floats(1.5, 5.0), y=st.floats(-5.0, 5.0))
def test_an_object_beside_the_origin_of_its_body_is_refused_and_its_error_has_the_remedy(
    shape: str, x: float, y: float
) -> None:
    corners_mm = np.array([*product((-20, 20), (870, 930), (-10, 10))])
    vertices = mjcf_text(corners_mm.ravel())
    asset = f'<mesh name="far" scale=".001 .001 .001" vertex="{vertices}"/>'

    def at(place: np.ndarray) -> str:
        return mjcf(f'<geom {shape} pos="{mjcf_text(place)}" quat="1 0 0 1"/>', asset)

    place = np.array([x, y, 0.0])
    with pytest.raises(InputError, match="not at the origin") as error:
        MjcfObject("thing", at(place), 0.1)
    offset = re.search(r"Subtract \((.*)\) m", str(error.value))
    assert offset
    low, high = MjcfObject("thing", at(place - np.array(offset[1].split(","), float)), 0.1).bounds
    assert np.allclose(low + high, 0.0, atol=2e-3)


@pytest.mark.parametrize("unit", [1e-3, 1e-2])
def test_an_object_in_another_unit_is_refused_with_its_width(unit: float) -> None:
    size = " ".join(f"{length / unit:g}" for length in (0.02, 0.03, 0.01))
    with pytest.raises(InputError, match="width of the object is impossible"):
        MjcfObject("thing", mjcf(f'<geom type="box" size="{size}"/>'), 0.1)
