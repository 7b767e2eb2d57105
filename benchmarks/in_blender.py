"""Exported files in a real Blender: where it puts the joints, against the truth.

    python -m benchmarks.formats --keep FOLDER     # in the project's environment
    pip install bpy==5.0.1                         # in another one: bpy wants an older NumPy
    python benchmarks/in_blender.py FOLDER         # there

Blender puts the first key of a BVH at frame 1, whatever start is asked for, and keys of a .glb at
frame 0; it scales the scene to the rate of a BVH only where asked to (`update_scene_fps`).
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy
import numpy as np


def worst(wanted: dict, first: int) -> float:
    """m, greatest distance of a joint from where it belongs, over some frames."""
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
    """Prints a line for each file."""
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
