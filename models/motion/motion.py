"""Motion of any skeleton, as read from BVH, ASF/AMC and other files."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.reader_report import ReaderReport


class PlacedJoints(NamedTuple):
    """Positions and rotations of the joints, in the recording's own frame."""

    positions: Array
    """(T, J, 3) m."""
    rotations: Array
    """(T, J, 3, 3), the frame attached to each joint."""
    ends: Array
    """(T, J, 3) m, ends of the joints' bones; NaN for joints whose bone has no end."""


@dataclass(frozen=True)
class Motion:
    """T frames of J joints, parents before children.

    Attributes:
        names: Unique names of the joints.
        parents: (J,) index of each joint's parent, -1 for a root.
        shifts: (T, J, 3) m, position of every joint in its parent's frame.
        rotations: (T, J, 3, 3), parent from joint.
        ends: (J, 3) m, end of a joint's bone in the joint's frame; NaN for joints without an end.
        frame_time: Duration of one frame (s).
        numbers: (T,) number of each frame from 0, increasing, if the recorder may have left frames
            out; None for consecutive frames.
        report: Parts of the file that the reader left out or assumed.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    shifts: Array
    rotations: Array
    ends: Array
    frame_time: float
    numbers: Array | None = None
    report: ReaderReport = field(default_factory=ReaderReport)

    def __len__(self) -> int:
        return len(self.shifts)

    @property
    def time(self) -> Array:
        """Times (T,) s from the first frame."""
        numbers = np.arange(len(self), dtype=np.float64) if self.numbers is None else self.numbers
        return np.asarray(numbers * self.frame_time)

    def index(self, name: str) -> int:
        """Index of a joint.

        Raises:
            MotionError: The joint does not exist.
        """
        if name not in self.names:
            raise MotionError("no such joint", got=name, expected=", ".join(self.names))
        return self.names.index(name)

    def place(self) -> PlacedJoints:
        """Forward kinematics of all frames."""
        positions = np.empty(self.shifts.shape)
        rotations = np.empty(self.rotations.shape)
        for j, parent in enumerate(self.parents):
            if parent < 0:
                positions[:, j], rotations[:, j] = self.shifts[:, j], self.rotations[:, j]
                continue
            above = rotations[:, parent]
            moved = (above @ self.shifts[:, j, :, None])[..., 0]
            positions[:, j] = positions[:, parent] + moved
            rotations[:, j] = above @ self.rotations[:, j]
        ends = positions + (rotations @ self.ends[:, :, None])[..., 0]
        return PlacedJoints(positions, rotations, ends)


def rotations_of_angles(angles: Array, axes: str, *, fixed: bool) -> Array:
    """Products (..., 3, 3) of n rotations by angles (..., n) rad about coordinate axes.

    Args:
        angles: Angles in the order of the axes.
        axes: Letters x, y and z.
        fixed: True rotates about fixed axes (ASF). False rotates about axes that earlier rotations
            have rotated (BVH).
    """
    out = np.broadcast_to(np.eye(3), (*angles.shape[:-1], 3, 3))
    for i, axis in enumerate(axes):
        turn = _about("xyz".index(axis), angles[..., i])
        out = turn @ out if fixed else out @ turn
    return np.array(out)


def _about(axis: int, angle: Array) -> Array:
    """Rotations (..., 3, 3) about one coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    out = np.zeros((*angle.shape, 3, 3))
    b, d = (axis + 1) % 3, (axis + 2) % 3
    out[..., axis, axis] = 1.0
    out[..., b, b] = out[..., d, d] = c
    out[..., b, d], out[..., d, b] = -s, s
    return out
