"""Reads and writes calibrations as JSON files, so that a hand needs to be measured only once."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from msgspec import Meta, Struct

from encoders.paalm.calibration import HandCalibration
from encoders.paalm.coupling import Coupling
from models.arithmetic import total
from models.errors import EncoderError
from models.frames import SIDES
from models.json_input import checked, decoded, read_bytes

SCHEMA = 1
_LARGEST = 1 << 20


_Finite = Annotated[float, Meta(ge=-1e6, le=1e6)]
_Length = Annotated[float, Meta(gt=0, le=1e6)]
_Slope = Annotated[float, Meta(ge=0, le=3)]
_Place = tuple[_Finite, _Finite, _Finite]
_Bones = tuple[_Length, _Length, _Finite]


class _HandRecord(Struct):
    """One hand's calibration in a file or header; see `HandCalibration`."""

    standard: tuple[_Length, _Length, _Length, _Length, _Length]
    spread: tuple[_Finite, _Finite, _Finite, _Finite, _Finite]
    tips: tuple[_Place, _Place, _Place, _Place, _Place]
    directions: tuple[_Place, _Place, _Place, _Place, _Place]
    bones: tuple[_Bones, _Bones, _Bones, _Bones, _Bones] | None
    frames: int
    seconds: _Finite
    left_out: dict[str, int]
    dialect: str | None = None
    coupling: tuple[_Slope, _Finite] | None = None
    by_tip: bool = False
    palm_shift: _Place | None = None

    def __post_init__(self) -> None:
        if any(
            abs(math.sqrt(total(c * c for c in direction)) - 1.0) > 1e-3
            for direction in self.directions
        ):
            raise ValueError("directions must be unit vectors")


class _CalibrationHead(Struct):
    """Fields that distinguish a calibration from other files; their values are not checked."""

    schema: Any = None
    paalm_calibration: Any = None


class _CalibrationFile(Struct):
    """The hands of a file, by side."""

    paalm_calibration: dict[str, _HandRecord]


def write_calibration(hands: Mapping[str, HandCalibration], path: Path) -> None:
    """Writes calibrations by side to a file; lengths are in metres.

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
        raise EncoderError(
            f"the calibration cannot be written: {error}",
            where=str(path),
            remedy="Choose another path with --out",
        ) from error


def calibration_to_json(c: HandCalibration) -> dict[str, Any]:
    """One hand's calibration as JSON values, exact to the bit."""
    record: dict[str, Any] = {
        "standard": c.standard.tolist(),
        "spread": c.spread.tolist(),
        "tips": c.tips.tolist(),
        "directions": c.directions.tolist(),
        "bones": None if c.bones is None else c.bones.tolist(),
        "frames": c.frames,
        "seconds": c.seconds,
        "left_out": c.left_out,
    }
    if c.dialect is not None:
        record["dialect"] = c.dialect
    if c.coupling is not None:
        record["coupling"] = [c.coupling.slope, c.coupling.offset]
    if c.by_tip:
        record["by_tip"] = True
    if c.palm_shift is not None:
        record["palm_shift"] = list(c.palm_shift)
    return record


def calibration_from_json(side: str, fields: Mapping[str, Any]) -> HandCalibration:
    """Reads one hand's calibration from JSON values.

    Raises:
        EncoderError: The values are damaged.
    """
    what, where = "the calibration is damaged", f"{side} hand"
    record = checked(dict(fields), _HandRecord, EncoderError, what=what, where=where)
    return _hand(side, record, where)


def read_calibration(path: Path) -> dict[str, HandCalibration]:
    """Reads calibrations by side.

    Raises:
        EncoderError: The file is missing, of another program or version, or damaged.
    """
    where, what = str(path), "the calibration cannot be read"
    data = read_bytes(path, EncoderError, what=what, largest=_LARGEST)
    head = decoded(data, _CalibrationHead, EncoderError, what=what, where=where)
    if not head.paalm_calibration or head.schema != SCHEMA:
        raise EncoderError(
            "not a PAALM calibration",
            where=where,
            expected=f"schema {SCHEMA}, as `sandbox paalm calibrate --out` writes it",
        )
    hands = decoded(
        data, _CalibrationFile, EncoderError, what="the calibration is damaged", where=where
    ).paalm_calibration
    return {
        side: _hand(side, record, f"{where}, paalm_calibration.{side}")
        for side, record in hands.items()
    }


def is_calibration(path: Path) -> bool:
    """True if a file contains calibrations for PAALM, even if these are damaged."""
    try:
        data = read_bytes(path, EncoderError, what="", largest=_LARGEST)
        head = decoded(data, dict[str, Any], EncoderError, what="", where=str(path))
    except EncoderError:
        return False
    return "paalm_calibration" in head


def read_hand(path: Path, side: str) -> HandCalibration:
    """Reads one hand's calibration from a file.

    Raises:
        EncoderError: As in `read_calibration`, or the file has only the other hand.
    """
    known = read_calibration(path)
    if side not in known:
        raise EncoderError(
            "this hand was not measured", where=str(path), got=side, expected=", ".join(known)
        )
    return known[side]


def _hand(side: str, record: _HandRecord, where: str) -> HandCalibration:
    if side not in SIDES:
        raise EncoderError(
            "no such side of a hand", where=where, got=side[:40], expected=" or ".join(SIDES)
        )
    return HandCalibration(
        side,
        np.array(record.standard),
        np.array(record.spread),
        np.array(record.tips),
        np.array(record.directions),
        None if record.bones is None else np.array(record.bones),
        record.frames,
        record.seconds,
        record.left_out,
        record.dialect,
        None if record.coupling is None else Coupling(*record.coupling),
        record.by_tip,
        record.palm_shift,
    )
