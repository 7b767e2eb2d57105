"""The script for Maya, in a small scene that behaves like Maya's as far as that is documented."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.paalm import TWO_THIRDS
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.palm import Palm
from models.arithmetic import Array
from models.motion.armature import Y_UP, Armature
from models.person import Person
from models.skeleton import ADULT
from sandbox.cli.main import main
from sandbox.cli.stream import script
from sandbox.stream.guest import Line, Refused
from sandbox.stream.lines import MAYA, HandLines
from tests.sandbox.stream.fake_maya import FakeMaya, maya_with
from tests.support.motion_poses import moving

RATE = 60.0
SCRIPT = script("maya")


def commands(
    q: Array, side: str = "right", run: str = "r1"
) -> tuple[HandLines, list[str], tuple[Array, Array]]:
    """The rig's command, and those of poses at 60 Hz."""
    armature = Armature(Person(side).skeleton(ADULT))
    hand = HandLines(armature, side, MAYA, run=run)
    keys = armature.keys(q)
    moments = [
        hand.lines(i / RATE, type(keys)(keys.root[i : i + 1], keys.turns[i : i + 1]))
        for i in range(len(q))
    ]
    return hand, [line for lines in moments for line in lines], armature.place(keys)


def chain(
    scene: FakeMaya, name: str, places: Iterable[Sequence[float]], parent: str | None = None
) -> list[str]:
    """Joints of an animator's own rig."""
    scene.select(*([parent] if parent else []), clear=not parent)
    names = [scene.joint(name=f"{name}{i}", position=place) for i, place in enumerate(places)]
    return names


def where(scene: FakeMaya, name: str) -> Array:
    return np.array(scene.xform(name, query=True, worldSpace=True, translation=True))


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(("up", "angle"), [("y", "deg"), ("z", "deg"), ("y", "rad")])
def test_a_hand_made_in_maya_has_its_fingertips_where_the_streamed_one_has(
    side: str, up: str, angle: str
) -> None:
    scene, q = FakeMaya(up=up, angle=angle), moving(ADULT, 60, 4)[::6]
    hand, lines, (joints, tips) = commands(q, side)
    with maya_with(SCRIPT, scene) as (names, run):
        names["start"](side=side)
        run(hand.rig)
        axes = Y_UP if up == "y" else np.eye(3)
        worst = 0.0
        for i, line in enumerate(lines):
            run(line)
            for k, finger in enumerate(("middle_dip", "index_dip", "little_dip")):
                tip = tips[i, (2, 1, 4)[k]]
                found = where(scene, f"{finger}_tip_{side}")
                worst = max(worst, float(np.abs(found - 100 * axes @ tip).max()))
            wrist = where(scene, f"wrist_{side}")
            assert np.allclose(wrist, 100 * axes @ joints[i, 0], atol=2e-3)
        assert worst < 0.01  # cm; and a finger as straight as a legal one is told 1e-4 short
        assert names["counts"] == {"lines": 11, "lines refused": 0}
    assert not scene.warnings


@pytest.mark.parametrize(
    ("chains", "joints"), [(1, 4), (1, 2), (2, 3), (3, 6), (4, 2), (5, 3), (5, 4)]
)
def test_any_chains_that_are_selected_reach_as_far_and_point_as_the_fingers_do(
    chains: int, joints: int
) -> None:
    scene = FakeMaya()
    q = moving(ADULT, 60, 1)[::15]
    _, lines, (places, tips) = commands(q)
    bases = []
    scene.select(clear=True)
    scene.joint(name="palm", position=(0, 0, 0))
    for c in range(chains):
        # Of other lengths than ours, pointing to +z, back up: little finger at -x.
        row = [(3.0 - 2.0 * c, 0.1 * c, 5.0 + (1.0 + 0.2 * c) * i) for i in range(joints)]
        bases.append(chain(scene, f"f{c}_", row, "palm")[0])
    scene.select(*bases)
    with maya_with(SCRIPT, scene) as (names, run):
        names["start"](absolute=True)
        fingers = names["BY_COUNT"][chains]
        armature = Armature(ADULT)
        for i, line in enumerate(lines):
            run(line)
            for c, finger in enumerate(fingers):
                first = 1 + int(ADULT.first_bone[finger])
                bone = sum(b.length for b in ADULT.bones if b.finger == finger)
                truth = Y_UP @ (tips[i, finger] - places[i, first]) / bone
                size = (1.0 + 0.2 * c) * (joints - 1)
                way = (where(scene, f"f{c}_{joints - 1}") - where(scene, f"f{c}_0")) / size
                if joints > 2:
                    assert np.allclose(way, truth, atol=2e-3)
                else:  # one bone cannot bend, but it points
                    assert np.allclose(way, truth / np.linalg.norm(truth), atol=2e-3)
        assert names["counts"]["lines refused"] == 0
    assert armature.names[0] == "wrist"


def test_keys_are_whole_frames_and_baking_leaves_the_joints_as_they_were_seen() -> None:
    scene, q = FakeMaya("film"), moving(ADULT, 30, 2)
    hand, lines, _ = commands(q)
    with maya_with(SCRIPT, scene) as (names, run):
        names["start"]()
        run(hand.rig)
        for line in lines:
            run(line)
        group = "hand_sandbox_right"
        seen, ends = {}, ["index_dip_tip_right", "thumb_mcp_tip_right", "wrist_right"]
        for frame in range(1, 14):
            scene.currentTime(frame)
            seen[frame] = [where(scene, end) for end in ends]
        assert scene.objExists(group)
        run(hand.stop)
        # Nothing of ours is left, and everything that moved has keys.
        assert not scene.objExists(group) and not names["hands"]
        assert not [n for n in scene.nodes if n.kind not in ("joint", "transform")]
        first = {n.name: sorted(n.curves["rotateX"]) for n in scene.nodes if n.curves}
        assert set(map(tuple, first.values())) == {tuple(map(float, range(1, 14)))}
        assert len(first) == 15
        for frame, places in seen.items():
            scene.currentTime(frame)
            assert np.allclose([where(scene, end) for end in ends], places, atol=1e-6)
    assert not scene.warnings


def test_a_thousand_moments_leave_the_undo_queue_as_it_was() -> None:
    scene, q = FakeMaya(), moving(ADULT, 100, 3)
    hand, lines, _ = commands(q)
    row = [chain(scene, f"f{c}_", [(c, 0, 3 * i) for i in range(4)])[0] for c in range(2)]
    scene.select(*row)
    before = len(scene.undo)
    with maya_with(SCRIPT, scene) as (names, run):
        names["start"]()
        for _ in range(10):
            for line in lines[::10]:
                run(line)
        run(hand.stop)
    assert scene.undo[before:] == ["hand_sandbox start", "hand_sandbox stop"]
    assert scene.undoInfo(query=True, state=True)


def test_a_rig_goes_on_from_where_it_stands_unless_it_is_to_be_where_the_hand_is() -> None:
    scene, q = FakeMaya(), moving(ADULT, 10, 5)
    _, lines, (places, _) = commands(q)
    palm = chain(scene, "palm", [(50.0, 20.0, 10.0)])[0]
    firsts = [
        chain(scene, f"f{c}_", [(50 - 2 * c, 20, 10 + 3 * i) for i in range(1, 5)], palm)[0]
        for c in range(4)
    ]
    scene.select(*firsts)
    with maya_with(SCRIPT, scene) as (names, run):
        names["start"](scale=100.0)
        for i, line in enumerate(lines):
            run(line)
            moved = 100 * Y_UP @ (places[i, 0] - places[0, 0])
            assert np.allclose(where(scene, palm), np.add([50, 20, 10], moved), atol=2e-3)


@pytest.mark.parametrize(
    ("select", "said"),
    [
        (["a0", "a1"], "in the chain of another"),
        (["a3"], "has no joint below it"),
        (["a0", "b0", "c0", "d0", "e0", "g0"], "1 to 5 chains"),
        (["still0"], "at the same place"),
    ],
)
def test_chains_that_cannot_follow_a_hand_are_refused_in_words_and_leave_nothing(
    select: list[str], said: str
) -> None:
    scene = FakeMaya()
    for name in "abcdeg":
        chain(scene, name, [(ord(name), 0, 3 * i) for i in range(4)])
    chain(scene, "still", [(0, 0, 0)] * 3)
    scene.select(*select)
    count = len(scene.nodes)
    with maya_with(SCRIPT, scene) as (names, _):
        names["start"]()
        assert not names["hands"]
    assert len(scene.nodes) == count and len(scene.warnings) == 1
    assert said in scene.warnings[0]


def test_targets_that_somebody_deletes_end_the_hand_with_a_word_and_nothing_else() -> None:
    scene, q = FakeMaya(), moving(ADULT, 3, 0)
    hand, lines, _ = commands(q)
    scene.select(chain(scene, "f", [(0, 0, 3 * i) for i in range(4)])[0])
    with maya_with(SCRIPT, scene) as (names, run):
        names["start"]()
        run(lines[0])
        scene.delete("hand_sandbox_right")
        run(lines[1])
        assert not names["hands"] and "start() again" in scene.warnings[-1]
        said = len(scene.warnings)
        run(lines[2])
        run(hand.stop)
        assert len(scene.warnings) == said


good = "hs1 r1 right 0 0.0000 p 0 0 0 1 0 0 0 c 1 0 0.5 0 0 0 1 0.1"


@given(st.one_of(st.text(max_size=200), st.integers(0, len(good)).map(lambda n: good[:n])))
def test_nothing_that_is_written_to_the_port_reaches_maya_as_an_error(text: str) -> None:
    scene = FakeMaya()
    scene.select(chain(scene, "f", [(0, 0, 3 * i) for i in range(4)])[0])
    with maya_with(SCRIPT, scene) as (names, _):
        names["start"]()
        names["hand_sandbox"](text)
        assert sum(names["counts"].values()) <= 1
        names["hand_sandbox"](good)
        assert names["counts"]["lines"] >= 1
    assert scene.undoInfo(query=True, state=True)


@pytest.mark.parametrize(
    "line",
    [
        good.replace("0.5", "nan"),
        good.replace("0.5", "1e999"),
        good.replace("0.5", "1.5"),
        good.replace("c 1", "c 5"),
        good.replace("c 1", "c -1"),
        good.replace("0 1 0 0 0 c", "0 0 0 0 0 c"),
        good.replace("0.0000", "-1"),
        good.replace("hs1", "hs2"),
        good + " x",
        good + "; import os",
        good + "\n",
        good + " c 1 0 0.5 0 0 0 1 0",
        good + " c 2 0 0.5 0 0 0 1 0.1" * 400,
        "hs1 r1 right rig b wrist 0 0 0 0 1 0 0 0",
        "hs1 r1 right rig b a -1 0 0 0 1 0 0 0 b b 2 0 0 0 1 0 0 0",
        "hs1 r1 right rig b a -1 0 0 0 1 0 0 0 e 3 0 0 0",
    ],
)
def test_a_line_that_is_not_exactly_as_it_should_be_is_refused(line: str) -> None:
    assert Line(good).kind == "moment"
    with pytest.raises(Refused):
        Line(line)


@pytest.mark.parametrize(
    ("program", "own"), [("maya", {"maya", "__main__"}), ("blender", {"bpy", "mathutils"})]
)
def test_a_script_is_one_file_for_pythons_from_3_7_that_needs_nothing_of_ours(
    program: str, own: set[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["stream", "--script", program]) == 0
    tree = ast.parse(capsys.readouterr().out, feature_version=(3, 7))
    imported = {
        str(node.module) if isinstance(node, ast.ImportFrom) else node.names[0].name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    assert imported - sys.stdlib_module_names == own


@pytest.mark.parametrize("up", ["y", "z"])
def test_inner_joints_bend_as_paalm_couples_them(up: str) -> None:
    """With its share of the preferred angle, a solver finds PAALM's angles by itself."""
    scene = FakeMaya(up=up)
    angles = np.zeros((40, 5, 4))
    angles[:, 1:, 0] = np.linspace(0, 40, 40)[:, None]
    angles[:, 1:, 2] = np.linspace(5, 100, 40)[:, None]
    angles[:, 1:, 3] = TWO_THIRDS.slope * angles[:, 1:, 2]
    palm = Palm((0.0, 0.0, 0.2), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    q = np.array([hand_pose(table, palm) for table in angles])
    hand, lines, (joints, _) = commands(q)
    names_of = Armature(ADULT).names
    axes = Y_UP if up == "y" else np.eye(3)
    with maya_with(SCRIPT, scene) as (names, run):
        names["start"]()
        run(hand.rig)
        for i, line in enumerate(lines):
            run(line)
            for name in ("index_pip", "index_dip", "middle_dip", "ring_dip", "little_dip"):
                truth = 100 * axes @ joints[i, names_of.index(name)]
                assert np.abs(where(scene, f"{name}_right") - truth).max() < 0.02  # cm
        assert names["counts"]["lines refused"] == 0


@pytest.mark.parametrize(
    ("node", "attribute", "driver", "said"),
    [
        ("f0_1", "rotateZ", "", "locked"),
        ("f0_0", "rotate", "", "locked"),
        ("hand0", "translateX", "", "locked"),
        ("f0_2", "rotateX", "drive", "driven by drive"),
        ("f0_1", "rotate", "drive", "driven by drive"),
    ],
)
def test_channels_that_could_not_be_baked_are_refused_before_anything_is_played(
    node: str, attribute: str, driver: str, said: str
) -> None:
    scene = FakeMaya()
    scene.group(empty=True, name="drive")
    palm = chain(scene, "hand", [(0.0, 0.0, 0.0)])[0]
    first = chain(scene, "f0_", [(0, 0, 3 * i) for i in range(1, 5)], palm)[0]
    found = next(n for n in scene.nodes if n.name == node)
    if driver:
        found.drivers[attribute] = [driver]
    else:
        found.locked.add(attribute)
    scene.select(first)
    count = len(scene.nodes)
    with maya_with(SCRIPT, scene) as (names, _):
        names["start"]()
        assert not names["hands"] and said in scene.warnings[0]
        assert len(scene.nodes) == count
        # Keys may be there: baking replaces them.
        found.drivers, found.locked = {}, set()
        found.curves["rotateX"] = {1.0: 0.0}
        names["start"]()
        assert names["hands"]
