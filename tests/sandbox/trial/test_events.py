"""Events for other programs: no session ends because nobody listens, but that is told."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from models.errors import InputError
from sandbox.cli.main import main
from sandbox.trial.events import EventLog

FULL = Path("/dev/full")
"""A device on which there is never any room."""


def test_events_are_lines_that_are_added_to_a_file(tmp_path: Path) -> None:
    path = tmp_path / "events.jsonl"
    for number in (1, 2):
        log = EventLog(path)
        log.tell("trial_start", seed=number)
        assert json.loads(path.read_text().splitlines()[-1]) == {
            "event": "trial_start",
            "seed": number,
        }
        log.close()
        log.close()
    assert len(path.read_text().splitlines()) == 2


def test_a_reader_who_leaves_a_pipe_is_told_of_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    log = EventLog(path)
    log.tell("listening", address="here")
    assert json.loads(os.read(reader, 1000)) == {"event": "listening", "address": "here"}
    os.close(reader)
    log.tell("warning", what="nobody hears this")
    log.tell("warning", what="nor this")
    with pytest.raises(InputError, match=r"events were lost.*Broken pipe"):
        log.close()
    log.close()


def test_a_trial_is_played_to_its_end_though_its_events_find_no_room(
    capsys: pytest.CaptureFixture[str],
) -> None:
    if not FULL.exists():
        pytest.skip(f"device node absent: {FULL}")
    assert main(["run", "box-to-goal", "--seed", "3", "--events", str(FULL)]) == 2
    told = capsys.readouterr()
    assert "box-to-goal: done" in told.out
    assert "events were lost" in told.err and "No space left" in told.err
    assert told.err.count("\n") == 1
