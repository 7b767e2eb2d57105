"""What a session of a study learns of its participant's hand: only what its design lets it."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.frames import Contact
from models.person import Person, PersonFrame
from models.surface import Surface
from sandbox.recording.recording import load_recording
from sandbox.study.design.session_plan import TrialStep
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.run.controls import Controls
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulated_study import simulated_person
from sandbox.study.share.shared_folder import Masking, share_study
from sandbox.trial.assembly import DeviceMakers
from sandbox.trial.replay import replay
from sandbox.trial.settings import Settings
from tests.support.scripted import Script
from tests.support.study_files import design, first_session, play_session, quiet, state_of

FIVE = 1e-3 * np.array([[40, 110], [75, 68], [100, 55], [123, 62], [144, 84]])
"""Touches of a right hand of size 1, m on the surface, thumb first."""


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
time_limit_s = 1.0
learning = "session"
"""


def touching(trial: TrialStep, settings: Settings) -> DeviceMakers:
    """Five fingers that touch and stay, a little farther apart in each trial."""
    hand = settings.hands[0].person

    def maker(task: object, surface: Surface) -> Script:
        spread = (FIVE - FIVE[0]) * (0.92 + 0.08 * trial.number)
        xy = PersonFrame(Person(hand.hand), surface).outwards(FIVE[0] + spread * hand.hand_size)
        contacts = [Contact(f, *place) for f, place in enumerate(xy.tolist())]
        return Script(lambda now: contacts)

    return (maker,)


def play(study: StudyFolder, controls: Controls | None = None, say: Any = quiet) -> SessionOutcome:
    """Plays the session of one participant, or what remains of it."""
    person = study.add(1, **simulated_person(study.design, 1))
    return play_session(study, person, touching, controls=controls or Controls(say), say=say)


def known(study: StudyFolder) -> list[Any]:
    """Layouts at the beginning of every trial of the participant, by their recordings."""
    trials = first_session(study) / "trials"
    recordings = [load_recording(path) for path in sorted(trials.glob("T*.jsonl*"))]
    return [r.header["settings"]["hands"][0].get("layouts", []) for r in recordings]


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    study = StudyFolder(tmp_path_factory.mktemp("learned"), design(DESIGN), SIMULATED)
    assert play(study) is SessionOutcome.COMPLETE
    return study


def test_every_trial_begins_without_layouts_unless_the_design_says_otherwise(
    tmp_path: Path,
) -> None:
    text = DESIGN.replace('learning = "session"\n', "")
    study = StudyFolder(tmp_path, design(text), SIMULATED)
    assert play(study) is SessionOutcome.COMPLETE
    assert known(study) == [[], [], [], []]
    assert study.design.learning == "trial"


def test_a_session_that_learns_begins_each_trial_with_what_the_trials_before_it_found(
    learned: StudyFolder,
) -> None:
    layouts = known(learned)
    assert [len(known) for known in layouts] == [0, 1, 2, 3]
    for before, after in pairwise(layouts):
        assert after[: len(before)] == before
    _, verification = replay(load_recording(first_session(learned) / "trials/T003.jsonl"))
    assert verification.exact and verification.complete


def test_a_session_that_was_stopped_goes_on_with_what_it_had_learned(
    tmp_path: Path, learned: StudyFolder
) -> None:
    study = StudyFolder(tmp_path, design(DESIGN), SIMULATED)
    controls = Controls(quiet)
    left = [2]

    def say(text: str) -> None:
        left[0] -= "  trial " in text
        if left[0] == 0:
            controls.type("q later")

    assert play(study, controls, say) is SessionOutcome.STOPPED
    assert play(study) is SessionOutcome.COMPLETE
    assert known(study)[-1] == known(learned)[-1]


def test_an_anonymous_copy_tells_no_layouts_unless_hands_are_kept(
    tmp_path: Path, learned: StudyFolder
) -> None:
    assert state_of(first_session(learned)).learned
    assert share_study(learned, tmp_path / "copy", Masking(), quiet).hands == 4
    assert not list((tmp_path / "copy").rglob("T0*.jsonl*"))
    share_study(learned, tmp_path / "hands", Masking(hands=True), quiet)
    assert len(list((tmp_path / "hands").rglob("T0*.jsonl*"))) == 4
    for path in tmp_path.rglob("session.jsonl"):
        assert "learned" not in json.dumps(read_journal(path))


def test_layouts_of_an_earlier_design_are_not_told_either(tmp_path: Path) -> None:
    study = StudyFolder(tmp_path, design(DESIGN), SIMULATED)
    assert play(study) is SessionOutcome.COMPLETE
    changed = design(DESIGN.replace('learning = "session"\n', ""))
    study = StudyFolder(tmp_path, changed, SIMULATED, "no learning any more")
    assert study.design.learning == "trial"
    assert share_study(study, tmp_path / "copy", Masking(), quiet).hands == 4
    assert not list((tmp_path / "copy").rglob("T0*.jsonl*"))
