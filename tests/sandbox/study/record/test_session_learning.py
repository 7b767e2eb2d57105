"""What a session of a study learns of its participant's hand: only what its design lets it."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from sandbox.recording.recording import load_recording
from sandbox.study.design.reading import DesignError
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.controls import Controls
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulate import run_simulated, simulated_person
from sandbox.study.share.privacy import Masking, anonymise
from sandbox.trial.replay import replay
from tests.support.study_files import design

DESIGN = """
name = "learning"
seed = 3
[settings]
task = "box-to-goal"
encoder = "linear"
labels = "population"
[[factors]]
name = "contact"
order = "blocked"
levels = ["hard", "soft"]
[trials]
repetitions = 2
time_limit_s = 2.0
learning = "session"
"""


def quiet(text: str) -> None:
    """Nobody listens."""


def with_five_fingers(out: Path, text: str) -> StudyFolder:
    """A study with one participant who touches with five fingers."""
    study = StudyFolder(out, design(text), SIMULATED)
    person = simulated_person(study.design, 0)
    study.add(0, **{**person, "user": {**person["user"], "fingers": 5}})
    return study


def known(study: StudyFolder) -> list[Any]:
    """Layouts at the beginning of every trial of the participant, by their recordings."""
    folder = session_path(study.path, study.participants()[0].ppid)
    recordings = [load_recording(path) for path in sorted((folder / "trials").glob("T*"))]
    return [r.header["settings"]["hands"][0].get("layouts", []) for r in recordings]


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    study = with_five_fingers(tmp_path_factory.mktemp("learned"), DESIGN)
    assert run_simulated(study, 0, quiet) is SessionOutcome.COMPLETE
    return study


def test_every_trial_begins_without_layouts_unless_the_design_says_otherwise(tmp_path):
    study = with_five_fingers(tmp_path, DESIGN.replace('learning = "session"\n', ""))
    assert run_simulated(study, 0, quiet) is SessionOutcome.COMPLETE
    assert known(study) == [[], [], [], []]
    assert study.design.learning == "trial"


def test_a_session_that_learns_begins_each_trial_with_what_the_trials_before_it_found(learned):
    layouts = known(learned)
    assert layouts[0] == [] and layouts[1]
    for before, after in pairwise(layouts):
        assert len(after) >= len(before)
    folder = session_path(learned.path, learned.participants()[0].ppid)
    _, verification = replay(load_recording(folder / "trials" / "T003.jsonl"))
    assert verification.exact and verification.complete


def test_a_session_that_was_stopped_goes_on_with_what_it_had_learned(tmp_path, learned):
    study = with_five_fingers(tmp_path, DESIGN)
    controls = Controls(quiet)
    left = [2]

    def say(text: str) -> None:
        left[0] -= "  trial " in text
        if left[0] == 0:
            controls.type("q later")

    assert run_simulated(study, 0, say, controls) is SessionOutcome.STOPPED
    assert run_simulated(study, 0, quiet) is SessionOutcome.COMPLETE
    assert known(study)[-1] == known(learned)[-1]


def test_an_anonymous_copy_tells_no_layouts_unless_hands_are_kept(tmp_path, learned):
    folder = session_path(learned.path, learned.participants()[0].ppid)
    state = SessionState.of(read_journal(folder / "journal.jsonl"))
    assert state.learned and "learned" in (folder / "journal.jsonl").read_text()
    assert anonymise(learned, tmp_path / "copy", Masking(), quiet).hands == 4
    assert not list((tmp_path / "copy").rglob("T0*.jsonl*"))
    anonymise(learned, tmp_path / "hands", Masking(hands=True), quiet)
    assert len(list((tmp_path / "hands").rglob("T0*.jsonl*"))) == 4
    for path in tmp_path.rglob("journal.jsonl"):
        assert "learned" not in json.dumps(read_journal(path))


def test_a_design_that_learns_with_names_that_never_learn_has_a_mistake():
    with pytest.raises(DesignError, match="labels"):
        design(DESIGN.replace('labels = "population"\n', ""))
    with pytest.raises(DesignError, match="learning"):
        design(DESIGN.replace('"session"', '"for ever"'))
