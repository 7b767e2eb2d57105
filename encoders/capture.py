"""Captures: touches and hand poses recorded at the same time, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.input_vector import contact_vectors
from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import FINGERS
from models.pose import POSE_SIZE, relative_pose


@dataclass(frozen=True)
class Capture:
    """Recorded frames of contacts and pose; T frames, sorted by trial, then time.

    Contacts are stored by label: finger f of frame t has the id `ids[t, f]` and the position
    `xy[t, f]`, or -1 and NaN while it is lifted.

    Attributes:
        time: (T,) s.
        trial: (T,) int, equal for the frames of one continuous take. Frames of a trial depend on
            each other, so captures must be split by trial.
        ids: (T, 5) int64, contact ids.
        xy: (T, 5, 2) m on the surface, x right and y down.
        q: (T, 48) pose in the 3-D surface frame.
        meta: Subject, side, skeleton, rate (Hz) and origin of the capture; JSON values only.
    """

    time: Array
    trial: NDArray[np.int64]
    ids: NDArray[np.int64]
    xy: Array
    q: Array
    meta: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        frames = len(self.time)
        for name, shape in (
            ("time", (frames,)),
            ("trial", (frames,)),
            ("ids", (frames, len(FINGERS))),
            ("xy", (frames, len(FINGERS), 2)),
            ("q", (frames, POSE_SIZE)),
        ):
            if getattr(self, name).shape != shape:
                raise CaptureError(
                    "wrong shape", where=name, got=getattr(self, name).shape, expected=str(shape)
                )
        if not frames:
            raise CaptureError("the capture is empty", expected="at least one frame")
        if not (np.isfinite(self.time).all() and np.isfinite(self.q).all()):
            raise CaptureError("times and poses must be finite", where="time, q")
        down = self.ids >= 0
        lifted = np.isnan(self.xy).all(axis=2)
        if not (np.array_equal(down, ~lifted) and np.isfinite(self.xy[down]).all()):
            raise CaptureError(
                "contact ids and positions disagree",
                where="ids, xy",
                expected="a finite position for every id, NaN where the id is -1",
            )
        if not down.any(axis=1).all():
            raise CaptureError(
                "frames have no contact",
                where="ids",
                got=int((~down.any(axis=1)).sum()),
                expected="at least one contact in every frame",
                remedy="Drop these frames; they have no contact vector",
            )

    def __len__(self) -> int:
        return len(self.time)

    @cached_property
    def down(self) -> NDArray[np.bool_]:
        """Mask (T, 5) of touching fingers."""
        return self.ids >= 0

    @cached_property
    def _inputs(self) -> tuple[Array, Array]:
        return contact_vectors(self.xy)

    @property
    def u(self) -> Array:
        """Contact vectors (T, 15); derived, never stored."""
        return self._inputs[0]

    @property
    def leftmost(self) -> Array:
        """Leftmost contacts (T, 2) m on the surface."""
        return self._inputs[1]

    @cached_property
    def relative(self) -> Array:
        """Relative poses (T, 48); derived, never stored."""
        return relative_pose(self.q, self.leftmost)

    def select(self, frames: NDArray[Any]) -> Capture:
        """Capture of the selected frames (a mask or indices), in their order."""
        return Capture(
            self.time[frames],
            self.trial[frames],
            self.ids[frames],
            self.xy[frames],
            self.q[frames],
            self.meta,
        )
