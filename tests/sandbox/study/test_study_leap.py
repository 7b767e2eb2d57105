"""Studies over a Leap: hands are measured before the first trial, and are not in shared copies."""

from __future__ import annotations

import gzip
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from models.errors import DeviceError
from sandbox.devices.leap.leap_fake import FakeLeapd
from sandbox.devices.leap.leap_write import leap_message
from sandbox.devices.registry import DeviceSettings
from sandbox.recording.recording import load_recording
from sandbox.study.design.session_plan import CalibrationStep, TrialStep, session_plan
from sandbox.study.record.folder import PILOT, Participant, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.run.forms import SimulatedForms
from sandbox.study.run.run_device import hand_measurer, person_devices, settings_fitter
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.share.shared_folder import Masking, share_study
from sandbox.trial.replay import replay
from tests.support.leap_hands import take
from tests.support.study_files import DESIGN, SHORT, design, first_session, play_session, quiet

OVER_A_LEAP = SHORT.replace("[settings]\n", '[settings]\ndevice = "leap"\n')
WANTED = 60


@cache
def open_hand() -> list[dict[str, Any]]:
    return [leap_message(f, n) for n, f in enumerate(take(0, drop_outs=False).frames[:120])]


def steps(text: str, number: int) -> list[type]:
    return [type(step) for step in session_plan(design(text), number)]


def test_whoever_has_trials_over_a_leap_is_measured_before_them_and_nobody_else() -> None:
    some = SHORT.replace(
        'name = "contact"\norder = "latin"\nlevels = ["hard", "soft"]',
        'name = "device"\norder = "between"\nlevels = ["touch", "leap"]',
    ).replace('"contact"', '"device"')
    over = steps(some, 2)
    assert over.index(CalibrationStep) < over.index(TrialStep) and over.count(CalibrationStep) == 1
    assert CalibrationStep not in steps(some, 1)
    assert CalibrationStep not in steps(DESIGN, 1)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    """Somebody's session whose trials are over a Leap that shows an open hand."""
    found = StudyFolder(tmp_path_factory.mktemp("leap"), design(OVER_A_LEAP), PILOT)
    person = found.add(hand="right", hand_size=1.0, language="en")
    server = FakeLeapd(open_hand(), port=0, rate=1000.0, loop=True)
    forms = SimulatedForms(1)
    try:
        outcome = play_session(
            found,
            person,
            person_devices(DeviceSettings.of("mouse"), person, leap=server.address),
            device=DeviceSettings.of("leap"),
            fit=settings_fitter("mouse"),
            calibrate=hand_measurer(forms, person, server.address, quiet, WANTED),
        )
        assert outcome is SessionOutcome.COMPLETE
    finally:
        server.close()
    return found


def measured(study: StudyFolder) -> tuple[Path, dict[str, Any]]:
    session = first_session(study)
    records = read_journal(session / "session.jsonl")
    (found,) = (r["calibration"] for r in records if "calibration" in r)
    return session, found


def test_every_trial_is_played_with_the_hand_that_was_measured_and_replays(
    study: StudyFolder,
) -> None:
    session, hand = measured(study)
    recordings = sorted((session / "trials").glob("*.jsonl*"))
    assert len(recordings) == 2 and hand["frames"] > WANTED / 2
    for path in recordings:
        recording = load_recording(path)
        assert recording.header["settings"]["hands"][0]["in_air"]["calibration"] == hand
        _, found = replay(recording)
        assert found.exact and found.complete


@pytest.mark.parametrize("kept", [False, True])
def test_lengths_of_fingers_are_in_an_anonymous_copy_only_if_somebody_wants_them(
    study: StudyFolder, tmp_path: Path, kept: bool
) -> None:
    _, hand = measured(study)
    done = share_study(study, tmp_path / "copy", Masking(hands=kept), quiet)
    assert done.hands == (0 if kept else 2)
    copy = StudyFolder.at(tmp_path / "copy")
    trials = first_session(copy) / "trials"
    assert len(list(trials.glob("*.jsonl*"))) == (2 if kept else 0)
    assert len(list(trials.glob("*.frames.csv.gz"))) == 2
    length = str(hand["standard"][0]).encode()
    files = [p.read_bytes() for p in copy.path.rglob("*") if p.is_file()]
    inside = [gzip.decompress(d) if d[:2] == b"\x1f\x8b" else d for d in files]
    assert any(length in data for data in inside) is kept


def test_a_sensor_that_falls_silent_ends_the_session_with_one_clear_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("sandbox.devices.leap.leap.SILENCE", 0.5)
    server = FakeLeapd(open_hand()[:30], port=0, rate=1000.0)
    person = Participant("3B5G5T", 0)
    measure = hand_measurer(SimulatedForms(1), person, server.address, quiet, 1000, again="run it")
    try:
        with pytest.raises(
            DeviceError, match=r"is silent.*`run it` resumes the session at this step"
        ):
            measure(lambda: None)
    finally:
        server.close()
