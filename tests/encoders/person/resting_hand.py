"""A simulated hand that rests on a screen with five fingers, for tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from encoders.capture import load_capture
from models.arithmetic import Array
from models.pose import ROOT_POSITION

CAPTURE = Path(__file__).resolve().parents[3] / "encoders" / "data" / "capture.npz"


def resting(size: float = 1.0) -> Array:
    """(48,) pose of a right hand of a size in the first frame with five fingers of the built-in
    capture, in the frame of its surface."""
    capture = load_capture(CAPTURE)
    q: Array = capture.q[np.flatnonzero(capture.down.all(axis=1))[0]].copy()
    q[ROOT_POSITION] *= size
    return q
