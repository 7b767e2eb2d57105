"""Writes skinned hands in motion as one binary glTF 2.0 file (.glb), key by key.

Lengths are metres, and +y is up. Joints are nested nodes, each in its own frame; a node above the
wrist rotates the world's z axis (up) to glTF's y axis. Keys are interpolated linearly: a quaternion
for every joint, and the wrist's position. In the file, the description precedes the numbers, and
the numbers of one joint are contiguous. Every channel is therefore collected in its own temporary
file until the end.
"""

from __future__ import annotations

import shutil
import tempfile
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from models.arithmetic import Array
from models.motion.armature import Armature, Keys
from models.motion.output import MotionWriter, checked_rate, refused
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.skin.skin import Skin, frames
from models.skin.skinned_glb import FLOAT, GlbArrays, inverse_binds, material, primitive

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
