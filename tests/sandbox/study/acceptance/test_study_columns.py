"""The codebook says of every column what is in it, and a row says where its trial stood."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.study.design.design import Design
from sandbox.study.design.session_plan import FormStep, session_plan, trials_of
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.report.data import load_study
from sandbox.study.run.simulated_study import simulated_person
from sandbox.study.tables.column import UXF_NAMES
from sandbox.study.tables.tables import make_tables, table_files
from sandbox.study.tables.trial_table import planned_cells
from tests.support.in_r import in_r
from tests.support.study_driver import run
from tests.support.study_files import DESIGN, design, rows_of

TYPES = ("number", "integer", "logical", "factor", "text")


SECOND = '\n[[factors]]\nname = "servo"\norder = "latin"\nlevels = ["orientation", "position"]\n'


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("columns"), people=2)


def fits(kind: str, cell: str) -> bool:
    """True if a cell is of a type of the codebook."""
    if kind == "logical":
        return cell in ("0", "1")
    if kind == "integer":
        return cell.lstrip("-").isdecimal()
    if kind == "number":
        return isinstance(float(cell), float)
    return True


def test_every_column_has_the_type_that_the_codebook_says(study: Path) -> None:
    book = {(r["table"], r["column"]): r["type"] for r in rows_of(study / "tables/codebook.csv")}
    assert set(book.values()) <= set(TYPES)
    for path in sorted((study / "tables").glob("*.csv")):
        if path.name == "codebook.csv":
            continue
        for row in rows_of(path):
            for name, cell in row.items():
                kind = book[path.name, name]
                assert not cell or fits(kind, cell), (path.name, name, kind, cell)
    # What is text to the codebook and a number to a reader is a pseudonym or an answer.
    numbers = {
        name
        for row in rows_of(study / "tables/trials.csv")
        for name, cell in row.items()
        if book["trials.csv", name] in ("text", "factor") and cell.isdecimal()
    }
    assert numbers == set()


@pytest.mark.needs("r")
def test_r_finds_in_every_column_the_type_that_the_codebook_says(study: Path) -> None:
    script = """
    book <- words(file.path(given[[1]], "codebook.csv"))
    for (file in intersect(unique(book$table), list.files(given[[1]]))) {
      table <- words(file.path(given[[1]], file))
      for (column in names(table)) {
        cells <- table[[column]][table[[column]] != ""]
        type <- book$type[book$table == file & book$column == column]
        found <- class(type.convert(cells, as.is = TRUE))
        right <- switch(type, number = found %in% c("numeric", "integer"), integer = ,
                        logical = found == "integer", factor = , text = found == "character")
        if (length(cells) && !right) cat(file, column, type, found, "\\n")
      }
    }
    """
    differ = in_r(script, study / "tables")
    # An answer has the type of its question, which is text to a table of several.
    assert [line for line in differ if not line.startswith("answers.csv answer ")] == []


def test_a_row_has_its_place_in_the_order_and_its_time_limit(study: Path) -> None:
    for row in rows_of(study / "tables/trials.csv"):
        order = ["hard", "soft"] if row["number"] == "1" else ["soft", "hard"]
        assert row["place_contact"] == str(order.index(row["factor_contact"]) + 1)
        assert row["position"] == row["place_contact"]
        assert float(row["limit_s"]) > float(row["time_s"])


def test_what_was_answered_in_a_form_that_was_left_is_in_the_table_and_stays_in_the_form(
    tmp_path: Path,
) -> None:
    study = StudyFolder(tmp_path, design(DESIGN), SIMULATED)
    person = study.add(**simulated_person(study.design, 1))
    form = next(step for step in session_plan(study.design, 1) if isinstance(step, FormStep))
    with SessionFolder(study, person) as session:
        session.write("answer", step=form.id, item=form.form.items[0].name, answer=33)
    make_tables(study)
    (row,) = rows_of(study.path / "tables/answers.csv")
    assert (row["instrument"], row["answer"], row["form_complete"]) == (form.form.name, "33", "0")
    assert "time" not in row
    with SessionFolder(study, person) as session:
        assert session.state.drafts[form.id] == {form.form.items[0].name: 33}
    run(tmp_path, DESIGN)
    rows = rows_of(study.path / "tables/answers.csv")
    assert len(rows) == 3 and {r["form_complete"] for r in rows} == {"1"}


def met(plan: Design, number: int) -> dict[int, dict[str, object]]:
    start = {"kind": "session", "n": 0, "time": "2026-11-21T00:00:00.000+00:00"}
    about = {"clock": 0.0, "number": number, "session": 1}
    return planned_cells(plan, SessionState.of([{**start, **about}]))


@pytest.mark.parametrize("rounds", ["", '\nrepeat_inside = "contact"'])
def test_places_are_those_within_the_same_outer_level_and_round(rounds: str) -> None:
    plan = design(DESIGN.replace("[trials]", SECOND + "[trials]" + rounds))
    cells = met(plan, 1)
    trials = [t for t in trials_of(session_plan(plan, 1)) if not t.practice]
    assert [cells[t.number]["position"] for t in trials] == list(range(1, len(trials) + 1))
    # Each level of the inner factor is at a place of its own in every outer level and round.
    for outer in ("hard", "soft"):
        for again in {t.repetition for t in trials} if rounds else {0}:
            some = [
                (t.levels["servo"], cells[t.number]["place_servo"])
                for t in trials
                if t.levels["contact"] == outer and again in (0, t.repetition)
            ]
            assert len(set(some)) == 2 and {place for _, place in some} == {1, 2}


def test_names_of_uxf_are_one_option_and_a_report_reads_both(study: Path) -> None:
    ours = rows_of(study / "tables/trials.csv")
    before = load_study(study)
    assert main(["study", "tables", str(study), "--uxf-names"]) == 0
    theirs = rows_of(study / "tables/trials.csv")
    names = {UXF_NAMES.get(name, name): name for name in ours[0]}
    assert list(theirs[0]) == list(names) and "ppid" in names
    assert [{names[k]: v for k, v in row.items()} for row in theirs] == ours
    book = {(row["table"], row["column"]) for row in rows_of(study / "tables/codebook.csv")}
    assert {("trials.csv", name) for name in theirs[0]} <= book
    assert load_study(study).used.equals(before.used)
    make_tables(StudyFolder.at(study))
    assert rows_of(study / "tables/trials.csv") == ours


def test_tables_are_the_same_whatever_the_order_of_folders(
    study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = table_files(StudyFolder.at(study))
    glob = Path.glob
    monkeypatch.setattr(Path, "glob", lambda path, pattern: reversed(list(glob(path, pattern))))
    assert table_files(StudyFolder.at(study)) == before
