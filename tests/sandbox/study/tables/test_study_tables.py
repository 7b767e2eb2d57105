"""Tables are a function of the records: any order of steps gives those that are made at the end."""

from __future__ import annotations

import csv
import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from sandbox.study.design.design import DEMOGRAPHICS
from sandbox.study.design.session_plan import FormStep, TrialStep
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import sessions_of
from sandbox.study.report.data import load_study
from sandbox.study.share.withdraw import withdraw
from sandbox.study.tables.tables import make_tables, table_files
from tests.support.study_files import DESIGN, design, open_study, rows_of, trial_result

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


class Sessions:
    """Sessions of a study that go on step by step, in any order."""

    def __init__(self, study: StudyFolder) -> None:
        self.study = study

    def do(self, action: str, who: int, number: float) -> None:
        """Does something in the session of a participant, and updates the tables."""
        people = self.study.participants()
        if action == "new" or not people:
            self.study.add(hand="left" if number > 5.0 else "right")
            return
        person = people[who % len(people)]
        if action == "withdraw":
            withdraw(self.study, person.ppid)
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
            session.seal()

    def trial(self, session: SessionFolder, seconds: float) -> None:
        step = session.state.next_step(session.steps)
        while step is not None and not isinstance(step, TrialStep):
            if isinstance(step, FormStep):
                session.write(
                    "form",
                    step=step.id,
                    form=step.form.name,
                    block=step.block,
                    levels=step.levels,
                    seconds=1.0,
                    answers={item.name: 3 for item in step.form.items},
                )
            else:
                session.write("done", step=step.id)
            step = session.state.next_step(session.steps)
        if step is None:
            session.write("end", complete=True)
            return
        recording = session.begin(step)
        recording.write_text("a recording\n")
        measures = {"first_contact_s": 0.25, "lost_s": 0.0}
        won = seconds < 6.0
        session.finish(step, trial_result(seconds, won, seed=step.seed, measures=measures))

    def exclude_trial(self, session: SessionFolder, number: float) -> None:
        session.command("exclude", trial=1 + int(number), reason="coughed, twice")

    def exclude_person(self, session: SessionFolder, number: float) -> None:
        session.command("exclude", trial=None, reason='said "no"')

    def repeat(self, session: SessionFolder, number: float) -> None:
        for trial, attempts in session.state.attempts.items():
            if attempts[-1].end is not None:
                session.command("repeat", step=attempts[-1].start["step"], trial=trial, reason="")
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
        for path in sorted((folder / "tables").glob("*.csv"))
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
def test_tables_after_any_order_of_steps_are_those_of_a_study_that_is_opened_anew(
    steps: list[tuple[str, int, float]],
) -> None:
    with TemporaryDirectory() as folder:
        sessions = Sessions(open_study(Path(folder), TWO_SESSIONS))
        for step in steps:
            sessions.do(*step)
        counts = make_tables(sessions.study)
        first = written(sessions.study.path)
        assert first.keys() == {f"tables/{name}" for name in table_files(sessions.study)}
        shutil.rmtree(sessions.study.path / "tables")
        anew = StudyFolder.at(sessions.study.path)
        assert make_tables(anew) == counts and written(anew.path) == first
        assert {f"tables/{name}": data for name, data in table_files(anew).items()} == first


def test_no_column_is_empty_in_all_rows_and_the_codebook_has_those_that_are_there(
    tmp_path: Path,
) -> None:
    sessions = Sessions(open_study(tmp_path, TWO_SESSIONS))
    sessions.do("new", 0, 1.5)
    sessions.do("finish", 0, 1.5)
    make_tables(sessions.study)
    codebook = rows_of(sessions.study.path / "tables/codebook.csv")
    for path in (sessions.study.path / "tables").glob("*.csv"):
        rows = rows_of(path)
        assert rows or path.name == "scores.csv"
        if path.name == "codebook.csv" or not rows:
            continue
        assert [name for name in rows[0] if not any(row[name] for row in rows)] == []
        described = [row["column"] for row in codebook if row["table"] == path.name]
        assert described[: len(rows[0])] == list(rows[0])


def people_of(study: StudyFolder) -> list[dict[str, str]]:
    """Rows of `participants.csv`."""
    make_tables(study)
    with (study.path / "tables/participants.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_trial_that_is_excluded_in_words_for_people_excludes_nobody(tmp_path: Path) -> None:
    sessions = Sessions(open_study(tmp_path))
    sessions.do("new", 0, 1.5)
    sessions.do("trial", 0, 1.5)
    sessions.do("trial", 0, 1.5)
    person = sessions.study.participants()[0]
    with SessionFolder(sessions.study, person) as session:
        session.command("exclude", trial=2, reason="participant: coughed")
    sessions.do("trial", 0, 1.5)
    (row,) = people_of(sessions.study)
    assert row["excluded"] == "0" and "exclusion_reason" not in row
    sessions.do("exclude_person", 0, 1.5)
    (row,) = people_of(sessions.study)
    assert (row["excluded"], row["exclusion_reason"]) == ("1", 'said "no"')


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
    make_tables(study)
    old, new = (person.ppid for person in study.participants())
    for name in ("trials.csv", "answers.csv"):
        rows = [
            row
            for row in rows_of(study.path / "tables" / name)
            if row.get("instrument") != DEMOGRAPHICS
        ]
        levels = {(row["participant"], row["factor_contact"], row["factor_feel"]) for row in rows}
        expected = {(old, "hard", ""), (old, "soft", ""), (new, "", "hard"), (new, "", "soft")}
        assert levels == expected
    book = {r["column"]: r["meaning"] for r in rows_of(study.path / "tables/codebook.csv")}
    assert book["factor_feel"] == "level: hard, soft"
    assert book["factor_contact"] == "level in an earlier design, empty since then: hard, soft"
    followed = written(study.path)
    make_tables(StudyFolder.at(study.path))
    assert written(study.path) == followed
    factors = {factor.name: factor.levels for factor in load_study(study.path).factors}
    assert factors == {"feel": ("hard", "soft"), "contact": ("hard", "soft")}
