"""Writes points as C3D, the exchange format of biomechanics, key by key.

Files have millimetres, z up (`X_SCREEN` +X, `Y_SCREEN` +Z), single precision, Intel byte order, and
no analog channels. A file consists of blocks of 512 bytes. It has a header, then the parameters,
then four numbers for each point of each frame. The number of frames is in three places and is
filled in at the end. A number of frames above 65,535 fits only into `TRIAL:ACTUAL_END_FIELD`, a
later extension of the format.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from models.motion.armature import Keys
from models.motion.output import MotionWriter, checked_rate
from models.motion.points import HandPoints

BLOCK = 512
MILLIMETRES = 1000.0
INTEL = 84
"""Code of the byte order (Intel)."""
FLOATING = -1.0
"""Scale of the file. A negative scale means floating point numbers, which are not scaled."""
MOST = 65_535
"""Largest number of frames that fits into 16 bits."""

CHAR, INTEGER, REAL = -1, 2, 4
"""Types of parameters."""


class C3dWriter(MotionWriter):
    """Points of any number of hands as C3D.

    Args:
        path: Path of the file.
        points: The points to write.
        rate: Rate (Hz) of the keys.
    """

    def __init__(self, path: Path, points: HandPoints, rate: float) -> None:
        self._points = points
        checked_rate(rate)
        labels = points.labels
        parameters, self._counts = _parameters(labels, rate)
        data_start = 2 + len(parameters) // BLOCK
        at = self._counts["DATA_START"]
        parameters[at : at + 2] = struct.pack("<H", data_start)
        super().__init__(path)
        self._outputs[0].write(_header(len(labels), rate, data_start))
        self._outputs[0].write(bytes(parameters))

    def write(self, *hands: Keys) -> None:
        """Appends keys of all hands at the same moments."""
        places = self._points.place(hands)
        # The fourth number, which codes the residual and the cameras that saw the point, stays 0.
        values = np.zeros((*places.shape[:2], 4), "<f4")
        values[..., :3] = MILLIMETRES * places
        self._outputs[0].write(values.tobytes())
        self.frames += len(places)

    def finish(self) -> None:
        """Fills in the number of frames, and pads the last block."""
        out = self._outputs[0]
        if self.frames <= MOST:
            # If the count does not fit into 16 bits, ezc3d reads frames up to the end of the file.
            # It would also read the padding as frames.
            out.write(bytes(-out.file.tell() % BLOCK))
        capped = struct.pack("<H", min(self.frames, MOST))
        out.put(2 * 4, capped)
        out.put(BLOCK + self._counts["FRAMES"], capped)
        out.put(BLOCK + self._counts["ACTUAL_END_FIELD"], struct.pack("<I", self.frames))


def _header(points: int, rate: float, data_start: int) -> bytes:
    words = struct.pack("<BBHHHHHfHHf", 2, 0x50, points, 0, 1, 1, 0, FLOATING, data_start, 0, rate)
    return words + bytes(BLOCK - len(words))


def _parameters(labels: list[str], rate: float) -> tuple[bytearray, dict[str, int]]:
    """The parameter blocks, and the offset of each parameter's value in them."""
    out = bytearray(struct.pack("<BBBB", 1, 0x50, 0, INTEL))
    places: dict[str, int] = {}

    def group(number: int, name: str) -> None:
        out.extend(struct.pack("<bb", len(name), -number) + name.encode("ascii"))
        out.extend(struct.pack("<hB", 3, 0))

    def parameter(number: int, name: str, kind: int, shape: tuple[int, ...], data: bytes) -> None:
        out.extend(struct.pack("<bb", len(name), number) + name.encode("ascii"))
        size = 2 + 1 + 1 + len(shape) + len(data) + 1
        out.extend(struct.pack("<hbB", size, kind, len(shape)) + bytes(shape))
        places[name] = len(out)
        out.extend(data + b"\0")

    def text(number: int, name: str, value: str) -> None:
        parameter(number, name, CHAR, (len(value),), value.encode("ascii"))

    def texts(number: int, name: str, values: list[str]) -> None:
        width = max(len(value) for value in values)
        data = "".join(value.ljust(width) for value in values).encode("ascii")
        parameter(number, name, CHAR, (width, len(values)), data)

    def integer(number: int, name: str, *values: int) -> None:
        shape = (len(values),) if len(values) > 1 else ()
        parameter(number, name, INTEGER, shape, struct.pack(f"<{len(values)}H", *values))

    def real(number: int, name: str, value: float) -> None:
        parameter(number, name, REAL, (), struct.pack("<f", value))

    group(1, "POINT")
    integer(1, "USED", len(labels))
    real(1, "SCALE", FLOATING)
    real(1, "RATE", rate)
    integer(1, "DATA_START", 0)
    integer(1, "FRAMES", 0)
    texts(1, "LABELS", labels)
    texts(1, "DESCRIPTIONS", [label.replace("_", " ") for label in labels])
    text(1, "UNITS", "mm")
    text(1, "X_SCREEN", "+X")
    text(1, "Y_SCREEN", "+Z")
    group(2, "ANALOG")
    integer(2, "USED", 0)
    group(3, "TRIAL")
    integer(3, "ACTUAL_START_FIELD", 1, 0)
    integer(3, "ACTUAL_END_FIELD", 0, 0)
    out.extend(bytes(-len(out) % BLOCK))
    out[2] = len(out) // BLOCK
    return out, places
