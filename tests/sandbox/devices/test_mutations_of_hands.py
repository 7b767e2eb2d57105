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
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.captures.conversion.hand_files import Mapping, read_points, read_poses
from models.errors import InputError
from models.motion.asf import AmcWriter
from models.motion.vicon_v import RECORD, VWriter, read_v
from models.reader_report import ReaderReport
from sandbox.devices.leap.leap_file import LeapRecording, read_leap
from sandbox.devices.webcam.landmarks import LandmarkRecording, read_landmarks
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.server.protocol import PageHands, PageScreen, SeenJoints
from tests.sandbox.devices.test_strange_hands import CAMERA, leap, numbers, pictures, scaled
from tests.support.hand_recording import (
    QUALISYS,
    RATE,
    markers,
    played,
    write_bvh,
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


def of_headset(messages: list[PageHands]) -> Outcome:
    device = HeadsetDevice()
    screen = PageScreen(96.0, 1000.0, 800.0, True)
    for message in messages:
        device.receive(message, screen)
    palms = [np.array(hand.palm) for frame in device.poll() for hand in frame.hands]
    return Outcome(palms, bool(device.report))


@dataclass(frozen=True)
class Format:
    """A format: its reader, its rows, and how its numbers and rows are changed.

    Attributes:
        read: Reads a file.
        name: Name of the file.
        head: Number of rows before the frames.
        rows: All rows.
        scale: Rows with lengths and times multiplied; None where others test it.
        numbered: Rows have numbers, so that a missing one is noticed.
        counted: Text of a stated count, and of a wrong one; empty where none is stated.
        told: Rows that are swapped are noticed, by a number or a time.
        write: Writes rows to the file.
        renamed: Rows with a name in other bytes; None for the usual ones.
    """

    read: Callable[[Path], Outcome]
    name: str
    head: int
    rows: Rows
    scale: Callable[[float, float], Rows]
    numbered: bool = False
    counted: tuple[bytes, bytes] = (b"", b"")
    told: bool = True
    write: Callable[[Path, Rows], object] = lambda path, rows: path.write_bytes(
        b"\n".join(rows) + b"\n"
    )
    renamed: Callable[[Rows], Rows] | None = None


def _json_rows(messages: list[dict[str, Any]]) -> Rows:
    header = [{"landmarks": 1, "camera": {"view": CAMERA.view}}] if "seen" in messages[0] else []
    return [json.dumps(m).encode() for m in (*header, *messages)]


def _file(write: Callable[[Path], object], name: str) -> Rows:
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder) / name)
        return (Path(folder) / name).read_bytes().splitlines()


@cache
def formats() -> dict[str, Format]:
    """All formats by name, with 60 frames or fewer of one hand in each."""
    truth = played(2.0, seed=3)
    bvh = _file(lambda path: write_bvh(path, truth), "hand.bvh")
    tsv = _file(lambda path: write_tsv(path, markers(truth)), "hand.tsv")
    csv = _file(lambda path: write_pose_table(path, truth.time, truth.q), "hand.csv")

    def of_bvh(length: float, time: float) -> Rows:
        out, frames = [], bvh.index(b"MOTION") + 3
        for i, row in enumerate(bvh):
            words = row.split()
            if words[0] == b"OFFSET" or i >= frames:
                first = 1 if words[0] == b"OFFSET" else 0
                for k in range(first, first + 3):
                    words[k] = b"%.9g" % (float(words[k]) * length)
            if row.startswith(b"Frame Time:"):
                words[-1] = b"%.9g" % (float(words[-1]) * time)
            out.append(b" ".join(words))
        return out

    def of_tsv(length: float, time: float) -> Rows:
        out = []
        for i, row in enumerate(tsv):
            cells = row.split(b"\t")
            if cells[0] == b"FREQUENCY":
                cells[1] = b"%.9g" % (float(cells[1]) / time)
            if i >= len(tsv) - len(truth.q):
                cells = [b"%.9g" % (float(c) * length) if c.strip() else c for c in cells]
            out.append(b"\t".join(cells))
        return out

    def of_csv(length: float, time: float) -> Rows:
        out = csv[:1]
        for row in csv[1:]:
            cells = [float(c) for c in row.split(b",")]
            cells[0] *= time
            cells[1:4] = [c * length for c in cells[1:4]]
            out.append(b",".join(b"%.9g" % c for c in cells))
        return out

    return {
        "leap": Format(
            lambda path: of_recording(read_leap, path),
            "hands.jsonl",
            0,
            _json_rows(leap()),
            lambda length, time: _json_rows(scaled(leap(), length, time)),
            numbered=True,
        ),
        "leap without numbers": Format(
            lambda path: of_recording(read_leap, path),
            "hands.jsonl",
            0,
            _json_rows([{k: v for k, v in m.items() if k != "id"} for m in leap()]),
            lambda length, time: _json_rows(scaled(leap(), length, time)),
        ),
        "landmarks": Format(
            lambda path: of_recording(read_landmarks, path),
            "hands.jsonl",
            1,
            _json_rows(pictures()),
            lambda length, time: _json_rows(scaled(pictures(), length, time)),
        ),
        "bvh": Format(
            of_points,
            "hand.bvh",
            bvh.index(b"MOTION") + 3,
            bvh,
            of_bvh,
            counted=(b"Frames: %d" % len(truth.q), b"Frames: %d" % (len(truth.q) - 7)),
            told=False,
        ),
        "tsv": Format(
            of_points,
            "hand.tsv",
            len(tsv) - len(truth.q),
            tsv,
            of_tsv,
            counted=(b"NO_OF_FRAMES\t%d" % len(truth.q), b"NO_OF_FRAMES\t%d" % (len(truth.q) + 7)),
            told=False,
        ),
        "csv": Format(of_table, "hand.csv", 1, csv, of_csv),
        "amc": amc(),
        "v": vicon(),
    }


def _scaled_words(row: bytes, first: int, count: int, factor: float) -> bytes:
    """A row with some of its words multiplied."""
    words = row.split(b" ")
    for k in range(first, first + count):
        words[k] = b"%.9g" % (float(words[k]) * factor)
    return b" ".join(words)


def amc() -> Format:
    """AMC with its ASF as the first row; a row is a frame with its number."""
    truth = played(2.0, seed=3)

    def write(path: Path) -> None:
        written(lambda armature: AmcWriter(path, armature, RATE), truth.skeleton, truth.q)
        path.write_bytes(path.with_suffix(".asf").read_bytes() + b"\0" + path.read_bytes())

    skeleton, motion = b"\n".join(_file(write, "hand.amc")).split(b"\0")
    head, *frames = motion.split(b"\n1\n", 1)
    rest = b"1\n" + frames[0]
    starts = [0, *(rest.index(b"\n%d\n" % n) + 1 for n in range(2, len(truth.q) + 1)), None]
    rows = [skeleton, head, *(rest[a:b].rstrip(b"\n") for a, b in pairwise(starts))]

    def scale(length: float, time: float) -> Rows:
        bones = [
            _scaled_words(line, 5, 1, length) if line.startswith(b"    length") else line
            for line in skeleton.split(b"\n")
        ]
        rate = b" %.9g\n" % RATE
        assert rate in head + b"\n"
        out = [b"\n".join(bones), head.replace(rate, b" %.9g\n" % (RATE / time))]
        for row in rows[2:]:
            number, root, *others = row.split(b"\n")
            out.append(b"\n".join([number, _scaled_words(root, 1, 3, length), *others]))
        return out

    def write_rows(path: Path, all_rows: Rows) -> None:
        path.with_suffix(".asf").write_bytes(all_rows[0] + b"\n")
        path.write_bytes(b"\n".join(all_rows[1:]) + b"\n")

    def renamed(all_rows: Rows) -> Rows:
        return [row.replace(b"index_proximal", OTHER_NAME) for row in all_rows]

    return Format(
        of_points, "hand.amc", 2, rows, scale, numbered=True, write=write_rows, renamed=renamed
    )


def vicon() -> Format:
    """V with its VSK as the first row; a row is a record."""
    truth = played(2.0, seed=3)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hand.v"
        written(lambda armature: VWriter(path, armature, RATE), truth.skeleton, truth.q)
        data, skeleton = path.read_bytes(), path.with_suffix(".vsk").read_bytes()
        size = RECORD.size + 4 * len(read_v(path).labels)
    start = len(data) - size * len(truth.q)
    rows = [skeleton, data[:start], *(data[i : i + size] for i in range(start, len(data), size))]

    def scale(length: float, time: float) -> Rows:
        bones = re.sub(
            rb'(?<=POSITION=")[^"]+|(?<=PRESENT-POSITION=")[^"]+',
            lambda m: _scaled_words(m[0], 0, 3, length),
            skeleton,
        )
        rate = struct.pack("<d", RATE)
        assert rate in data[:start]
        out = [bones, data[:start].replace(rate, struct.pack("<d", RATE / time))]
        for row in rows[2:]:
            values = np.frombuffer(row, "<f4", offset=RECORD.size).copy()
            values[3:6] *= length
            out.append(row[: RECORD.size] + values.tobytes())
        return out

    def write_rows(path: Path, all_rows: Rows) -> None:
        path.with_suffix(".vsk").write_bytes(all_rows[0])
        path.write_bytes(b"".join(all_rows[1:]))

    def renamed(all_rows: Rows) -> Rows:
        # As long as the subject that it replaces.
        return [all_rows[0], all_rows[1].replace(b"hand:", OTHER_NAME[:4] + b":"), *all_rows[2:]]

    return Format(
        of_points, "hand.v", 2, rows, scale, numbered=True, write=write_rows, renamed=renamed
    )


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
    read = outcome(formats()[name], formats()[name].rows)
    assert read is not None and not read.reported
    return read


def is_silent(name: str, rows: Rows) -> bool:
    """True if rows with a fault are read differently, without a word."""
    read = outcome(formats()[name], rows)
    return read is not None and not read.reported and not read.same(sound(name))


def mutate(form: Format, kind: str, draw: Callable[[int], int]) -> Rows:
    """Rows with a fault of a kind; `draw(n)` is one of the first n numbers."""
    rows = list(form.rows)
    # Numbers may begin anywhere, so that the first and the last row may be missing.
    at = form.head + 1 + draw(len(rows) - form.head - 2)
    if kind == "lengths":
        return form.scale(LENGTHS[draw(len(LENGTHS))], 1.0)
    if kind == "times":
        return form.scale(1.0, TIMES[draw(len(TIMES))])
    if kind == "both":
        return form.scale(LENGTHS[draw(len(LENGTHS))], TIMES[draw(len(TIMES))])
    if kind == "dropped":
        del rows[at]
    elif kind == "doubled":
        rows.insert(at, rows[at])
    elif kind == "swapped":
        rows[at], rows[at + 1] = rows[at + 1], rows[at]
    elif kind == "count":
        rows = [row.replace(*form.counted) for row in rows]
    elif kind == "bytes" and form.renamed is not None:
        rows = form.renamed(rows)
    elif kind == "bytes":
        # A name in Latin-1, where the format has room for one.
        other = OTHER_NAME
        if rows[0].startswith(b"{"):
            rows[at] = rows[at][:-1] + b', "who": "' + other + b'"}'
        elif form.name.endswith("bvh"):
            rows = [row.replace(b"ROOT wrist", b"ROOT " + other + b":wrist") for row in rows]
        elif form.name.endswith("tsv"):
            rows.insert(0, b"DESCRIPTION\t" + other)
        else:
            rows = [rows[0] + b"," + other, *(row + b",0" for row in rows[1:])]
    return rows


def kinds(form: Format) -> tuple[str, ...]:
    """Detectable faults of a format."""
    found = ["lengths", "times", "both", "bytes", "doubled"]
    found += ["swapped"] if form.told else []
    found += ["dropped"] if form.numbered or form.counted[0] else []
    return (*found, "count") if form.counted[0] else tuple(found)


@pytest.mark.parametrize("name", ["leap", "landmarks", "bvh", "tsv", "csv", "amc", "v"])
@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_no_detectable_fault_is_silent(name: str, data: st.DataObject) -> None:
    form = formats()[name]
    kind = data.draw(st.sampled_from(kinds(form)))
    rows = mutate(form, kind, lambda n: data.draw(st.integers(0, n - 1)))
    assert not is_silent(name, rows), kind


@pytest.mark.parametrize("factor", [1.0, *LENGTHS])
def test_a_skeleton_in_a_unit_without_a_name_is_read_in_it_or_refused(
    factor: float, tmp_path: Path
) -> None:
    form = formats()["amc"]
    # Inches times 0.45, as CMU's files have them, instead of centimetres.
    skeleton, *rest = form.scale(factor * 0.45 / 2.54, 1.0)
    form.write(tmp_path / form.name, [skeleton.replace(b"length 2.54", b"length 0.45"), *rest])
    if factor == 1.0:
        assert of_points(tmp_path / form.name).same(sound("amc"))
        return
    with pytest.raises(InputError, match="impossible in the unit that the skeleton states"):
        of_points(tmp_path / form.name)


def _edited(name: str, change: Callable[[bytes], bytes]) -> Outcome | None:
    """What is read of a changed file."""
    whole = b"\n".join(formats()[name].rows)
    changed = change(whole)
    assert changed != whole
    return outcome(formats()[name], [changed])


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


@pytest.mark.parametrize("name", ["bvh", "amc"])
def test_angles_that_may_be_radians_are_reported(name: str) -> None:
    form = formats()[name]
    rows = list(form.rows)
    for i in range(form.head, len(rows)):
        lines = rows[i].split(b"\n")
        # After the words of a line that are no angles: a name, and three places of the root.
        first = {b"root": 4}
        lines = [
            _scaled_words(line, start, line.count(b" ") + 1 - start, np.pi / 180)
            for line in lines
            for start in [3 if name == "bvh" else first.get(line.split(b" ")[0], 1)]
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
    form = formats()[name]
    at = data.draw(st.integers(form.head + 1, len(form.rows) - 1))
    read = outcome(form, [row for i, row in enumerate(form.rows) if i != at])
    assert read is not None
    frames = sound(name).frames
    del (rest := list(frames))[at - form.head]
    assert read.same(Outcome(rest, False))


@cache
def _headset_joints() -> list[list[tuple[float, float, float]]]:
    """25 joints of a hand in 40 moments."""
    out = []
    for message in pictures()[:20] * 2:
        seen = np.array(message["seen"][0]["world"])
        joints = [seen[0], *seen[1:5]]
        for first in (5, 9, 13, 17):
            # A metacarpal begins near the wrist.
            joints += [0.7 * seen[0] + 0.3 * seen[first], *seen[first : first + 4]]
        out.append([(float(x), float(y), float(z)) for x, y, z in np.array(joints) + 0.3])
    return out


def headset(length: float) -> Outcome:
    return of_headset(
        [
            PageHands(
                seq,
                10.0 * seq,
                [SeenJoints("right", [(x * length, y * length, z * length) for x, y, z in joints])],
            )
            for seq, joints in enumerate(_headset_joints(), start=1)
        ]
    )


@settings(max_examples=200, deadline=None)
@given(length=st.sampled_from(LENGTHS))
def test_a_headset_with_another_unit_goes_on_with_a_notice(length: float) -> None:
    assert not headset(1.0).reported
    read = headset(length)
    # Places that are too far away in metres are left out until the unit is known.
    assert read.reported and 10 <= len(read.frames) <= 40
