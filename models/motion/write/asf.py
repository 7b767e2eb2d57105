"""Writes a hand as an Acclaim skeleton (.asf) and its motion (.amc), key by key.

y up, centimetres (written as in the CMU files: inches times `length`), degrees. A bone begins where
its parent ends, so every finger is attached to a bone without degrees of freedom, from the wrist to
its knuckle. All bones share the file's frame at rest (`axis 0 0 0`); rotations are about fixed
axes, x first, as every reader expects, which equals the Euler order ZYX about rotating axes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from models.arithmetic import Array
from models.motion.armature import Y_UP, Armature, Keys
from models.motion.euler import ContinuousEuler
from models.motion.output import NUMBER, MotionWriter, checked_rate, rows
from models.motion.read.asf import RATE_REMARK

ORDER = "ZYX"
CENTIMETRES = 100.0
LENGTH = 2.54
"""The file's unit of length: numbers divided by it are inches."""


class AmcWriter(MotionWriter):
    """One hand as ASF and AMC.

    Args:
        path: Path of either file; the other has the same name with the other ending.
        armature: The hand.
        rate: Hz of the keys.
    """

    def __init__(self, path: Path, armature: Armature, rate: float) -> None:
        checked_rate(rate)
        self._armature, self._zero = armature, armature.zero(ORDER)
        self.euler = ContinuousEuler(ORDER)
        super().__init__(path.with_suffix(".asf"), path.with_suffix(".amc"))
        asf, self._amc = self._outputs
        asf.write(_skeleton(armature, self._zero).encode("ascii"))
        self._amc.write(f"{RATE_REMARK} {rate:.9g}\n:FULLY-SPECIFIED\n:DEGREES\n".encode("ascii"))
        lines = ["%d", " ".join(["root", *[NUMBER] * 6])]
        lines += [" ".join([name, *[NUMBER] * 3]) for name in armature.names[1:]]
        self._line = "\n".join(lines) + "\n"

    def write(self, *hands: Keys) -> None:
        """Appends keys of the one hand."""
        (keys,) = hands
        root, turns = self._armature.relative(keys, self._zero, Y_UP)
        count = len(root)
        # For fixed axes the order is reversed: the last one comes first.
        angles = np.rad2deg(self.euler.angles(turns))[..., ::-1].reshape(count, -1)
        numbers = np.arange(self.frames + 1, self.frames + count + 1)[:, None]
        values = np.concatenate([numbers, CENTIMETRES * root, angles], axis=1)
        self._amc.write(rows(values, self._line))
        self.frames += count


def _skeleton(armature: Armature, zero: Array) -> str:
    bones: list[tuple[str, Array, bool]] = []
    hierarchy: list[str] = []
    for j, name in enumerate(armature.names):
        below = [armature.names[child] for child in armature.children[j]]
        if not j:
            for child in armature.children[0]:
                base = f"{armature.names[child].partition('_')[0]}_base"
                bones.append((base, zero[0] @ armature.offsets[child], False))
                hierarchy.append(f"{base} {armature.names[child]}")
            hierarchy.insert(0, " ".join(["root", *(b[0] for b in bones)]))
            continue
        end = armature.offsets[armature.children[j][0]] if below else armature.ends[j]
        bones.append((name, zero[j] @ end, True))
        if below:
            hierarchy.append(" ".join([name, *below]))
    lines = [
        ":version 1.10",
        ":name hand",
        ":units",
        "  mass 1.0",
        f"  length {LENGTH}",
        "  angle deg",
        ":documentation",
        f"  A {armature.skeleton.side} hand of the Hand Sandbox, y up, cm",
        ":root",
        "  order TX TY TZ RX RY RZ",
        "  axis XYZ",
        "  position 0 0 0",
        "  orientation 0 0 0",
        ":bonedata",
    ]
    for number, (name, along, moves) in enumerate(bones, start=1):
        length = float(np.linalg.norm(along))
        x, y, z = (np.round(along / length, 12) + 0.0).tolist()
        lines += [
            "  begin",
            f"    id {number}",
            f"    name {name}",
            f"    direction {x:.12f} {y:.12f} {z:.12f}",
            f"    length {CENTIMETRES * length:.9f}",
            "    axis 0 0 0 XYZ",
        ]
        if moves:
            lines += ["    dof rx ry rz", "    limits (-180.0 180.0)"]
            lines += ["           (-180.0 180.0)"] * 2
        lines.append("  end")
    lines += [":hierarchy", "  begin", *(f"    {line}" for line in hierarchy), "  end"]
    return "\n".join(lines) + "\n"
