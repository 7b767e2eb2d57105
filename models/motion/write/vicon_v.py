"""Writes a hand's motion as a Vicon V file (.v) beside its skeleton (.vsk), key by key."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from models.arithmetic import Array
from models.motion.armature import Z_UP, Armature, Keys
from models.motion.output import MotionWriter, checked_rate
from models.motion.read.vicon_v import MAGIC, SECTION, VERSION
from models.motion.write.vsk import MILLIMETRES, ORDER, vsk
from models.rotations import log, unwrap_near

GROUP, FLOAT = 1, 5


class VWriter(MotionWriter):
    """One hand as V and VSK.

    Args:
        path: Path of either file; the other has the same name with the other ending.
        armature: The hand.
        rate: Hz of the keys.
        subject: Prefix of the labels.
    """

    def __init__(self, path: Path, armature: Armature, rate: float, subject: str = "hand") -> None:
        checked_rate(rate)
        self._armature, self._zero = armature, armature.zero(ORDER)
        self._last: Array | None = None
        super().__init__(path.with_suffix(".v"), path.with_suffix(".vsk"))
        self._v, skeleton = self._outputs
        skeleton.write(vsk(armature))
        labels = [f"{subject}:{name} <a-{axis}>" for name in armature.names for axis in "XYZ"]
        labels[3:3] = [f"{subject}:{armature.names[0]} <t-{axis}>" for axis in "XYZ"]
        self._v.write(_static(labels, rate))
        self._record = np.dtype(
            [("length", "<u2"), ("group", "<u2"), ("frame", "<u4"), ("values", "<f4", len(labels))]
        )

    def write(self, *hands: Keys) -> None:
        """Appends keys of the one hand."""
        (keys,) = hands
        root, turns = self._armature.relative(keys, self._zero, Z_UP)
        vectors = self._continuous(log(turns))
        count = len(root)
        records = np.zeros(count, self._record)
        records["length"] = self._record.itemsize - 2
        records["group"] = GROUP
        records["frame"] = np.arange(self.frames + 1, self.frames + count + 1)
        records["values"] = np.concatenate(
            [vectors[:, 0], MILLIMETRES * root, vectors[:, 1:].reshape(count, -1)], axis=1
        )
        self._v.write(records.tobytes())
        self.frames += count

    def _continuous(self, vectors: Array) -> Array:
        """Rotation vectors without jumps by whole turns; only the wrist's could jump."""
        last = vectors[0, 0] if self._last is None else self._last
        chain = np.concatenate([last[None], vectors[:, 0]])
        jumps = np.abs(np.diff(chain, axis=0)).max(axis=1) > np.pi / 2
        if jumps.any() or np.linalg.norm(last) > np.pi:
            for i in range(len(vectors)):
                last = vectors[i, 0] = unwrap_near(vectors[i, 0], last)
        self._last = vectors[-1, 0]
        return vectors


def _static(labels: list[str], rate: float) -> bytes:
    """All bytes before the first frame."""
    described = b"a hand\0"
    body = struct.pack("<HB", GROUP, len(described)) + described
    body += struct.pack("<BBdH", FLOAT, 4, rate, len(labels))
    for label in labels:
        text = label.encode("ascii") + b"\0"
        body += bytes([len(text)]) + text
    section = struct.pack("<H", len(body)) + body + b"\0\0"
    out = MAGIC + struct.pack("<h", VERSION)
    out += SECTION.pack(len(section), b"DATAGROUP") + section
    return out + SECTION.pack(0, b"")
