"""Saves and loads captures as npz files without pickle, checked completely on loading."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from encoders.capture import Capture
from encoders.npz import read_npz, write_npz
from models.arithmetic import squared_lengths
from models.errors import CaptureError
from models.pose import JOINTS

SCHEMA = 1
"""Version of the file's layout."""

FARTHEST = 3.0
"""Largest median distance (m) of a wrist from its touches. It is usually 0.1 to 0.2 m. A larger
distance shows that lengths are not in metres."""

_ARRAYS = {"time": "f", "trial": "i", "ids": "i", "xy": "f", "q": "f"}


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
