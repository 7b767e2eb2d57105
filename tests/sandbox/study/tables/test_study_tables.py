"""Tables are a function of the records, whatever happened to people and design meanwhile."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from sandbox.study.design.design import DEMOGRAPHICS
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.report.data import load_study
from sandbox.study.run.simulated_study import run_simulated, simulate, simulated_person
from sandbox.study.share.withdraw import withdraw
from sandbox.study.tables.tables import make_tables, table_files
from tests.support.study_files import (
    SHORT,
    TWICE,
    design,
    open_study,
    quiet,
    rows_of,
)

RULES = """
[[exclusions]]
name = "slow"
measure = "time_s"
above = 0.2
[[exclusions]]
name = "slow-person"
of = "participant"
measure = "time_s"
above = 0.1
"""


def written(study: StudyFolder) -> dict[str, bytes]:
    """All tables of a study."""
    return {path.name: path.read_bytes() for path in (study.path / "tables").glob("*.csv")}


@pytest.fixture
def eventful(tmp_path: Path) -> StudyFolder:
    """Two sessions each: of one who is excluded, one with a trial that is repeated, one who
    withdrew, one who took their number and has not begun, and one after their first session."""
    study = open_study(tmp_path, TWICE + RULES)
    simulate(study, 3, False, quiet)
    one, other, gone = study.participants()
    with SessionFolder(study, one, 2) as session:
        session.command("exclude", trial=None, reason='said "no"')
    with SessionFolder(study, other, 2) as session:
        session.command("exclude", trial=1, reason="coughed, twice")
        session.command("repeat", step="trial:2", trial=2, reason="")
    withdraw(study, gone.ppid)
    study.add(hand="left")
    late = study.add(**simulated_person(study.design, 4))
    with SessionFolder(study, late) as session:
        session.write("answer", step="form:demographics", item="age", answer=33)
    return study


def test_tables_are_those_of_a_study_that_is_opened_anew_without_them(
    eventful: StudyFolder,
) -> None:
    counts = make_tables(eventful)
    first = written(eventful)
    shutil.rmtree(eventful.path / "tables")
    anew = StudyFolder.at(eventful.path)
    assert make_tables(anew) == counts and written(anew) == first == table_files(anew)
    people = rows_of(eventful.path / "tables/participants.csv")
    # Who has not begun has no row.
    assert [(p["excluded"], p["complete"]) for p in people] == [("1", "1"), ("0", "0"), ("0", "0")]
    assert people[0]["exclusion_reason"] == 'said "no"'


def test_no_column_is_empty_in_all_rows_and_the_codebook_has_those_that_are_there(
    eventful: StudyFolder,
) -> None:
    make_tables(eventful)
    codebook = rows_of(eventful.path / "tables/codebook.csv")
    for path in (eventful.path / "tables").glob("*.csv"):
        rows = rows_of(path)
        assert rows or path.name == "scores.csv"
        if path.name == "codebook.csv" or not rows:
            continue
        assert [name for name in rows[0] if not any(row[name] for row in rows)] == []
        described = [row["column"] for row in codebook if row["table"] == path.name]
        assert described[: len(rows[0])] == list(rows[0])


def test_a_trial_that_is_excluded_in_words_for_people_excludes_nobody(tmp_path: Path) -> None:
    study = open_study(tmp_path, SHORT)
    run_simulated(study, 1, quiet)
    with SessionFolder(study, study.participants()[0]) as session:
        session.command("exclude", trial=2, reason="participant: coughed")
    make_tables(study)
    (row,) = rows_of(study.path / "tables/participants.csv")
    assert row["excluded"] == "0" and "exclusion_reason" not in row


RENAMED = (SHORT.replace('name = "contact"\n', 'name = "feel"\nsetting = "contact"\n')).replace(
    'at = "contact"', 'at = "feel"'
)
"""The same design, whose factor has another name."""


def test_levels_of_a_factor_that_was_renamed_in_the_middle_stay_in_all_tables(
    tmp_path: Path,
) -> None:
    """The cells of those who had come before were empty, and no table had their levels."""
    run_simulated(open_study(tmp_path, SHORT), 1, quiet)
    study = StudyFolder(tmp_path, design(RENAMED), SIMULATED, "a better name")
    run_simulated(study, 2, quiet)
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
    assert table_files(StudyFolder.at(study.path)) == written(study)
    factors = {factor.name: factor.levels for factor in load_study(study.path).factors}
    assert factors == {"feel": ("hard", "soft"), "contact": ("hard", "soft")}
