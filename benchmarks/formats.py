"""Reads exported files with our readers and with other programs, and prints the largest error.

    python -m benchmarks.formats                  # needs the extra `test`; node for three.js
    python -m benchmarks.formats --keep FOLDER    # keeps the files and the true positions there

The files have 240 keys of a hand that moves all joints, BVH in every Euler order. The error is the
largest coordinate difference of a joint's position. `benchmarks/in_blender.py` and
`benchmarks/in_dart.cpp` compare the kept files with the truth in Blender and DART.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from benchmarks.machine import describe_machine
from models.arithmetic import Array
from models.motion.armature import ORDERS, Y_UP, Z_UP, Armature, chunks
from models.motion.asf import AmcWriter, read_amc, read_asf
from models.motion.bvh import BvhWriter, read_bvh
from models.motion.c3d import C3dWriter
from models.motion.gltf import GltfWriter
from models.motion.output import MotionWriter
from models.motion.points import HandPoints
from models.motion.vicon_v import VWriter, motion_of, read_v
from models.motion.vsk import read_vsk
from models.skeleton import ADULT

COUNT, RATE = 240, 60.0
FRAMES = (0, 1, 17, 100, 239)
INCH = 0.0254


def lively() -> Array:
    """Returns (240, 48) poses in the world. Joints move in their ranges, and the wrist rotates by
    2 rad a second."""
    rng = np.random.default_rng(5)
    t = np.arange(COUNT)[:, None] / RATE
    wave = np.sin(2 * np.pi * rng.uniform(0.2, 1.5, 48) * t + rng.uniform(0, 6, 48))
    q = 0.3 * wave
    q[:, 5] = 2.0 * t[:, 0]
    middle, half = (ADULT.upper + ADULT.lower) / 2, (ADULT.upper - ADULT.lower) / 2
    q[:, 6:] = middle + half * wave[:, 6:]
    return q


def main() -> None:
    """Prints a line for each format and reader."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--keep", type=Path)
    options = parser.parse_args()
    print(describe_machine())
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        check(folder)


def check(folder: Path) -> None:
    """Writes every format to a folder, reads it with every reader, and prints the errors."""
    armature, q = Armature(ADULT), lively()
    joints, tips = armature.place(armature.keys(q))
    wanted = {
        "names": armature.names,
        "frames": FRAMES,
        "joints": joints[list(FRAMES)].tolist(),
    }
    (folder / "wanted.json").write_text(json.dumps(wanted))

    def write(writer: MotionWriter) -> None:
        with writer:
            for keys in chunks(armature, q):
                writer.write(keys)

    def tell(kind: str, reader: str, found: str) -> None:
        print(f"{kind:10}{reader:34}{found}", flush=True)

    def say(kind: str, reader: str, error: float) -> None:
        tell(kind, reader, f"{error:9.1e} m")

    for order in ORDERS:
        path = folder / f"hand-{order}.bvh"
        write(BvhWriter(path, armature, RATE, order))
        motion = read_bvh(path)
        found = motion.place().positions[:, [motion.index(n) for n in armature.names]]
        say(f"bvh {order}", "ours", np.abs(found - joints @ Y_UP.T).max())
        say(f"bvh {order}", "bvhio", _bvhio(path, armature, joints))
        _node(say, f"bvh {order}", "three.js BVHLoader", partial(_three, path, armature, joints))
    write(AmcWriter(folder / "hand.amc", armature, RATE))
    motion = read_amc(folder / "hand.amc", read_asf(folder / "hand.asf"))
    found = motion.place().positions[:, [motion.index(n) for n in armature.names[1:]]]
    say("asf/amc", "ours", np.abs(found - joints[:, 1:] @ Y_UP.T).max())
    say("asf/amc", "pyacclaim", _pyacclaim(folder, armature, joints))
    write(VWriter(folder / "hand.v", armature, RATE))
    motion = motion_of(folder / "hand.v", read_vsk(folder / "hand.vsk"), read_v(folder / "hand.v"))
    say("v/vsk", "ours", np.abs(motion.place().positions[:, :15] - joints @ Z_UP.T).max())
    # Input of DART: rotation vectors (rad) and the wrist's position (m), as in the V file.
    values = read_v(folder / "hand.v").values[list(FRAMES)]
    values[:, 3:6] /= 1000
    np.savetxt(folder / "for_dart.txt", values)
    np.savetxt(folder / "dart_wants.txt", joints[list(FRAMES)].reshape(-1, 3))
    write(GltfWriter(folder / "hand.glb", (armature,), RATE))
    _node(say, "glb", "three.js GLTFLoader", lambda: _three_glb(folder, armature, joints))
    _node(tell, "glb", "gltf-validator", lambda: f"{_issues(folder / 'hand.glb')} issues")
    points = HandPoints([armature], ["right"], joints=True)
    write(C3dWriter(folder / "hand.c3d", points, RATE))
    places = np.concatenate([joints, tips], axis=1)
    for reader, read in (("ezc3d", _ezc3d), ("c3d", _c3d)):
        say("c3d", reader, np.abs(read(folder / "hand.c3d") - places).max())


def _bvhio(path: Path, armature: Armature, joints: Array) -> float:
    import bvhio

    root, worst = bvhio.readAsHierarchy(str(path)), 0.0
    for frame in FRAMES:
        root.loadPose(frame)
        found = {j.Name: np.array(j.PositionWorld) / 100 for j, _, _ in root.layout()}
        for j, name in enumerate(armature.names):
            worst = max(worst, np.abs(found[name] - Y_UP @ joints[frame, j]).max())
    return worst


def _pyacclaim(folder: Path, armature: Armature, joints: Array) -> float:
    import pyacclaim

    asf = pyacclaim.loadASF(str(folder / "hand.asf"), verbose=False)
    frames, worst = pyacclaim.loadAMC(asf, str(folder / "hand.amc")), 0.0
    for frame in [f for f in FRAMES if f < len(frames)]:
        asf["bones"]["root"].set_pose(frames[frame])
        for j, name in enumerate(armature.names):
            for child in armature.children[j] if j else ():
                found = INCH * asf["bones"][name].global_coordinate
                worst = max(worst, np.abs(found - Y_UP @ joints[frame, child]).max())
    return worst


def _ezc3d(path: Path) -> Array:
    import ezc3d

    return ezc3d.c3d(str(path))["data"]["points"][:3].transpose(2, 1, 0) / 1000


def _c3d(path: Path) -> Array:
    import c3d

    with path.open("rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return np.array([f[:, :3] for _, f, _ in c3d.Reader(file).read_frames()], float) / 1000


def _node(say: Callable[..., None], kind: str, reader: str, ask: Callable[[], object]) -> None:
    try:
        say(kind, reader, ask())
    except pytest.skip.Exception as error:  # Node is not installed
        print(f"{kind:10}{reader:34}{error}")


def _three(path: Path, armature: Armature, joints: Array) -> float:
    from tests.support.node_readers import ask

    said = ask("bvh", path, *FRAMES)["places"]
    return _worst(said, armature, joints, 100.0)


def _three_glb(folder: Path, armature: Armature, joints: Array) -> float:
    from tests.support.node_readers import ask

    said = ask("glb", folder / "hand.glb", *(f / RATE for f in FRAMES))["moments"]
    return _worst([moment["places"] for moment in said], armature, joints, 1.0)


def _issues(path: Path) -> int:
    from tests.support.node_readers import ask

    said = ask("validate", path)
    return said["errors"] + said["warnings"] + said["infos"]


Said = list[dict[str, list[float]]]


def _worst(said: Said, armature: Armature, joints: Array, unit: float) -> float:
    return max(
        float(np.abs(np.array(found[name]) / unit - Y_UP @ joints[frame, j]).max())
        for frame, found in zip(FRAMES, said, strict=True)
        for j, name in enumerate(armature.names)
    )


if __name__ == "__main__":
    main()
