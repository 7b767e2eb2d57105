"""Labelled 3-D markers over time, as Qualisys Track Manager exports them to text.

A file has a header of `KEY<TAB>value` lines, then one line per frame. The three numbers of a marker
that was not seen are empty, `nan` or all zero. Some systems write decimal commas.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.motion.text import numbers, read_lines
from models.reader_report import ReaderReport

MILLIMETRE = 0.001
"""Millimetre (m), the unit of Qualisys exports."""

_GAPS = ("", "nan")
"""Cells that mean a missing number."""


@dataclass(frozen=True)
class MarkerTracks:
    """Positions of M markers over T frames.

    Attributes:
        names: Unique names of the markers.
        time: (T,) s, increasing.
        places: (T, M, 3) m, positions in the recorder's frame; NaN for a marker that was not seen.
        report: Parts of the file that the reader left out or assumed.
    """

    names: tuple[str, ...]
    time: Array
    places: Array
    report: ReaderReport = field(default_factory=ReaderReport)

    def __len__(self) -> int:
        return len(self.time)


def read_markers(path: Path, unit: float = MILLIMETRE) -> MarkerTracks:
    """Reads a Qualisys TSV file, plain or packed with gzip.

    Args:
        path: The file.
        unit: Unit of length of the file (m).

    Raises:
        MotionError: The file is not a Qualisys TSV file, is cut short, or contains a number that is
            not finite.
    """
    report = ReaderReport()
    lines = read_lines(path, "a Qualisys TSV file", report)
    head: dict[str, list[str]] = {}
    at = 0
    # Keys are in capitals. The table begins at the first line without a key.
    while at < len(lines):
        key, *values = lines[at].rstrip("\t").split("\t")
        if not key or key != key.upper() or key[0].isdigit() or key[0] in "-+.":
            break
        head[key] = values
        at += 1
    names = _names(path, head)
    frames = _count(path, head, "NO_OF_FRAMES")
    rate = numbers([_point(w) for w in head.get("FREQUENCY", [])], 1, f"{path}, FREQUENCY")[0]
    if rate <= 0:
        raise MotionError(
            "not a frame rate",
            where=f"{path}, FREQUENCY",
            got=rate,
            expected="a positive number of Hz",
        )
    # A line of column titles may follow; the first columns may be Frame and Time.
    titles = lines[at].split("\t") if at < len(lines) else []
    lead = 0
    if titles and titles[0].strip() and not _is_number(titles[0]):
        lead = sum(title.strip() in ("Frame", "Time") for title in titles[:2])
        at += 1
    width = lead + 3 * len(names)
    # A frame in which no marker was seen is a line of tabs.
    rows = [
        (n, line)
        for n, line in enumerate(lines[at:], start=at + 1)
        if line.strip() or line.count("\t") >= width - 1
    ]
    if len(rows) < frames:
        raise MotionError(
            "the file has fewer frames than it states",
            where=str(path),
            got=len(rows),
            expected=str(frames),
            remedy="The file was probably cut short",
        )
    if len(rows) > frames:
        report.assume(f"the file states {frames} frames and has {len(rows)}; all were read")
    places = np.array([_row(line, width, f"{path}, line {n}")[lead:] for n, line in rows])
    places = places.reshape(len(rows), len(names), 3)
    unseen = (np.nan_to_num(places) == 0).all(axis=2) | np.isnan(places).any(axis=2)
    seen_in_part = np.isnan(places).any(axis=2) & ~np.isnan(places).all(axis=2)
    report.leave_out("places of markers that lack a coordinate", int(seen_in_part.sum()))
    places[unseen] = np.nan
    return MarkerTracks(names, np.arange(len(rows)) / rate, places * unit, report)


def _row(line: str, width: int, where: str) -> list[float]:
    """A line's numbers; NaN for empty cells."""
    cells = [cell.strip() for cell in line.rstrip("\r\n").split("\t")]
    if len(cells) == width + 1 and not cells[-1]:
        cells.pop()  # many exports end every line with a tab
    if len(cells) != width:
        raise MotionError(
            "wrong number of values", where=where, got=len(cells), expected=f"{width}"
        )
    return [
        np.nan if cell.lower() in _GAPS else numbers([_point(cell)], 1, where)[0] for cell in cells
    ]


def _point(number: str) -> str:
    """A number with a point in place of a decimal comma."""
    return number if "." in number else number.replace(",", ".", 1)


def _names(path: Path, head: dict[str, list[str]]) -> tuple[str, ...]:
    names = tuple(name.strip() for name in head.get("MARKER_NAMES", []))
    if not names or len(set(names)) != len(names) or not all(names):
        raise MotionError(
            "this is not a Qualisys TSV file",
            where=str(path),
            expected="a line MARKER_NAMES with different names",
        )
    if "NO_OF_MARKERS" in head and _count(path, head, "NO_OF_MARKERS") != len(names):
        raise MotionError(
            "the number of markers differs from the one that the file states",
            where=str(path),
            got=len(names),
            expected=head["NO_OF_MARKERS"][0],
        )
    return names


def _count(path: Path, head: dict[str, list[str]], key: str) -> int:
    value = numbers(head.get(key, []), 1, f"{path}, {key}")[0]
    if value < 1 or value != int(value):
        raise MotionError(
            "not a count", where=f"{path}, {key}", got=value, expected="a whole number above 0"
        )
    return int(value)


def _is_number(text: str) -> bool:
    try:
        float(_point(text))
    except ValueError:
        return False
    return True
