"""A study whose numbers of participants count from 0 is read as it was meant, and goes on."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import journal_bytes, read_journal
from sandbox.study.record.notes import INCLUDE, PARTICIPANT, read_notes, write_notes
from sandbox.study.record.records import RUNS, SCHEMA
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.share.shared_folder import Masking, share_study
from tests.support.study_driver import run, tables
from tests.support.study_files import SHORT, design, quiet, rows_of


def from_zero(study: Path) -> None:
    """Writes a study with the records and notes of before, sealed anew."""
    heads = {}
    for path in study.glob("*/S001/session.jsonl"):
        records = read_journal(path)
        for record in records:
            if record["kind"] in RUNS:
                record |= {"schema": 3, "number": record["number"] - 1}
        path.write_bytes(journal_bytes(records))
        heads[path.parent.parent.name] = read_journal(path)[-1]["hash"]
    for path in study.glob("*/notes.jsonl"):
        notes = read_notes(path)
        for note in notes:
            if note["kind"] in (PARTICIPANT, INCLUDE) and note.get("number") is not None:
                note["number"] -= 1
                del note["schema"]
        write_notes(path, notes)
    site = study / "notes/A.jsonl"
    sealed = [
        {**note, "hash": heads[note["ppid"]]} if note["kind"] == "sealed" else note
        for note in read_notes(site)
    ]
    write_notes(site, sealed)


def test_numbers_of_before_count_from_1_and_the_study_goes_on_with_the_next_one(
    tmp_path: Path,
) -> None:
    path = run(tmp_path, people=2)
    study = StudyFolder(tmp_path, design(SHORT), SIMULATED)
    study.release(study.add().ppid, "did not come")
    released = next(p for p in study.participants() if p.number == 3)
    study.include(released, begun=False, reason="came", after={}, session=None, trial=None)
    before, orders = tables(path), rows_of(path / "tables/trials.csv")
    from_zero(path)
    assert tables(path) == before and main(["replay", str(path), "--verify"]) == 0
    study = StudyFolder(tmp_path, design(SHORT), SIMULATED)
    assert sorted(p.number for p in study.participants()) == [1, 2, 3]
    records = {p: p.read_bytes() for p in path.glob("*/S001/session.jsonl")}
    run_simulated(study, 1, quiet)
    assert {p: p.read_bytes() for p in records} == records
    assert rows_of(path / "tables/trials.csv") == orders
    assert study.add().number == 4
    share_study(study, tmp_path / "copy", Masking(), quiet)
    copied = {p.number for p in StudyFolder.at(tmp_path / "copy").participants()}
    assert copied == {1, 2}


def test_a_study_of_a_later_layout_is_refused_and_stays_as_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = run(tmp_path, people=1)
    (journal,) = path.glob("*/S001/session.jsonl")
    records = read_journal(journal)
    records[0]["schema"] = SCHEMA + 1
    written = journal_bytes(records)
    journal.write_bytes(written)
    assert main(["study", "tables", str(path)]) != 0
    assert f"layout {SCHEMA + 1}" in capsys.readouterr().err
    assert journal.read_bytes() == written
