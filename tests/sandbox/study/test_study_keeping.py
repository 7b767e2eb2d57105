"""Withdrawn data are gone, backups hold what they say, and merged folders mix nothing up."""

from __future__ import annotations

import gzip
import json
import shutil
import tarfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.recording.recording import load_recording, packed, read_stored
from sandbox.study.audit.audit import audit
from sandbox.study.record.folder import PILOT, SIMULATED, StudyFolder
from sandbox.study.record.journal import journal_bytes, read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.controls import Controls
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulate import run_simulated, simulate
from sandbox.study.share import backup
from sandbox.study.share.backup import back_up, check_backup
from sandbox.study.share.export_log import copies, log_copy
from sandbox.study.share.merge import merge
from sandbox.study.share.withdraw import withdraw, withdrawn
from tests.support.study_files import DESIGN, TRIALS, check_session, design, rows_of


def quiet(text: str) -> None:
    """Nobody listens."""


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("two")
    simulate(StudyFolder(out, design(), SIMULATED), 2, False, quiet)
    return out


@pytest.fixture
def study(two: Path, tmp_path: Path) -> StudyFolder:
    shutil.copytree(two, tmp_path / "out")
    return StudyFolder.at(tmp_path / "out/quick-simulated")


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
    found = withdraw(study, gone, "by phone")
    assert found.files > 20 and not found.before and not found.copies and not found.still
    assert mentions(study.path, gone) == [study.path / "study.jsonl"]
    records = read_journal(study.path / "study.jsonl")
    (tomb,) = [r for r in records if "ppid" in r and r["ppid"] == gone]
    fields = {"n", "time", "clock", "kind", "ppid", "reason", "previous", "digest"}
    assert set(tomb) == fields
    assert tomb["kind"] == "withdrawn" and tomb["reason"] == "by phone"
    for table in (
        "trial_results.csv",
        "participants.csv",
        "questionnaires.csv",
        "questionnaire_scores.csv",
    ):
        assert {r["ppid"] for r in rows_of(study.path / table)} <= {stays}
    assert {p: p.read_bytes() for p in before} == before
    assert withdrawn(study) == {gone}


def test_a_withdrawal_that_was_cut_short_is_ended_by_another_call(study: StudyFolder) -> None:
    gone = study.participants()[0].ppid
    folder = study.path / gone
    kept = folder.with_name("kept")
    shutil.copytree(folder, kept)
    withdraw(study, gone, "first")
    # As if the program had been killed between the tombstone and the deletion.
    kept.rename(folder)
    found = withdraw(study, gone, "second")
    assert found.before and found.files > 20 and not folder.exists()
    assert [
        r["reason"] for r in read_journal(study.path / "study.jsonl") if r["kind"] == "withdrawn"
    ] == ["first"]


def test_the_number_of_who_withdrew_goes_to_the_next_newcomer(study: StudyFolder) -> None:
    person = study.participants()[0]
    withdraw(study, person.ppid, "")
    assert study.add().number == person.number


def test_a_withdrawal_tells_which_copies_and_files_still_hold_the_data(
    study: StudyFolder, tmp_path: Path
) -> None:
    gone, other = (p.ppid for p in study.participants())
    archive = tmp_path / "b.tar.gz"
    log_copy(study, "backup", archive, back_up(study, archive).ppids)
    log_copy(study, "export", tmp_path / "elsewhere", [other])
    # A report need not name a person to have them in its numbers.
    (study.path / "report.html").write_text("<p>2 people began.</p>")
    packed = gzip.compress(f"{gone}, {other}".encode())
    # Of what was cut short nobody can say what was in it.
    for name, data in (("all.csv.gz", packed), ("cut.csv.gz", packed[:-9]), ("no.csv.gz", b"text")):
        (study.path / name).write_bytes(data)
    (study.path / "other.csv.gz").write_bytes(gzip.compress(other.encode()))
    found = withdraw(study, gone, "")
    assert [(c.what, c.path, c.there) for c in found.copies] == [("backup", archive, True)]
    names = ("all.csv.gz", "cut.csv.gz", "no.csv.gz", "report.html")
    assert found.still == tuple(study.path / name for name in names)
    archive.unlink()
    assert [c.there for c in copies(study, gone)] == [False]


def test_nobody_is_withdrawn_by_a_slip_or_in_the_middle_of_a_session(study: StudyFolder) -> None:
    with pytest.raises(StudyError, match="no such participant"):
        withdraw(study, "000000", "")
    live = StudyFolder(study.path.parent, design(), SIMULATED)
    person = live.participants()[0]
    with SessionFolder(live, person), pytest.raises(StudyError, match="in use"):
        withdraw(study, person.ppid, "")
    assert {p.ppid for p in study.participants()} >= {person.ppid}


def test_a_backup_unpacks_to_the_same_files_and_the_study_goes_on_from_it(
    study: StudyFolder, tmp_path: Path
) -> None:
    archive = tmp_path / "b.tar.gz"
    found = back_up(study, archive)
    assert found.trials == 2 * TRIALS and set(found.ppids) == {p.ppid for p in study.participants()}
    assert check_backup(archive) == found
    with tarfile.open(archive) as packed:
        # Python 3.11 has filters from 3.11.4 on.
        packed.extraction_filter = getattr(tarfile, "data_filter", lambda member, _: member)
        packed.extractall(tmp_path / "again")
    again = tmp_path / "again/quick-simulated"
    for path in study.path.rglob("*"):
        if path.is_file() and path.name != ".lock":
            assert (again / path.relative_to(study.path)).read_bytes() == path.read_bytes()
    restored = StudyFolder(tmp_path / "again", design(), SIMULATED)
    assert run_simulated(restored, 0, quiet) is SessionOutcome.COMPLETE
    assert check_session(restored, 0, TRIALS) == TRIALS


def test_a_backup_of_a_running_session_goes_on_where_its_journal_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = StudyFolder(tmp_path / "out", design(), SIMULATED)

    def one_more(number: int = 0) -> None:
        """Another trial of a participant."""
        controls = Controls(quiet)

        def say(text: str) -> None:
            if text.startswith("  ") and text.endswith(" s"):  # how a trial ended
                controls.type("q")

        run_simulated(study, number, say, controls)

    one_more()
    finished = check_session(study, 0, 1)
    contents = backup._contents

    def while_trials_end(folder: Path) -> Iterator[tuple[str, bytes]]:
        """Once the journals have been read, a trial ends, and somebody else begins."""
        for name, data in contents(folder):
            yield name, data
            if name.endswith("S001/journal.jsonl"):
                one_more()
                one_more(1)

    monkeypatch.setattr(backup, "_contents", while_trials_end)
    found = back_up(study, tmp_path / "b.tar.gz")
    assert found.trials == finished and len(found.ppids) == 1 < len(study.participants())
    monkeypatch.undo()
    assert check_session(study, 0, finished + 1) > finished
    shutil.unpack_archive(tmp_path / "b.tar.gz", tmp_path / "again")
    restored = StudyFolder(tmp_path / "again", design(), SIMULATED)
    assert check_session(restored, 0, finished) == finished
    assert run_simulated(restored, 0, quiet) is SessionOutcome.COMPLETE
    assert check_session(restored, 0, TRIALS) == TRIALS
    assert run_simulated(restored, 1, quiet) is SessionOutcome.COMPLETE
    assert audit(restored.path).findings.sound


def test_equal_studies_make_equal_archives_and_none_is_written_over(
    study: StudyFolder, tmp_path: Path
) -> None:
    back_up(study, tmp_path / "a.tar.gz")
    back_up(study, tmp_path / "b.tar.gz")
    assert (tmp_path / "a.tar.gz").read_bytes() == (tmp_path / "b.tar.gz").read_bytes()
    with pytest.raises(StudyError, match="exists already"):
        back_up(study, tmp_path / "a.tar.gz")
    with pytest.raises(StudyError, match="inside the study folder"):
        back_up(study, study.path / "backups/c.tar.gz")


def test_damage_anywhere_in_a_backup_is_found(study: StudyFolder, tmp_path: Path) -> None:
    archive = tmp_path / "a.tar.gz"
    back_up(study, archive)
    data = archive.read_bytes()
    # The last bytes are padding and sums, which reading the files does not come to.
    for i in [*range(20, len(data), len(data) // 25), *range(len(data) - 12, len(data))]:
        (tmp_path / "bad.tar.gz").write_bytes(data[:i] + bytes([data[i] ^ 0x55]) + data[i + 1 :])
        with pytest.raises(StudyError):
            check_backup(tmp_path / "bad.tar.gz")
        (tmp_path / "bad.tar.gz").write_bytes(data[:i])
        with pytest.raises(StudyError):
            check_backup(tmp_path / "bad.tar.gz")


def test_a_backup_without_a_finished_trials_recording_is_refused(
    study: StudyFolder, tmp_path: Path
) -> None:
    next(study.path.glob("*/S001/trials/T003.jsonl.gz")).unlink()
    with pytest.raises(StudyError, match="recordings of finished trials are missing"):
        back_up(study, tmp_path / "a.tar.gz")
    assert not list(tmp_path.glob("*.tar.gz"))


def site(out: Path, people: list[int], seed: str = "seed = 3") -> StudyFolder:
    found = StudyFolder(out, design(DESIGN.replace("seed = 3", seed)), SIMULATED)
    for number in people:
        run_simulated(found, number, quiet)
    return StudyFolder.at(found.path)


def test_two_sites_become_one_study_that_opens_resumes_and_counts_everybody_once(
    two: Path, study: StudyFolder, tmp_path: Path
) -> None:
    other = site(tmp_path / "b", [0])
    before = {p: p.read_bytes() for p in other.path.rglob("*") if p.is_file()}
    found = merge(study, other, tmp_path / "c/quick-simulated")
    assert found.people == 3 and not found.renamed and not found.both
    merged = StudyFolder(tmp_path / "c", design(), SIMULATED)
    assert {p.ppid for p in merged.participants()} == {
        p.ppid for s in (study, other) for p in s.participants()
    }
    rows = rows_of(merged.path / "trial_results.csv")
    assert len(rows) == 3 * TRIALS and all(r["counted"] == "1" for r in rows)
    assert [r["site"] for r in rows_of(merged.path / "sites.csv")] == ["A", "A", "B"]
    for person in merged.participants():
        with SessionFolder(merged, person) as session:
            assert session.state.complete
    assert {p: p.read_bytes() for p in before} == before
    with pytest.raises(StudyError, match="exists already"):
        merge(study, other, tmp_path / "c/quick-simulated")


def test_two_people_of_one_pseudonym_stay_two_people(study: StudyFolder, tmp_path: Path) -> None:
    other = site(tmp_path / "b", [0])
    mine, theirs = study.participants()[0].ppid, other.participants()[0].ppid
    # The chance of this is one in 33 million for each pair.
    (other.path / theirs).rename(other.path / mine)
    for path in (other.path / "study.jsonl", *session_path(other.path, mine).rglob("*.jsonl*")):
        data = read_stored(path).data.replace(theirs.encode(), mine.encode())
        if path.name in ("study.jsonl", "journal.jsonl"):
            data = journal_bytes([json.loads(line) for line in data.splitlines()])
        path.write_bytes(packed(data) if path.suffix == ".gz" else data)
    found = merge(study, other, tmp_path / "c/quick-simulated")
    ((_, new),) = found.renamed.items()
    assert found.people == 3 and new not in (mine, theirs)
    path = session_path(tmp_path / "c/quick-simulated", new)
    assert SessionState.of(read_journal(path / "journal.jsonl")).start["ppid"] == new
    recording = load_recording(path / "trials/T001.jsonl")
    assert recording.header["study"]["ppid"] == new and not recording.damage
    merged = StudyFolder(tmp_path / "c", design(), SIMULATED)
    with SessionFolder(merged, merged.find(new)) as session:
        assert session.state.complete


def test_who_is_in_both_folders_is_taken_once_from_where_they_went_further(
    tmp_path: Path,
) -> None:
    site(tmp_path / "a", [0])
    shutil.copytree(tmp_path / "a", tmp_path / "b")
    later = StudyFolder(tmp_path / "b", design(), SIMULATED)
    with SessionFolder(later, later.participants()[0]) as session:
        session.write("note", text="went on here", trial=None)
    folders = [StudyFolder.at(tmp_path / x / "quick-simulated") for x in "ab"]
    for i, (first, second) in enumerate((folders, folders[::-1])):
        found = merge(first, second, tmp_path / f"c{i}/quick-simulated")
        assert found.people == 1 and found.both == [later.participants()[0].ppid]
        path = session_path(tmp_path / f"c{i}/quick-simulated", found.both[0])
        assert "went on here" in (path / "journal.jsonl").read_text()
    with SessionFolder(
        StudyFolder(tmp_path / "a", design(), SIMULATED), later.participants()[0]
    ) as session:
        session.write("note", text="and elsewhere, too", trial=None)
    with pytest.raises(StudyError, match="continued at both sites"):
        merge(folders[0], folders[1], tmp_path / "d")


def test_who_withdraws_from_a_merged_study_is_gone_from_what_tells_of_the_sites(
    study: StudyFolder, tmp_path: Path
) -> None:
    gone, stays = (p.ppid for p in study.participants())
    shutil.copytree(study.path, tmp_path / "b/quick-simulated")
    merge(study, StudyFolder.at(tmp_path / "b/quick-simulated"), tmp_path / "c/quick-simulated")
    merged = StudyFolder.at(tmp_path / "c/quick-simulated")
    journal = merged.path / "study.jsonl"
    assert len(mentions(merged.path, gone)) > 10 and journal.read_text().count(gone) > 1
    assert not withdraw(merged, gone, "").still
    assert mentions(merged.path, gone) == [journal]
    assert journal.read_text().count(gone) == 1
    assert {r["ppid"] for r in rows_of(merged.path / "sites.csv")} == {stays}


def test_who_withdrew_at_one_site_does_not_come_back_from_the_other(
    study: StudyFolder, two: Path, tmp_path: Path
) -> None:
    gone = study.participants()[0].ppid
    withdraw(study, gone, "")
    found = merge(study, StudyFolder.at(two / "quick-simulated"), tmp_path / "c")
    assert found.left_out == [gone] and found.people == 1
    assert mentions(tmp_path / "c", gone) == [tmp_path / "c/study.jsonl"]


def test_other_studies_and_other_kinds_of_data_are_not_merged(
    study: StudyFolder, tmp_path: Path
) -> None:
    with pytest.raises(StudyError, match="different designs"):
        merge(study, site(tmp_path / "b", [], "seed = 4"), tmp_path / "c")
    pilot = StudyFolder(tmp_path / "b", design(), PILOT)
    with pytest.raises(StudyError, match="different kinds of data"):
        merge(study, StudyFolder.at(pilot.path), tmp_path / "c")
    with pytest.raises(StudyError, match="same folder"):
        merge(study, StudyFolder.at(study.path), tmp_path / "c")
    path = study.path / "study.json"
    other = site(tmp_path / "d", [])
    path.write_text(path.read_text().replace('"program": "', '"program": "0'))
    with pytest.raises(StudyError, match="different programs"):
        merge(StudyFolder.at(study.path), other, tmp_path / "c")
    assert not (tmp_path / "c").exists()
    merge(StudyFolder.at(study.path), other, tmp_path / "c", "a later patch")
    assert read_journal(tmp_path / "c/study.jsonl")[1]["reason"] == "a later patch"
