"""Pose tracks: compressed poses of a trial, for viewing it on machines that cannot reproduce it.

A track is for viewing only, as all joint positions are rounded. A simulation continues from a
keyframe.
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
"""Rounding of joint positions, in m, rad or quaternion units: 0.02 mm, 0.002 degrees."""
LEVEL = 6
"""Compression level of zlib. Level 6 takes 0.1 ms for the poses of a second; level 9 takes 0.5 to
1 ms and saves 2 percent."""
ROOM = 64
"""Initial capacity, poses: slightly more than a second."""
LONGEST = 3600 * 1000
"""Largest number of poses in one line of an undamaged file."""


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
    """Labels of fingers as a bit mask."""
    return sum(1 << f for f in fingers)


class PoseTrackWriter:
    """Collects poses and turns them into lines of a recording.

    Poses are copied into memory that was allocated beforehand: in a loop that has just slept,
    allocation takes longer than copying.
    """

    def __init__(self) -> None:
        self._entries: list[tuple[int, Sequence[frozenset[int]]]] = []
        self._poses = np.empty((0, 0))

    def add(self, step: int, qpos: Array, solid: Sequence[frozenset[int]]) -> None:
        """Adds a pose (nq,) and the solid fingers of every hand at a physics step."""
        row = len(self._entries)
        if row == len(self._poses):
            self._make_room(len(qpos))
        self._poses[row] = qpos
        self._entries.append((step, solid))

    def take(self) -> Callable[[], dict[str, Any]] | None:
        """A function that makes a line of all poses since the last call; None without poses.

        The function takes a millisecond, and may be called at any time and from any thread.
        """
        if not self._entries:
            return None
        make = partial(_line_of, self._entries, self._poses)
        self._entries, self._poses = [], np.empty_like(self._poses)
        return make

    def line(self) -> dict[str, Any] | None:
        """A line of all poses since the last one; None without poses."""
        make = self.take()
        return make() if make else None

    def _make_room(self, joints: int) -> None:
        room = np.empty((max(ROOM, 2 * len(self._poses)), joints))
        if len(self._poses):
            room[: len(self._poses)] = self._poses
        self._poses = room


def _line_of(
    entries: Sequence[tuple[int, Sequence[frozenset[int]]]], poses: Array
) -> dict[str, Any]:
    steps, solid = zip(*entries, strict=True)
    return track_line(list(steps), poses[: len(entries)], solid)


def track_line(
    steps: list[int], poses: Array | Sequence[Array], solid: Sequence[Sequence[frozenset[int]]]
) -> dict[str, Any]:
    """The line of a recording with poses (nq,) and the solid fingers of every hand, by step."""
    with np.errstate(invalid="ignore"):
        places = np.clip(np.nan_to_num(np.array(poses)), -1e4, 1e4) / GRAIN
    masks = [[bits(labels) for labels in hands] for hands in solid]
    fingers = np.array(masks, np.int64).reshape(len(steps), -1)
    rows = np.hstack([np.rint(places).astype(np.int64), fingers])
    changes = np.diff(rows, axis=0, prepend=0 * rows[:1])
    # Zigzag encoding: small changes of either sign become small numbers, whose upper bytes are 0.
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
    """Adds the poses of a recorded line to a track.

    Raises:
        ValueError: The line is damaged.
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
