"""A capture: what fingers and hand did at the same time, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.input_vector import contact_vectors
from models.arithmetic.arrays import Array
from models.errors import CaptureError
from models.frames import FINGERS
from models.pose import POSE_SIZE, relative_pose


@dataclass(frozen=True)
class Capture:
    """Recorded frames of contacts and pose; T frames, sorted by trial, then time.

    Contacts are stored by label (a capture knows its labels): finger f of frame t has the id
    `ids[t, f]` and the place `xy[t, f]`, or -1 and NaN when it is lifted.

    Attributes:
        time: (T,) s.
        trial: (T,) int, equal for frames of one continuous take. Frames of a trial depend on each
            other, so everything that splits a capture splits it by trial.
        ids: (T, 5) int64, contact ids.
        xy: (T, 5, 2) m on the surface, x right and y down.
        q: (T, 48) pose in the 3-D surface frame.
        meta: Subject, side, skeleton, rate (Hz) and how the capture came to be; JSON values only.
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
                "contacts and their places disagree",
                where="ids, xy",
                expected="a finite place where there is an id, NaN where the id is -1",
            )
        if not down.any(axis=1).all():
            raise CaptureError(
                "frames without any contact",
                where="ids",
                got=int((~down.any(axis=1)).sum()),
                expected="at least one contact in every frame",
                remedy="Drop those frames: no contact vector exists for them",
            )

    def __len__(self) -> int:
        return len(self.time)

    @cached_property
    def down(self) -> NDArray[np.bool_]:
        """(T, 5) which fingers touch."""
        return self.ids >= 0

    @cached_property
    def _inputs(self) -> tuple[Array, Array]:
        return contact_vectors(self.xy)

    @property
    def u(self) -> Array:
        """(T, 15) contact vectors; derived, never stored."""
        return self._inputs[0]

    @property
    def leftmost(self) -> Array:
        """(T, 2) m, leftmost contact on the surface."""
        return self._inputs[1]

    @cached_property
    def relative(self) -> Array:
        """(T, 48) relative poses; derived, never stored."""
        return relative_pose(self.q, self.leftmost)

    def select(self, frames: NDArray[Any]) -> Capture:
        """The capture of some of the frames (a mask or indices), in their order."""
        return Capture(
            self.time[frames],
            self.trial[frames],
            self.ids[frames],
            self.xy[frames],
            self.q[frames],
            self.meta,
        )
