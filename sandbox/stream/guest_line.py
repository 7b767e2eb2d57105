"""Parser of the stream's lines inside Maya and Blender. It is strict, since any program can write
to their ports. It runs with Python 3.7 and later."""

from __future__ import annotations

import math
import re
from typing import Dict, List, Sequence, Tuple

from sandbox.stream.guest_math import Quaternion, Refused, Vector, length, unit

LONGEST = 4096
FARTHEST = 1000.0  # m
BONES = 64


class Line:
    """One line of the stream; `kind` is moment, rig or stop."""

    def __init__(self, text: str) -> None:
        if len(text) >= LONGEST or not re.match(r"hs1( [A-Za-z0-9_.\-]+)+\Z", text):
            raise Refused("not a line of Hand Sandbox")
        words = text.split(" ")
        self.run, self.side, self.kind = "", "", ""
        self.time = 0.0
        self.place: Vector = (0.0, 0.0, 0.0)
        self.turn: Quaternion = (1.0, 0.0, 0.0, 0.0)
        # By finger: vector to the tip / length, direction in which it bulges, length (m).
        self.chains: Dict[int, Tuple[Vector, Vector, float]] = {}
        self.turns: Dict[int, Quaternion] = {}
        self.bones: List[Tuple[str, int, Vector, Quaternion]] = []
        self.ends: Dict[int, Vector] = {}
        try:
            self.run, self.side, self.kind = words[1], words[2], words[3]
            if self.kind == "rig":
                self._rig(words[4:])
            elif self.kind != "stop":
                self.kind = "moment"
                self._moment(words[3:])
            elif len(words) > 4:
                raise ValueError("words after stop")
        except (ValueError, IndexError) as error:
            raise Refused("the line is incomplete or damaged: %s" % error) from None

    def _moment(self, words: List[str]) -> None:
        self.time = _finite(words[1:2], 1)[0]
        if words[2] != "p" or int(words[0]) < 0 or not 0.0 <= self.time < 1e7:
            raise ValueError("not a moment")
        n = _finite(words[3:10], 7)
        self.place, self.turn = _vector(n[:3], FARTHEST), unit(n[3:])
        at = 10
        while at < len(words):
            if words[at] == "c":
                n, finger = _finite(words[at + 2 : at + 9], 7), int(words[at + 1])
                if not (0 <= finger < 5 and 1e-3 < n[6] < 10.0):
                    raise ValueError("not a finger")
                self.chains[finger] = (_vector(n[:3], 1.001), _vector(n[3:6], 1.001), n[6])
                at += 9
            elif words[at] == "j":
                joint = int(words[at + 1])
                if not 0 <= joint < BONES:
                    raise ValueError("not a joint")
                self.turns[joint] = unit(_finite(words[at + 2 : at + 6], 4))
                at += 6
            else:
                raise ValueError("an unknown word")

    def _rig(self, words: List[str]) -> None:
        at = 0
        while at < len(words):
            if words[at] == "b":
                n, parent = _finite(words[at + 3 : at + 10], 7), int(words[at + 2])
                if not -1 <= parent < len(self.bones) < BONES or (parent < 0) == bool(self.bones):
                    raise ValueError("not a tree of joints")
                self.bones.append((words[at + 1], parent, _vector(n[:3], FARTHEST), unit(n[3:])))
                at += 10
            elif words[at] == "e":
                joint = int(words[at + 1])
                if not 0 <= joint < len(self.bones):
                    raise ValueError("a fingertip of an unknown joint")
                self.ends[joint] = _vector(_finite(words[at + 2 : at + 5], 3), FARTHEST)
                at += 5
            else:
                raise ValueError("an unknown word")


def _finite(words: Sequence[str], count: int) -> List[float]:
    numbers = [float(word) for word in words]
    if len(numbers) != count or not all(math.isfinite(v) for v in numbers):
        raise ValueError("not the expected numbers")
    return numbers


def _vector(numbers: Sequence[float], longest: float) -> Vector:
    vector: Vector = (numbers[0], numbers[1], numbers[2])
    if length(vector) > longest:
        raise ValueError("too far away")
    return vector
