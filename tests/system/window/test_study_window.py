"""A study's trials in a window at real time are written down like any others."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import glfw
import pytest

from sandbox.recording.recording import load_recording
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.controls import Controls
from sandbox.study.run.forms import SimulatedForms
from sandbox.study.run.players import HeadlessPlayer, TrialPlayer, WindowPlayer
from sandbox.study.run.runner import SessionOutcome, SessionRunner
from sandbox.study.run.simulated_study import simulated_devices, simulated_person
from sandbox.trial.replay import replay
from tests.support.screen import screen
from tests.support.study_files import DESIGN, open_study

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="needs an X server in memory"
)

SHORT = DESIGN.replace("repetitions = 2\npractice = 1", "repetitions = 1\npractice = 0")


def hashes(out: Path, player: TrialPlayer) -> list[str]:
    """State hashes of a participant's trials, which have all been finished."""
    study = open_study(out, SHORT)
    person = study.add(**simulated_person(study.design, 1))
    with SessionFolder(study, person) as session:
        runner = SessionRunner(
            session,
            player,
            simulated_devices(person),
            SimulatedForms(1),
            Controls(),
            lambda text: None,
        )
        assert runner.run() is SessionOutcome.COMPLETE
    player.close()
    folder = session_path(study.path, person.ppid)
    for path in sorted((folder / "trials").glob("*.jsonl.gz")):
        _, found = replay(load_recording(path))
        assert found.exact and found.complete
    rows = list(csv.DictReader((study.path / "tables/trials.csv").open()))
    return [row["state_hash"] for row in rows]


def test_the_same_participant_does_the_same_in_a_window_and_without_one(tmp_path: Path) -> None:
    with screen():
        seen = hashes(tmp_path / "window", WindowPlayer("simulated user"))
        glfw.terminate()
    assert len(seen) == 2
    assert seen == hashes(tmp_path / "headless", HeadlessPlayer())
