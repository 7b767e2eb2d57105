"""What a journal has lost is offered: nothing is taken in silently, and nothing is played again."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.recording.recording import read_stored
from sandbox.study.audit.audit import audit
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.leftovers import whole_leftovers
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.controls import Controls
from sandbox.study.run.simulate import run_simulated, simulate
from tests.support.study_files import DESIGN, TRIALS, design, rows_of

LOST = 4096


DIVERGING = DESIGN.replace(
    "tests/support/regress_tasks.py:Quick", "tests/sandbox/session/absurd_task.py:Absurd"
).replace(
    'repetitions = 2\npractice = 1\npractice_each = "contact"', "repetitions = 1\npractice = 0"
)


def quiet(text: str) -> None:
    """Nobody listens."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("made")
    simulate(StudyFolder(out, design(), SIMULATED), 1, False, quiet)
    return out


@pytest.fixture
def study(made: Path, tmp_path: Path) -> StudyFolder:
    """A finished study, of whose only session the journal has lost 4 KiB."""
    shutil.copytree(made, tmp_path / "out")
    found = StudyFolder(tmp_path / "out", design(), SIMULATED)
    journal = session(found) / "journal.jsonl"
    journal.write_bytes(journal.read_bytes()[:-LOST])
    return found


def session(study: StudyFolder) -> Path:
    return session_path(study.path, study.participants()[0].ppid)


def finished(study: StudyFolder) -> int:
    state = SessionState.of(read_journal(session(study) / "journal.jsonl"))
    return sum(state.counted(trial) is not None for trial in state.attempts)


def leftovers(study: StudyFolder) -> int:
    """Number of whole recordings without a record; a trial may also have lost its end only."""
    path = session(study)
    return len(whole_leftovers(path, SessionState.of(read_journal(path / "journal.jsonl"))))


def files(study: StudyFolder) -> dict[Path, bytes]:
    return {p: p.read_bytes() for p in study.path.rglob("*") if p.is_file() and p.name != ".lock"}


def test_a_session_whose_journal_has_lost_records_is_not_continued_and_stays_as_it_is(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files(study)
    assert 0 < finished(study) < TRIALS
    with pytest.raises(StudyError, match=r"whole recordings without a record: T00.*recover"):
        run_simulated(study, 0, quiet)
    assert main(["study", "recover", str(study.path)]) == 1
    said = capsys.readouterr().out
    assert "records are lost" in said and f"T00{TRIALS}.jsonl: trial {TRIALS}" in said
    assert main(["study", "recover", str(study.path), "--take-in"]) == 2
    assert main(["study", "recover", str(study.path), "--take-in", "--set-aside"]) == 2
    assert main(["replay", str(study.path), "--verify"]) == 1
    said = capsys.readouterr().out
    assert "S001/journal.jsonl, line" in said and "missing" in said and "orphaned" in said
    assert files(study) == before


def test_recordings_that_are_taken_in_count_and_verification_says_so(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    left = leftovers(study)
    assert left > 0
    before = rows_of(study.path / "trial_results.csv")
    reason = ["--reason", "the disk lost 4 KiB"]
    assert main(["study", "recover", str(study.path), "--take-in", *reason]) == 0
    assert finished(study) == TRIALS
    assert main(["study", "recover", str(study.path)]) == 0
    rows = rows_of(study.path / "trial_results.csv")
    unknown = [row["trial_num"] for row in rows if not row["start_time"]]
    assert len(unknown) == left
    apart = ("start_time", "end_time")
    assert [{k: v for k, v in row.items() if k not in apart} for row in rows] == [
        {k: v for k, v in row.items() if k not in apart} for row in before
    ]
    capsys.readouterr()
    assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out
    said = capsys.readouterr().out
    assert f"{left} trials that were taken in by hand" in said
    assert "records whose loss was accepted" in said
    # What else was lost is asked for again.
    run_simulated(study, 0, quiet)
    assert finished(study) == TRIALS and audit(study.path).findings.sound


def test_recordings_that_are_set_aside_stay_and_their_trials_are_run_again(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    left = leftovers(study)
    assert left > 0
    aside = read_stored(session(study) / f"trials/T00{TRIALS}.jsonl")
    reason = ["--reason", "not sure"]
    assert main(["study", "recover", str(study.path), "--set-aside", *reason]) == 0
    assert finished(study) == TRIALS - left
    run_simulated(study, 0, quiet)
    assert finished(study) == TRIALS
    assert read_stored(session(study) / f"trials/T00{TRIALS}.jsonl") == aside
    assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out
    said = capsys.readouterr().out
    assert f"{left} recordings that were set aside by hand" in said


def test_a_journal_that_lost_less_than_a_trial_is_told_from_its_log(study: StudyFolder) -> None:
    path = session(study)
    for recording in (path / "trials").glob("*"):
        number = int(recording.name[1:4])
        state = SessionState.of(read_journal(path / "journal.jsonl"))
        if state.counted(number) is None:
            recording.unlink()
    with pytest.raises(StudyError, match=r"records fewer than session_info/log.csv has"):
        SessionFolder(study, study.participants()[0])


def test_a_recording_of_somebody_else_cannot_be_taken_in(
    study: StudyFolder, made: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trials = session(study) / "trials"
    data = read_stored(trials / "T001.jsonl").data
    (trials / "T009.jsonl").write_bytes(data.replace(b'"session":1', b'"session":2'))
    assert main(["study", "recover", str(study.path), "--take-in", "--reason", "r"]) == 0
    said = capsys.readouterr().out
    assert "T009.jsonl: cannot count: it is of another participant or session" in said
    assert "T009.jsonl: set aside" in said and audit(study.path).findings.sound


@pytest.mark.parametrize("answer", ["q", "r the box was lost"])
def test_the_last_states_of_a_trial_that_diverged_are_no_attempt_that_somebody_lost(
    answer: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = StudyFolder(tmp_path, design(DIVERGING), SIMULATED)
    controls, answers = Controls(quiet), iter([answer, "q"])

    def say(text: str) -> None:
        if "diverged" in text or "repeated" in text:
            controls.type(next(answers, "q"))

    assert run_simulated(study, 0, say, controls) == "stopped"
    trials = session(study) / "trials"
    assert {path.name[:13] for path in trials.iterdir()} > {"T001-diverged"}
    assert main(["study", "recover", str(study.path)]) == 0
    run_simulated(study, 0, quiet)
    rows = rows_of(study.path / "trial_results.csv")
    assert {row["status"] for row in rows} == {"diverged"}
    capsys.readouterr()
    assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out


def test_a_report_and_a_copy_of_a_study_that_lost_records_say_so_and_leave_its_tables(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (study.path / "trial_results.csv").read_bytes()
    out = study.path.parent
    assert main(["study", "report", str(study.path), "--out", str(out / "report")]) == 0
    said = capsys.readouterr().out
    assert "the journal has lost" in said and f"sandbox study recover {study.path}" in said
    assert "until that is decided, the tables are left as they are" in said
    assert (study.path / "trial_results.csv").read_bytes() == before
    page = (out / "report" / "report.html").read_text(encoding="utf-8")
    lost = f"Records of {study.participants()[0].ppid} are lost"
    assert lost in page[: page.index("</header>")]
    shared = ["--anonymise", "--out", str(out / "shared")]
    assert main(["study", "export", str(study.path), *shared]) == 0
    assert "what was lost is not in the copy" in capsys.readouterr().out
