"""Captures: touches and hand poses recorded at the same time, frame by frame, and their files.

A file is npz without pickle, and is checked completely on loading.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.input_vector import contact_vectors
from encoders.npz import read_npz, write_npz
from models.arithmetic import Array, squared_lengths
from models.errors import CaptureError
from models.frames import FINGERS
from models.pose import JOINTS, POSE_SIZE, relative_pose

SCHEMA = 1
"""Version of the file's layout."""

FARTHEST = 3.0
"""Largest median distance (m) of a wrist from its touches. It is usually 0.1 to 0.2 m. A larger
distance shows that lengths are not in metres."""

_ARRAYS = {"time": "f", "trial": "i", "ids": "i", "xy": "f", "q": "f"}


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


def save_capture(capture: Capture, path: Path | str, dtype: type[np.floating] = np.float64) -> None:
    """Writes a capture as npz, without pickle.

    Args:
        capture: Frames of contacts and poses.
        path: The file; an existing file is replaced.
        dtype: Precision of positions and poses. float32 halves the file; positions are then
            accurate to 0.01 micrometre.
    """
    arrays = {
        "time": capture.time,
        "trial": capture.trial,
        "ids": capture.ids,
        "xy": capture.xy.astype(dtype),
        "q": capture.q.astype(dtype),
    }
    write_npz(Path(path), {"schema": SCHEMA, **capture.meta}, arrays)


def check_order(capture: Capture) -> None:
    """Checks the order of a capture's frames, on which filters, jumps and labels depend.

    Raises:
        CaptureError: A take is not contiguous, its time does not increase, or two fingers of a
            frame share an id.
    """
    next_take = np.diff(capture.trial) != 0
    takes = 1 + int(next_take.sum())
    if takes != len(np.unique(capture.trial)):
        raise CaptureError(
            "a take is not in one piece",
            where="trial",
            expected="all frames of a take one after the other, and a different number per take",
        )
    back = np.flatnonzero((np.diff(capture.time) <= 0.0) & ~next_take)
    if len(back):
        at = int(back[0]) + 1
        raise CaptureError(
            "the time does not increase within a take",
            where=f"time, frame {at} of take {capture.trial[at]}",
            got=f"{capture.time[at]:g} s after {capture.time[at - 1]:g} s",
            remedy="Sort the frames of each take by time. If a clock restarted, begin a new take",
        )
    ids = np.sort(capture.ids, axis=1)
    twice = np.flatnonzero(((ids[:, 1:] == ids[:, :-1]) & (ids[:, 1:] >= 0)).any(axis=1))
    if len(twice):
        raise CaptureError(
            "two fingers of a frame share an id",
            where=f"ids, frame {int(twice[0])}",
            got=capture.ids[twice[0]].tolist(),
            expected="a different id for every contact",
        )


def check_units(capture: Capture) -> None:
    """Checks that positions are in metres and rotations in radians, by what a hand can reach.

    Raises:
        CaptureError: The median distance between wrist and touches, or the rotation of a joint, is
            implausibly large.
    """
    apart = capture.q[:, None, :2] * [1.0, -1.0] - capture.xy
    far = float(np.sqrt(np.median(squared_lengths(apart[capture.down]))))
    if far > FARTHEST:
        raise CaptureError(
            "the wrist is too far from its touches",
            where="xy, q",
            got=f"{far:.3g} m",
            expected=f"up to {FARTHEST:g} m",
            remedy="Give xy and q in metres, from the same origin; y points down in xy and up in q",
        )
    most = float(np.abs(capture.q[:, JOINTS]).max())
    if most > 2 * np.pi:
        raise CaptureError(
            "a joint turns by more than a full turn",
            where="q",
            got=f"{most:.3g} rad",
            expected="rotation vectors in radians",
        )


def load_capture(path: Path | str) -> Capture:
    """Reads a capture, written by `save_capture` or `sandbox capture`.

    Raises:
        CaptureError: The file is missing, damaged, of another version, or breaks the contract.
    """
    meta, arrays = read_npz(
        Path(path),
        _ARRAYS,
        CaptureError,
        "a capture",
        "`sandbox subject --out FILE` makes a valid one",
    )
    where, schema = str(path), meta.pop("schema", None)
    if schema != SCHEMA:
        raise CaptureError(
            "the capture has another version", where=where, got=schema, expected=f"schema {SCHEMA}"
        )
    for name, kind in _ARRAYS.items():
        if arrays[name].dtype.kind != kind:
            raise CaptureError(
                "wrong type", where=f"{where}: {name}", got=arrays[name].dtype, expected=kind
            )
    try:
        capture = Capture(
            arrays["time"].astype(float),
            arrays["trial"].astype(np.int64),
            arrays["ids"].astype(np.int64),
            arrays["xy"].astype(float),
            arrays["q"].astype(float),
            meta,
        )
        check_order(capture)
        check_units(capture)
        return capture
    except CaptureError as error:
        place = f"{where}: {error.where}" if error.where else where
        raise CaptureError(
            error.what,
            where=place,
            got=error.got,
            expected=error.expected,
            remedy=error.remedy,
        ) from None
