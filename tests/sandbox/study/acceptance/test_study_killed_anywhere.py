"""Killed, without room, or run twice: nothing that was finished is lost, and no number is given
twice."""

from __future__ import annotations

import os
import signal
import time
from datetime import datetime, timedelta, tzinfo
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from models.errors import InputError, StudyError
from sandbox.cli.main import main
from sandbox.recording.recording import load_recording
from sandbox.study.record import journal
from sandbox.study.record.copies import JOURNAL
from sandbox.study.record.folder import REAL, SIMULATED, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from tests.support.study_driver import WritePoints, in_program, places, results, resume, run, verify
from tests.support.study_files import SHORT, design, in_child, killed_after, rows_of

LATER = 600.0
"""s after which somebody goes on with a session whose program was killed."""
FULL = 3
"""Exit status of a program that said in one error why it ends."""


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("undisturbed"))


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """All places at which a session writes something."""
    out = tmp_path_factory.mktemp("places")
    assert in_program(lambda: watched(out, report=out / "places")) == 0
    return list(places(out / "places"))


def watched(out: Path, fatal: str = "", how: str = "before", report: Path | None = None) -> None:
    WritePoints(fatal, how, report).watch()
    try:
        run(out)
    except InputError:
        os._exit(FULL)


def check(folder: Path, undisturbed: Path) -> None:
    """A study that went on after a kill has the tables of one that nobody killed."""
    resume(folder)
    assert results(folder) == results(undisturbed)
    assert verify(folder) == []


def test_killed_at_random_moments_a_study_goes_on_as_if_nothing_had_been(
    tmp_path: Path, undisturbed: Path
) -> None:
    rng, kills = np.random.default_rng(11), 0
    for _ in range(10):
        child = in_child(lambda say: run(tmp_path))
        killed, _ = killed_after(child, float(rng.uniform(0.0, 0.5)))
        kills += killed
        if not killed:
            break
    assert kills
    check(tmp_path / "quick-simulated", undisturbed)


def test_killed_at_any_place_where_something_is_written_a_study_goes_on_as_if_nothing_had_been(
    tmp_path: Path, undisturbed: Path, found: list[str]
) -> None:
    assert len(found) >= 8
    # Every place once, before or after it in turns.
    for number, place in enumerate(found):
        out, passed = tmp_path / str(number), tmp_path / f"{number}.places"
        fatal = partial(watched, out, place, ("before", "after")[number % 2], passed)
        status = in_program(fatal)
        # A thread syncs the journal now and then, so that some programs never pass that place.
        assert status == (-signal.SIGKILL if place in places(passed) else 0)
        assert status or place.startswith("fsync session_folder.py:_sync")
        check(out / "quick-simulated", undisturbed)


def test_a_disk_that_is_full_from_any_place_on_ends_a_session_with_one_error_and_costs_nothing(
    tmp_path: Path, undisturbed: Path, found: list[str]
) -> None:
    for number, place in enumerate(found[:: max(1, len(found) // 6)]):
        out = tmp_path / str(number)
        # Where tables cannot be written, the session goes on, and says so.
        assert in_program(lambda out=out, place=place: watched(out, place, "full")) in (0, FULL)  # type: ignore[misc]
        check(out / "quick-simulated", undisturbed)


def test_a_full_disk_at_a_step_of_the_clock_leaves_a_state_that_is_that_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Set(datetime):
        @classmethod
        def now(cls, tz: tzinfo | None = None) -> datetime:  # type: ignore[override]
            return datetime.now(tz) + timedelta(hours=1)

    study = StudyFolder(tmp_path, design(SHORT), SIMULATED)
    with SessionFolder(study, study.add()) as session:
        monkeypatch.setattr(journal, "datetime", Set)
        write = os.write

        def once(fd: int, data: bytes) -> int:
            monkeypatch.setattr(os, "write", no_room)
            return write(fd, data)

        def no_room(fd: int, data: bytes) -> int:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(os, "write", once)
        with pytest.raises(StudyError, match="No space left"):
            session.command("note", text="the door was open")
        monkeypatch.undo()
        session.command("note", text="the door was open")
        state = SessionState.of(read_journal(session.path / JOURNAL))
        assert state.clock_steps == session.state.clock_steps and len(state.clock_steps) >= 1
        assert state.seconds.of == session.state.seconds.of


def test_a_trial_whose_end_was_lost_ends_when_its_recording_ends_whenever_somebody_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed() -> None:
        monkeypatch.setattr(
            SessionFolder, "_commit", lambda *args: os.kill(os.getpid(), signal.SIGKILL)
        )
        run(tmp_path)

    assert in_program(killed) == -signal.SIGKILL
    clock = SimpleNamespace(monotonic=lambda: time.monotonic() + LATER)
    monkeypatch.setattr(journal, "time", clock)
    folder = run(tmp_path)
    monkeypatch.undo()
    first, second = rows_of(folder / "tables/trials.csv")
    end = load_recording(folder / first["recording"]).end
    assert end is not None
    length = end["step"] * 0.002
    assert float(first["ended_s"]) - float(first["started_s"]) == pytest.approx(length, abs=0.1)
    assert [row["adopted"] for row in (first, second)] == ["1", "0"]
    assert float(second["started_s"]) > LATER > float(first["ended_s"])
    assert verify(folder) == []


def test_a_session_that_is_open_is_refused_and_newcomers_of_many_programs_have_a_number_each(
    tmp_path: Path,
) -> None:
    study = StudyFolder(tmp_path, design(SHORT), REAL)
    person = study.add()
    with SessionFolder(study, person), pytest.raises(StudyError, match="in use by another"):
        SessionFolder(study, person)

    def add() -> None:
        for _ in range(6):
            StudyFolder(tmp_path, design(SHORT), REAL).add()

    children = [in_child(lambda say: add()) for _ in range(4)]
    for child in children:
        killed_after(child, 60.0)
    numbers = [p.number for p in study.participants()]
    assert sorted(numbers) == list(range(1, 1 + 1 + 4 * 6))


def test_every_attempt_replays_to_the_recorded_states(undisturbed: Path) -> None:
    assert main(["replay", str(undisturbed), "--verify"]) == 0
