"""Recordings that were made before the settings of a run had a tuple of hands."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import pytest

from models.errors import RecordingError
from sandbox.export.sources import open_source
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.recording.recording import load_recording
from sandbox.recording.recording_file import first_line
from sandbox.recording.upgrade import upgraded
from sandbox.trial.hand_input import HandInput
from sandbox.trial.headless import run_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import HandSettings, RunSettings, result_settings

EARLIER = Path(__file__).with_name("earlier")
"""Recordings made at commit df29ff1, without keyframes and track."""

HANDS = {
    "one_hand.jsonl.gz": (HandSettings("left", 0.9, 180),),
    "two_hands.jsonl.gz": (HandSettings("right"), HandSettings("left")),
}


@pytest.mark.parametrize("name", HANDS)
def test_an_earlier_recording_replays_to_the_bit(name: str) -> None:
    recording = load_recording(EARLIER / name)
    assert RunSettings.from_json(recording.header["settings"]).hands == HANDS[name]
    session, found = replay(recording)
    assert recording.end is not None and found.compared > 400
    if found.same_machine:
        assert found.exact and found.complete
        assert session.state_hash == recording.end["result"]["state_hash"]


def test_the_recording_of_the_demo_is_of_one_right_hand_and_replays() -> None:
    recording = load_recording(Path(str(files("sandbox") / "data" / "demo.jsonl")))
    assert RunSettings.from_json(recording.header["settings"]).hands == (HandSettings(),)
    _, found = replay(recording)
    assert found.exact or not found.same_machine


@pytest.mark.parametrize("name", HANDS)
def test_an_earlier_recording_is_a_device_of_all_its_hands(name: str, tmp_path: Path) -> None:
    chosen = plan(SceneOptions(device=str(EARLIER / name)))
    assert chosen.settings.hands == HANDS[name] and len(chosen.makers) == len(HANDS[name])
    recording = load_recording(EARLIER / name)
    result = run_trial(chosen.settings, chosen.makers, record=tmp_path / "again.jsonl")
    assert recording.end is not None
    if result.versions["fingerprint"] == recording.header["versions"]["fingerprint"]:
        assert result.state_hash == recording.end["result"]["state_hash"]
    # The settings of results have kept their form.
    settings = json.loads(json.dumps(result.settings))
    assert settings == recording.end["result"]["settings"]
    again = json.loads(first_line(tmp_path / "again.jsonl"))
    assert again["settings"] == load_recording(EARLIER / name).header["settings"]


def test_an_earlier_recording_is_exported_with_the_names_of_its_hands() -> None:
    assert open_source(EARLIER / "one_hand.jsonl.gz").names == ("left",)
    assert open_source(EARLIER / "two_hands.jsonl.gz", of="commanded").names == ("right", "left")


@pytest.mark.parametrize("one_surface", [True, False])
@pytest.mark.parametrize(
    "hands",
    [
        (HandSettings(),),
        (HandSettings("left", 1.2, 90),),
        (HandSettings(in_air=HandInput()),),
        (HandSettings(), HandSettings("right", 0.9, 180)),
        (HandSettings(in_air=HandInput((0.1, 0.0, -0.1))), HandSettings("left")),
        (HandSettings("left"), HandSettings("right", in_air=HandInput(calibration={"a": 1}))),
    ],
)
def test_settings_in_the_earlier_form_are_upgraded_to_the_settings_they_were(
    hands: tuple[HandSettings, ...], one_surface: bool
) -> None:
    settings = RunSettings(seed=7, hands=hands, one_surface=one_surface and len(hands) == 2)
    header = {"schema": 1, "settings": json.loads(json.dumps(settings.as_json()))}
    assert upgraded(header) is header
    earlier = {**header, "settings": result_settings(header["settings"])}
    assert upgraded(earlier) == header
    assert RunSettings.from_json(upgraded(earlier)["settings"]) == settings


def test_an_unknown_setting_of_an_earlier_second_hand_is_refused() -> None:
    second = {"hand": "left", "hand_size": 1.0, "turn": 0, "shared": False, "colour": "blue"}
    settings = {**result_settings(RunSettings().as_json()), "second": second}
    with pytest.raises(RecordingError, match="colour missing or unknown"):
        RunSettings.from_json(upgraded({"settings": settings})["settings"])
