"""Whatever is changed in a study's folder is named; what kills, people and copies leave is not."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.recording.recording import read_stored
from sandbox.study.audit.audit import Audit, audit
from sandbox.study.audit.findings import Kind
from sandbox.study.audit.witness import read_witnesses
from sandbox.study.record.chain import chained_bytes, without_chain
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import Journal, read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.simulate import run_simulated, simulate, simulated_person
from sandbox.study.share.backup import back_up
from sandbox.study.share.export_log import log_copy
from sandbox.study.share.merge import merge
from sandbox.study.share.privacy import Masking, anonymise
from sandbox.study.share.withdraw import withdraw
from sandbox.study.tables.tables import LOG, SOURCES, log_bytes, rebuild_all
from tests.support.study_files import DESIGN, TRIALS, design

WITNESS = "witness.jsonl"


def quiet(text: str) -> None:
    """Nobody listens."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("made")
    simulate(StudyFolder(out, design(), SIMULATED), 2, False, quiet, out / WITNESS)
    return out


@pytest.fixture
def study(made: Path, tmp_path: Path) -> StudyFolder:
    shutil.copytree(made, tmp_path / "out")
    return StudyFolder.at(tmp_path / "out/quick-simulated")


def first(study: StudyFolder) -> Path:
    """The session of the first participant."""
    return session_path(study.path, study.participants()[0].ppid)


def told(found: Audit) -> list[str]:
    """All findings as lines."""
    return [str(finding) for finding in found.findings.found]


def test_a_study_as_it_was_written_passes_and_what_was_compared_is_counted(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(study.path), "--verify"]) == 0
    said = capsys.readouterr().out
    for count in (f"{2 * TRIALS} recordings compared", f"{2 * TRIALS} recordings replayed"):
        assert count in said
    assert told(audit(study.path)) == [] and audit(study.path).findings.notes == []


def test_one_bit_anywhere_is_found_and_the_file_is_named(study: StudyFolder) -> None:
    files = sorted(p for p in study.path.rglob("*") if p.is_file() and p.name != ".lock")
    rng = np.random.default_rng(18)
    for path in rng.permutation(np.array(files, dtype=object)):
        data = path.read_bytes()
        changed = bytearray(data)
        changed[int(rng.integers(len(data)))] ^= 1 << int(rng.integers(8))
        path.write_bytes(changed)
        found = audit(study.path)
        name = path.relative_to(study.path).as_posix()
        assert any(finding.path == name for finding in found.findings.found), told(found)
        path.write_bytes(data)
    assert told(audit(study.path)) == []


def test_every_file_that_is_deleted_is_named(study: StudyFolder) -> None:
    for path in sorted(p for p in study.path.rglob("*") if p.is_file() and p.name != ".lock"):
        data = path.read_bytes()
        path.unlink()
        name = path.relative_to(study.path).as_posix()
        found = audit(study.path).findings.found
        assert [f for f in found if f.path == name and f.kind == Kind.MISSING], name
        path.write_bytes(data)


def swapped(lines: list[bytes]) -> list[bytes]:
    return [*lines[:4], lines[5], lines[4], *lines[6:]]


def flipped(lines: list[bytes]) -> list[bytes]:
    return [line.replace(b'"success":false', b'"success":true') for line in lines]


JOURNALS: list[tuple[Callable[[list[bytes]], list[bytes]], Kind, int]] = [
    (lambda lines: [*lines[:7], *lines[9:]], Kind.MISSING, 8),
    (swapped, Kind.REORDERED, 6),
    (lambda lines: [*lines[:9], lines[3], *lines[9:]], Kind.REORDERED, 10),
    (lambda lines: lines[:-4], Kind.MISSING, 0),
]


@pytest.mark.parametrize(("change", "kind", "line"), JOURNALS)
def test_records_that_are_gone_moved_or_written_twice_are_named_with_their_line(
    study: StudyFolder, change: Callable[[list[bytes]], list[bytes]], kind: Kind, line: int
) -> None:
    path = first(study) / "journal.jsonl"
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(change(lines)))
    found = [f for f in audit(study.path).findings.found if f.path.endswith("S001/journal.jsonl")]
    assert (kind, line or len(lines) - 3) in {(f.kind, f.line) for f in found}, found


def test_a_result_that_was_changed_is_named_and_nothing_goes_on_with_it(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    path = next(
        p for p in study.path.glob("*/S001/journal.jsonl") if b'"success":false' in p.read_bytes()
    )
    lines = path.read_bytes().splitlines(keepends=True)
    number = next(i for i, line in enumerate(lines, start=1) if b'"success":false' in line)
    path.write_bytes(b"".join(flipped(lines)))
    assert main(["replay", str(study.path), "--verify"]) == 1
    assert f"S001/journal.jsonl, line {number}: changed" in capsys.readouterr().out
    with pytest.raises(StudyError, match="changed after it was written"):
        StudyFolder.at(study.path) and read_journal(path)
    with pytest.raises(StudyError, match="changed after it was written"):
        Journal(path)


def test_a_recording_of_another_trial_and_one_too_many_are_named(study: StudyFolder) -> None:
    trials = first(study) / "trials"
    one, other = trials / "T002.jsonl.gz", trials / "T003.jsonl.gz"
    shutil.copyfile(one, trials / "T009.jsonl.gz")
    shutil.copyfile(other, one)
    assert {(f.kind, Path(f.path).name) for f in audit(study.path).findings.found} == {
        (Kind.CHANGED, one.name),
        (Kind.ORPHANED, "T009.jsonl.gz"),
    }


def test_a_recording_that_was_compressed_anew_is_told_from_one_with_other_content(
    study: StudyFolder,
) -> None:
    path = first(study) / "trials/T002.jsonl.gz"
    whole = bytearray(path.read_bytes())
    whole[4] ^= 1
    path.write_bytes(whole)
    (line,) = told(audit(study.path))
    assert "the compressed file is another one; its content is" in line
    path.with_name("T002.jsonl").write_bytes(read_stored(path).data)
    path.unlink()
    found = [f.path for f in audit(study.path).findings.found]
    # The tables name the file by its whole name; the recording itself is the same.
    assert all(name.endswith("trial_results.csv") for name in found)


def test_attempts_that_a_kill_broke_off_are_no_error_before_and_after_the_next_opening(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = StudyFolder(tmp_path, design(), SIMULATED)
    run_simulated(study, 0, quiet)
    person = study.add(1, **simulated_person(study.design, 1))
    source = first(study) / "trials/T001.jsonl"
    for count, part in enumerate((b"", read_stored(source).data[:4000]), start=1):
        with SessionFolder(study, person) as session:
            trial = next(s for s in session.steps if s.id == "trial:1")
            recording = session.begin(trial)  # type: ignore[arg-type]
            recording.write_bytes(part)
        assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out
        assert f"{count} attempts that were broken off" in capsys.readouterr().out
    assert main(["replay", str(study.path)]) == 0
    run_simulated(study, 1, quiet)
    assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out
    # What was left of an attempt has a digest now.
    (session_path(study.path, person.ppid) / "trials/T001.jsonl").write_bytes(b"x")
    (line,) = told(audit(study.path))
    assert "T001.jsonl: changed" in line


def test_a_withdrawal_leaves_a_chain_that_is_accepted_and_counted(
    study: StudyFolder, made: Path
) -> None:
    gone = study.participants()[0].ppid
    log_copy(study, "backup", made / "b.tar.gz", [gone])
    withdraw(study, gone, "by phone")
    witnesses = {WITNESS: read_witnesses(made / WITNESS)}
    found = audit(study.path, witnesses)
    assert told(found) == []
    assert found.findings.counts["participants who have withdrawn"] == 1
    assert found.findings.counts["records that a withdrawal has replaced"] == 3
    assert found.findings.counts["witnesses of participants who have withdrawn"] == 1
    path = study.path / "study.jsonl"
    data = path.read_bytes()
    path.write_bytes(data.replace(b'"reason":"by phone"', b'"reason":"by email"'))
    assert "study.jsonl, line 2: changed" in told(audit(study.path))[0]


def test_an_anonymous_copy_is_accepted_and_counted_with_and_without_recordings(
    study: StudyFolder, tmp_path: Path
) -> None:
    for name, recordings in (("with", True), ("without", False)):
        anonymise(study, tmp_path / name, Masking(recordings=recordings, hands=True), quiet)
        found = audit(tmp_path / name)
        assert told(found) == [] and found.findings.notes == []
        assert found.findings.counts["anonymous copy"] == 1
        assert len(found.finished) == (2 * TRIALS if recordings else 0)
        lacks = found.findings.counts["recordings that an anonymous copy lacks"]
        assert lacks == (0 if recordings else 2 * TRIALS)
        about = tmp_path / name / "anonymised.json"
        about.write_text(about.read_text().replace('"participants": 2', '"participants": 3'))
        assert "anonymised.json, line 2: changed" in told(audit(tmp_path / name))[0]


def test_a_merged_study_keeps_the_chains_of_both_and_what_their_witnesses_know(
    study: StudyFolder, made: Path, tmp_path: Path
) -> None:
    other = StudyFolder(tmp_path / "b", design(), SIMULATED)
    run_simulated(other, 0, quiet, witness=tmp_path / "other")
    merge(study, other, tmp_path / "c/quick-simulated")
    witnesses = {p.name: read_witnesses(p) for p in (made / WITNESS, tmp_path / "other")}
    found = audit(tmp_path / "c/quick-simulated", witnesses)
    assert told(found) == [] and found.findings.counts["merged sites"] == 2
    assert found.findings.counts["witnesses compared"] == 3
    assert len(found.finished) == 3 * TRIALS
    merged = StudyFolder(tmp_path / "c", design(), SIMULATED)
    gone = merged.participants()[0].ppid
    withdraw(merged, gone, "")
    assert told(audit(merged.path, witnesses)) == []


def test_a_backup_that_is_unpacked_passes(study: StudyFolder, tmp_path: Path) -> None:
    log_copy(study, "backup", tmp_path / "b.tar.gz", back_up(study, tmp_path / "b.tar.gz").ppids)
    assert told(audit(study.path)) == []
    (tmp_path / "back").mkdir()
    # The program that people unpack with; Python's own needs an argument that 3.11.2 lacks.
    subprocess.run(["tar", "-xzf", tmp_path / "b.tar.gz", "-C", tmp_path / "back"], check=True)
    found = audit(tmp_path / "back/quick-simulated")
    assert told(found) == [] and found.findings.notes == [
        "SHA256SUMS: not a part of the study's record"
    ]
    # It can go on there, backups included.
    again = back_up(StudyFolder.at(tmp_path / "back/quick-simulated"), tmp_path / "c.tar.gz")
    assert again.trials == 2 * TRIALS


def test_tables_that_a_report_built_anew_after_a_kill_pass(
    study: StudyFolder, tmp_path: Path
) -> None:
    # A killed program left the tables of a session, and of the study, with what there was before.
    log, sources = first(study) / LOG, study.path / SOURCES
    records = read_journal(first(study) / "journal.jsonl")[:8]
    log.write_bytes(log_bytes(records))
    sizes = json.loads(sources.read_bytes())
    name = f"{first(study).parent.name}/{first(study).name}"
    with (first(study) / "journal.jsonl").open("rb") as journal:
        sizes[name] = sum(len(journal.readline()) for _ in records)
    sources.write_bytes(json.dumps(sizes).encode())
    assert main(["study", "report", str(study.path), "--out", str(tmp_path / "report")]) == 0
    assert told(audit(study.path)) == []


def forge(study: StudyFolder) -> None:
    """Turns failures into successes, and computes every digest and table anew."""
    heads = {}
    for path in study.path.glob("*/S001/journal.jsonl"):
        data = b"".join(flipped(path.read_bytes().splitlines(keepends=True)))
        path.write_bytes(chained_bytes(without_chain(json.loads(x)) for x in data.splitlines()))
        heads[path.parent.parent.name] = read_journal(path)[-1]["digest"]
    records = study.records()
    for record in records:
        if record["kind"] == "sealed":
            record["digest_of_last"] = heads[record["ppid"]]
    (study.path / "study.jsonl").write_bytes(chained_bytes(records))
    rebuild_all(study)


def test_who_computes_the_whole_chain_anew_is_found_by_a_witness(
    study: StudyFolder, made: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    witness = str(made / WITNESS)
    assert main(["replay", str(study.path), "--verify", "--witness", witness]) == 0
    forge(study)
    capsys.readouterr()
    assert main(["replay", str(study.path), "--verify"]) == 0
    assert main(["replay", str(study.path), "--verify", "--witness", witness]) == 1
    said = capsys.readouterr().out
    assert "S001/journal.jsonl, line 24: changed" in said and "study.jsonl, line" in said


def test_what_is_no_witness_is_bad_input(study: StudyFolder, tmp_path: Path) -> None:
    for content in (b"", b"{}\n", b"\xff\n"):
        (tmp_path / "w").write_bytes(content)
        line = ["replay", str(study.path), "--verify", "--witness", str(tmp_path / "w")]
        assert main(line) == 2
    assert main(["replay", str(study.path), "--verify", "--witness", "nowhere"]) == 2
    (tmp_path / "w").write_bytes(b"")
    assert main(["replay", str(study.path), "--witness", str(tmp_path / "w")]) == 2


def test_digests_and_witnesses_are_those_that_the_session_said(made: Path) -> None:
    study = StudyFolder.at(made / "quick-simulated")
    said = [r["digest_of_last"] for r in study.records() if r["kind"] == "sealed"]
    known = [w.digest for w in read_witnesses(made / WITNESS) if w.journal != "study.jsonl"]
    assert said == known and len(known) == 2


def test_a_design_with_another_comment_is_another_design(study: StudyFolder) -> None:
    path = study.path / "design.toml"
    path.write_text(DESIGN + "# nothing\n")
    assert any("design.toml: changed" in line for line in told(audit(study.path)))
