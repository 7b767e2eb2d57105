"""Files from outside are read, or refused with one clear error of the reader's own class."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.captures.conversion.hand_files import read_mapping
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import calibration_to_json, is_calibration, read_calibration
from models.errors import EncoderError, InputError, RecordingError, StudyError
from sandbox.devices.files.frame_file import read_frame_file
from sandbox.devices.files.paired_capture import arrivals, first_line_with_host, read_about
from sandbox.devices.files.touch_files import open_file
from sandbox.devices.files.touch_log_file import read_touch_log
from sandbox.devices.tuio.touch_capture import read_capture
from sandbox.regress.baseline import Baseline, BaselineTask, BaselineTrial, load_baseline
from sandbox.regress.run_plan import Origin
from sandbox.study.record.journal import chained, read_journal
from sandbox.study.record.notes import read_notes
from sandbox.study.record.state import SessionState
from sandbox.study.share.masking import PersonMasking, shared_line
from sandbox.trial.profiles import load_profile
from tests.support.json_values import VALUES, damaged


class Reader(NamedTuple):
    """A reader with a sound file.

    Attributes:
        read: Reads a file.
        sound: The text of a file that is read.
        error: The class of the errors.
    """

    read: Callable[[Path], object]
    sound: str
    error: type[InputError]


HAND = HandCalibration(
    "right",
    np.full(5, 0.08),
    np.full(5, 0.001),
    np.zeros((5, 3)),
    np.tile([0.0, 1.0, 0.0], (5, 1)),
    np.full((5, 3), 0.03),
    1000,
    9.5,
    {"the hand was not seen": 3},
)
PROFILE = {
    "kind": "hand-sandbox profile",
    "schema": 1,
    "hand": "left",
    "hand_size": 0.9,
    "turn": 0,
    "hand_size_95": [0.8, 1.0],
    "device": "tuio",
    "simulated": False,
}
TRIALS = {seed: BaselineTrial(True, 0.5, 3.25, "ab") for seed in (1, 2, 2**70)}
ORIGIN = Origin(
    {"encoder": "cubic"}, {"states": 2, "version": "0.2.0", "models": {"encoder": "ab"}}
)
BASELINE = Baseline(ORIGIN, {"stack": BaselineTask(1, "m", TRIALS)})

FRAMES: list[dict[str, Any]] = [
    {"surface_in": [7.76, 5.82], "device": "evdev"},
    {
        "time": 0.5,
        "contacts": [{"id": 3, "x": 1.5, "y": 2, "finger": "index", "size": 0.4}],
        "lift": 0.5,
        "host": 12.5,
    },
    {"time": 0.75, "contacts": [], "cancelled": [3], "host": 13},
]
PACKETS: list[dict[str, Any]] = [
    {"t": 1.5, "hex": "23627564", "from": "tablet"},
    {"t": 2, "closed": "tablet"},
]
MAPPING = {
    "points": {"a": "index_tip", "b": {"bone": "palm", "at": [0, 0.1, 0], "spread": 0.01}},
    "surface": {"top_left": "a", "top_right": [1, 2, 3.5], "bottom_left": "b"},
}
ABOUT = {"side": "left", "subject": "p1", "simulated": True, "touches": "tuio"}


RECORDS: list[dict[str, Any]] = [
    {"n": 0, "kind": "session", "ppid": "AB12CD"},
    {"n": 1, "kind": "done", "step": "i"},
    {"n": 2, "kind": "trial", "step": "t1", "trial": 1, "attempt": 1},
    {"n": 3, "kind": "trial_end", "step": "t1", "trial": 1, "attempt": 1, "result": {}},
    {"n": 4, "kind": "command", "command": "repeat", "step": "t1", "trial": 1, "reason": "again"},
    {"n": 5, "kind": "command", "command": "skip", "step": "q", "reason": None},
    {"n": 6, "kind": "command", "command": "exclude", "trial": None, "reason": "r"},
    {"n": 7, "kind": "answer", "step": "q", "item": "a", "answer": [1]},
    {"n": 8, "kind": "form", "step": "q", "form": "f", "answers": {"a": 1}},
    {"n": 9, "kind": "consent", "step": "c", "agreed": True},
    {"n": 10, "kind": "end", "complete": True},
    {"n": 11, "kind": "clock_step", "seconds": 3.5},
    {"n": 12, "kind": "repaired", "file": "trials/T1.jsonl", "recording": "00"},
    {"n": 13, "kind": "resume", "ppid": "AB12CD", "boot": "b"},
]
MOMENT = {"time": "2026-11-21T10:00:00.000+00:00", "clock": 1.5}
JOURNAL = [{**MOMENT, **record} for record in RECORDS]
NOTE = {"time": MOMENT["time"]}
NOTES: list[dict[str, Any]] = [
    {**NOTE, "kind": "study", "schema": 2, "experiment": "e", "mode": "pilot", "build": {}},
    {**NOTE, "kind": "sealed", "ppid": "AB12CD", "session": 1, "records": 9, "hash": "00"},
    {**NOTE, "kind": "exclude", "reason": "r", "after": {"1": 9}, "session": 1, "trial": 2},
    {**NOTE, "kind": "withdrawn", "ppid": "AB12CD"},
]


def played_journal(path: Path) -> object:
    """Everything that is read out of a journal."""
    records = read_journal(path)
    return SessionState.of(records)


RECORDING: list[dict[str, Any]] = [
    {"kind": "header", "settings": {"profile": "/home/me/p.json"}, "study": {"ppid": "AB12CD"}},
    {"kind": "event", "step": 3, "event": "note"},
    {"kind": "end", "step": 9, "result": {"study": {"ppid": "AB12CD"}, "broken_off": "why"}},
]


def anonymous(path: Path) -> list[bytes]:
    """The lines of a recording without what tells who somebody was."""
    person_masking = PersonMasking("NEW")
    return [shared_line(x, person_masking, str(path)) for x in path.read_bytes().split(b"\n") if x]


def journal_lines(values: list[Any]) -> str:
    """Values as the records of a journal, whose chain is that of somebody who can compute it."""
    before, made = "", []
    for value in values:
        record, line = chained(value, before) if isinstance(value, dict) else (None, b"")
        made.append(line.decode() if record else json.dumps(value) + "\n")
        before = record["hash"] if record else before
    return "".join(made)


def lines(values: list[dict[str, Any]]) -> str:
    """Values as JSON lines."""
    return "".join(json.dumps(value) + "\n" for value in values)


def folder_of(path: Path) -> Path:
    """The folder of a session with a file as its description."""
    path.with_name("about.json").write_bytes(path.read_bytes())
    return path.parent


READERS = {
    "profile": Reader(load_profile, json.dumps(PROFILE), InputError),
    "baseline": Reader(load_baseline, BASELINE.text(), InputError),
    "calibration": Reader(
        read_calibration,
        json.dumps(
            {"schema": 1, "paalm_calibration": {"right": calibration_to_json(HAND)}}, indent=1
        ),
        EncoderError,
    ),
    "frames": Reader(read_frame_file, lines(FRAMES), RecordingError),
    "shown touches": Reader(lambda path: read_touch_log(path, None), lines(FRAMES), InputError),
    "arrivals": Reader(lambda path: arrivals(path, 2), lines(FRAMES), RecordingError),
    "first arrival": Reader(first_line_with_host, lines(FRAMES), RecordingError),
    "packets": Reader(read_capture, lines(PACKETS), RecordingError),
    "any touches": Reader(lambda path: open_file(path, None), lines(FRAMES), InputError),
    "mapping": Reader(read_mapping, json.dumps(MAPPING), InputError),
    "session": Reader(lambda path: read_about(folder_of(path)), json.dumps(ABOUT), RecordingError),
    "journal": Reader(played_journal, journal_lines(JOURNAL), StudyError),
    "study": Reader(read_notes, lines(NOTES), StudyError),
    "anonymous recording": Reader(anonymous, lines(RECORDING), StudyError),
    "any calibration": Reader(is_calibration, "{}", EncoderError),
}


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("outside") / "from-outside.json"


@pytest.mark.parametrize("name", READERS)
def test_a_sound_file_is_read(name: str, file: Path) -> None:
    file.write_text(READERS[name].sound)
    assert READERS[name].read(file) is not None


def read(reader: Reader, file: Path) -> None:
    """Reads a file; another error than the reader's own ends the test."""
    try:
        reader.read(file)
    except reader.error as error:
        text = str(error)
        assert str(file.parent) in text or "record " in text
        assert len(text.splitlines()) == 1
        assert len(text) < 900


@pytest.mark.parametrize("name", READERS)
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused_in_one_line(
    name: str, file: Path, data: st.DataObject
) -> None:
    file.write_bytes(data.draw(damaged(READERS[name].sound.encode())))
    read(READERS[name], file)


@pytest.mark.parametrize("name", READERS)
@given(value=VALUES)
def test_any_json_is_read_or_refused_in_one_line(name: str, file: Path, value: Any) -> None:
    file.write_text(json.dumps(value))
    read(READERS[name], file)


@pytest.mark.parametrize("name", READERS)
@given(data=st.data(), value=VALUES)
def test_any_value_in_the_place_of_another_is_read_or_refused_in_one_line(
    name: str, file: Path, data: st.DataObject, value: Any
) -> None:
    values = [json.loads(line) for line in _values(READERS[name].sound)]
    inner: Any = values
    while True:
        keys = range(len(inner)) if isinstance(inner, list) else list(inner)
        if not keys:
            break
        key = data.draw(st.sampled_from(keys))
        if not isinstance(inner[key], dict | list) or data.draw(st.booleans()):
            inner[key] = value
            break
        inner = inner[key]
    file.write_text((journal_lines if name == "journal" else lines)(values))
    read(READERS[name], file)


def _values(text: str) -> list[str]:
    """The JSON values of a text: one, or one a line."""
    try:
        json.loads(text)
    except ValueError:
        return text.splitlines()
    return [text]
