"""Recorded touch frames: JSON lines, one per frame, lengths in inches.

    {"surface_in": [7.76, 5.82], "surface_calibrated": true, "device": "evdev"}
    {"time": 2.99, "contacts": [{"id": 0, "x": 1.21, "y": 1.21, "finger": null}]}

The first line is optional; its `surface_calibrated` is false if the size is a guess. A frame may
also have `cancelled` (ids) and `lift` (0 to 1). A contact may also have `size`, and with it `width`
and `height`.

A file is read up to a line that is not JSON. A contact, size, time or name that cannot be read is
left out; everything else in its line is used. If times or positions are impossible in seconds and
inches, they are read in units in which they are possible.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

from msgspec import Struct

from models.errors import FrameError, InputError, RecordingError
from models.frames import FINGERS, Contact, TouchFrame
from models.json_input import converted, decoded, loosely_decoded, numbered_lines
from models.plausible import (
    FEWEST,
    FINGERS_APART,
    LARGEST_TABLE,
    MARGIN,
    TOUCH_STEP,
    USUAL_LEAST,
    USUAL_MOST,
    Bounds,
    ContactSizes,
    TouchIds,
    Units,
    find_units,
    in_order,
    on_surface,
    parse_units,
    touch_steps,
    unit_size,
)
from models.reader_report import ReaderReport
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.device import Closeable, Device, FilePlayer


class LineFile(Closeable):
    """Writes lines from one thread; a crash loses at most the line being written.

    Args:
        path: The file; an existing file is never overwritten.

    Attributes:
        lines: Number of lines written.

    Raises:
        RecordingError: The file exists or cannot be created.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.lines = path, 0
        try:
            self._file = path.open("x", encoding="utf-8")
        except FileExistsError:
            raise RecordingError(
                "this file exists already, and is not overwritten",
                where=str(path),
                remedy="Name another file",
            ) from None
        except OSError as error:
            raise RecordingError(
                "the file cannot be written",
                where=str(path),
                got=error.strerror,
                remedy="Name another file",
            ) from None

    def write(self, values: Mapping[str, Any]) -> None:
        """Appends a line.

        Raises:
            RecordingError: The line cannot be written; the lines before it are on disk.
        """
        try:
            print(json.dumps(values, separators=(",", ":")), file=self._file, flush=True)
        except OSError as error:
            raise RecordingError(
                "a line of the recording cannot be written",
                where=str(self.path),
                got=error.strerror,
                remedy="Free space on the disk; earlier lines are in the file",
            ) from None
        self.lines += 1

    def discard(self) -> None:
        """Closes the file and removes it, for a recording without content."""
        self.close()
        self.path.unlink(missing_ok=True)

    def close(self) -> None:
        """Closes the file; may be called twice."""
        # `write` has already reported a line that could not be written.
        with suppress(OSError):
            self._file.close()


LONGEST_LINE = 1_000_000
"""Largest number of bytes in a line; a frame of ten contacts has about a thousand."""

_DAMAGED = "the recording of touches is damaged here"
_PLAYABLE = "The lines before this one can be played"
_FORMATS = "`sandbox touches formats` lists what can be played"
_EXPECTED = '{"time": seconds, "contacts": [{"id", "x", "y", "finger"}]}'

_SAMPLE, _PLACES = 100, 40
"""Number of lines from which the unit of time is found, and number of lines from which the unit of
length is found."""
_LABELS = {name: label for label, name in enumerate(FINGERS)}


class TouchLine(Struct):
    """A contact in a line; lengths in inches."""

    id: int
    x: float
    y: float
    finger: str | None = None
    size: float | None = None
    width: float | None = None
    height: float | None = None


class FrameLine(Struct):
    """A frame in a line; time in seconds, NaN if it has none."""

    time: float
    contacts: list[TouchLine]
    lift: float | None = None
    cancelled: list[int] = []


class HeaderLine(Struct):
    """The first line of a file with a header."""

    surface_in: tuple[float, float] | None = None
    surface_calibrated: bool = True


@dataclass(frozen=True)
class FrameFile:
    """The frames of a file.

    Attributes:
        frames: Frames up to the end or the damage.
        surface: Touch surface, if the file has its size; else None.
        damage: Error with file and line that ended the file early; None if it is undamaged.
        report: Report on left-out data and assumptions.
    """

    frames: tuple[TouchFrame, ...]
    surface: Surface | None = None
    damage: RecordingError | None = None
    report: ReaderReport = field(default_factory=ReaderReport)


class FramesDevice(FilePlayer, Device):
    """Plays touch frames at their times; the first one plays at session time 0.

    Args:
        frames: Frames in order of time.
        damage: Error that ended the file early; None without damage.
        report: Report on left-out data and assumptions.
    """

    name = "frames"
    lift: bool

    def __init__(
        self,
        frames: Sequence[TouchFrame],
        damage: RecordingError | None = None,
        report: ReaderReport | None = None,
    ) -> None:
        start = frames[0].time if frames else 0.0
        played = [replace(frame, time=frame.time - start) for frame in frames]
        super().__init__(played, damage, report)
        self.lift = any(frame.lift is not None for frame in frames)


def frame_record(frame: TouchFrame) -> dict[str, Any]:
    """Returns the JSON values of a frame's line; unknown values are left out, except `finger`."""
    contacts = []
    for contact in frame.contacts:
        record: dict[str, Any] = {
            "id": contact.id,
            "x": contact.x / METRES_PER_INCH,
            "y": contact.y / METRES_PER_INCH,
            "finger": None if contact.label is None else FINGERS[contact.label],
        }
        if contact.size is not None:
            record["size"] = contact.size / METRES_PER_INCH
        if contact.extent is not None:
            record["width"], record["height"] = (e / METRES_PER_INCH for e in contact.extent)
        contacts.append(record)
    line: dict[str, Any] = {"time": frame.time, "contacts": contacts}
    if frame.lift is not None:
        line["lift"] = frame.lift
    if frame.cancelled:
        line["cancelled"] = sorted(frame.cancelled)
    return line


def header_record(surface: Surface, device: str) -> dict[str, Any]:
    """JSON values of a file's first line."""
    size = [surface.width_in, surface.height_in]
    return {"surface_in": size, "surface_calibrated": surface.calibrated, "device": device}


def read_frame_file(path: Path, unit: str = "", *, ordered: bool = True) -> FrameFile:
    """Reads a file up to its end or to the first line that is not a frame.

    Args:
        path: The file.
        unit: Units of times and lengths that a person gave; missing ones are found.
        ordered: True leaves out frames whose time runs backwards or is missing. False returns all
            frames in the order of the lines, up to a frame without a time.

    Raises:
        RecordingError: The file does not exist, its first frame cannot be read, or its times or
            positions are impossible in any unit.
    """
    surface: Surface | None = None
    lines: list[FrameLine] = []
    damage: RecordingError | None = None
    report = ReaderReport()
    try:
        for number, line in numbered_lines(path, LONGEST_LINE):
            where, remedy = f"{path}, line {number}", _PLAYABLE if lines else _FORMATS
            try:
                if not lines and surface is None:
                    surface = frame_surface(line, where)
                    if surface is not None:
                        continue
                frame = _decoded(line, where, remedy, report)
            except InputError as error:
                damage = (
                    error
                    if isinstance(error, RecordingError)
                    else RecordingError(f"{_DAMAGED}: {error.what}", where=where, remedy=remedy)
                )
                break
            if math.isfinite(frame.time):
                lines.append(frame)
            elif ordered:
                report.leave_out("frames without a time")
            else:
                damage = RecordingError(f"{_DAMAGED}: no time", where=where, remedy=remedy)
                break
    except OSError as error:
        raise RecordingError(
            "the file cannot be read", where=str(path), got=error.strerror
        ) from None
    if not lines:
        raise damage or RecordingError(
            "the file contains no touches",
            where=str(path),
            got=report.line() or None,
            expected=f"lines like {_EXPECTED}",
        )
    lines = in_order(lines, report) if ordered else lines
    found = _units(lines, surface, parse_units(unit), str(path), report)
    reader = _Reader(unit_size(found, "time"), unit_size(found, "length"), surface, report)
    frames = tuple(map(reader.frame, lines))
    ids = TouchIds(report)
    for touched in islice((frame for frame in frames if frame.contacts), _SAMPLE):
        ids.look(touched)
    return FrameFile(frames, surface, damage, report)


def _units(
    lines: Sequence[FrameLine],
    surface: Surface | None,
    given: Units,
    where: str,
    report: ReaderReport,
) -> Units:
    """Finds the units in which times and positions are possible.

    Raises:
        RecordingError: There are no such units, or more than one possibility.
    """
    first = lines[:_SAMPLE]
    steps = touch_steps([line.time for line in first], [bool(line.contacts) for line in first])
    seen = {TOUCH_STEP: [abs(step) for step in steps]}
    some = [line.contacts for line in lines[:: len(lines) // _PLACES + 1] if line.contacts]
    if len(some) < FEWEST:
        touched = [line.contacts for line in lines if line.contacts]
        some = touched[:: len(touched) // _PLACES + 1]
    # With too few frames, a single wrong position could decide the unit.
    if len(some) >= FEWEST:
        seen[FINGERS_APART] = [
            math.hypot(b.x - a.x, b.y - a.y) for touches in some for a, b in pairwise(touches)
        ]
        width, height = (LARGEST_TABLE, LARGEST_TABLE) if surface is None else surface.size
        # For each frame, the position of the touch that is farthest out, in widths of the surface.
        seen[Bounds("the place of a touch", 0.0, (1.0 + MARGIN) * float(width))] = [
            max(max(abs(c.x), abs(c.y) * float(width / height)) for c in touches)
            for touches in some
        ]
    declared = {"time": "s", "length": "in"}
    return find_units(seen, declared, given, where=where, report=report, error=RecordingError)


def _decoded(line: bytes, where: str, remedy: str, report: ReaderReport) -> FrameLine:
    """Decodes a line of a file; parts that cannot be read are left out.

    Args:
        line: The line, JSON.
        where: The file and the line's number.
        remedy: The next step for the person who reads the error.
        report: Left-out parts are added to it.

    Raises:
        RecordingError: The line is not a frame.
    """
    try:
        return decoded(
            line,
            FrameLine,
            RecordingError,
            what=_DAMAGED,
            where=where,
            expected=_EXPECTED,
            remedy=remedy,
        )
    except RecordingError:
        loose = loosely_decoded(line)
        if not isinstance(loose, dict) or not isinstance(loose.get("contacts"), list):
            raise
    contacts = [converted(part, TouchLine) for part in loose["contacts"]]
    report.leave_out("touches that cannot be read", contacts.count(None))
    cancelled = loose.get("cancelled")
    ids = [converted(id_, int) for id_ in cancelled] if isinstance(cancelled, list) else []
    time = converted(loose.get("time"), float)
    return FrameLine(
        math.nan if time is None else time,
        [contact for contact in contacts if contact is not None],
        converted(loose.get("lift"), float),
        [id_ for id_ in ids if id_ is not None],
    )


def frame_surface(line: bytes, where: str) -> Surface | None:
    """Returns the surface of a header line; None for a line without a surface.

    Raises:
        InputError: The line is not a JSON object, or its surface is invalid.
    """
    if b'"surface_in"' not in line:
        return None
    header = decoded(
        line,
        HeaderLine,
        RecordingError,
        what=_DAMAGED,
        where=where,
        expected=_EXPECTED,
        remedy=_FORMATS,
    )
    if header.surface_in is None:
        return None
    return Surface(*header.surface_in, calibrated=header.surface_calibrated)


def touch_surface(path: Path) -> Surface | None:
    """Returns the surface in the first line of a file of touch frames; None if it has none.

    Raises:
        InputError: The first line is damaged.
    """
    for number, line in numbered_lines(path, LONGEST_LINE):
        return frame_surface(line, f"{path}, line {number}")
    return None


class _Reader:
    """Makes frames from the lines of a file.

    Args:
        second: Unit of the file's times, s.
        metre: Unit of the file's lengths, m.
        surface: Surface of the file; None if it has none.
        report: Left-out data are added to it.
    """

    def __init__(
        self, second: float, metre: float, surface: Surface | None, report: ReaderReport
    ) -> None:
        self._second, self._metre, self._report = second, metre, report
        self._size: tuple[float, float] | None = None
        if surface is not None:
            self._size = float(surface.size[0]), float(surface.size[1])
        self._sizes = ContactSizes(report)
        # Smallest width (m) that is accepted unchecked; infinite until enough sizes were checked.
        self._least = math.inf

    def frame(self, line: FrameLine) -> TouchFrame:
        """Makes the frame of a line."""
        contacts: dict[int, Contact] = {}
        for touch in line.contacts:
            try:
                contact = self._contact(touch)
            except FrameError as error:
                self._report.leave_out(error.what)
                continue
            if contacts.setdefault(touch.id, contact) is not contact:
                self._report.leave_out("touches with the id of another")
        lift = line.lift
        if lift is not None and not 0.0 <= lift <= 1.0:
            self._report.leave_out("places of the lift control beyond its ends")
            lift = None
        return TouchFrame(
            self._second * line.time,
            tuple(contacts.values()),
            lift,
            frozenset(line.cancelled),
            "file",
        )

    def _contact(self, touch: TouchLine) -> Contact:
        """Makes the contact of a touch.

        Raises:
            FrameError: The touch must be left out.
        """
        metre = self._metre
        x, y = metre * touch.x, metre * touch.y
        if self._size is None:
            # In a file without a surface, the origin may be anywhere.
            if not (math.isfinite(x) and math.isfinite(y)):
                raise FrameError("positions beyond the surface")
        elif not (0.0 <= x <= self._size[0] and 0.0 <= y <= self._size[1]):
            width, height = self._size
            across, down = on_surface(x / width), on_surface(y / height)
            if across is None or down is None:
                raise FrameError("positions beyond the surface")
            x, y = min(max(x, 0.0), width), min(max(y, 0.0), height)
        size = extent = None
        if touch.size is not None:
            size = metre * touch.size
        if touch.width is not None and touch.height is not None:
            width, height = metre * touch.width, metre * touch.height
            extent = width, height
            if not (self._least <= width <= USUAL_MOST and self._least <= height <= USUAL_MOST):
                size, extent = self._sizes.known(size, extent)
                if self._sizes.decided:
                    self._least = USUAL_LEAST
        elif size is not None:
            size, extent = self._sizes.known(size, None)
        label = None
        if touch.finger is not None:
            label = _LABELS.get(touch.finger)
            if label is None:
                self._report.leave_out("names that no finger has")
        return Contact(touch.id, x, y, size, label, extent)
