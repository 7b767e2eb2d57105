"""The script for Blender, in a real Blender: the module `bpy`, in an environment made for it.

`bpy` is 370 MB to fetch and wants a NumPy older than ours, so this is no quick check: it runs with
`.ci/run --full`. `HAND_SANDBOX_BPY` names the Python of an environment that has it already.
"""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.motion.armature import Y_UP, Armature, Keys
from models.motion.bvh import BvhWriter, read_bvh
from models.person import Person
from models.skeleton import ADULT
from sandbox.cli.stream import script
from sandbox.stream.lines import BLENDER, HandLines
from sandbox.stream.sender import Sender
from tests.support.motion_poses import moving

VERSION = "bpy==5.0.1"
"""The newest for Python 3.11; for another Python another one is taken."""
PATIENT = 60.0
TOLERANCE = 2e-6
"""m: the stream has six digits of places and seven of turns, Blender counts in single precision."""

pytestmark = pytest.mark.full


@pytest.fixture(scope="session")
def python(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A Python that has bpy."""
    if there := os.environ.get("HAND_SANDBOX_BPY"):
        return there
    folder = tmp_path_factory.mktemp("bpy")
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    own = str(folder / "bin" / "python")
    wanted = VERSION if sys.version_info[:2] == (3, 11) else "bpy"
    subprocess.run([own, "-m", "pip", "install", "-q", wanted], check=True)
    return own


def streamed(
    python: str,
    folder: Path,
    hand: HandLines,
    keys: Keys,
    *words: str,
    status: int = 0,
    beside: HandLines | None = None,
) -> str:
    """Streams keys into Blender, which ends with a status; what it said.

    A second hand, `beside`, has them in reverse order.
    """
    (folder / "side.py").write_text(script("blender"))
    side = subprocess.Popen(
        [python, "side.py", "--port", "0", *words],
        cwd=folder,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert side.stdout is not None
    said = ""
    while "listening" not in said:
        line = side.stdout.readline()
        assert line, said
        said += line
    hands = {"right": hand} if beside is None else {"right": hand, "left": beside}
    sender = Sender("127.0.0.1", int(line.rsplit(":", 1)[1]), [h.rig for h in hands.values()])
    try:
        for i in range(len(keys.root)):
            for name, each in hands.items():
                k = i if each is hand else len(keys.root) - 1 - i
                one = Keys(keys.root[k : k + 1], keys.turns[k : k + 1])
                made = lambda i=i, one=one, each=each: each.lines(i / 60.0, one)  # noqa: E731
                assert sender.show(name, made, PATIENT)
        for each in hands.values():
            sender.order(each.stop)
        assert sender.flush(PATIENT)
        out, _ = side.communicate(timeout=PATIENT)
    finally:
        sender.close()
        side.kill()
    assert side.returncode == status, said + out
    return said + out


@pytest.mark.parametrize("side", ["right", "left"])
def test_what_blender_keys_and_exports_is_what_we_export(
    python: str, tmp_path: Path, side: str
) -> None:
    armature = Armature(Person(side).skeleton(ADULT))
    keys = armature.keys(moving(ADULT, 120, 3))
    hand = HandLines(armature, side, BLENDER)
    said = streamed(python, tmp_path, hand, keys, "--out", "theirs.bvh")
    assert f"hand_sandbox_{side}, frames [1, 120]" in said
    with BvhWriter(tmp_path / "ours.bvh", armature, 60.0) as writer:
        writer.write(keys)
    theirs, ours = read_bvh(tmp_path / "theirs.bvh"), read_bvh(tmp_path / "ours.bvh")
    assert theirs.names == ours.names and len(theirs) == len(ours) == 120
    a, b = theirs.place(), ours.place()
    assert np.abs(a.positions - b.positions @ Y_UP).max() < TOLERANCE
    assert np.nanmax(np.abs(a.ends - b.ends @ Y_UP)) < TOLERANCE
    assert abs(theirs.frame_time - 1 / 60) < 1e-6


RIG = """
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
data = bpy.data.armatures.new("Rig")
rig = bpy.data.objects.new("Rig", data)
bpy.context.scene.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
root = data.edit_bones.new("root")
root.head, root.tail = (0, 0, 0), (0, 0, 1)
for c, bones in enumerate((1, 2, 5)):
    above = root
    for i in range(bones):
        bone = data.edit_bones.new(f"chain{c}_{i}")
        bone.head, bone.tail = (0.5 * c, 1 + i, 0.2), (0.5 * c, 2 + i, 0.2)
        bone.parent, above = above, bone
        bone.roll = 0.3 * c
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.wm.save_as_mainfile(filepath="rig.blend")
"""


def test_chains_of_any_number_of_bones_reach_as_far_and_point_as_the_fingers_do(
    python: str, tmp_path: Path
) -> None:
    (tmp_path / "rig.py").write_text(RIG)
    subprocess.run([python, "rig.py"], cwd=tmp_path, check=True, capture_output=True)
    armature = Armature(ADULT)
    keys = armature.keys(moving(ADULT, 60, 5))
    hand = HandLines(armature, "right", BLENDER)
    chains = [f"chain{c}_0" for c in range(3)]
    rig = ("--open", "rig.blend", "--armature", "Rig", "--fps", "60", "--chains", *chains)
    streamed(python, tmp_path, hand, keys, *rig, "--out", "theirs.bvh")
    theirs = read_bvh(tmp_path / "theirs.bvh")
    placed = theirs.place()
    joints, tips = armature.place(keys)
    first = placed.rotations[0, theirs.index("root")]
    for c, bones in enumerate((1, 2, 5)):
        bone = 1 + int(ADULT.first_bone[c])
        size = sum(b.length for b in ADULT.bones if b.finger == c)
        # In the palm's frame, which here is the root's at the first key.
        way = np.einsum("nji,nj->ni", keys.turns[:, 0], tips[:, c] - joints[:, bone]) / size
        a = placed.positions[:, theirs.index(f"chain{c}_0")]
        b = placed.ends[:, theirs.index(f"chain{c}_{bones - 1}")]
        turn = placed.rotations[:, theirs.index("root")] @ first.T
        found = np.einsum("nji,nj->ni", turn, b - a) / bones
        if bones == 1:
            way /= np.linalg.norm(way, axis=1, keepdims=True)
        assert np.abs(found - way).max() < 1e-3, c


def test_a_rig_in_the_place_of_the_hand_does_not_depend_on_a_first_moment_seen_wrongly(
    python: str, tmp_path: Path
) -> None:
    (tmp_path / "rig.py").write_text(RIG)
    subprocess.run([python, "rig.py"], cwd=tmp_path, check=True, capture_output=True)
    armature = Armature(ADULT)
    keys = armature.keys(moving(ADULT, 40, 5))
    # The palm is first seen the wrong way round, as first frames of a Leap are.
    turns = keys.turns.copy()
    turns[:6, 0] = turns[:6, 0] @ np.diag([-1.0, 1.0, -1.0])
    wrong = Keys(keys.root, turns)
    hand = HandLines(armature, "right", BLENDER)
    chains = [f"chain{c}_0" for c in range(3)]
    rig = ["--open", "rig.blend", "--armature", "Rig", "--fps", "60", "--chains", *chains]
    said = streamed(python, tmp_path, hand, wrong, *rig, "--absolute", "--out", "theirs.bvh")
    assert "the palm turned by 180 degrees at once at frame 7" in said
    assert "use --absolute" not in said
    assert "use --absolute" in streamed(python, tmp_path, hand, wrong, *rig, "--out", "on.bvh")
    joints, tips = armature.place(keys)
    theirs = read_bvh(tmp_path / "theirs.bvh")
    placed = theirs.place()
    for c, bones in enumerate((1, 2, 5)):
        bone = 1 + int(ADULT.first_bone[c])
        size = sum(b.length for b in ADULT.bones if b.finger == c)
        way = (tips[:, c] - joints[:, bone]) / size
        a = placed.positions[:, theirs.index(f"chain{c}_0")]
        b = placed.ends[:, theirs.index(f"chain{c}_{bones - 1}")]
        found = (b - a) / bones
        if bones == 1:
            way /= np.linalg.norm(way, axis=1, keepdims=True)
        assert np.abs(found - way)[6:].max() < 1e-3, c


def test_a_left_hand_moves_a_rig_that_waits_for_it_and_ends(python: str, tmp_path: Path) -> None:
    (tmp_path / "rig.py").write_text(RIG)
    subprocess.run([python, "rig.py"], cwd=tmp_path, check=True, capture_output=True)
    armature = Armature(Person("left").skeleton(ADULT))
    hand = HandLines(armature, "left", BLENDER)
    keys = armature.keys(moving(ADULT, 3, 5))
    rig = ("--open", "rig.blend", "--fps", "60", "--armature", "Rig", "--chains", "chain1_0")
    said = streamed(python, tmp_path, hand, keys, *rig, "--side", "left", "--out", "theirs.bvh")
    assert "Rig, frames [1, 3]" in said and (tmp_path / "theirs.bvh").exists()


READ = """
import bpy, json, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
file = sys.argv[1]
load = bpy.ops.import_scene.fbx if file.endswith("fbx") else bpy.ops.import_scene.gltf
load(filepath=file)
rigs = [each for each in bpy.data.objects if each.type == "ARMATURE"]
rig = rigs[0]
actions = [each.name for each in bpy.data.actions]
ends = [each.frame_range[:] for each in bpy.data.actions]
wrists = []
for frame in (ends[0][0], ends[0][1]):
    bpy.context.scene.frame_set(int(frame))
    bone = rig.pose.bones[0]
    wrists.append(list((rig.matrix_world @ bone.matrix).translation))
meshes = [each.name for each in bpy.data.objects if each.type == "MESH" and each.find_armature()]
print(json.dumps([len(rigs), len(actions), ends, wrists, len(meshes)]))
"""


def read_back(python: str, file: Path) -> list[Any]:
    """What another Blender finds in a file.

    Numbers of armatures and of actions, first and last frames of these, places of the wrist in
    those, and the number of skins.
    """
    read = [python, "-c", READ, file.name]
    done = subprocess.run(read, cwd=file.parent, check=True, capture_output=True, text=True)
    found: list[Any] = json.loads(done.stdout.splitlines()[-1])
    return found


@pytest.mark.parametrize("ending", ["fbx", "glb"])
def test_each_of_two_hands_has_its_own_motion_in_a_file_of_its_own(
    python: str, tmp_path: Path, ending: str
) -> None:
    armatures = [Armature(ADULT), Armature(Person("left").skeleton(ADULT))]
    right, left = (
        HandLines(a, side, BLENDER) for a, side in zip(armatures, ("right", "left"), strict=True)
    )
    keys = armatures[0].keys(moving(ADULT, 20, 3))
    streamed(python, tmp_path, right, keys, "--out", f"hand.{ending}", beside=left)
    for side, order in (("right", (0, -1)), ("left", (-1, 0))):
        rigs, actions, _, wrists, _ = read_back(python, tmp_path / f"hand-{side}.{ending}")
        assert (rigs, actions) == (1, 1)
        assert np.abs(np.array(wrists) - keys.root[list(order)]).max() < 1e-4


def test_a_rig_takes_its_skin_along_and_no_other_hand_and_keeps_the_rate_of_its_file(
    python: str, tmp_path: Path
) -> None:
    skin = """
mesh = bpy.data.meshes.new("Skin")
mesh.from_pydata([(0, 1, 0), (1, 1, 0), (0, 2, 0)], [], [(0, 1, 2)])
body = bpy.data.objects.new("Skin", mesh)
bpy.context.scene.collection.objects.link(body)
body.vertex_groups.new(name="chain1_0").add([0, 1, 2], 1.0, "ADD")
body.modifiers.new("Armature", "ARMATURE").object = rig
body.parent = rig
bpy.context.scene.render.fps = 30
bpy.ops.wm.save_as_mainfile(filepath="rig.blend")
"""
    (tmp_path / "rig.py").write_text(RIG + skin)
    subprocess.run([python, "rig.py"], cwd=tmp_path, check=True, capture_output=True)
    armatures = [Armature(ADULT), Armature(Person("left").skeleton(ADULT))]
    right, left = (
        HandLines(a, side, BLENDER) for a, side in zip(armatures, ("right", "left"), strict=True)
    )
    rig = ("--open", "rig.blend", "--armature", "Rig", "--chains", "chain1_0", "--side", "left")
    keys = armatures[0].keys(moving(ADULT, 61, 5))
    said = streamed(python, tmp_path, right, keys, *rig, "--out", "rig.glb", beside=left)
    assert "Rig, frames [1, 31], rig.glb" in said  # a second at the file's 30 frames a second
    assert [file.name for file in tmp_path.glob("*.glb")] == ["rig.glb"]
    rigs, actions, _, _, skins = read_back(python, tmp_path / "rig.glb")
    assert (rigs, actions, skins) == (1, 1, 1)


def test_a_rig_whose_hand_never_comes_ends_with_a_line_that_says_so(
    python: str, tmp_path: Path
) -> None:
    (tmp_path / "rig.py").write_text(RIG)
    subprocess.run([python, "rig.py"], cwd=tmp_path, check=True, capture_output=True)
    armature = Armature(Person("left").skeleton(ADULT))
    hand = HandLines(armature, "left", BLENDER)
    keys = armature.keys(moving(ADULT, 3, 5))
    rig = ("--open", "rig.blend", "--armature", "Rig", "--chains", "chain1_0")
    said = streamed(python, tmp_path, hand, keys, *rig, status=1)
    assert "Rig waited for the right hand, which was not streamed; --side says another" in said


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--armature", "Rgi", "--chains", "chain1_0"], "no armature has the name Rgi; .*: Rig$"),
        (
            ["--armature", "Rig", "--chains", "chain9_0"],
            "no bone has the name chain9_0; .*chain1_0",
        ),
        (["--armature", "Rig"], "--armature needs --chains"),
        (["--chains", "chain1_0"], "no armature is selected; the file has: Rig$"),
        (["--open", "none.blend"], "none.blend"),
        (["--out", "hand.gltx"], r"--out needs a name that ends in \.bvh"),
        (["--port", "99999"], "port"),
    ],
)
def test_what_blender_cannot_do_is_told_in_one_line(
    python: str, tmp_path: Path, words: list[str], told: str
) -> None:
    rig = RIG + "rig.select_set(False)\nbpy.context.view_layer.objects.active = None\n"
    rig += 'bpy.ops.wm.save_as_mainfile(filepath="rig.blend")\n'
    (tmp_path / "rig.py").write_text(rig)
    subprocess.run([python, "rig.py"], cwd=tmp_path, check=True, capture_output=True)
    (tmp_path / "side.py").write_text(script("blender"))
    opened = [] if "--open" in words else ["--open", "rig.blend"]
    asked = [python, "side.py", "--port", "0", *opened, *words]
    side = subprocess.run(asked, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert side.returncode == 2 and "Traceback" not in side.stderr
    lines = [line for line in side.stderr.splitlines() if line.startswith("hand_sandbox: ")]
    assert len(lines) == 1 and re.search(told, lines[0]), side.stderr


def test_a_port_in_blender_outlives_whatever_is_written_to_it(python: str, tmp_path: Path) -> None:
    (tmp_path / "side.py").write_text(script("blender"))
    side = subprocess.Popen(
        [python, "side.py", "--port", "0"], cwd=tmp_path, stdout=subprocess.PIPE, text=True
    )
    assert side.stdout is not None
    port = int(side.stdout.readline().rsplit(":", 1)[1])
    armature = Armature(ADULT)
    hand = HandLines(armature, "right", BLENDER)
    keys = armature.keys(moving(ADULT, 1, 0))
    for rude in (b"\n\n\n", b"import os\n", b"\xff" * 9000, b"hs1 r right 0 0 p nan\n"):
        with socket.create_connection(("127.0.0.1", port)) as channel:
            channel.sendall(rude)
            time.sleep(0.05)
    sender = Sender("127.0.0.1", port, [hand.rig])
    sender.show("right", lambda: hand.lines(0.0, keys), PATIENT)
    sender.order(hand.stop)
    assert sender.flush(PATIENT)
    assert "frames [1, 1]" in side.communicate(timeout=PATIENT)[0]
    sender.close()
    assert side.returncode == 0
