"""Writes skinned hands as one binary glTF 2.0 file (.glb): in motion, key by key, or at rest.

    python -m models.motion.gltf hand.glb

Lengths are metres. Up is +y, as glTF requires: a node above the hand rotates the world's z axis to
it. Weights are normalised bytes and colours are linear, as the standard requires.

In a file of motion, joints are nested nodes, each in its own frame. Keys are interpolated linearly:
a quaternion for every joint, and the wrist's position. In the file, the description precedes the
numbers, and the numbers of one joint are contiguous. Every channel is therefore collected in its
own temporary file until the end.
"""

from __future__ import annotations

import json
import shutil
import struct
import sys
import tempfile
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.errors import InputError
from models.motion.armature import Armature, Keys
from models.motion.output import MotionWriter, checked_rate, refused
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

UP = [-float(np.sqrt(0.5)), 0.0, 0.0, float(np.sqrt(0.5))]
"""Quaternion x, y, z, w of the node that rotates the world's z axis to glTF's y axis."""


class GltfWriter(MotionWriter):
    """Any number of hands as one .glb.

    Args:
        path: Path of the file.
        armatures: The hands.
        rate: Rate (Hz) of the keys.
        names: Names of the hands; by default their sides. In a file of several hands they also
            precede the names of the joints, since programs that animate by name need unique names.
    """

    def __init__(
        self, path: Path, armatures: tuple[Armature, ...], rate: float, names: tuple[str, ...] = ()
    ) -> None:
        self._rate = checked_rate(rate)
        self._armatures = armatures
        self._names = names or tuple(f"{a.skeleton.side} hand" for a in armatures)
        # Created before the file is opened: if that fails, everything is closed.
        self._closing = ExitStack()
        super().__init__(path)
        self._last: list[Array | None] = [None] * len(armatures)
        self._first: list[tuple[Array, Array]] = []
        try:
            # In the folder of the output file, since the folder for temporary files may be in
            # memory.
            self._places = [self._temporary() for _ in armatures]
            self._turns = [[self._temporary() for _ in a.names] for a in armatures]
        except OSError as error:
            self.abort()
            raise refused(path, error) from error

    def write(self, *hands: Keys) -> None:
        """Appends keys of all hands at the same moments."""
        try:
            for i, keys in enumerate(hands):
                self._write_hand(i, keys)
        except OSError as error:
            raise refused(self.paths[0], error) from error
        self.frames += len(hands[0].root)

    def finish(self) -> None:
        """Writes description and channels into the file."""
        try:
            self._finish()
        except OSError as error:
            raise refused(self.paths[0], error) from error
        finally:
            self._closing.close()

    def abort(self) -> None:
        """Removes the unfinished files."""
        super().abort()
        with suppress(OSError):
            self._closing.close()

    def _temporary(self) -> BinaryIO:
        folder = self.paths[0].parent
        return self._closing.enter_context(tempfile.TemporaryFile(dir=folder))

    def _write_hand(self, i: int, keys: Keys) -> None:
        turns = matrix_to_quaternion(keys.turns)
        before = self._last[i]
        chain = turns if before is None else np.concatenate([before[None], turns])
        # A quaternion and its opposite are the same rotation; the one nearer to the previous is
        # used.
        flips = np.where((chain[1:] * chain[:-1]).sum(axis=-1) < 0, -1.0, 1.0)
        if before is None:
            flips = np.concatenate([np.ones_like(chain[:1, :, 0]), flips])
            self._first.append((keys.root[0], turns[0]))
        turns = turns * np.cumprod(flips, axis=0)[..., None]
        self._last[i] = turns[-1]
        self._places[i].write(keys.root.astype("<f4").tobytes())
        stored = np.ascontiguousarray(turns[..., [1, 2, 3, 0]].astype("<f4").swapaxes(0, 1))
        for file, channel in zip(self._turns[i], stored, strict=True):
            file.write(channel.tobytes())

    def _finish(self) -> None:
        arrays = GlbArrays()
        nodes: list[dict[str, Any]] = []
        skins, meshes, tops = [], [], []
        parts = Skin.builtin().parts
        starts = []
        for i, armature in enumerate(self._armatures):
            skin = Skin.builtin().fitted(armature.skeleton)
            start = len(nodes)
            starts.append(start)
            nodes += self._joints(i, armature, start)
            top = len(nodes)
            nodes.append({"name": self._names[i], "rotation": UP, "children": [start]})
            nodes.append({"name": f"{self._names[i]} skin", "mesh": i, "skin": i})
            tops += [top, top + 1]
            primitives = [primitive(arrays, skin, p) for p in range(len(parts))]
            meshes.append({"name": self._names[i], "primitives": primitives})
            binds = inverse_binds(*frames(armature.skeleton, np.zeros(POSE_SIZE)))
            skins.append(
                {
                    "joints": list(range(start, start + len(armature.names))),
                    "skeleton": start,
                    "inverseBindMatrices": arrays.add(binds, FLOAT, "MAT4"),
                }
            )
        animation = self._animation(arrays, starts)
        out = self._outputs[0]
        out.write(
            arrays.head(
                {
                    "asset": {"version": "2.0", "generator": "Hand Sandbox"},
                    "scene": 0,
                    "scenes": [{"nodes": tops}],
                    "nodes": nodes,
                    "meshes": meshes,
                    "skins": skins,
                    "materials": [material(p.name) for p in parts],
                    "animations": [animation],
                }
            )
        )
        out.write(bytes(arrays.bytes))
        for a in range(0, self.frames, 1 << 16):
            at = np.arange(a, min(a + (1 << 16), self.frames))
            out.write((at / self._rate).astype("<f4").tobytes())
        for i in range(len(self._armatures)):
            for file in (self._places[i], *self._turns[i]):
                file.seek(0)
                shutil.copyfileobj(file, out.file)

    def _joints(self, i: int, armature: Armature, start: int) -> list[dict[str, Any]]:
        """Nodes of a hand, posed at its first key."""
        root, turns = self._first[i]
        hand = self._names[i].removesuffix(" hand").replace(" ", "_")
        before = f"{hand}_" if len(self._armatures) > 1 else ""
        out = []
        for j, name in enumerate(armature.names):
            w, x, y, z = turns[j].tolist()
            node: dict[str, Any] = {
                "name": before + name,
                "rotation": [x, y, z, w],
                "translation": (armature.offsets[j] if j else root).tolist(),
            }
            if armature.children[j]:
                node["children"] = [start + child for child in armature.children[j]]
            out.append(node)
        return out

    def _animation(self, arrays: GlbArrays, starts: list[int]) -> dict[str, Any]:
        """Channels, in the order in which their numbers are stored."""
        last = float(np.float32((self.frames - 1) / self._rate))
        time = arrays.append(self.frames, FLOAT, "SCALAR", min=[0.0], max=[last])
        samplers: list[dict[str, Any]] = []
        channels: list[dict[str, Any]] = []
        for i, armature in enumerate(self._armatures):
            paths = [("translation", 0, "VEC3")]
            paths += [("rotation", j, "VEC4") for j in range(len(armature.names))]
            for path, j, kind in paths:
                output = arrays.append(self.frames, FLOAT, kind)
                channels.append(
                    {"sampler": len(samplers), "target": {"node": starts[i] + j, "path": path}}
                )
                samplers.append({"input": time, "output": output, "interpolation": "LINEAR"})
        return {"name": "keys", "samplers": samplers, "channels": channels}


def glb(skin: Skin, name: str = "hand") -> bytes:
    """A .glb of a skin at the zero pose: one mesh, 15 joints, no other files.

    All joints are direct children of one node and are placed at the zero pose. So a program that
    knows the poses of the bodies can set the joints one by one.
    """
    writer = GlbArrays()
    primitives = [primitive(writer, skin, i) for i in range(len(skin.parts))]
    places, turns = frames(skin.skeleton, np.zeros(POSE_SIZE))
    names = ["palm", *(b.name for b in skin.skeleton.bones)]
    joints = []
    for bone, place, turn in zip(names, places, turns, strict=True):
        w, x, y, z = matrix_to_quaternion(turn).tolist()
        joints.append({"name": bone, "translation": place.tolist(), "rotation": [x, y, z, w]})
    top = len(joints)
    document = {
        "asset": {"version": "2.0", "generator": "Hand Sandbox"},
        "scene": 0,
        "scenes": [{"nodes": [top]}],
        "nodes": [
            *joints,
            {"name": name, "rotation": UP, "children": [*range(top), top + 1]},
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
        print(f"gltf: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
