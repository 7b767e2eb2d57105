"""Killed anywhere, out of disk, or run twice at once: no finished trial of a study is ever lost."""

from __future__ import annotations

import csv
import ctypes
import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from models.errors import InputError, StudyError
from sandbox.study.design.session_plan import trials_of
from sandbox.study.record.folder import REAL, StudyFolder
from sandbox.study.record.journal import SYNC, Journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.simulated_study import run_simulated, simulate
from sandbox.study.tables.tables import make_tables
from tests.support.study_files import (
    DESIGN,
    TRIALS,
    check_session,
    in_child,
    killed_after,
    open_study,
    told_finished,
    trial_result,
)

Say = Callable[[str], object]

WHOLE = 120.0
"""s after which a child that nobody kills is given up."""


def without_capabilities() -> None:
    """The superuser may write everywhere; without capabilities, only where its user may.

    Another user might not reach the checkout at all, as below a private temporary folder.
    """
    version_3 = (ctypes.c_uint32 * 2)(0x20080522, 0)
    none = (ctypes.c_uint32 * 6)()
    if ctypes.CDLL(None, use_errno=True).capset(version_3, none) != 0:
        raise OSError(ctypes.get_errno(), "capset")


def kill_often(out: Path, kills: int, seed: int) -> int:
    """Kills simulated studies at random moments and resumes them; how often it took effect."""
    rng = np.random.default_rng(seed)
    done = round_ = 0
    while done < kills:
        study = open_study(out / f"round{round_}")
        round_ += 1
        killed, finished = True, 0
        while killed:
            # Mostly within a trial or two; every so often at once, before anything is open.
            wait = float(rng.choice([rng.uniform(0.0, 0.02), rng.uniform(0.0, 0.5)]))
            wait = wait if done < kills else WHOLE
            child = in_child(lambda say, study=study: simulate(study, 1, True, say))  # type: ignore[misc]
            killed, said = killed_after(child, wait)
            done += killed
            before = finished
            finished = check_session(study, 1, max(before, told_finished(said)))
        assert finished == TRIALS
        rows = list(csv.DictReader((study.path / "tables/trials.csv").open()))
        assert [int(r["trial"]) for r in rows if r["counted"] == "1"] == [1, 2, 3, 4, 5, 6]
        person = study.participants()
        assert len(person) == 1
        trackers = session_path(study.path, person[0].ppid) / "trials"
        for row in rows:
            assert (study.path / row["frames"]).exists()
        assert not [p for p in trackers.iterdir() if p.name.startswith(".tmp")]
    return done


def test_a_study_killed_at_random_moments_loses_nothing_and_counts_nothing_twice(
    tmp_path: Path,
) -> None:
    assert kill_often(tmp_path, 20, seed=1) >= 20


@pytest.mark.full
def test_a_study_killed_two_hundred_times_loses_nothing(tmp_path: Path) -> None:
    assert kill_often(tmp_path, 200, seed=2) >= 200


def test_a_kill_while_tables_are_rebuilt_leaves_them_whole(tmp_path: Path) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 1, lambda text: None)
    person = study.participants()[0]
    folder = study.path / "tables"
    names = ("trials.csv", "answers.csv", "events.csv", "codebook.csv")
    before = {n: (folder / n).read_bytes() for n in names}

    def work(say: Say) -> None:
        with SessionFolder(study, person) as session:
            while True:
                session.command("exclude", trial=2, reason=f"no. {len(session.journal.records)}")
                make_tables(study)

    rng = np.random.default_rng(4)
    for _ in range(6):
        killed, _ = killed_after(in_child(work), float(rng.uniform(0.02, 0.2)))
        assert killed
        for name in names:
            text = (folder / name).read_bytes()
            head = before[name].split(b",")[0]
            assert text.startswith(head) and text.endswith(b"\n")
            assert text.count(b"\n") >= before[name].count(b"\n")
    with SessionFolder(study, person) as session:
        make_tables(study)
        assert not list(folder.rglob(".tmp*"))
        assert session.state.excluded[2].startswith("no. ")
    rows = list(csv.DictReader((folder / "trials.csv").open()))
    assert [r["excluded"] for r in rows] == ["0", "1", "0", "0", "0", "0"]


@pytest.mark.slow
def test_two_programs_that_are_killed_while_they_fill_one_study_do_not_disturb_each_other(
    tmp_path: Path,
) -> None:
    study = open_study(tmp_path)
    rng = np.random.default_rng(5)
    finished, alive = [0, 0], [True, True]
    rounds = 0
    while any(alive):
        rounds += 1
        children = [in_child(lambda say, n=n: run_simulated(study, n + 1, say)) for n in (0, 1)]  # type: ignore[misc]
        for n, child in enumerate(children):
            wait = float(rng.uniform(0.1, 0.6)) if rounds <= 4 else WHOLE
            alive[n], said = killed_after(child, wait)
            finished[n] = check_session(study, n + 1, max(finished[n], told_finished(said)))
    assert finished == [TRIALS, TRIALS]
    make_tables(study)
    rows = list(csv.DictReader((study.path / "tables/trials.csv").open()))
    counted = [(r["number"], r["trial"]) for r in rows if r["counted"] == "1"]
    assert len(counted) == len(set(counted)) == 2 * TRIALS
    assert sorted(p.number for p in study.participants()) == [1, 2]


def test_a_full_disk_ends_a_session_with_one_clear_error_and_costs_no_finished_trial(
    tmp_path: Path,
) -> None:
    study = open_study(tmp_path)
    finished = 0

    def work(limit: int, say: Say) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        try:
            run_simulated(study, 1, say)
            say("no error")
        except InputError as error:
            say(f"refused: {error}")

    for limit in (300, 1500, 4000, 9000, 14_000, 30_000):
        child = in_child(lambda say, limit=limit: work(limit, say))  # type: ignore[misc]
        killed, said = killed_after(child, WHOLE)
        assert not killed
        assert limit > 14_000 or ("refused" in said and "File too large" in said), said
        finished = check_session(study, 1, max(finished, told_finished(said)))
    run_simulated(study, 1, lambda text: None)
    assert check_session(study, 1, finished) == TRIALS


def test_a_journal_on_a_full_device_says_so(tmp_path: Path) -> None:
    (tmp_path / "session.jsonl").symlink_to("/dev/full")
    journal = Journal(tmp_path / "session.jsonl")
    with pytest.raises(StudyError, match="No space left"):
        journal.append("command", command="note", text="lost")
    assert journal.records == []
    journal.close()


def test_a_session_whose_recording_never_reaches_the_disk_finishes_no_trial(
    tmp_path: Path,
) -> None:
    study = open_study(tmp_path)
    with SessionFolder(study, study.add()) as session:
        trial = trials_of(session.steps)[0]
        recording = session.begin(trial)
        recording.symlink_to("/dev/full")
        time.sleep(2.5 * SYNC)
        recording.unlink()
        recording.write_text("as if nothing had been")
        with pytest.raises(StudyError, match="could not be written to the disk"):
            session.finish(trial, trial_result())
        assert trial.id not in session.state.finished
        assert session.journal.records[-1]["kind"] == "trial"


def test_a_folder_that_cannot_be_written_is_refused_before_anything_runs() -> None:
    with tempfile.TemporaryDirectory() as name:
        out = Path(name) / "locked"
        out.mkdir()
        for folder, mode in ((Path(name), 0o755), (out, 0o555)):
            folder.chmod(mode)

        def work(say: Say) -> None:
            without_capabilities()
            try:
                open_study(out, mode=REAL)
            except StudyError as error:
                say(f"refused: {error}")

        _, said = killed_after(in_child(work), WHOLE)
        assert "refused" in said and "Permission denied" in said
        assert not list(out.iterdir())


def test_a_session_folder_of_another_study_is_refused(tmp_path: Path) -> None:
    study = open_study(tmp_path / "a")
    other = open_study(tmp_path / "b", DESIGN.replace('name = "quick"', 'name = "slow"'))
    person = study.add()
    SessionFolder(study, person).close()
    there = session_path(other.path, person.ppid)
    there.parent.mkdir()
    session_path(study.path, person.ppid).rename(there)
    with pytest.raises(StudyError, match="another study"):
        SessionFolder(other, person)
    assert isinstance(other, StudyFolder)
