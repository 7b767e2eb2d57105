"""Recordings survive damage, keep every number, and never overwrite."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.errors import RecordingError
from models.frames import Contact, TouchFrame
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recording import (
    DeferredLine,
    Line,
    RecordingLines,
    RecordingWriter,
    is_recording,
    load_recording,
)
from tasks.score import Status
from tests.support.scripted import scripted

HEADER = {"settings": {"timestep": 0.002}, "versions": {}, "digests": {}}

coordinates = st.floats(-1.0, 1.0, allow_nan=False)
contacts = st.builds(
    Contact,
    st.integers(-(2**31), 2**31 - 1),
    coordinates,
    coordinates,
    st.none() | st.floats(0.0, 0.1),
    st.none() | st.integers(0, 4),
    st.none() | st.tuples(st.floats(1e-6, 1.0), st.floats(1e-6, 1.0)),
)
frames = st.builds(
    TouchFrame,
    st.floats(0.0, 100.0),
    st.lists(contacts, max_size=6, unique_by=lambda c: c.id).map(tuple),
    st.none() | st.floats(0.0, 1.0),
    st.frozensets(st.integers(0, 9), max_size=3),
)


def write(path: Path, written: list[TouchFrame], end: bool = True) -> None:
    writer = RecordingWriter(path, HEADER)
    for i, frame in enumerate(written):
        writer.input(8 * i, 0, frame, f"{i:032x}")
    writer.keyframe(0, np.array([1.0, -0.0, 1e-300, np.pi]), "0")
    if end:
        writer.end(8 * len(written), {"state_hash": "ff", "status": "held", "success": True})
    writer.close()


@given(written=st.lists(frames, max_size=5))
def test_every_frame_comes_back_to_the_bit(
    tmp_path_factory: pytest.TempPathFactory, written: list[TouchFrame]
) -> None:
    path = tmp_path_factory.mktemp("recording") / "a.jsonl"
    write(path, written)
    recording = load_recording(path)
    assert [i.frame for i in recording.inputs.get(0, [])] == written
    assert recording.keyframes[0].tobytes() == np.array([1.0, -0.0, 1e-300, np.pi]).tobytes()
    assert not recording.damage


def test_an_existing_file_is_never_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "a.jsonl"
    path.write_text("precious")
    with pytest.raises(RecordingError, match="exists"):
        RecordingWriter(path, HEADER)
    assert path.read_text() == "precious"


@pytest.mark.parametrize("keep", [0.2, 0.5, 0.9, 0.999])
def test_a_truncated_recording_plays_up_to_the_damage_and_says_so(
    tmp_path: Path, keep: float
) -> None:
    path = tmp_path / "a.jsonl"
    written = [TouchFrame(0.016 * i, (Contact(1, 0.01 * i, 0.02),)) for i in range(9)]
    write(path, written)
    data = path.read_bytes()
    header = data.index(b"\n") + 1
    path.write_bytes(data[: header + int(keep * (len(data) - header))])
    recording = load_recording(path)
    got = [i.frame for i in recording.inputs.get(0, [])]
    assert got == written[: len(got)]
    assert recording.damage
    assert recording.end is None


def input_line(**wrong: Any) -> bytes:
    """A line of an input with a wrong part."""
    line = {"kind": "input", "step": 1, "hand": 0, "time": 0, "contacts": [], "hash": ""}
    return json.dumps(line | wrong).encode()


@pytest.mark.parametrize(
    "line",
    [
        b"\xff\xfe not text",
        b"[]",
        b"7",
        b'{"kind": "input"}',
        input_line(contacts=[[1, 2]]),
        input_line(contacts=[[1, np.nan, 0, None, None]]),
        input_line(contacts=[[1, 0.1, 0.2, None, None, 0.02]]),
        input_line(contacts=[[1, 0.1, 0.2, None, None, 0.02, -1.0]]),
        input_line(time=None),
        input_line(step=np.inf),
        input_line(hand=np.inf),
        input_line(lift=1.5),
        input_line(lift="high"),
        b'{"kind": "event", "step": Infinity, "event": "contact"}',
        b'{"kind": "keyframe", "step": 1, "state": "***", "hash": ""}',
        b'{"kind": "keyframe", "step": 1, "state": "AAAA", "hash": ""}',
        b'{"kind": "keyframe", "step": -Infinity, "state": "", "hash": ""}',
        b'{"kind": "track", "steps": [0, 8, Infinity], "joints": 1, "hands": 1, "poses": ""}',
        b'{"kind": "end"}',
        b'{"kind": "end", "step": 8, "hash": ""}',
        b'{"kind": "end", "step": 8, "hash": "", "result": {"success": true}}',
        b'{"kind": "end", "step": Infinity, "hash": "0", "result": {}}',
    ],
)
def test_a_damaged_line_ends_the_recording_with_its_number(tmp_path: Path, line: bytes) -> None:
    path = tmp_path / "a.jsonl"
    write(path, [TouchFrame(0.0, (Contact(1, 0.1, 0.2),))], end=False)
    lines = path.read_bytes().splitlines()
    path.write_bytes(b"\n".join([*lines, line, lines[1]]) + b"\n")
    recording = load_recording(path)
    assert len(recording.inputs[0]) == 1 and recording.end is None
    assert f"line {len(lines) + 1} is damaged" in recording.damage


def test_other_files_are_no_recordings(tmp_path: Path) -> None:
    for text in ("", "hello", "[1]", '{"kind": "header"}', '{"t": 0, "hex": "00"}'):
        path = tmp_path / "other"
        path.write_text(text)
        assert not is_recording(path)
        with pytest.raises(RecordingError, match="not a recording"):
            load_recording(path)
    with pytest.raises(RecordingError):
        load_recording(tmp_path / "missing")


def test_another_versions_recording_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.jsonl"
    path.write_text(json.dumps({"kind": "header", "schema": 99, "settings": {}}) + "\n")
    with pytest.raises(RecordingError, match="another version"):
        load_recording(path)


def test_a_full_disk_is_told_at_the_end_and_stalls_nobody() -> None:
    device = Path("/dev/full")
    if not device.exists():
        pytest.skip("device node absent: /dev/full")
    writer = RecordingWriter.__new__(RecordingWriter)
    # /dev/full exists already, and a writer makes new files only: hand it the open file.
    writer.__dict__.update(_file=device.open("wb", buffering=0), path=device)
    writer._start()
    for i in range(1000):
        writer.input(i, 0, TouchFrame(0.0), "")
    with pytest.raises(RecordingError, match="incomplete"):
        writer.close()


def test_what_json_does_not_know_is_told_at_the_end_and_what_was_written_before_is_sound(
    tmp_path: Path,
) -> None:
    path = tmp_path / "a.jsonl"
    writer = RecordingWriter(path, {"settings": {}})
    writer.input(0, 0, TouchFrame(0.0), "")
    writer.event(8, "measured", good=np.bool_(True))
    writer.input(16, 0, TouchFrame(0.1), "")
    with pytest.raises(RecordingError, match=r"incomplete.*not JSON serializable"):
        writer.close()
    found = load_recording(path)
    assert [entry.step for entry in found.inputs[0]] == [0] and "breaks off" in found.damage


@pytest.mark.parametrize("end", [True, False])
def test_a_recorded_device_gives_each_frame_at_its_step_and_says_where_it_breaks_off(
    end: bool, tmp_path: Path
) -> None:
    path = tmp_path / "a.jsonl"
    written = [TouchFrame(0.016 * i, (Contact(1, 0.01 * i, 0.02),)) for i in range(4)]
    write(path, written, end)
    device = RecordedDevice(load_recording(path))
    assert device.plays_file and (device.damage is None) == end
    got = [list(device.poll(8 * i * 0.002)) for i in range(4)]
    assert got == [[f] for f in written]
    assert device.finished


class Kept(RecordingLines):
    """Keeps lines, and which states it was told of."""

    def __init__(self) -> None:
        super().__init__()
        self.told: list[str] = []

    def _put(self, line: Line | DeferredLine) -> None:
        self.told.append(line.line()["kind"] if isinstance(line, DeferredLine) else line["kind"])

    def state(
        self, step: int, state: Array, state_hash: str, qpos: Array, solid: Sequence[frozenset[int]]
    ) -> None:
        super().state(step, state, state_hash, qpos, solid)
        self.told.append(f"state {step}")


def test_what_a_period_begins_with_is_recorded_before_the_pause_ahead_of_it() -> None:
    recorder = Kept()
    session = scripted(lambda now: [Contact(1, 0.1, 0.1)], recorder, seed=1)
    assert recorder.told == []
    for period in range(1, 4):
        session.advance()
        states = [t for t in recorder.told if t.startswith("state")]
        assert states == [f"state {8 * n}" for n in range(period + 1)]
        assert recorder.told[-1] == states[-1]
    # Each touch lies between the state that it met and the one that it led to.
    assert recorder.told[2:] == ["input", "state 8", "input", "state 16", "input", "state 24"]


def test_a_trial_that_is_over_records_no_state_that_nothing_begins_with() -> None:
    recorder = Kept()
    session = scripted(lambda now: [], recorder, seed=1)
    session.advance()
    before = list(recorder.told)
    session.scorer.abort(Status.TIMEOUT, "the test is over")
    session.advance()
    assert recorder.told == before + [t for t in recorder.told[len(before) :] if t == "input"]
