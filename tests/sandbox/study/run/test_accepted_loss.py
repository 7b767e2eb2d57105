"""What a session has lost is reported: nothing is taken in silently, or played again."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.recording.recording import read_stored
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.trial_files import whole_leftovers
from sandbox.study.run.controls import Controls
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.share.verify import verify
from tests.support.study_driver import everything, note
from tests.support.study_files import SHORT, TRIALS, design, first_session, quiet, rows_of, state_of

LOST = 4096


DIVERGING = SHORT.replace(
    "tests/support/regress_tasks.py:Quick", "tests/sandbox/session/absurd_task.py:Absurd"
)


@pytest.fixture
def study(two_people: Path, tmp_path: Path) -> StudyFolder:
    """A finished study, of which the journal of the first session has lost 4 KiB."""
    shutil.copytree(two_people, tmp_path / "out" / two_people.name)
    found = StudyFolder(tmp_path / "out", design(), SIMULATED)
    journal = first_session(found) / "session.jsonl"
    journal.write_bytes(journal.read_bytes()[:-LOST])
    return found


def finished(study: StudyFolder) -> int:
    state = state_of(first_session(study))
    return sum(state.counted(trial) is not None for trial in state.attempts)


def leftovers(study: StudyFolder) -> int:
    """Number of whole recordings without a record; a trial may also have lost its end only."""
    path = first_session(study)
    return len(whole_leftovers(path, state_of(path)))


def accept(study: StudyFolder, reason: str) -> int:
    """Accepts the loss; the exit status."""
    return note(study.path, study.participants()[0].ppid, "--accept-loss", reason)


def test_a_session_whose_journal_has_lost_records_is_not_continued_and_stays_as_it_is(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    before = everything(study.path)
    assert 0 < finished(study) < TRIALS
    with pytest.raises(StudyError, match=r"whole recordings without a record: T00.*--accept-loss"):
        run_simulated(study, 1, quiet)
    assert main(["study", "tables", str(study.path)]) == 1
    said = capsys.readouterr().out
    assert "records are missing or changed" in said and f"T00{TRIALS}.jsonl: trial {TRIALS}" in said
    ppid = study.participants()[0].ppid
    assert note(study.path, ppid, "--exclude", "r") == 1
    assert main(["replay", str(study.path), "--verify"]) == 1
    said = capsys.readouterr().out
    assert "S001/session.jsonl: missing" in said and "a whole recording without a record" in said
    assert everything(study.path) == before


def test_recordings_that_are_taken_in_count_and_verification_says_so(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    left = leftovers(study)
    assert left > 0
    before = rows_of(study.path / "tables/trials.csv")
    assert accept(study, "the disk lost 4 KiB") == 0
    assert finished(study) == TRIALS
    assert main(["study", "tables", str(study.path)]) == 0
    rows = rows_of(study.path / "tables/trials.csv")
    unknown = [row["trial"] for row in rows if not row["started_s"]]
    assert len(unknown) == left
    # One more may have lost nothing but the record of its end.
    assert {row["trial"] for row in rows if row["adopted"] == "1"} >= set(unknown)
    for row, old in zip(rows, before, strict=True):
        differ = {name for name in row if row[name] != old[name]}
        assert differ <= {"started_s", "ended_s", "adopted"}
    capsys.readouterr()
    assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out
    # What else was lost is asked for again.
    run_simulated(study, 1, quiet)
    assert finished(study) == TRIALS and verify(study.path, replays=False).sound


def test_a_recording_of_somebody_else_cannot_be_taken_in(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    trials = first_session(study) / "trials"
    data = read_stored(trials / "T001.jsonl").data
    (trials / "T009.jsonl").write_bytes(data.replace(b'"session":1', b'"session":2'))
    assert main(["study", "tables", str(study.path)]) == 1
    said = capsys.readouterr().out
    assert "T009.jsonl: cannot count: it is of another participant or session" in said
    assert accept(study, "r") == 0
    assert (
        "T009.jsonl: set aside" in capsys.readouterr().out
        and verify(study.path, replays=False).sound
    )


@pytest.mark.parametrize("answer", ["q", "r the box was lost"])
def test_the_last_states_of_a_trial_that_diverged_are_no_attempt_that_somebody_lost(
    answer: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = StudyFolder(tmp_path, design(DIVERGING), SIMULATED)
    controls, answers = Controls(quiet), iter([answer, "q"])

    def say(text: str) -> None:
        if "diverged" in text or "repeated" in text:
            controls.type(next(answers, "q"))

    assert run_simulated(study, 1, say, controls) == "stopped"
    trials = first_session(study) / "trials"
    assert {path.name[:13] for path in trials.iterdir()} > {"T001-diverged"}
    assert main(["study", "tables", str(study.path)]) == 0
    run_simulated(study, 1, quiet)
    rows = rows_of(study.path / "tables/trials.csv")
    assert {row["status"] for row in rows} == {"diverged"}
    capsys.readouterr()
    assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out


def test_a_report_and_a_copy_of_a_study_that_lost_records_say_so_and_leave_its_tables(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (study.path / "tables/trials.csv").read_bytes()
    out = study.path.parent
    assert main(["study", "report", str(study.path), "--out", str(out / "report")]) == 0
    said = capsys.readouterr().out
    assert "records are missing or changed" in said and f"sandbox study note {study.path}" in said
    assert "until that is decided, the tables are left as they are" in said
    assert (study.path / "tables/trials.csv").read_bytes() == before
    page = (out / "report" / "report.html").read_text(encoding="utf-8")
    lost = f"Records of {study.participants()[0].ppid} are missing or changed"
    assert lost in page[: page.index("</header>")]
    shared = ["--out", str(out / "shared")]
    assert main(["study", "share", str(study.path), *shared]) == 0
    assert "what was lost is not in the folder" in capsys.readouterr().out
