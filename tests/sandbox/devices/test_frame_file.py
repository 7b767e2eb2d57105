"""Recorded frames come back as they were, read once; a damaged file is good up to the damage."""

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
    FrameFile,
    FramesDevice,
    frame_record,
    header_record,
    read_frame_file,
)
from sandbox.trial.assembly import device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.guarded import draw_task
from tasks.registry import find_task

LENGTHS = st.floats(0.0, 0.12)
CONTACTS = st.lists(
    st.builds(
        Contact,
        st.integers(-(2**63), 2**63 - 1),
        LENGTHS,
        LENGTHS,
        st.none() | st.floats(2e-3, 0.1),
        st.none() | st.integers(0, 4),
        st.none() | st.tuples(st.floats(0.02, 0.1), st.floats(0.02, 0.1)),
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


@pytest.mark.parametrize("size", [0.0, -1.0, float("nan"), float("inf")])
def test_a_size_that_is_no_length_is_unknown(size: float) -> None:
    assert Contact(1, 0.05, 0.05, size).size is None


GOOD = [json.dumps(frame_record(TouchFrame(n / 8, (Contact(1, 0.1, 0.1),)))) for n in range(4)]
DAMAGE = [
    GOOD[2][:30],
    "17",
    "[]",
    "{}",
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


TOUCH = '{"id": 1, "x": 1, "y": 1}'
OTHER = '{"id": 2, "x": 1, "y": 1'
PARTS = {
    "no place": ('{"id": 2, "x": 1}', 1, "cannot be read"),
    "a place that is no number": ('{"id": 2, "x": NaN, "y": 1}', 1, "beyond the surface"),
    "no objects": ("7, null, []", 1, "3 touches that cannot be read"),
    "one id twice": ('{"id": 1, "x": 2, "y": 2}', 1, "id of another"),
    "an endless id": (f'{{"id": {2**70}, "x": 1, "y": 1}}', 1, "more than 64 bits"),
    "no finger's name": (OTHER + ', "finger": "toe"}', 2, "names that no finger has"),
    "a negative size": (OTHER + ', "size": -1}', 2, ""),
    "a size of 0": (OTHER + ', "size": 0, "width": 0, "height": 0.3}', 2, ""),
    "a size of 30 x 2000 px": (OTHER + ', "width": 0.2, "height": 15}', 2, "no finger or hand has"),
    "a little beyond the edge": ('{"id": 2, "x": 7.9, "y": -0.2}', 2, ""),
    "far beyond the edge": ('{"id": 2, "x": 1e9, "y": 1}', 1, "beyond the surface"),
    "a lift of 7": (OTHER + '}], "lift": 7, "cancelled": ["a"], "more": [4', 2, "lift control"),
}


@pytest.mark.parametrize(("line", "touches", "reason"), PARTS.values(), ids=PARTS)
def test_one_wrong_part_costs_itself_alone(
    tmp_path: Path, line: str, touches: int, reason: str
) -> None:
    header = json.dumps(header_record(Surface(), "page"))
    after = GOOD[3].replace("0.375", "9.5")
    middle = f'{{"time": 9, "contacts": [{TOUCH}, {line}]}}'
    path = written(tmp_path / "frames.jsonl", header, *GOOD[:2], middle, after)
    file = read_frame_file(path)
    assert file.damage is None
    assert [len(frame.contacts) for frame in file.frames] == [1, 1, touches, 1]
    width, height = Surface().size
    assert all(0.0 <= c.x <= width and 0.0 <= c.y <= height for c in file.frames[2].contacts)
    assert reason in file.report.line()
    assert bool(reason) == bool(file.report.line())


@pytest.mark.parametrize("time", ["NaN", "null", '"1"', "1e999", "0.01", "1e9", "1" * 400])
def test_a_frame_without_a_possible_time_costs_itself_alone(tmp_path: Path, time: str) -> None:
    line = f'{{"time": {time}, "contacts": [{TOUCH}]}}'
    path = written(tmp_path / "frames.jsonl", *GOOD[:2], line, *GOOD[2:])
    file = read_frame_file(path)
    assert [frame.time for frame in file.frames] == [n / 8 for n in range(4)]
    assert file.damage is None
    assert "1 frames" in file.report.line() and "time" in file.report.line()


def steady(unit: float, step: float = 1 / 60, count: int = 30, inch: float = 1.0) -> list[str]:
    """Frames of a finger that moves beside another over an iPad, in other units."""
    return [
        json.dumps(
            {
                "time": n * step * unit,
                "contacts": [
                    {"id": 1, "x": (2.0 + n / 10) * inch, "y": 3.0 * inch},
                    {"id": 2, "x": 5.2 * inch, "y": 5.1 * inch},
                ],
            }
        )
        for n in range(count)
    ]


@pytest.mark.parametrize(
    ("second", "inch", "told"),
    [
        (1.0, 1.0, ""),
        *((1e3, 1.0, "times are read in ms"), (1e6, 1.0, "times are read in us")),
        *((1e9, 1.0, "times are read in ns"), (1.0, 25.4, "lengths are read in mm")),
        *((1.0, 2.54, "lengths are read in cm"), (1.0, 0.0254, "lengths are read in m")),
        (1e3, 25.4, "times are read in ms"),
    ],
)
def test_times_and_places_are_read_in_the_unit_in_which_they_are_possible(
    tmp_path: Path, second: float, inch: float, told: str
) -> None:
    header = json.dumps(header_record(Surface(), "page"))
    path = written(tmp_path / "frames.jsonl", header, *steady(second, inch=inch))
    file = read_frame_file(path)
    assert [f.time for f in file.frames] == pytest.approx([n / 60 for n in range(30)])
    assert file.frames[0].contacts[0].x == pytest.approx(2.0 * 0.0254)
    assert told in file.report.line()
    assert bool(told) == bool(file.report.line())
    again = read_frame_file(path, "s,in")
    assert again.frames[1].time == pytest.approx(second / 60), "a person's unit is not doubted"


@pytest.mark.parametrize(("second", "inch"), [(0.0, 1.0), (1e-3, 1.0), (1.0, 132.0), (1.0, 1e3)])
def test_times_and_places_that_are_impossible_in_any_unit_are_refused(
    tmp_path: Path, second: float, inch: float
) -> None:
    header = json.dumps(header_record(Surface(), "page"))
    path = written(tmp_path / "frames.jsonl", header, *steady(second, inch=inch))
    with pytest.raises(RecordingError, match=r"zero|impossible|several") as refusal:
        read_frame_file(path)
    assert "frames.jsonl" in str(refusal.value)


def test_a_screen_that_nobody_touches_is_silent_for_any_time(tmp_path: Path) -> None:
    lines = steady(1.0)
    lines[10:10] = ['{"time": 0.16, "contacts": []}']
    late = [line.replace('"time": ', '"time": 900') for line in lines[11:]]
    bursts = steady(1.0, step=1e-5)[:2]
    file = read_frame_file(written(tmp_path / "frames.jsonl", *bursts, *lines[2:11], *late))
    assert not file.report.line()


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


def test_touches_are_read_once_and_again_when_the_file_has_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reads: list[Path] = []

    def read(path: Path) -> FrameFile:
        reads.append(path)
        return read_frame_file(path)

    monkeypatch.setattr("sandbox.devices.files.touch_files.read_frame_file", read)
    task = draw_task(find_task("box-to-goal"), 1, Surface())
    header, path = json.dumps(header_record(Surface(), "a pad")), tmp_path / "pad.jsonl"
    for count in (3, 4):
        written(path, header, *GOOD[:count])
        for _ in range(3):
            for make in device_makers(trial_settings(TrialOptions(device=str(path)))):
                make(task, Surface()).close()
    assert reads == 2 * [path]
