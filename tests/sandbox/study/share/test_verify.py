"""Whatever is changed in a study's folder is named; what kills, people and copies leave is not."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.recording.recording import read_stored
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import HASH, chained_bytes, read_journal
from sandbox.study.record.notes import SEALED, read_notes, write_notes
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.simulated_study import run_simulated, simulated_person
from sandbox.study.share.verify import (
    FRAMES,
    GONE,
    PLANS,
    RECORDINGS,
    SEALS,
    TABLES,
    Verified,
    verify,
)
from sandbox.study.share.withdraw import withdraw
from sandbox.study.tables.tables import make_tables
from tests.support.study_driver import verify as findings
from tests.support.study_files import design, first_session, quiet


def quick(path: Path) -> Verified:
    """Verifies a study without replays."""
    return verify(path, replays=False)


def named(study: StudyFolder, path: Path) -> bool:
    """True if a verification names a file, or refuses the study for it."""
    name = path.relative_to(study.path).as_posix()
    person = name.partition("/")[0] if name.endswith("notes.jsonl") else name
    try:
        lines = findings(study.path)
    except StudyError as error:
        return path.name in str(error) or path.parent.name in str(error)
    return any(line.startswith((f"{name}:", f"{name},", f"{person}:")) for line in lines)


def is_record(path: Path) -> bool:
    """True for a file that is not a lock's, and of whose content the records tell."""
    return path.name not in (".lock", ".tables.json") and not path.name.endswith(".frames.csv.gz")


def test_one_bit_anywhere_is_found_and_the_file_is_named(study: StudyFolder) -> None:
    files = sorted(p for p in study.path.rglob("*") if p.is_file() and is_record(p))
    rng = np.random.default_rng(18)
    for path in rng.permutation(np.array(files, dtype=object)):
        data = path.read_bytes()
        changed = bytearray(data)
        changed[int(rng.integers(len(data)))] ^= 1 << int(rng.integers(8))
        if path.name in ("notes.jsonl", "A.jsonl"):
            # Times of notes, and words in them, are no part of what is verified.
            other = data.replace(b'"number":', b'"nunber":').replace(b'"hash":', b'"hush":')
            changed = bytearray(other)
        path.write_bytes(changed)
        assert named(study, path), path
        path.write_bytes(data)
    assert findings(study.path) == []


def test_every_file_that_is_deleted_is_named(study: StudyFolder) -> None:
    for path in sorted(p for p in study.path.rglob("*") if p.is_file() and is_record(p)):
        if path.suffix == ".csv":
            # Tables are derived, and may be deleted.
            continue
        data = path.read_bytes()
        path.unlink()
        assert named(study, path), path
        path.write_bytes(data)


def flipped(lines: list[bytes]) -> list[bytes]:
    return [line.replace(b'"success":false', b'"success":true') for line in lines]


def test_a_recording_of_another_trial_and_one_too_many_are_named(study: StudyFolder) -> None:
    trials = first_session(study) / "trials"
    one, other = trials / "T002.jsonl.gz", trials / "T003.jsonl.gz"
    shutil.copyfile(one, trials / "T009.jsonl.gz")
    shutil.copyfile(other, one)
    lines = [str(finding) for finding in quick(study.path).found[RECORDINGS]]
    assert any("T002.jsonl.gz: changed" in line for line in lines)
    assert any("T009.jsonl.gz: a whole recording without a record" in line for line in lines)
    assert len(lines) == 2


def test_a_recording_that_was_compressed_anew_is_the_same(study: StudyFolder) -> None:
    path = first_session(study) / "trials/T002.jsonl.gz"
    path.with_name("T002.jsonl").write_bytes(read_stored(path).data)
    path.unlink()
    assert quick(study.path).found[RECORDINGS] == []


def test_frames_and_tables_that_were_changed_by_hand_are_named(study: StudyFolder) -> None:
    frames = first_session(study) / "trials/T001.frames.csv.gz"
    shutil.copyfile(frames.with_name("T002.frames.csv.gz"), frames)
    table = study.path / "tables/participants.csv"
    table.write_text(table.read_text().replace("right", "left"))
    done = verify(study.path)
    assert [Path(f.path).name for f in done.found[FRAMES]] == [frames.name]
    # Measures follow from the frames.
    names = ["tables/participants.csv", "tables/trials.csv"]
    assert [f.path for f in done.found[TABLES]] == names
    # Tables are made again from frames, and the missing ones from recordings.
    frames.unlink()
    assert main(["study", "tables", str(study.path)]) == 0
    assert verify(study.path).sound


def test_a_seal_that_was_kept_elsewhere_tells_a_record_that_was_written_anew(
    study: StudyFolder, tmp_path: Path
) -> None:
    kept = tmp_path / "seals.jsonl"
    shutil.copyfile(study.notes, kept)
    printed = read_journal(first_session(study) / "session.jsonl")[-1][HASH]
    forge(study)
    assert main(["replay", str(study.path), "--verify"]) == 0
    assert read_journal(first_session(study) / "session.jsonl")[-1][HASH] != printed
    assert main(["replay", str(study.path), "--verify", "--seals", str(kept)]) == 1
    finding = verify(study.path, kept, False).found[SEALS][0]
    assert "not the line that was sealed" in str(finding)


@pytest.mark.parametrize("content", [None, b"", b'{"time":"2026-01-01T00:00:00+00:00"'])
def test_a_copy_of_seals_without_a_seal_is_refused(
    study: StudyFolder, tmp_path: Path, content: bytes | None
) -> None:
    copy = tmp_path / "seals.jsonl"
    if content is not None:
        copy.write_bytes(content)
    with pytest.raises(StudyError, match="no seals") as error:
        verify(study.path, copy, False)
    assert error.value.where == str(copy)


def test_a_session_without_its_seal_is_named(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    notes = read_notes(study.notes)
    write_notes(study.notes, [note for note in notes if note["kind"] != SEALED])
    assert len(quick(study.path).found[SEALS]) == 2
    assert main(["study", "tables", str(study.path)]) == 0
    assert capsys.readouterr().out.count("session 1: no seal") == 2


def test_a_number_or_an_order_that_is_not_that_of_the_design_is_named(study: StudyFolder) -> None:
    ppid = study.participants()[0].ppid
    path = study.path / ppid / "notes.jsonl"
    notes = read_notes(path)
    write_notes(path, [{**notes[0], "number": 5}])
    assert "number" in str(quick(study.path).found[PLANS][0])
    write_notes(path, notes)
    record = first_session(study) / "session.jsonl"
    records = read_journal(record)
    start = next(r for r in records if r["kind"] == "trial")
    start["seed"] += 1
    record.write_bytes(chained_bytes(records))
    assert "another seed" in str(quick(study.path).found[PLANS][0])


def test_attempts_that_a_kill_broke_off_are_no_error_before_and_after_the_next_opening(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = StudyFolder(tmp_path, design(), SIMULATED)
    run_simulated(study, 1, quiet)
    person = study.add(2, **simulated_person(study.design, 2))
    source = first_session(study) / "trials/T001.jsonl"
    for part in (b"", read_stored(source).data[:4000]):
        with SessionFolder(study, person) as session:
            trial = next(s for s in session.steps if s.id == "trial:1")
            recording = session.begin(trial)  # type: ignore[arg-type]
            recording.write_bytes(part)
        assert main(["study", "tables", str(study.path)]) == 0
        assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out
    assert main(["replay", str(study.path)]) == 0
    run_simulated(study, 2, quiet)
    assert main(["replay", str(study.path), "--verify"]) == 0, capsys.readouterr().out
    # The part that was left of an attempt has a digest now.
    (session_path(study.path, person.ppid) / "trials/T001.jsonl").write_bytes(b"x")
    assert "T001.jsonl: changed" in str(quick(study.path).found[RECORDINGS][0])


def test_a_withdrawal_leaves_a_study_that_passes_and_their_folder_may_not_come_back(
    study: StudyFolder, tmp_path: Path
) -> None:
    gone = study.participants()[0].ppid
    shutil.copytree(study.path / gone, tmp_path / gone)
    withdraw(study, gone)
    assert findings(study.path) == []
    shutil.copytree(tmp_path / gone, study.path / gone)
    assert [f.path for f in quick(study.path).found[GONE]] == [gone]
    assert gone not in {person.ppid for person in study.participants()}


def test_two_sites_are_merged_by_copying_and_copying_twice_changes_nothing(
    study: StudyFolder, tmp_path: Path
) -> None:
    other = StudyFolder(tmp_path / "b", design(), SIMULATED, site="B")
    run_simulated(other, 1, quiet)
    for _ in range(2):
        for path in other.path.iterdir():
            if path.is_dir():
                shutil.copytree(path, study.path / path.name, dirs_exist_ok=True)
    make_tables(study)
    assert findings(study.path) == []
    people = [(p.site, p.number) for p in study.participants()]
    assert sorted(people) == [("A", 1), ("A", 2), ("B", 1)]
    # Each site goes on with its own numbers.
    for site, number in (("A", 3), ("B", 2)):
        merged = StudyFolder(study.path.parent, design(), SIMULATED, site=site)
        assert merged.add().number == number


def forge(study: StudyFolder) -> None:
    """Turns failures into successes, and computes every hash and table anew."""
    heads = {}
    for path in study.path.glob("*/S001/session.jsonl"):
        data = b"".join(flipped(path.read_bytes().splitlines(keepends=True)))
        path.write_bytes(chained_bytes(json.loads(line) for line in data.splitlines()))
        heads[path.parent.parent.name] = read_journal(path)[-1][HASH]
    notes = read_notes(study.notes)
    write_notes(
        study.notes, [{**n, HASH: heads[n["ppid"]]} if n["kind"] == SEALED else n for n in notes]
    )
    make_tables(study)
