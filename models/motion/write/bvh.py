"""Writes a hand as BVH, key by key: y up, centimetres, degrees in any Euler order.

Offsets are the hand in its zero pose (`models.motion.armature`), so that the file needs only the
rotations of the motion. The number of frames in the header is filled in at the end.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from models.arithmetic import Array
from models.motion.armature import Y_UP, Armature, Keys
from models.motion.euler import ContinuousEuler
from models.motion.output import NUMBER, MotionWriter, checked_rate, rows

CENTIMETRES = 100.0
"""Centimetres in a metre."""

_COUNT = 10
"""Characters reserved for the number of frames."""


class BvhWriter(MotionWriter):
    """One hand as BVH.

    Args:
        path: Path of the file.
        armature: The hand.
        rate: Hz of the keys.
        order: Euler order of every joint.
    """

    def __init__(self, path: Path, armature: Armature, rate: float, order: str = "ZXY") -> None:
        frame_time = 1.0 / checked_rate(rate)
        self._armature, self._zero = armature, armature.zero(order)
        self.euler = ContinuousEuler(order)
        super().__init__(path)
        out = self._outputs[0]
        out.write(_hierarchy(armature, self._zero, order).encode("ascii"))
        out.write(b"MOTION\nFrames: ")
        self._count_at = out.file.tell()
        # Eight decimals, or 60 Hz would not be 60 Hz to its fifth digit.
        out.write(f"{'':{_COUNT}}\nFrame Time: {frame_time:.8f}\n".encode("ascii"))
        self._line = " ".join([NUMBER] * (3 + 3 * len(armature.names))) + "\n"

    def write(self, *hands: Keys) -> None:
        """Appends keys of the one hand."""
        (keys,) = hands
        root, turns = self._armature.relative(keys, self._zero, Y_UP)
        angles = np.rad2deg(self.euler.angles(turns))
        values = np.concatenate([CENTIMETRES * root, angles.reshape(len(root), -1)], axis=1)
        self._outputs[0].write(rows(values, self._line))
        self.frames += len(root)

    @property
    def greatest_step(self) -> tuple[float, int, str]:
        """Largest change of an angle between two keys: degrees, the later key, the joint."""
        key, joint = self.euler.biggest_at
        return float(np.rad2deg(self.euler.biggest_step)), key, self._armature.names[joint]

    def finish(self) -> None:
        """Writes the number of frames into the header."""
        self._outputs[0].put(self._count_at, f"{self.frames:<{_COUNT}d}".encode("ascii"))


def _hierarchy(armature: Armature, zero: Array, order: str) -> str:
    turns = " ".join(f"{axis}rotation" for axis in order)
    lines = ["HIERARCHY"]

    def offset(at: Array, indent: str) -> str:
        x, y, z = (np.round(CENTIMETRES * at, 6) + 0.0).tolist()
        return f"{indent}OFFSET {x:.6f} {y:.6f} {z:.6f}"

    def joint(j: int, depth: int) -> None:
        tab = "\t" * depth
        lines.append(f"{tab}{'JOINT' if depth else 'ROOT'} {armature.names[j]}")
        lines.append(tab + "{")
        parent = armature.parents[j]
        lines.append(
            offset(zero[parent] @ armature.offsets[j] if depth else np.zeros(3), tab + "\t")
        )
        places = "6 Xposition Yposition Zposition" if not depth else "3"
        lines.append(f"{tab}\tCHANNELS {places} {turns}")
        for child in armature.children[j]:
            joint(child, depth + 1)
        if not armature.children[j]:
            lines.extend([f"{tab}\tEnd Site", tab + "\t{"])
            lines.append(offset(zero[j] @ armature.ends[j], tab + "\t\t"))
            lines.append(tab + "\t}")
        lines.append(tab + "}")

    joint(0, 0)
    return "\n".join(lines) + "\n"
