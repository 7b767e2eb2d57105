"""Recorded frames come back as they were, and a damaged file is good up to the damage."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import RecordingError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.files.frame_file import (
    FramesDevice,
    frame_record,
    header_record,
    read_frame_file,
)

LENGTHS = st.floats(-0.5, 0.5)
CONTACTS = st.lists(
    st.builds(
        Contact,
        st.integers(-(2**63), 2**63 - 1),
        LENGTHS,
        LENGTHS,
        st.none() | st.floats(1e-4, 0.1),
        st.none() | st.integers(0, 4),
        st.none() | st.tuples(st.floats(1e-4, 0.1), st.floats(1e-4, 0.1)),
    ),
    max_size=6,
    unique_by=lambda c: c.id,
)
FRAMES = st.lists(
    st.builds(
        TouchFrame,
        st.floats(0.0, 1e6),
        CONTACTS.map(tuple),
        st.none() | st.floats(0.0, 1.0),
        st.frozensets(st.integers(), max_size=3),
    ),
    min_size=1,
    max_size=6,
).map(lambda frames: sorted(frames, key=lambda f: f.time))


def written(path: Path, *lines: str) -> Path:
    path.write_text("".join(line + "\n" for line in lines))
    return path


@pytest.mark.parametrize("size", [0.0, -1.0, float("nan"), float("inf")])
def test_what_a_device_says_that_does_not_measure_sizes_is_read_to_the_end(
    tmp_path: Path, size: float
) -> None:
    frame = TouchFrame(0.5, (Contact(1, 0.05, 0.05, size),))
    assert frame.contacts[0].size is None
    path = written(tmp_path / "a.jsonl", json.dumps(frame_record(frame)))
    file = read_frame_file(path)
    assert file.damage is None and len(file.frames) == 1


@given(FRAMES)
def test_frames_come_back_as_they_were(tmp_path_factory: object, frames: list[TouchFrame]) -> None:
    path = tmp_path_factory.getbasetemp() / "frames.jsonl"  # type: ignore[attr-defined]
    lines = [json.dumps(frame_record(frame)) for frame in frames]
    written(path, json.dumps(header_record(Surface(10.0, 5.0), "evdev")), *lines)
    file = read_frame_file(path)
    assert file.damage is None
    assert file.surface is not None
    assert (file.surface.width_in, file.surface.height_in) == (10.0, 5.0)
    assert len(file.frames) == len(frames)
    for got, was in zip(file.frames, frames, strict=True):
        assert (got.time, got.lift, got.cancelled) == (was.time, was.lift, was.cancelled)
        for a, b in zip(got.contacts, was.contacts, strict=True):
            assert (a.id, a.label) == (b.id, b.label)
            assert (a.x, a.y) == pytest.approx((b.x, b.y), abs=1e-15)
            assert a.size == (b.size and pytest.approx(b.size))
            assert a.extent == (b.extent and pytest.approx(b.extent))


GOOD = [json.dumps(frame_record(TouchFrame(n / 8, (Contact(1, 0.1, 0.1),)))) for n in range(4)]
DAMAGE = [
    GOOD[2][:30],
    "17",
    "[]",
    "{}",
    '{"time": 9, "contacts": [{"id": 1, "x": 1}]}',
    '{"time": 9, "contacts": [{"id": true, "x": 1, "y": 1}]}',
    '{"time": 9, "contacts": [{"id": 1, "x": NaN, "y": 1}]}',
    '{"time": 9, "contacts": [{"id": 1, "x": 1, "y": 1}, {"id": 1, "x": 2, "y": 2}]}',
    '{"time": 9, "contacts": [{"id": 1, "x": 1, "y": 1, "finger": "toe"}]}',
    '{"time": 9, "contacts": [{"id": 1, "x": 1, "y": 1, "size": -1}]}',
    '{"time": 9, "contacts": [], "lift": 7}',
    '{"time": 9, "contacts": [], "cancelled": ["a"]}',
    '{"time": 1e999, "contacts": []}',
    '{"time": 0.01, "contacts": []}',
    '{"time": 9, "contacts": 4}',
    '{"surface_in": [1, 2]}',
    "[" * 100_000,
    "x" * 1_100_000,
]


@pytest.mark.parametrize("line", DAMAGE, ids=range(len(DAMAGE)))
def test_a_damaged_file_is_good_up_to_the_line_that_is_named(tmp_path: Path, line: str) -> None:
    file = read_frame_file(written(tmp_path / "frames.jsonl", *GOOD[:2], "", line, GOOD[3]))
    assert len(file.frames) == 2
    assert isinstance(file.damage, RecordingError)
    assert "frames.jsonl, line 4" in str(file.damage)
    assert len(str(file.damage)) < 700


def test_a_file_without_a_single_frame_is_refused(tmp_path: Path) -> None:
    for lines in ([], ["hello"], ['{"surface_in": [9, 6]}'], ['{"surface_in": "big"}']):
        with pytest.raises(RecordingError, match="frames"):
            read_frame_file(written(tmp_path / "frames", *lines))
    for path in (tmp_path / "none", tmp_path):
        with pytest.raises(RecordingError, match=str(path)):
            read_frame_file(path)


@given(FRAMES, st.lists(st.floats(0.0, 2e6), max_size=12))
def test_what_is_played_does_not_depend_on_when_it_is_asked_for(
    frames: list[TouchFrame], moments: list[float]
) -> None:
    at_once = list(FramesDevice(frames).poll(2e6))
    device = FramesDevice(frames)
    assert [f for now in [*sorted(moments), 2e6] for f in device.poll(now)] == at_once
    assert device.finished
    assert at_once[0].time == 0.0
