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

from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import calibration_to_json, is_calibration, read_calibration
from models.errors import EncoderError, InputError
from sandbox.options.profiles import load_profile
from sandbox.regress.baseline import Baseline, Kept, KeptTask, load_baseline
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
TRIALS = {seed: Kept(True, 0.5, 3.25, "ab") for seed in (1, 2, 2**70)}
BASELINE = Baseline({"settings": {"encoder": "best"}}, {"stack": KeptTask(1, "m", TRIALS)})

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
    "any calibration": Reader(is_calibration, "{}", EncoderError),
}


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("outside") / "from-outside.json"


@pytest.mark.parametrize("name", READERS)
def test_a_sound_file_is_read(name: str, file: Path) -> None:
    file.write_text(READERS[name].sound)
    READERS[name].read(file)


def read(reader: Reader, file: Path) -> None:
    """Reads a file; another error than the reader's own ends the test."""
    try:
        reader.read(file)
    except reader.error as error:
        text = str(error)
        assert str(file) in text
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
    lines = [json.loads(line) for line in _values(READERS[name].sound)]
    inner: Any = lines
    while True:
        keys = range(len(inner)) if isinstance(inner, list) else list(inner)
        if not keys:
            break
        key = data.draw(st.sampled_from(keys))
        if not isinstance(inner[key], dict | list) or data.draw(st.booleans()):
            inner[key] = value
            break
        inner = inner[key]
    file.write_text("".join(json.dumps(line) + "\n" for line in lines))
    read(READERS[name], file)


def _values(text: str) -> list[str]:
    """The JSON values of a text: one, or one a line."""
    try:
        json.loads(text)
    except ValueError:
        return text.splitlines()
    return [text]
