"""Withdrawn data are gone, and nobody is withdrawn by a slip."""

from __future__ import annotations

import gzip
import shutil
from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.recording.recording import read_stored
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.notes import withdrawn
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.share.withdraw import withdraw
from tests.support.study_files import design, rows_of


def mentions(folder: Path, ppid: str) -> list[Path]:
    found = [p for p in folder.rglob("*") if ppid in p.name]
    inside = [p for p in folder.rglob("*") if p.is_file() and ppid.encode() in read_stored(p).data]
    return found + inside


def test_who_withdraws_is_gone_but_for_a_tombstone_and_others_are_untouched(
    study: StudyFolder,
) -> None:
    gone, stays = (p.ppid for p in study.participants())
    before = {p: p.read_bytes() for p in (study.path / stays).rglob("*") if p.is_file()}
    assert len(mentions(study.path, gone)) > 10
    found = withdraw(study, gone)
    assert found.files > 12 and not found.before and not found.copies and not found.still
    assert mentions(study.path, gone) == [study.notes]
    (tomb,) = [note for note in study.records() if gone in str(note)]
    assert set(tomb) == {"time", "kind", "ppid"} and tomb["kind"] == "withdrawn"
    assert tomb["time"].endswith("T00:00:00.000+00:00")
    for table in ("trials.csv", "participants.csv", "answers.csv", "scores.csv"):
        assert {r["participant"] for r in rows_of(study.path / "tables" / table)} <= {stays}
    assert {p: p.read_bytes() for p in before} == before
    assert withdrawn(study.records()) == {gone}


def test_a_withdrawal_that_was_cut_short_is_ended_by_another_call(study: StudyFolder) -> None:
    gone = study.participants()[0].ppid
    folder = study.path / gone
    kept = folder.with_name("kept")
    shutil.copytree(folder, kept)
    withdraw(study, gone)
    # As if the program had been killed between the tombstone and the deletion.
    kept.rename(folder)
    found = withdraw(study, gone)
    assert found.before and found.files > 12 and not folder.exists()
    assert [n["kind"] for n in study.records()].count("withdrawn") == 1


def test_the_number_of_who_withdrew_goes_to_the_next_newcomer(study: StudyFolder) -> None:
    person = study.participants()[0]
    withdraw(study, person.ppid)
    assert study.add().number == person.number


def test_a_withdrawal_tells_which_copies_and_files_still_hold_the_data(
    study: StudyFolder, tmp_path: Path
) -> None:
    gone, other = (p.ppid for p in study.participants())
    archive = tmp_path / "b.tar.gz"
    archive.write_bytes(b"a copy")
    study.note("copied", path=str(archive), ppids=[gone, other])
    study.note("copied", path=str(tmp_path / "elsewhere"), ppids=[other])
    # A report need not name a person to have them in its numbers.
    (study.path / "report.html").write_text("<p>2 people began.</p>")
    packed = gzip.compress(f"{gone}, {other}".encode())
    # Of what was cut short nobody can say what was in it.
    for name, data in (("all.csv.gz", packed), ("cut.csv.gz", packed[:-9]), ("no.csv.gz", b"text")):
        (study.path / name).write_bytes(data)
    (study.path / "other.csv.gz").write_bytes(gzip.compress(other.encode()))
    found = withdraw(study, gone)
    assert found.copies == (archive,)
    names = ("all.csv.gz", "cut.csv.gz", "no.csv.gz", "report.html")
    assert found.still == tuple(study.path / name for name in names)
    assert gone not in str([note for note in study.records() if note["kind"] == "copied"])


def test_nobody_is_withdrawn_by_a_slip_or_in_the_middle_of_a_session(study: StudyFolder) -> None:
    with pytest.raises(StudyError, match="no such participant"):
        withdraw(study, "000000")
    live = StudyFolder(study.path.parent, design(), SIMULATED)
    person = live.participants()[0]
    with SessionFolder(live, person), pytest.raises(StudyError, match="in use"):
        withdraw(study, person.ppid)
    assert {p.ppid for p in study.participants()} >= {person.ppid}
