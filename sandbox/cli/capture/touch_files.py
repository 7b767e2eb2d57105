"""Reads touches from recordings, captures of TUIO packets, and the output of `touches show`."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from encoders.captures.conversion import TouchLog
from models.errors import InputError, RecordingError
from models.frames import TouchFrame
from models.json_input import numbered_lines
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.files.frame_file import LONGEST_LINE, decoded_frame, frame_surface
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from sandbox.options.touch_devices import first_line
from sandbox.recording.recording import is_recording, load_recording


def read_touch_log(path: Path, surface: Surface | None) -> tuple[TouchLog, str]:
    """Reads the touches of a file, whose content decides the format.

    Args:
        path: The file.
        surface: Touch surface; only captures of TUIO packets need it.

    Returns:
        The log, and a description of damage at the end of the file; empty without damage.

    Raises:
        InputError: The file has none of the three formats, or holds no touch.
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
        "this is not a recording of touches",
        where=str(path),
        expected="a recording of this program, a capture of TUIO packets, or lines of "
        "`sandbox touches show --json`",
    )


def touch_surface(path: Path) -> Surface | None:
    """The surface that a file of `touches show` or `capture record` names; None if it names none.

    Raises:
        InputError: Its first line is damaged.
    """
    for number, line in numbered_lines(path, LONGEST_LINE):
        return frame_surface(line, f"{path}, line {number}")
    return None


def _log(frames: Iterable[TouchFrame], path: Path) -> TouchLog:
    seen = list(frames)
    rows = [(f, c.id, c.x, c.y) for f, frame in enumerate(seen) for c in frame.contacts]
    return _arrays([frame.time for frame in seen], rows, path)


def _shown(path: Path) -> tuple[TouchLog, str]:
    """Reads output of `touches show` in the order of arrival; times may run backwards."""
    times: list[float] = []
    rows: list[tuple[int, int, float, float]] = []
    damage = ""
    remedy = "Everything before this line is used"
    for number, line in numbered_lines(path, LONGEST_LINE):
        where = f"{path}, line {number}"
        try:
            if number == 1 and frame_surface(line, where) is not None:
                continue
            frame = decoded_frame(line, where, remedy)
            if len({touch.id for touch in frame.contacts}) != len(frame.contacts):
                raise RecordingError("two contacts share an id", where=where, remedy=remedy)
        except InputError as error:
            damage = str(error)
            break
        inch = METRES_PER_INCH
        rows += [(len(times), t.id, inch * t.x, inch * t.y) for t in frame.contacts]
        times.append(frame.time)
    return _arrays(times, rows, path), damage


def _arrays(times: list[float], rows: list[tuple[int, int, float, float]], path: Path) -> TouchLog:
    if not rows:
        raise RecordingError("the file holds no touch", where=str(path))
    table = np.array(rows, float)
    # Ids may be too large for a float; they only need to differ.
    names = {id_: n for n, id_ in enumerate(dict.fromkeys(row[1] for row in rows))}
    ids = np.array([names[row[1]] for row in rows], np.int64)
    return TouchLog(np.array(times, float), table[:, 0].astype(np.int64), ids, table[:, 2:])
