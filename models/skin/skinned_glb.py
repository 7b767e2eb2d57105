"""The skinned hand as a binary glTF 2.0 file (.glb): one mesh, 15 joints, no other files.

    python -m models.skin.skinned_glb hand.glb

Lengths are metres. Up is +y, as glTF requires: a node above the hand rotates the hand's z axis to
it. All joints are direct children of this node and are placed at the zero pose. So a program that
knows the poses of the bodies can set the joints one by one. Weights are normalised bytes and
colours are linear, as the standard requires.
"""

from __future__ import annotations

import json
import struct
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.errors import InputError
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.skeleton import ADULT, Skeleton
from models.skin.skin import (
    CUFF,
    NAIL,
    SLEEVE,
    Colour,
    Skin,
    frames,
    linear,
    normals_of,
    tone_colours,
)

FLOAT, UNSIGNED_BYTE, UNSIGNED_SHORT = 5126, 5121, 5123
VERTICES, INDICES = 34962, 34963
"""Codes of glTF 2.0: component types, and targets of buffer views."""
COMPONENTS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
TYPES = {FLOAT: np.float32, UNSIGNED_BYTE: np.uint8, UNSIGNED_SHORT: np.uint16}

MATERIALS: dict[str, tuple[Colour, float]] = {
    "skin": ((1.0, 1.0, 1.0), 0.62),
    "nail": (NAIL, 0.35),
    "cuff": (CUFF, 0.90),
    "sleeve": (SLEEVE, 0.95),
}
"""Kind of a part -> its sRGB colour and roughness. The colour of skin is stored at each vertex."""


def glb(skin: Skin, name: str = "hand") -> bytes:
    """A .glb of a skin at the zero pose."""
    writer = GlbArrays()
    primitives = [primitive(writer, skin, i) for i in range(len(skin.parts))]
    places, turns = frames(skin.skeleton, np.zeros(POSE_SIZE))
    names = ["palm", *(b.name for b in skin.skeleton.bones)]
    joints = []
    for bone, place, turn in zip(names, places, turns, strict=True):
        w, x, y, z = matrix_to_quaternion(turn).tolist()
        joints.append({"name": bone, "translation": place.tolist(), "rotation": [x, y, z, w]})
    half = float(np.sqrt(0.5))
    top = len(joints)
    document = {
        "asset": {"version": "2.0", "generator": "Hand Sandbox"},
        "scene": 0,
        "scenes": [{"nodes": [top]}],
        "nodes": [
            *joints,
            {"name": name, "rotation": [-half, 0.0, 0.0, half], "children": [*range(top), top + 1]},
            {"name": "skin", "mesh": 0, "skin": 0},
        ],
        "meshes": [{"name": name, "primitives": primitives}],
        "skins": [
            {
                "joints": list(range(top)),
                "inverseBindMatrices": writer.add(inverse_binds(places, turns), FLOAT, "MAT4"),
            }
        ],
        "materials": [material(p.name) for p in skin.parts],
    }
    return writer.finished(document)


def primitive(writer: GlbArrays, skin: Skin, index: int) -> dict[str, Any]:
    """Mesh primitive of one part of a skin at the zero pose."""
    part = skin.parts[index]
    rest = skin.rest[part.vertices]
    triangles = skin.triangles[part.triangles] - part.vertices.start
    attributes = {
        "POSITION": writer.add(rest, FLOAT, "VEC3", VERTICES, bounds=True),
        "NORMAL": writer.add(normals_of(rest, triangles), FLOAT, "VEC3", VERTICES),
        "JOINTS_0": writer.add(skin.bones[part.vertices], UNSIGNED_BYTE, "VEC4", VERTICES),
        "WEIGHTS_0": writer.add(
            skin.weights[part.vertices], UNSIGNED_BYTE, "VEC4", VERTICES, normalised=True
        ),
    }
    if part.name == "skin":
        colours = np.ones((len(rest), 4))
        colours[:, :3] = linear(tone_colours(skin.tone[part.vertices]))
        attributes["COLOR_0"] = writer.add(
            np.round(255 * colours), UNSIGNED_BYTE, "VEC4", VERTICES, normalised=True
        )
    return {
        "attributes": attributes,
        "indices": writer.add(triangles.ravel(), UNSIGNED_SHORT, "SCALAR", INDICES),
        "material": index,
    }


def material(part: str) -> dict[str, Any]:
    """Material of a part of the skin."""
    colour, roughness = MATERIALS[part.partition("_")[0]]
    return {
        "name": part,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear(np.array(colour)).tolist(), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": roughness,
        },
    }


def inverse_binds(places: Array, turns: Array) -> Array:
    """Matrices (15, 16) from the mesh to each joint, each stored column by column."""
    matrices = np.tile(np.eye(4), (len(places), 1, 1))
    matrices[:, :3, :3] = np.swapaxes(turns, 1, 2)
    matrices[:, :3, 3] = -np.einsum("bji,bj->bi", turns, places)
    return np.swapaxes(matrices, 1, 2).reshape(-1, 16)


class GlbArrays:
    """Collects arrays in one buffer, with their accessors."""

    def __init__(self) -> None:
        self.bytes = bytearray()
        self._behind = 0
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []

    def add(
        self,
        values: NDArray[Any],
        component: int,
        kind: str,
        target: int | None = None,
        normalised: bool = False,
        bounds: bool = False,
    ) -> int:
        """Adds an array; returns the number of its accessor."""
        stored = np.ascontiguousarray(values, TYPES[component])
        view = {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": stored.nbytes}
        if target is not None:
            view["target"] = target
        self.bytes += stored.tobytes() + bytes(-stored.nbytes % 4)
        accessor: dict[str, Any] = {
            "bufferView": len(self._views),
            "componentType": component,
            "type": kind,
            "count": len(stored),
        }
        if normalised:
            accessor["normalized"] = True
        if bounds:
            accessor |= {"min": stored.min(axis=0).tolist(), "max": stored.max(axis=0).tolist()}
        self._views.append(view)
        self._accessors.append(accessor)
        return len(self._accessors) - 1

    def append(self, count: int, component: int, kind: str, **bounds: list[float]) -> int:
        """Adds an accessor of `count` values that the caller writes after the buffer.

        The values must follow the arrays in the order of these calls. The length of each must be a
        multiple of 4 bytes.

        Returns:
            The number of the accessor.
        """
        size = count * COMPONENTS[kind] * np.dtype(TYPES[component]).itemsize
        view = {"buffer": 0, "byteOffset": len(self.bytes) + self._behind, "byteLength": size}
        self._behind += size
        self._accessors.append(
            {
                "bufferView": len(self._views),
                "componentType": component,
                "type": kind,
                "count": count,
                **bounds,
            }
        )
        self._views.append(view)
        return len(self._accessors) - 1

    def head(self, document: dict[str, Any]) -> bytes:
        """The bytes in front of the buffer: header, description, and the head of the buffer's
        chunk."""
        size = len(self.bytes) + self._behind
        document |= {
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": size}],
        }
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", size, 0x004E4942)
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks) + size) + chunks

    def finished(self, document: dict[str, Any]) -> bytes:
        """The whole file: header, description, buffer."""
        return self.head(document) + bytes(self.bytes)


def write_glb(path: Path, skeleton: Skeleton) -> None:
    """Writes the skinned hand of a skeleton of either side and any size.

    Raises:
        InputError: The file cannot be written.
    """
    try:
        path.write_bytes(glb(Skin.builtin().fitted(skeleton), f"{skeleton.side} hand"))
    except OSError as error:
        raise InputError(
            "the hand cannot be written here", where=str(path), got=error.strerror
        ) from error


def main(arguments: list[str]) -> int:
    """Writes the built-in hand; returns 2 if that fails."""
    try:
        if len(arguments) != 1:
            raise InputError(
                "give the path of one file to write",
                got=" ".join(arguments) or None,
                expected="FILE.glb",
            )
        write_glb(Path(arguments[0]), ADULT)
    except InputError as error:
        print(f"skin_gltf: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
