"""Studies with trials for two hands: simulated, with two devices, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.devices.registry import DeviceSettings
from sandbox.recording.recording import load_recording
from sandbox.study.design.conditions import run_settings
from sandbox.study.design.session_plan import TrialStep
from sandbox.study.measures.arrays import NO_CONTACT
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.run.run_device import needs_second_device, person_devices, settings_fitter
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.tables.frame_table import read_frames
from sandbox.trial.settings import HandSettings, Settings, recorded_settings
from tasks.user import UserConfiguration
from tests.support.study_files import PAIRS, first_session, open_study, play_session, quiet, rows_of

TASK = "carry-together"


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    """A study of one simulated participant with one trial, broken off after 4 s."""
    found = open_study(tmp_path_factory.mktemp("pairs"), PAIRS)
    assert run_simulated(found, 1, quiet) is SessionOutcome.COMPLETE
    return found


def test_a_simulated_trial_for_two_hands_has_tables_of_both_and_replays(study: StudyFolder) -> None:
    trial = read_frames(first_session(study) / "trials/T001.jsonl")
    assert trial is not None and len(trial.hands) == 2
    for hand in trial.hands:
        assert (hand.labels[:, 1] != NO_CONTACT).any() and (hand.true[:, 0] != NO_CONTACT).any()
    (row,) = rows_of(study.path / "tables/trials.csv")
    assert row["status"] == "timeout" and float(row["label_accuracy"]) > 0.9
    assert float(row["palm_path_m"]) > 0.05
    assert main(["replay", str(study.path), "--verify"]) == 0
    assert main(["study", "report", str(study.path)]) == 0


def test_a_pilot_is_run_with_a_device_for_each_hand(tmp_path: Path) -> None:
    text = PAIRS.replace("time_limit_s = 4.0", "time_limit_s = 0.5")
    study = open_study(tmp_path, text)
    person = study.add(hand="left", hand_size=1.1, language="en")
    touch, second = (DeviceSettings.of(device) for device in ("mouse", "simulated"))
    devices = person_devices(touch, person, second=second)
    fit = settings_fitter("mouse", second="simulated")
    outcome = play_session(study, person, devices, device=touch, fit=fit, second_device=second)
    assert outcome is SessionOutcome.COMPLETE
    recording = load_recording(next(study.path.glob("*/S001/trials/*.jsonl*")))
    settings = recorded_settings(recording.header)
    assert settings.hands == (HandSettings("left", 1.1), HandSettings("right", 1.1))
    assert settings.device.name == "mouse" and settings.second_device is not None
    assert settings.second_device.name == "simulated"
    assert settings.second_device.user == UserConfiguration()
    assert {entry.step for entry in recording.inputs[1]}


def step(**values: Any) -> tuple[TrialStep, Settings]:
    """A trial of the task for two hands, and its settings."""
    given = {"task": TASK, **values}
    return TrialStep("trial:1", 1, 1, 1, 1, False, {}, given, 3), run_settings(given, 3, "left")


@pytest.mark.parametrize(
    ("values", "needed"),
    [
        ({}, True),
        ({"second_device": "touch"}, True),
        ({"second_device": "simulated"}, False),
        ({"one_surface": True, "surface": "15.5x5.8in"}, False),
        ({"device": "leap"}, False),
        ({"device": "leap", "second_device": "touch"}, True),
        ({"second_device": "leap"}, False),
        ({"task": "box-to-goal"}, False),
    ],
)
def test_a_design_decides_whether_a_second_touch_device_is_needed(
    values: dict[str, Any], needed: bool
) -> None:
    trial, settings = step(**values)
    assert needs_second_device(trial.values, settings) is needed
    devices = person_devices(DeviceSettings.of("mouse"), Participant("TEST", 1, "left", 1.0))
    if needed:
        with pytest.raises(StudyError, match="two hands"):
            devices(trial, settings)
    else:
        assert len(devices(trial, settings)) == len(settings.hands)
