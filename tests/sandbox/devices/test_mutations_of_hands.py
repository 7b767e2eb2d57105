"""Recordings of hands in the air with faults: equal, reported or refused, never silently different.

Detectable faults: lengths by 10, 25.4 and 1000 or their inverses, times in other units, numbered or
timed rows dropped, doubled and swapped, stated counts that are wrong, and names in other bytes.
Undetectable is a missing row without a number: it costs that frame alone.
"""

from __future__ import annotations

import json
import re
import struct
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.captures.conversion.hand_files import Mapping, read_points, read_poses
from models.errors import InputError
from models.motion.asf import AmcWriter
from models.motion.bvh import BvhWriter
from models.motion.vicon_v import RECORD, VWriter, read_v
from models.reader_report import ReaderReport
from sandbox.devices.leap.leap_file import LeapRecording, read_leap
from sandbox.devices.webcam.landmarks import LandmarkRecording, header_record, read_landmarks
from tests.sandbox.devices.test_strange_hands import CAMERA, leap, numbers, pictures, scaled
from tests.support.hand_recording import (
    QUALISYS,
    RATE,
    Truth,
    markers,
    played,
    write_pose_table,
    write_tsv,
)
from tests.support.motion_poses import written

Rows = list[bytes]
OTHER_NAME = "Händchen".encode("latin-1")
LENGTHS = (10.0, 25.4, 1000.0, 0.1, 1 / 25.4, 1e-3)
TIMES = (1e3, 1e6, 1e9, 1e-3, 1e-6, 1e-9)


@dataclass(frozen=True)
class Outcome:
    """The numbers of each frame that was read, its time first, and whether it was reported on."""

    frames: list[np.ndarray]
    reported: bool

    def same(self, other: Outcome) -> bool:
        return len(self.frames) == len(other.frames) and all(
            a.shape == b.shape and np.allclose(a, b, rtol=1e-4, atol=2e-5, equal_nan=True)
            for a, b in zip(self.frames, other.frames, strict=True)
        )


def of_recording(read: Callable[[Path], LeapRecording | LandmarkRecording], path: Path) -> Outcome:
    recording = read(path)
    reported = bool(recording.report) or recording.damage is not None
    return Outcome([np.array(frame) for frame in numbers(recording)], reported)


def of_points(path: Path) -> Outcome:
    read = read_points(path, Mapping(dict(QUALISYS) if path.suffix == ".tsv" else {}))
    columns = [read.time[:, None], *(read.points[name] for name in sorted(read.sites))]
    return Outcome(list(np.concatenate(columns, axis=1)), bool(read.report))


def of_table(path: Path) -> Outcome:
    report = ReaderReport()
    time, q = read_poses(path, "", report)
    return Outcome(list(np.concatenate([time[:, None], q], axis=1)), bool(report))


# Rows of files: a line, or in AMC and V the skeleton, the head, and then one row a frame.


def lines_of(path: Path) -> Rows:
    return path.read_bytes().splitlines()


def write_lines(path: Path, rows: Rows) -> None:
    path.write_bytes(b"\n".join(rows) + b"\n")


def amc_rows(path: Path) -> Rows:
    head, *frames = re.split(rb"\n(?=\d+\n)", path.read_bytes().rstrip(b"\n"))
    return [path.with_suffix(".asf").read_bytes(), head, *frames]


def write_amc(path: Path, rows: Rows) -> None:
    path.with_suffix(".asf").write_bytes(rows[0])
    write_lines(path, rows[1:])


def v_rows(path: Path) -> Rows:
    data, size = path.read_bytes(), RECORD.size + 4 * len(read_v(path).labels)
    start = len(data) - size * FRAMES
    records = [data[i : i + size] for i in range(start, len(data), size)]
    return [path.with_suffix(".vsk").read_bytes(), data[:start], *records]


def write_v(path: Path, rows: Rows) -> None:
    path.with_suffix(".vsk").write_bytes(rows[0])
    path.write_bytes(b"".join(rows[1:]))


# Files with lengths and times multiplied.

FRAMES = 120


def hand(length: float) -> Truth:
    """A hand of another size, with all places multiplied."""
    truth = played(FRAMES / RATE, seed=3)
    q = truth.q.copy()
    q[:, :3] *= length
    return replace(truth, q=q, skeleton=truth.skeleton.scaled(length))


def write_bones(writer: Callable[..., Any], path: Path, length: float) -> None:
    written(lambda a: writer(path, a, RATE), hand(length).skeleton, hand(length).q)


def write_markers(path: Path, length: float) -> None:
    write_tsv(path, {name: length * at for name, at in markers(hand(1.0)).items()})


def motion(
    name: str,
    write: Callable[[Path, float], object],
    clock: tuple[bytes, Callable[[float], bytes]],
    load: Callable[[Path], Rows] = lines_of,
) -> Callable[[float, float], Rows]:
    """Rows of a motion file.

    Args:
        name: Name of the file.
        write: Writes the file, with lengths multiplied.
        clock: Text of its rate, and of the rate of multiplied times.
        load: Reads the rows.
    """

    @cache
    def rows(length: float, time: float) -> Rows:
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder) / name, length)
            found = load(Path(folder) / name)
        assert any(clock[0] in row for row in found)
        return [row.replace(clock[0], clock[1](time)) for row in found]

    return rows


@cache
def table(length: float, time: float) -> Rows:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hand.csv"
        write_pose_table(path, time * hand(1.0).time, hand(length).q)
        return lines_of(path)


@cache
def leap_rows(length: float, time: float) -> Rows:
    return [json.dumps(m).encode() for m in scaled(leap(), length, time)]


@cache
def bare_leap_rows(length: float, time: float) -> Rows:
    messages = [{k: v for k, v in m.items() if k != "id"} for m in scaled(leap(), length, time)]
    return [json.dumps(m).encode() for m in messages]


@cache
def picture_rows(length: float, time: float) -> Rows:
    messages = [header_record(CAMERA), *scaled(pictures(), length, time)]
    return [json.dumps(m).encode() for m in messages]


# Names in other bytes, where the formats have room for one.


def with_member(rows: Rows) -> Rows:
    return [*rows[:-1], rows[-1][:-1] + b', "who": "' + OTHER_NAME + b'"}']


def with_column(rows: Rows) -> Rows:
    return [rows[0] + b"," + OTHER_NAME, *(row + b",0" for row in rows[1:])]


def with_description(rows: Rows) -> Rows:
    return [b"DESCRIPTION\t" + OTHER_NAME, *rows]


def with_other(old: bytes, new: bytes) -> Callable[[Rows], Rows]:
    return lambda rows: [row.replace(old, new) for row in rows]


@dataclass(frozen=True)
class Format:
    """A format: its reader, its rows, and how its numbers and rows are changed.

    Attributes:
        read: Reads a file.
        name: Name of the file.
        scaled: Rows with lengths and times multiplied.
        faults: Detectable faults of rows.
        renamed: Rows with a name in other bytes.
        write: Writes rows to the file.
        count: Text of a stated count, and of a wrong one.
        frames: Number of rows that are frames, the last ones.
    """

    read: Callable[[Path], Outcome]
    name: str
    scaled: Callable[[float, float], Rows]
    faults: tuple[str, ...]
    renamed: Callable[[Rows], Rows] = with_member
    write: Callable[[Path, Rows], object] = write_lines
    count: tuple[bytes, bytes] = (b"", b"")
    frames: int = FRAMES

    @property
    def rows(self) -> Rows:
        """All rows as they should be."""
        return self.scaled(1.0, 1.0)

    @property
    def head(self) -> int:
        """Number of rows before the frames."""
        return len(self.rows) - self.frames


FORMATS = {
    "leap": Format(
        lambda path: of_recording(read_leap, path),
        "hands.jsonl",
        leap_rows,
        ("doubled", "swapped", "dropped"),
        frames=60,
    ),
    "leap without numbers": Format(
        lambda path: of_recording(read_leap, path), "hands.jsonl", bare_leap_rows, (), frames=60
    ),
    "landmarks": Format(
        lambda path: of_recording(read_landmarks, path),
        "hands.jsonl",
        picture_rows,
        ("doubled", "swapped"),
        frames=30,
    ),
    "bvh": Format(
        of_points,
        "hand.bvh",
        motion(
            "hand.bvh",
            partial(write_bones, BvhWriter),
            (b"Time: 0.01666667", lambda time: b"Time: %.9g" % (time / RATE)),
        ),
        ("doubled", "dropped", "count"),
        with_other(b"ROOT wrist", b"ROOT " + OTHER_NAME + b":wrist"),
        count=(b"Frames: 120", b"Frames: 113"),
    ),
    "tsv": Format(
        of_points,
        "hand.tsv",
        motion(
            "hand.tsv",
            write_markers,
            (b"FREQUENCY\t60", lambda time: b"FREQUENCY\t%.9g" % (RATE / time)),
        ),
        ("doubled", "dropped", "count"),
        with_description,
        count=(b"NO_OF_FRAMES\t120", b"NO_OF_FRAMES\t127"),
    ),
    "csv": Format(of_table, "hand.csv", table, ("doubled", "swapped"), with_column),
    "amc": Format(
        of_points,
        "hand.amc",
        motion(
            "hand.amc",
            partial(write_bones, AmcWriter),
            (b" 60\n:FULLY", lambda time: b" %.9g\n:FULLY" % (RATE / time)),
            amc_rows,
        ),
        ("doubled", "swapped", "dropped"),
        with_other(b"index_proximal", OTHER_NAME),
        write_amc,
    ),
    "v": Format(
        of_points,
        "hand.v",
        motion(
            "hand.v",
            partial(write_bones, VWriter),
            (struct.pack("<d", RATE), lambda time: struct.pack("<d", RATE / time)),
            v_rows,
        ),
        ("doubled", "swapped", "dropped"),
        # As long as the subject that it replaces.
        with_other(b"hand:", OTHER_NAME[:4] + b":"),
        write_v,
    ),
}


def outcome(form: Format, rows: Rows) -> Outcome | None:
    """What is read of rows; None if they are refused."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / form.name
        form.write(path, rows)
        try:
            return form.read(path)
        except InputError:
            return None


@cache
def sound(name: str) -> Outcome:
    read = outcome(FORMATS[name], FORMATS[name].rows)
    assert read is not None and not read.reported
    return read


def faulty(form: Format, fault: str, draw: Callable[[int], int]) -> Rows:
    """Rows with a fault; `draw(n)` is one of the first n numbers."""
    rows = list(form.rows)
    # Numbers may begin anywhere, so that the first and the last row may be missing.
    at = form.head + 1 + draw(form.frames - 2)
    match fault:
        case "lengths":
            return form.scaled(LENGTHS[draw(6)], 1.0)
        case "times":
            return form.scaled(1.0, TIMES[draw(6)])
        case "both":
            return form.scaled(LENGTHS[draw(6)], TIMES[draw(6)])
        case "bytes":
            return form.renamed(rows)
        case "count":
            return with_other(*form.count)(rows)
        case "dropped":
            del rows[at]
        case "doubled":
            rows.insert(at, rows[at])
        case "swapped":
            rows[at], rows[at + 1] = rows[at + 1], rows[at]
    return rows


@pytest.mark.parametrize("name", [name for name, form in FORMATS.items() if form.faults])
@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_no_detectable_fault_is_silent(name: str, data: st.DataObject) -> None:
    form = FORMATS[name]
    fault = data.draw(st.sampled_from(["lengths", "times", "both", "bytes", *form.faults]))
    read = outcome(form, faulty(form, fault, lambda n: data.draw(st.integers(0, n - 1))))
    assert read is None or read.reported or read.same(sound(name)), fault


@pytest.mark.parametrize("factor", [1.0, *LENGTHS])
def test_a_skeleton_in_a_unit_without_a_name_is_read_in_it_or_refused(
    factor: float, tmp_path: Path
) -> None:
    form = FORMATS["amc"]
    # Inches times 0.45, as CMU's files have them, instead of centimetres.
    skeleton, *rest = form.scaled(factor * 0.45 / 2.54, 1.0)
    form.write(tmp_path / form.name, [skeleton.replace(b"length 2.54", b"length 0.45"), *rest])
    if factor == 1.0:
        assert of_points(tmp_path / form.name).same(sound("amc"))
        return
    with pytest.raises(InputError, match="impossible in the unit that the skeleton states"):
        of_points(tmp_path / form.name)


def _edited(name: str, change: Callable[[bytes], bytes]) -> Outcome | None:
    """What is read of a changed file."""
    whole = b"\n".join(FORMATS[name].rows)
    changed = change(whole)
    assert changed != whole
    return outcome(FORMATS[name], [changed])


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("csv", lambda text: text.replace(b",", b";")),
        ("csv", lambda text: text.replace(b",", b";").replace(b".", b",")),
        ("csv", lambda text: text.replace(b",", b"\t")),
        ("csv", lambda text: re.sub(rb"([^,\n]+)", rb'"\1"', text)),
        *(
            (name, lambda text: b"\xfe\xff" + text.decode().encode("utf-16-be") + b"\0")
            for name in ("bvh", "tsv", "csv")
        ),
        ("bvh", lambda text: text.replace(b"End Site", b"End Site thumb_end")),
        ("bvh", lambda text: text.replace(b"rotation", b"ROTATION")),
        ("bvh", lambda text: text.replace(b"\n", b"\r")),
    ],
)
def test_what_spreadsheets_and_exporters_write_otherwise_is_read_as_it_is(
    name: str, change: Callable[[bytes], bytes]
) -> None:
    read = _edited(name, change)
    assert read is not None and read.same(sound(name)) and not read.reported


@pytest.mark.parametrize(
    ("name", "change"),
    [
        # A space is missing before a minus.
        ("bvh", lambda text: re.sub(rb"(\d) (-\d)", rb"\1\2", text)),
        ("bvh", lambda text: text.replace(b"End Site", b"EndSite")),
        ("bvh", lambda text: re.sub(rb"(?<=Frame Time: )\S+", b"0", text)),
        ("bvh", lambda text: re.sub(rb"(\d)\.(\d)", rb"\1,\2", text)),
        ("tsv", lambda text: text.replace(b"\t", b";")),
        ("csv", lambda text: text[:-100]),
    ],
)
def test_what_cannot_be_read_for_certain_is_refused(
    name: str, change: Callable[[bytes], bytes]
) -> None:
    assert _edited(name, change) is None


def in_radians(row: bytes, first: int) -> bytes:
    """A row whose words from `first` on are angles."""
    words = row.split(b" ")
    return b" ".join([*words[:first], *(b"%.9g" % (float(w) * np.pi / 180) for w in words[first:])])


@pytest.mark.parametrize("name", ["bvh", "amc"])
def test_angles_that_may_be_radians_are_reported(name: str) -> None:
    form = FORMATS[name]
    rows = list(form.rows)
    for i in range(form.head, len(rows)):
        lines = rows[i].split(b"\n")
        # After the words of a line that are no angles: a name, and three places of the root.
        first = {b"root": 4}
        lines = [
            in_radians(line, 3 if name == "bvh" else first.get(line.split(b" ")[0], 1))
            for line in lines
            if not line.isdigit()
        ]
        rows[i] = b"\n".join([*rows[i].split(b"\n")[: name == "amc"], *lines])
    read = outcome(form, rows)
    assert read is not None and read.reported


@pytest.mark.parametrize("name", ["leap without numbers", "landmarks", "csv"])
@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_a_missing_row_without_a_number_costs_that_frame_alone(
    name: str, data: st.DataObject
) -> None:
    form = FORMATS[name]
    at = data.draw(st.integers(form.head + 1, len(form.rows) - 1))
    read = outcome(form, [row for i, row in enumerate(form.rows) if i != at])
    assert read is not None
    frames = sound(name).frames
    del (rest := list(frames))[at - form.head]
    assert read.same(Outcome(rest, False))
