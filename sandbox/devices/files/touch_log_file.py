"""Reads touches from recordings, captures of TUIO packets, and the output of `touches show`."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from encoders.captures.conversion import TouchLog
from models.errors import InputError, RecordingError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.files.frame_file import read_frame_file
from sandbox.devices.files.touch_files import first_line, recorded_surface
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from sandbox.recording.recording import is_recording, load_recording

_SAME_SIZE = 0.01
"""Largest relative difference between the recorded and the given size of a surface."""


def read_touch_log(path: Path, surface: Surface | None) -> tuple[TouchLog, str]:
    """Reads the touches of a file; its content decides the format.

    Args:
        path: The file.
        surface: Touch surface, as measured. Captures of TUIO packets need it. If the size in a file
            is a guess, its positions are scaled to this surface.

    Returns:
        The log, and remarks about the file: damage at its end, left-out data, or that the size is a
        guess; empty without remarks.

    Raises:
        InputError: The file has none of the three formats, has no touch, or states another size of
            the surface.
    """
    if is_recording(path):
        recording = load_recording(path)
        recorded = recorded_surface(recording.header["settings"])
        log = _log(recording.touches(), path)
        return _measured(log, recording.damage, recorded, surface, path)
    head = first_line(path)
    if "hex" in head:
        if surface is None:
            raise InputError(
                "a capture of TUIO packets does not contain the size of the surface",
                where=str(path),
                remedy="Add --surface, for example --surface ipad2 or --surface 197x148mm",
            )
        capture = read_capture(path)
        damage = str(capture.damage) if capture.damage else ""
        device = CaptureDevice(capture, surface)
        log = _log(device.poll(math.inf), path)
        return log, "; ".join(filter(None, (damage, device.report.line())))
    if "contacts" in head or "surface_in" in head:
        # Lines stay in the order of arrival, in which times of the device may run backwards.
        file = read_frame_file(path, ordered=False)
        damage = f"{file.damage}. Everything before this line is used" if file.damage else ""
        said = "; ".join(filter(None, (damage, file.report.line())))
        return _measured(_log(file.frames, path), said, file.surface, surface, path)
    raise InputError(
        "this is not a recording of touches",
        where=str(path),
        expected="a recording of this program, a capture of TUIO packets, or lines of "
        "`sandbox touches show --json`",
    )


def _measured(
    log: TouchLog, damage: str, recorded: Surface | None, given: Surface | None, path: Path
) -> tuple[TouchLog, str]:
    """Scales touches from the guessed surface of a file to the given surface.

    Args:
        log: The touches.
        damage: Remarks about the file.
        recorded: Surface in the file; None if it has none.
        given: Surface of --surface; None without.
        path: The file, for the error.

    Raises:
        InputError: The file has a measured surface of another size.
    """
    if recorded is None:
        return log, damage
    if given is None:
        guess = "" if recorded.calibrated else "the surface's size is a guess: give --surface"
        return log, "; ".join(filter(None, (damage, guess)))
    factors = np.array(given.size) / np.array(recorded.size)
    if not recorded.calibrated:
        return replace(log, xy=log.xy * factors), damage
    if np.abs(factors - 1.0).max() > _SAME_SIZE:
        raise InputError(
            "the size of the surface in the file is not that of --surface",
            where=str(path),
            got=f"{recorded.width_in:g}x{recorded.height_in:g}in in the file",
            expected=f"{given.width_in:g}x{given.height_in:g}in, as in --surface",
            remedy="Leave out --surface, or check which of the two is right",
        )
    return log, damage


def _log(frames: Iterable[TouchFrame], path: Path) -> TouchLog:
    seen = list(frames)
    rows = [(f, c.id, c.x, c.y) for f, frame in enumerate(seen) for c in frame.contacts]
    return _arrays([frame.time for frame in seen], rows, path)


def _arrays(times: list[float], rows: list[tuple[int, int, float, float]], path: Path) -> TouchLog:
    if not rows:
        raise RecordingError("the file has no touches", where=str(path))
    table = np.array(rows, float)
    # Ids may be too large for a float; they only need to differ.
    names = {id_: n for n, id_ in enumerate(dict.fromkeys(row[1] for row in rows))}
    ids = np.array([names[row[1]] for row in rows], np.int64)
    return TouchLog(np.array(times, float), table[:, 0].astype(np.int64), ids, table[:, 2:])
