"""Tables that follow a session step by step are, byte for byte, those made whole from journals."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from rich.console import Console

from sandbox.cli.study.report import ReportOptions, report
from sandbox.study.audit.audit import audit
from sandbox.study.design.design import DEMOGRAPHICS
from sandbox.study.design.plan import FormStep, TrialStep
from sandbox.study.measures.compute import VERSION
from sandbox.study.record.folder import SIMULATED, Participant, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import StoredSession, session_path, sessions_of
from sandbox.study.report.models.data import load_study
from sandbox.study.run.simulate import run_simulated
from sandbox.study.share.privacy import Masking, anonymise
from sandbox.study.share.withdraw import withdraw
from sandbox.study.tables import tables
from sandbox.study.tables.tables import (
    StudyTables,
    rebuild_all,
    rebuild_session,
    tables_are_outdated,
)
from sandbox.trial.result import TrialResult
from tasks.score import Status
from tests.support.study_files import DESIGN, design, open_study, rows_of

RULES = """
[[exclusions]]
name = "slow"
measure = "time_s"
above = 5.0
[[exclusions]]
name = "slow-person"
of = "participant"
measure = "time_s"
above = 4.0
"""
TWO_SESSIONS = DESIGN.replace('name = "quick"', 'name = "quick"\nsessions = 2') + RULES


def result(step: TrialStep, seconds: float) -> TrialResult:
    """The result of a trial that took so long."""
    won = seconds < 6.0
    return TrialResult(
        task="quick",
        task_version=1,
        encoder="linear",
        seed=step.seed,
        success=won,
        instant=won,
        held=won,
        final=won,
        status=Status.HELD if won else Status.TIMEOUT,
        progress=float(won),
        time_s=seconds,
        reason="" if won else "too far",
        state_hash="00",
        measures={"first_contact_s": 0.25, "lost_s": 0.0},
    )


class Sessions:
    """Sessions of a study that go on step by step, in any order."""

    def __init__(self, study: StudyFolder) -> None:
        self.study = study
        self.tables = StudyTables(study)

    def do(self, action: str, who: int, number: float) -> None:
        """Does something in the session of a participant, and updates the tables."""
        people = self.study.participants()
        if action == "new" or not people:
            self.study.add(hand="left" if number > 5.0 else "right")
            return
        person = people[who % len(people)]
        if action == "withdraw":
            withdraw(self.study, person.ppid, "wants to")
            self.tables.update()
            return
        begun = sessions_of(self.study, person)
        nth = 2 if begun and begun[0].state.complete else 1
        with SessionFolder(self.study, person, nth) as session:
            actions: dict[str, Callable[[SessionFolder, float], None]] = {
                "trial": self.trial,
                "exclude_trial": self.exclude_trial,
                "exclude_person": self.exclude_person,
                "repeat": self.repeat,
                "finish": self.finish,
            }
            actions[action](session, number)
            rebuild_session(session, durable=False)
        self.tables.update()

    def trial(self, session: SessionFolder, seconds: float) -> None:
        step = session.state.next_step(session.steps)
        while step is not None and not isinstance(step, TrialStep):
            if isinstance(step, FormStep):
                session.write(
                    "answers",
                    step=step.id,
                    form=step.form.name,
                    block=step.block,
                    levels=step.levels,
                    seconds=1.0,
                    answers={item.name: 3 for item in step.form.items},
                )
            else:
                session.write("step_done", step=step.id)
            step = session.state.next_step(session.steps)
        if step is None:
            session.write("session_end", complete=True)
            return
        recording = session.begin(step)
        recording.write_text("a recording\n")
        session.finish(step, result(step, seconds))
        values = {
            "version": VERSION,
            "truth": "",
            "drops": 1,
            "move_amplitude_m": seconds,
            "move_error_m": seconds / 10.0,
        }
        path = session.path / "trackers" / f"measures_{recording.stem}.json"
        path.write_text(json.dumps(values))

    def exclude_trial(self, session: SessionFolder, number: float) -> None:
        session.write("exclude", trial=1 + int(number), reason="coughed, twice")

    def exclude_person(self, session: SessionFolder, number: float) -> None:
        session.write("exclude", trial=None, reason='said "no"')

    def repeat(self, session: SessionFolder, number: float) -> None:
        for trial, attempts in session.state.attempts.items():
            if attempts[-1].end is not None:
                session.write("repeat", step=attempts[-1].start["step"], trial=trial, reason="")
                return

    def finish(self, session: SessionFolder, number: float) -> None:
        while not session.state.complete:
            self.trial(session, number)


ACTIONS = (
    "trial",
    "trial",
    "trial",
    "new",
    "exclude_trial",
    "exclude_person",
    "repeat",
    "finish",
    "withdraw",
)
Steps = st.lists(
    st.tuples(st.sampled_from(ACTIONS), st.integers(0, 3), st.sampled_from([1.5, 2.5, 4.5, 7.0])),
    min_size=1,
    max_size=12,
)


def written(folder: Path) -> dict[str, bytes]:
    """All tables in a folder."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*.csv"))
    }


@example(
    [
        ("new", 0, 1.5),
        ("new", 0, 1.5),
        ("trial", 0, 1.5),
        ("trial", 1, 2.5),
        ("trial", 0, 7.0),
        ("withdraw", 0, 1.5),
        ("trial", 0, 1.5),
    ]
)
@example(
    [
        ("new", 0, 1.5),
        ("finish", 0, 2.5),
        ("finish", 0, 4.5),
        ("exclude_trial", 0, 1.5),
        ("repeat", 0, 1.5),
        ("trial", 0, 1.5),
        ("exclude_person", 0, 1.5),
    ]
)
@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
@given(Steps)
def test_tables_after_any_order_of_steps_are_those_made_whole_from_the_journals(
    steps: list[tuple[str, int, float]],
) -> None:
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        # Here every step makes a journal longer, so that parts may be kept at once.
        patch.setattr(tables, "SETTLED", 0)
        sessions = Sessions(open_study(Path(folder), TWO_SESSIONS))
        for step in steps:
            sessions.do(*step)
        counts = sessions.tables.update()
        followed = written(sessions.study.path)
        assert not tables_are_outdated(sessions.study.path)
        for path in sessions.study.path.rglob("*.csv"):
            path.unlink()
        rebuild_all(StudyFolder.at(sessions.study.path))
        assert written(sessions.study.path) == followed
        assert StudyTables(sessions.study).update() == counts


def test_an_update_reads_only_the_journals_that_have_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "SETTLED", 0)
    sessions = Sessions(open_study(tmp_path, TWO_SESSIONS))
    for who in range(4):
        sessions.do("new", 0, 1.5)
        sessions.do("trial", who, 1.5)
    read: list[str] = []

    def counting(study: StudyFolder, person: Participant) -> list[StoredSession]:
        read.append(person.ppid)
        return sessions_of(study, person)

    monkeypatch.setattr(tables, "sessions_of", counting)
    sessions.tables.update()
    assert read == []
    sessions.do("trial", 2, 2.5)
    assert read == [sessions.study.participants()[2].ppid]
    other = StudyTables(sessions.study)
    other.update()
    assert len(read) == 5
    sessions.do("trial", 0, 2.5)
    other.update()
    assert read[5:] == [sessions.study.participants()[0].ppid] * 2, "another program's trial, too"


def test_a_part_whose_files_changed_just_now_is_not_trusted(tmp_path: Path) -> None:
    sessions = Sessions(open_study(tmp_path, TWO_SESSIONS))
    sessions.do("new", 0, 1.5)
    sessions.do("trial", 0, 1.5)
    person = sessions.study.participants()[0]
    path = session_path(sessions.study.path, person.ppid) / "trackers" / "measures_T001.json"
    # Another program writes within the same tick of the file system's clock.
    path.write_text(path.read_text().replace('"drops": 1', '"drops": 7'))
    sessions.tables.update()
    assert b",7," in (sessions.study.path / "trial_results.csv").read_bytes()


def test_a_report_has_the_trials_of_a_session_whose_program_was_killed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sandbox.study.report.make.make_report", lambda folder, *more: folder)
    sessions = Sessions(open_study(tmp_path, TWO_SESSIONS))
    sessions.do("new", 0, 1.5)
    sessions.do("finish", 0, 1.5)
    before = (sessions.study.path / "trial_results.csv").read_bytes()
    person = sessions.study.participants()[0]
    with SessionFolder(sessions.study, person, 2) as session:
        sessions.trial(session, 2.5)
    assert tables_are_outdated(sessions.study.path)
    report(ReportOptions(sessions.study.path), Console())
    assert "rebuilt" in capsys.readouterr().out and not tables_are_outdated(sessions.study.path)
    after = (sessions.study.path / "trial_results.csv").read_bytes()
    assert after.startswith(before) and after.count(b"\n") == before.count(b"\n") + 1


def people_of(study: StudyFolder) -> list[dict[str, str]]:
    """Rows of `participants.csv`."""
    with (study.path / "participants.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_trial_that_is_excluded_in_words_for_people_excludes_nobody(tmp_path: Path) -> None:
    sessions = Sessions(open_study(tmp_path))
    sessions.do("new", 0, 1.5)
    sessions.do("trial", 0, 1.5)
    sessions.do("trial", 0, 1.5)
    person = sessions.study.participants()[0]
    with SessionFolder(sessions.study, person) as session:
        session.write("exclude", trial=2, reason="participant: coughed")
    sessions.do("trial", 0, 1.5)
    (row,) = people_of(sessions.study)
    assert (row["excluded"], row["exclusion_reason"]) == ("0", "")
    sessions.do("exclude_person", 0, 1.5)
    (row,) = people_of(sessions.study)
    assert (row["excluded"], row["exclusion_reason"]) == ("1", 'said "no"')


def test_a_copy_without_a_journal_keeps_its_tables(tmp_path: Path) -> None:
    sessions = Sessions(open_study(tmp_path, TWO_SESSIONS))
    for who in range(2):
        sessions.do("new", 0, 1.5)
        sessions.do("trial", who, 1.5)
    person = sessions.study.participants()[0]
    (session_path(sessions.study.path, person.ppid) / "journal.jsonl").unlink()
    assert not tables_are_outdated(sessions.study.path)


RENAMED = (
    DESIGN.replace('name = "contact"\n', 'name = "feel"\nsetting = "contact"\n')
    .replace('practice_each = "contact"', 'practice_each = "feel"')
    .replace('at = "contact"', 'at = "feel"')
)
"""The same design, whose factor has another name."""


def test_levels_of_a_factor_that_was_renamed_in_the_middle_stay_in_all_tables(
    tmp_path: Path,
) -> None:
    """The cells of those who had come before were empty, and no table had their levels."""
    Sessions(open_study(tmp_path)).do("new", 0, 1.5)
    before = Sessions(open_study(tmp_path))
    before.do("finish", 0, 1.5)
    study = StudyFolder(tmp_path, design(RENAMED), SIMULATED, "a better name")
    after = Sessions(study)
    after.do("new", 0, 1.5)
    after.do("finish", 1, 1.5)
    old, new = (person.ppid for person in study.participants())
    for name in ("trial_results.csv", "questionnaires.csv"):
        rows = [row for row in rows_of(study.path / name) if row.get("instrument") != DEMOGRAPHICS]
        levels = {(row["ppid"], row["factor_contact"], row["factor_feel"]) for row in rows}
        expected = {(old, "hard", ""), (old, "soft", ""), (new, "", "hard"), (new, "", "soft")}
        assert levels == expected
    book = {r["column"]: r["meaning"] for r in rows_of(study.path / "codebook.csv")}
    assert book["factor_feel"] == "level: hard, soft"
    assert book["factor_contact"] == "level in an earlier design, empty since then: hard, soft"
    followed = written(study.path)
    rebuild_all(StudyFolder.at(study.path))
    for name in {*followed} - {path for path in followed if path.startswith(old)}:
        assert written(study.path)[name] == followed[name]
    assert "factor_contact" in (study.path / old / "S001" / "trial_results.csv").read_text()
    factors = {factor.name: factor.levels for factor in load_study(study.path).factors}
    assert factors == {"feel": ("hard", "soft"), "contact": ("hard", "soft")}


OLDER = DESIGN.replace('name = "age"\nkind', 'name = "years"\nkind')
"""The same design, whose question about the person has another name."""


def test_answers_to_a_question_about_the_person_that_was_renamed_stay(tmp_path: Path) -> None:
    """They were in no column of `participants.csv`, and `--drop` did not know them."""
    before = Sessions(open_study(tmp_path / "study"))
    before.do("new", 0, 1.5)
    before.do("finish", 0, 1.5)
    study = StudyFolder(tmp_path / "study", design(OLDER), SIMULATED, "a better name")
    after = Sessions(study)
    after.do("new", 0, 1.5)
    after.do("finish", 1, 1.5)
    old, new = rows_of(study.path / "participants.csv")
    assert old["age"] and not old["years"] and new["years"] and not new["age"]
    book = {r["column"]: r["meaning"] for r in rows_of(study.path / "codebook.csv")}
    assert book["years"] == "How old are you?"
    assert book["age"] == "answer to a question of an earlier design, empty since then"
    assert audit(study.path).findings.found == []

    def shared(name: str, masking: Masking) -> tuple[list[dict[str, str]], Sequence[str]]:
        done = anonymise(study, tmp_path / name, masking, lambda text: None)
        return rows_of(tmp_path / name / "participants.csv"), done.groups.columns

    (both, compared), (one, fewer) = (
        shared("whole", Masking(bins={"age": 5.0}, recordings=False)),
        shared("less", Masking(drop=("age",), recordings=False)),
    )
    assert {"age", "years"} <= {*compared} and "age" not in fewer and "years" in fewer
    assert [row["age"] for row in both if row["age"]] == [str(int(old["age"]) // 5 * 5)]
    assert not any(row.get("age") for row in one) and sum(bool(row["years"]) for row in one) == 1


def test_scores_of_a_questionnaire_that_is_asked_no_longer_stay(tmp_path: Path) -> None:
    """Answers stayed, and their scores were gone."""
    asked = DESIGN + '[[questionnaires]]\nuse = "sus"\nat = "end"\n'
    run_simulated(StudyFolder(tmp_path, design(asked), SIMULATED), 0, print)
    study = StudyFolder(tmp_path, design(DESIGN), SIMULATED, "too long")
    run_simulated(study, 1, print)
    old = study.participants()[0].ppid
    scores = rows_of(study.path / "questionnaire_scores.csv")
    assert [row["ppid"] for row in scores if row["instrument"] == "sus"] == [old]
    rebuild_all(StudyFolder.at(study.path))
    assert rows_of(study.path / "questionnaire_scores.csv") == scores
