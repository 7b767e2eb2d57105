"""Tasks are drawn beside the session, each once; what cannot be drawn has no picture."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.study.run import task_pictures
from sandbox.study.run.task_pictures import TaskPictures
from sandbox.trial.settings import Settings, encoded
from tests.support.needs import require
from tests.support.processes import PATIENCE


def test_each_task_has_a_picture_and_others_have_none(monkeypatch: pytest.MonkeyPatch) -> None:
    require("opengl")
    # A busy machine draws slowly.
    monkeypatch.setattr(task_pictures, "LONGEST", PATIENCE)
    trials = [Settings(task="box-to-goal", seed=seed) for seed in (3, 4)]
    with TaskPictures(trials) as pictures:
        (picture,) = {pictures.of("box-to-goal", lambda: None) for _ in range(2)}
        assert picture.startswith("data:image/jpeg;base64,") and len(picture) < 200_000
        assert pictures.of("stack", lambda: None) == ""


def test_the_experimenter_can_skip_a_step_while_a_picture_is_drawn() -> None:
    def poll() -> None:
        raise InterruptedError

    with TaskPictures([Settings()]) as pictures, pytest.raises(InterruptedError):
        pictures.of("box-to-goal", poll)


def test_a_task_that_cannot_be_drawn_costs_no_picture_of_the_next_one(tmp_path: Path) -> None:
    gone = replace(Settings(), task=str(tmp_path / "gone.py:Gone"))
    given = json.dumps([encoded(gone), encoded(gone)])
    command = [sys.executable, "-m", "sandbox.study.run.task_pictures"]
    done = subprocess.run(command, input=given, capture_output=True, text=True, check=True)
    assert done.stdout == "\n\n"
