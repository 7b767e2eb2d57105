"""A calibration as a JSON file, so that a hand is measured once."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.calibration import HandCalibration
from models.errors import EncoderError
from models.frames import FINGERS, SIDES

Array = NDArray[np.float64]

SCHEMA = 1
_LARGEST = 1 << 20
_FIVE = len(FINGERS)


def write_calibration(hands: Mapping[str, HandCalibration], path: Path) -> None:
    """Writes the calibrations by side; lengths in metres.

    Raises:
        EncoderError: The file cannot be written.
    """
    record = {
        "schema": SCHEMA,
        "paalm_calibration": {side: calibration_to_json(c) for side, c in hands.items()},
    }
    try:
        path.write_text(json.dumps(record, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise EncoderError(f"it cannot be written: {error}", where=str(path)) from error


def calibration_to_json(c: HandCalibration) -> dict[str, Any]:
    """One hand's calibration as JSON values, exact to the bit."""
    return {
        "standard": c.standard.tolist(),
        "spread": c.spread.tolist(),
        "tips": c.tips.tolist(),
        "directions": c.directions.tolist(),
        "bones": None if c.bones is None else c.bones.tolist(),
        "frames": c.frames,
        "seconds": c.seconds,
        "left_out": c.left_out,
    }


def calibration_from_json(side: str, fields: Mapping[str, Any]) -> HandCalibration:
    """One hand's calibration read back.

    Raises:
        EncoderError: It is damaged.
    """
    try:
        return _hand(_side(side), fields)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise EncoderError(f"the calibration is damaged: {error}") from error


def read_calibration(path: Path) -> dict[str, HandCalibration]:
    """Calibrations by side.

    Raises:
        EncoderError: The file is missing, of another program or version, or damaged.
    """
    where = str(path)
    try:
        if path.stat().st_size > _LARGEST:
            raise EncoderError("this is too large for a calibration", where=where)
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise EncoderError(f"the calibration cannot be read: {error}", where=where) from error
    hands = record.get("paalm_calibration") if isinstance(record, dict) else None
    if not isinstance(hands, dict) or not hands or record.get("schema") != SCHEMA:
        raise EncoderError(
            "this is no PAALM calibration",
            where=where,
            expected=f"schema {SCHEMA}, as `sandbox paalm calibrate --out` writes it",
        )
    try:
        return {_side(side): _hand(side, fields) for side, fields in hands.items()}
    except (KeyError, TypeError, ValueError) as error:
        raise EncoderError(f"the calibration is damaged: {error}", where=where) from error


def read_hand(path: Path, side: str) -> HandCalibration:
    """One hand's calibration out of a file.

    Raises:
        EncoderError: See `read_calibration`; or it is another hand's.
    """
    known = read_calibration(path)
    if side not in known:
        raise EncoderError(
            "this hand was not measured", where=str(path), got=side, expected=", ".join(known)
        )
    return known[side]


def _side(side: str) -> str:
    if side not in SIDES:
        raise ValueError(f"no such side: {side}")
    return side


def _hand(side: str, fields: Mapping[str, Any]) -> HandCalibration:
    standard = _array(fields, "standard", (_FIVE,))
    directions = _array(fields, "directions", (_FIVE, 3))
    bones = None if fields["bones"] is None else _array(fields, "bones", (_FIVE, 3))
    if standard.min() <= 0.0 or (bones is not None and bones[:, :2].min() <= 0.0):
        raise ValueError("lengths must be above 0")
    if np.abs(np.linalg.norm(directions, axis=1) - 1.0).max() > 1e-3:
        raise ValueError("directions must be unit vectors")
    seconds = float(fields["seconds"])
    if not math.isfinite(seconds):
        raise ValueError("seconds must be finite")
    return HandCalibration(
        side,
        standard,
        _array(fields, "spread", (_FIVE,)),
        _array(fields, "tips", (_FIVE, 3)),
        directions,
        bones,
        int(fields["frames"]),
        seconds,
        {str(k): int(v) for k, v in fields["left_out"].items()},
    )


def _array(fields: Mapping[str, Any], name: str, shape: tuple[int, ...]) -> Array:
    array = np.asarray(fields[name], float)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite numbers, {shape}")
    return array
