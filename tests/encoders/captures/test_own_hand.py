"""A person who plays over a Leap for the first time is measured once, and only if they agree."""

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from encoders.paalm.calibration_file import is_calibration, read_calibration
from models.errors import DeviceError
from sandbox.cli.play import PlayOptions
from sandbox.devices.leap.guided_calibration import measure_and_save
from sandbox.devices.leap.leap_fake import FakeLeapd
from sandbox.devices.leap.leap_write import leap_message
from sandbox.play.own_profile import with_measured_hand
from sandbox.trial.profiles import own_calibration_path
from tests.support.leap_hands import take


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("APPDATA", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    return tmp_path


def measured(seed: int = 0, side: str = "right") -> bool:
    """The measuring of a simulated hand over a Leap service, and whether it was saved."""
    messages = [leap_message(f, n) for n, f in enumerate(take(seed, side=side).frames)]
    server = FakeLeapd(messages, port=0, rate=1000.0, loop=True)
    try:
        return measure_and_save(
            server.address, side, own_calibration_path(), Console(file=StringIO()), 60
        )
    finally:
        server.close()


def test_a_hand_is_measured_kept_and_taken_the_next_time() -> None:
    assert measured() and is_calibration(own_calibration_path())
    said = StringIO()
    options = PlayOptions(device="leap")
    found = with_measured_hand(options, Console(file=said, width=500), ask=False)
    assert found.device_options == {"calibration": own_calibration_path()}
    assert "your right hand" in said.getvalue()
    # Of the other hand nothing is known.
    other = PlayOptions(device="leap", hand="left")
    assert with_measured_hand(other, Console(file=StringIO()), ask=False) == other


def test_the_other_hand_is_measured_beside_the_first() -> None:
    assert measured(1, "right") and measured(1, "left")
    assert set(read_calibration(own_calibration_path())) == {"right", "left"}


def test_a_person_who_declines_is_not_measured() -> None:
    for options in (
        PlayOptions(device="leap", profile="none"),
        PlayOptions(device="leap-simulated"),
        PlayOptions(device="mouse"),
    ):
        assert with_measured_hand(options, Console(file=StringIO()), ask=True) is options
    assert not own_calibration_path().exists()


def test_a_service_that_is_not_there_ends_the_measuring(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sandbox.devices.leap.leap.SILENCE", 0.3)
    with pytest.raises(DeviceError, match="is silent"):
        measure_and_save(
            "ws://127.0.0.1:1/v6.json",
            "right",
            own_calibration_path(),
            Console(file=StringIO()),
            60,
        )
    assert not own_calibration_path().exists()


@pytest.mark.parametrize("content", ["", "{", "[]", '{"kind": "hand-sandbox profile"}', "\x00"])
def test_other_files_are_not_taken_for_calibrations(content: str, tmp_path: Path) -> None:
    path = tmp_path / "file.json"
    path.write_text(content)
    assert not is_calibration(path) and not is_calibration(tmp_path / "missing.json")
