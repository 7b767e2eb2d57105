"""Tracks: every pose of a trial in a few bytes, so that it can be looked at where it cannot be
simulated again.

A track is for eyes: all joint positions are rounded. What a simulation goes on from is a keyframe.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from typing import Any

import numpy as np

from models.arithmetic.arrays import Array

GRAIN = 2e-5
"""m, rad or part of a quaternion, to which joint positions are rounded: 0.02 mm, 0.002 degrees."""
LEVEL = 6
"""Of zlib: a second's poses take 0.1 ms; 9 takes 0.5 to 1 ms and saves 2 percent."""
ROOM = 64
"""Poses: a second's, and a little."""
LONGEST = 3600 * 1000
"""Poses in one line beyond which a file is damaged."""


@dataclass(frozen=True)
class PoseTrack:
    """Poses by physics step.

    Attributes:
        qpos: Joint positions of the scene's model (nq,) by step.
        solid: Labels of the solid fingers of every hand by step.
    """

    qpos: dict[int, Array] = field(default_factory=dict)
    solid: dict[int, tuple[frozenset[int], ...]] = field(default_factory=dict)


@cache
def bits(fingers: frozenset[int]) -> int:
    """Fingers as a number, one bit each."""
    return sum(1 << f for f in fingers)


class PoseTrackWriter:
    """Collects poses, of which a line is made now and then.

    Poses are put into memory that was asked for beforehand: in a loop that has just slept, asking
    costs more than copying.
    """

    def __init__(self) -> None:
        self._told: list[tuple[int, Sequence[frozenset[int]]]] = []
        self._poses = np.empty((0, 0))

    def add(self, step: int, qpos: Array, solid: Sequence[frozenset[int]]) -> None:
        """Takes in a pose (nq,) and who is solid at a physics step."""
        row = len(self._told)
        if row == len(self._poses):
            self._make_room(len(qpos))
        self._poses[row] = qpos
        self._told.append((step, solid))

    def take(self) -> Callable[[], dict[str, Any]] | None:
        """Function that makes a line of everything collected since the last call; None if that is
        nothing. It takes a millisecond, and may be called at any time, from any thread."""
        if not self._told:
            return None
        make = partial(_line_of, self._told, self._poses)
        self._told, self._poses = [], np.empty_like(self._poses)
        return make

    def line(self) -> dict[str, Any] | None:
        """A line of all that was collected since the last time; None where that is nothing."""
        make = self.take()
        return make() if make else None

    def _make_room(self, joints: int) -> None:
        room = np.empty((max(ROOM, 2 * len(self._poses)), joints))
        if len(self._poses):
            room[: len(self._poses)] = self._poses
        self._poses = room


def _line_of(told: Sequence[tuple[int, Sequence[frozenset[int]]]], poses: Array) -> dict[str, Any]:
    steps, solid = zip(*told, strict=True)
    return track_line(list(steps), poses[: len(told)], solid)


def track_line(
    steps: list[int], poses: Array | Sequence[Array], solid: Sequence[Sequence[frozenset[int]]]
) -> dict[str, Any]:
    """A line of poses (nq,) and labels of solid fingers of every hand at some physics steps."""
    with np.errstate(invalid="ignore"):
        places = np.clip(np.nan_to_num(np.array(poses)), -1e4, 1e4) / GRAIN
    masks = [[bits(labels) for labels in hands] for hands in solid]
    fingers = np.array(masks, np.int64).reshape(len(steps), -1)
    rows = np.hstack([np.rint(places).astype(np.int64), fingers])
    changes = np.diff(rows, axis=0, prepend=0 * rows[:1])
    # Zigzag: small changes of either sign become small numbers, whose upper bytes are 0.
    folded = ((changes << 1) ^ (changes >> 63)).astype("<u4")
    planes = np.ascontiguousarray(folded.T).view(np.uint8).reshape(-1, 4).T
    data = base64.b64encode(zlib.compress(planes.tobytes(), LEVEL)).decode()
    return {
        "kind": "track",
        "steps": _runs(steps),
        "hands": fingers.shape[1],
        "joints": places.shape[1],
        "poses": data,
    }


def read_track_line(line: dict[str, Any], track: PoseTrack) -> None:
    """Adds a line's poses to a track.

    Raises:
        ValueError: It is damaged.
    """
    first, stride, count = (int(n) for n in line["steps"])
    joints, hands = int(line["joints"]), int(line["hands"])
    if not (0 < count <= LONGEST and 0 <= joints <= 10_000 and 0 <= hands <= 8):
        raise ValueError("a track of this size")
    size = 4 * count * (joints + hands)
    packed = zlib.decompressobj()
    data = packed.decompress(base64.b64decode(line["poses"], validate=True), size + 1)
    if len(data) != size:
        raise ValueError("a track of another length than it says")
    planes = np.frombuffer(data, np.uint8).reshape(4, -1).T
    folded = np.ascontiguousarray(planes).view("<u4").reshape(joints + hands, count).T
    folded = folded.astype(np.int64)
    rows = np.cumsum((folded >> 1) ^ -(folded & 1), axis=0)
    for i, row in enumerate(rows):
        step = first + i * stride
        track.qpos[step] = row[:joints] * GRAIN
        track.solid[step] = tuple(
            frozenset(f for f in range(5) if bits >> f & 1) for bits in row[joints:].tolist()
        )


def _runs(steps: list[int]) -> list[int]:
    """First step, stride and count of evenly spaced steps."""
    stride = steps[1] - steps[0] if len(steps) > 1 else 1
    return [steps[0], stride, len(steps)]
