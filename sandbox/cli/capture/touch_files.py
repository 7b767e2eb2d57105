"""Touches from files: our recordings, captures of TUIO packets, and what `touches show` prints."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from encoders.captures.conversion import TouchLog
from models.errors import InputError, RecordingError
from models.frames import TouchFrame
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from sandbox.options.touch_devices import first_line
from sandbox.recording.recording import is_recording, load_recording


def read_touch_log(path: Path, surface: Surface | None) -> tuple[TouchLog, str]:
    """The touches of a file, told apart by its content.

    Args:
        path: The file.
        surface: Its size; only captures of TUIO packets need it, which carry none.

    Returns:
        The log, and what is wrong with the file's tail; empty if nothing is.

    Raises:
        InputError: It is none of the three, or holds no touch.
    """
    if is_recording(path):
        recording = load_recording(path)
        return _log(recording.touches(), path), recording.damage
    head = first_line(path)
    if "hex" in head:
        if surface is None:
            raise InputError(
                "a capture of TUIO packets does not say how large the surface is",
                where=str(path),
                remedy="Add --surface, for example --surface ipad2 or --surface 197x148mm",
            )
        capture = read_capture(path)
        damage = str(capture.damage) if capture.damage else ""
        return _log(CaptureDevice(capture, surface).poll(math.inf), path), damage
    if "contacts" in head or "surface_in" in head:
        return _shown(path)
    raise InputError(
        "this is no recording of touches",
        where=str(path),
        expected="a recording of ours, a capture of TUIO packets, or lines of "
        "`sandbox touches show --json`",
    )


def _log(frames: Iterable[TouchFrame], path: Path) -> TouchLog:
    seen = list(frames)
    rows = [(f, c.id, c.x, c.y) for f, frame in enumerate(seen) for c in frame.contacts]
    return _arrays([frame.time for frame in seen], rows, path)


def _shown(path: Path) -> tuple[TouchLog, str]:
    """Lines {"time": s, "contacts": [{"id", "x", "y"}]} in inches."""
    times: list[float] = []
    rows: list[tuple[int, int, float, float]] = []
    damage = ""
    with path.open("rb") as file:
        for number, line in enumerate(file, start=1):
            if not line.strip():
                continue
            try:
                record = json.loads(line)
                if number == 1 and "surface_in" in record:
                    continue  # how large the surface is that was recorded
                contacts = [
                    (int(c["id"]), float(c["x"]), float(c["y"])) for c in record["contacts"]
                ]
                time = float(record["time"])
                if not math.isfinite(time + sum(x + y for _, x, y in contacts)):
                    raise ValueError("a value is not finite")
                if len({c[0] for c in contacts}) != len(contacts):
                    raise ValueError("two contacts share an id")
            except (ValueError, KeyError, TypeError, OverflowError, RecursionError) as error:
                damage = f"line {number} is damaged ({error}); everything before it is used"
                break
            inch = METRES_PER_INCH
            rows += [(len(times), id_, inch * x, inch * y) for id_, x, y in contacts]
            times.append(time)
    return _arrays(times, rows, path), damage


def _arrays(times: list[float], rows: list[tuple[int, int, float, float]], path: Path) -> TouchLog:
    if not rows:
        raise RecordingError("there is no touch in it", where=str(path))
    table = np.array(rows, float)
    # Ids may exceed what a float keeps; they only need to differ.
    names = {id_: n for n, id_ in enumerate(dict.fromkeys(row[1] for row in rows))}
    ids = np.array([names[row[1]] for row in rows], np.int64)
    return TouchLog(np.array(times, float), table[:, 0].astype(np.int64), ids, table[:, 2:])
