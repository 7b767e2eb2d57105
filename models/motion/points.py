"""Named points of moving hands (fingertips and joints), and CSV tables of these points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.frames import FINGERS
from models.motion.armature import WRIST, Armature, Keys
from models.motion.output import MotionWriter, checked_rate, rows


@dataclass(frozen=True)
class HandPoints:
    """Selection of points of hands, in the order in which they are written.

    Attributes:
        armatures: The hands.
        names: Names of the hands, used as prefixes if there are two hands.
        joints: True adds wrist and joints to the fingertips.
        fingers: Labels of the selected fingers.
    """

    armatures: Sequence[Armature]
    names: Sequence[str]
    joints: bool = False
    fingers: Sequence[int] = tuple(range(len(FINGERS)))

    def __post_init__(self) -> None:
        if not self.fingers or not set(self.fingers) <= set(range(len(FINGERS))):
            raise MotionError("no such fingers", got=str(list(self.fingers)))

    @property
    def labels(self) -> list[str]:
        """Names of the points: `thumb_tip`, .. or `right_thumb_tip`, .."""
        out = []
        for armature, name in zip(self.armatures, self.names, strict=True):
            before = f"{name}_" if len(self.names) > 1 else ""
            tips = [f"{FINGERS[f]}_tip" for f in self.fingers]
            joints = [armature.names[j] for j in self._joints(armature)]
            out += [before + label for label in (*joints, *tips)]
        return out

    def place(self, hands: Sequence[Keys]) -> Array:
        """Positions (n, P, 3) m of the points in the world."""
        parts = []
        for armature, keys in zip(self.armatures, hands, strict=True):
            joints, tips = armature.place(keys)
            parts += [joints[:, self._joints(armature)], tips[:, list(self.fingers)]]
        return np.concatenate(parts, axis=1)

    def _joints(self, armature: Armature) -> list[int]:
        if not self.joints:
            return []
        bones = enumerate(armature.skeleton.bones, start=1)
        own = [j for j, bone in bones if bone.finger in self.fingers]
        return [armature.names.index(WRIST), *own]


DECIMALS = 9
"""Number of decimals; the last decimal is a nanometre or a nanosecond."""


class PointsCsvWriter(MotionWriter):
    """Points of any number of hands as CSV.

    Args:
        path: Path of the file.
        points: The points to write.
        rate: Rate (Hz) of the keys.
    """

    def __init__(self, path: Path, points: HandPoints, rate: float) -> None:
        self._points, self._rate = points, checked_rate(rate)
        super().__init__(path)
        columns = ["time", *(f"{name}_{axis}" for name in points.labels for axis in "xyz")]
        self._outputs[0].write((",".join(columns) + "\n").encode("ascii"))
        self._line = ",".join([f"%.{DECIMALS}f"] * len(columns)) + "\n"

    def write(self, *hands: Keys) -> None:
        """Appends keys of all hands at the same moments."""
        places = self._points.place(hands)
        time = np.arange(self.frames, self.frames + len(places)) / self._rate
        values = np.concatenate([time[:, None], places.reshape(len(places), -1)], axis=1)
        self._outputs[0].write(rows(values, self._line, DECIMALS))
        self.frames += len(places)
