"""Compares the positions of joints in a real Blender with the truth, for exported files.

    python -m benchmarks.formats --keep FOLDER     # in the project's environment
    pip install bpy==5.0.1                         # in another one: bpy needs an older NumPy
    python benchmarks/in_blender.py FOLDER         # there

Blender puts the first key of a BVH at frame 1, whatever its option for the start is, and the first
key of a .glb at frame 0. It sets the scene to the rate of a BVH only with `update_scene_fps`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy
import numpy as np


def worst(wanted: dict, first: int) -> float:
    """Returns the largest coordinate difference (m) of a joint from its true position.

    Args:
        wanted: Contents of `wanted.json`: names, frames and true positions of joints.
        first: Blender's number of the first frame.
    """
    armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
    scene, out = bpy.context.scene, 0.0
    for frame, places in zip(wanted["frames"], wanted["joints"], strict=True):
        scene.frame_set(frame + first)
        seen = armature.evaluated_get(bpy.context.evaluated_depsgraph_get())
        for name, place in zip(wanted["names"], places, strict=True):
            found = np.array(seen.matrix_world @ seen.pose.bones[name].head)
            out = max(out, float(np.abs(found - place).max()))
    return out


def main(folder: Path) -> None:
    """Prints a line for each file of a folder."""
    wanted = json.loads((folder / "wanted.json").read_text())
    for path in (*sorted(folder.glob("*.bvh")), folder / "hand.glb"):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.scene.render.fps = 60
        if path.suffix == ".bvh":
            bpy.ops.import_anim.bvh(
                filepath=str(path), global_scale=0.01, axis_forward="-Z", axis_up="Y"
            )
            first = 1
        else:
            bpy.ops.import_scene.gltf(filepath=str(path))
            first = 0
        print(
            f"RESULT {path.name:16} Blender {bpy.app.version_string}: {worst(wanted, first):.1e} m"
        )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
