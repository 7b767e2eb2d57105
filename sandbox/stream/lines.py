"""The stream's format: one moment of a hand as a short, self-contained line of text.

    hs1 RUN SIDE SEQ TIME p X Y Z W X Y Z [c K DX DY DZ PX PY PZ L]... [j J W X Y Z]...
    hs1 RUN SIDE rig b NAME PARENT X Y Z W X Y Z ... e PARENT X Y Z ...
    hs1 RUN SIDE stop

`p` is the palm: its place (m), and a unit quaternion that rotates palm axes to world axes. In the
palm's frame, x points towards the little finger of a right hand or the thumb of a left hand, y
along the fingers, z out of the back of the hand. `c` is finger K, in the palm's frame. D is the
vector from the finger's first joint to its tip, divided by the length L (m) of its bones, so that D
has length 1 for a straight finger (direction times length ratio, PAALM section 5). P is the
direction in which the finger bulges when it bends. `j` is the rotation of joint J, from joint axes
to parent axes. A `rig` line describes the hand itself, with all joints at zero: joints (`b`), and
fingertips (`e`).

Every line of a moment has the palm, so that any such line may be lost. A line is shorter than the
limit of Maya's command port. Only letters, digits, `.`, `-`, `_` and spaces occur, so that a line
needs no escapes in any language.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from secrets import token_hex

import numpy as np

from models.arithmetic import Array
from models.errors import InputError
from models.frames import FINGERS
from models.motion.armature import Y_UP, Z_UP, Armature, Keys
from models.rotations import matrix_to_quaternion

LIMIT = 4096
"""Number of bytes (Maya's default bufferSize) from which Maya's command port closes the connection.
"""

VERSION = "hs1"
STRAIGHT = 0.9999
"""Largest length ratio that is sent. If a target is out of reach, IK solvers oscillate."""


@dataclass(frozen=True)
class StreamTarget:
    """A program that receives lines.

    Attributes:
        name: Name for people.
        up: (3, 3) rotation from this program's world axes to the receiver's.
        turns: True if the rotations of all joints are also sent.
        wrap: Function that converts a line to a command without newline.
    """

    name: str
    up: Array
    turns: bool
    wrap: Callable[[str], str]


MAYA = StreamTarget("Maya", Y_UP, False, "hand_sandbox('{}')".format)
MAYA_MEL = StreamTarget("Maya (MEL)", Y_UP, False, "python(\"hand_sandbox('{}')\");".format)
BLENDER = StreamTarget("Blender", Z_UP, True, "{}".format)


class HandLines:
    """Writes the lines of one hand.

    Args:
        armature: Armature of the hand.
        side: Name of the hand, `right` or `left`.
        target: The receiving program.
        limit: Number of bytes below which every command must be.
        run: Id of this start of the program; None chooses a random id.
    """

    def __init__(
        self,
        armature: Armature,
        side: str,
        target: StreamTarget,
        limit: int = LIMIT,
        run: str | None = None,
    ) -> None:
        self._armature, self._target, self._limit = armature, target, limit
        self._head = f"{VERSION} {run or token_hex(4)} {side}"
        self._chains = _chains(armature)
        self._lengths = [_length(armature, chain) for chain in self._chains]
        self._sent = 0

    @property
    def rig(self) -> str:
        """The command that describes the hand itself; sent at every start of a connection."""
        arm, zero = self._armature, self._armature.zero("ZXY")
        zero = zero[0].T @ zero  # in the palm's frame: fingers straight, side by side
        items = []
        for j, name in enumerate(arm.names):
            parent = arm.parents[j]
            turn = zero[parent].T @ zero[j] if j else np.eye(3)
            place = _numbers(arm.offsets[j], 5)
            items.append(f"b {name} {parent} {place} {_quaternion(turn)}")
        items += [f"e {chain[-1]} {_numbers(arm.ends[chain[-1]], 5)}" for chain in self._chains]
        return self._command(f"{self._head} rig " + " ".join(items))

    @property
    def stop(self) -> str:
        """The command that ends the stream: the receiver bakes keyframes and releases the rig."""
        return self._command(f"{self._head} stop")

    def lines(self, time: float, keys: Keys) -> list[str]:
        """The commands of one moment: usually one command, several if it would be too long.

        Args:
            time: Time since the stream's start, s.
            keys: Keyframe of one moment, shapes (1, 3) and (1, 15, 3, 3).

        Raises:
            InputError: A command with a single finger or joint exceeds the limit.
        """
        items = self._items(keys)
        head = f"{self._head} {self._sent} {time:.4f} {items[0]}"
        self._sent += 1
        out, line = [], head
        for item in items[1:]:
            longer = f"{line} {item}"
            if len(self._target.wrap(longer)) + 1 >= self._limit and line != head:
                out.append(self._command(line))
                longer = f"{head} {item}"
            line = longer
        return [*out, self._command(line)]

    def _items(self, keys: Keys) -> list[str]:
        arm, up = self._armature, self._target.up
        joints, tips = arm.place(keys)
        palm, turns = keys.turns[0, 0], keys.turns[0]
        items = [f"p {_numbers(up @ keys.root[0], 6)} {_quaternion(up @ palm)}"]
        for k, chain in enumerate(self._chains):
            reach = palm.T @ (tips[0, k] - joints[0, chain[0]]) / self._lengths[k]
            reach *= min(1.0, STRAIGHT / max(float(np.linalg.norm(reach)), 1e-9))
            # The finger bulges in the direction of its back, half-way along the finger.
            first, second = turns[chain[0]], turns[chain[1]]
            back = (first @ second)[:, 2]
            numbers = f"{_numbers(reach, 5)} {_numbers(back, 4)} {self._lengths[k]:.5f}"
            items.append(f"c {k} {numbers}")
        if self._target.turns:
            items += [f"j {j} {_quaternion(turns[j])}" for j in range(1, len(arm.names))]
        return items

    def _command(self, line: str) -> str:
        command = self._target.wrap(line)
        if len(command) + 1 >= self._limit:
            raise InputError(
                "a command would be too long for the receiving program",
                where=self._target.name,
                got=f"{len(command) + 1} bytes",
                expected=f"below {self._limit}",
            )
        return command


def _chains(armature: Armature) -> list[list[int]]:
    """Joints of every finger, from the palm outwards."""
    out: list[list[int]] = [[] for _ in FINGERS]
    for j, bone in enumerate(armature.skeleton.bones, start=1):
        out[bone.finger].append(j)
    return out


def _length(armature: Armature, chain: list[int]) -> float:
    """Sum (m) of the lengths of a finger's bones."""
    return float(sum(armature.skeleton.bones[j - 1].length for j in chain))


def _numbers(values: Array, decimals: int) -> str:
    # Adding 0.0 avoids -0, which would cost a byte.
    return " ".join(f"{v:.{decimals}f}" for v in (np.round(values, decimals) + 0.0).tolist())


def _quaternion(rotation: Array) -> str:
    return _numbers(matrix_to_quaternion(rotation), 7)
