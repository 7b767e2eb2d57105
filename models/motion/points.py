"""Named points of moving hands: fingertips and joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.frames import FINGERS
from models.motion.armature import WRIST, Armature, Keys


@dataclass(frozen=True)
class HandPoints:
    """Selection of points of hands, in the order in which they are written.

    Attributes:
        armatures: The hands.
        names: Names of the hands, used as prefixes where there are two.
        joints: True adds wrist and joints; otherwise fingertips alone.
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
