"""A session is written down whole, and nothing in it is mixed up or written over."""

from __future__ import annotations

import csv
import gzip
import io
import json
from fnmatch import fnmatch
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.recording.recording import load_recording, read_stored
from sandbox.study.record import build as build_module
from sandbox.study.record.folder import PILOT, REAL, SIMULATED, StudyFolder
from sandbox.study.record.journal import Journal, journal_bytes, now, parse_records, read_journal
from sandbox.study.record.notes import write_notes
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulate import run_simulated, simulated_person
from sandbox.study.tables.column import csv_bytes
from sandbox.study.tables.tables import make_tables
from sandbox.trial.replay import replay
from tests.support.study_files import DESIGN, TRIALS, design, open_study, pilot, quiet, rows_of


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    study = open_study(tmp_path_factory.mktemp("study"))
    assert run_simulated(study, 1, quiet) is SessionOutcome.COMPLETE
    make_tables(study)
    return study


def test_every_trial_has_one_row_one_recording_and_its_tables(finished: StudyFolder) -> None:
    rows = rows_of(finished.path / "tables/trials.csv")
    assert [int(r["trial"]) for r in rows] == list(range(1, TRIALS + 1))
    assert list(rows[0])[:5] == ["study", "mode", "site", "participant", "number"]
    for row in rows:
        recording = load_recording(finished.path / row["recording"])
        assert not recording.damage and recording.end is not None
        assert recording.end["result"]["state_hash"] == row["state_hash"]
        assert recording.header["study"]["ppid"] == row["participant"]
        with gzip.open(finished.path / row["frames"], "rt") as file:
            head, *frames = csv.reader(file)
        assert len(frames) == round(recording.end["step"] * 0.002 / 0.016)
        assert sum(name.startswith("q_") for name in head) == 48


def test_every_column_of_the_frames_is_in_the_codebook(finished: StudyFolder) -> None:
    book = rows_of(finished.path / "tables/codebook.csv")
    patterns = [r["column"] for r in book if r["table"] == "trials/*.frames.csv.gz"]
    frames = next(finished.path.glob("*/S001/trials/*.frames.csv.gz"))
    for name in gzip.decompress(frames.read_bytes()).decode().splitlines()[0].split(","):
        assert any(fnmatch(name, p.replace("OBJECT", "*")) for p in patterns), name


def test_answers_are_there_once_each(finished: StudyFolder) -> None:
    rows = rows_of(finished.path / "tables/answers.csv")
    assert [r["instrument"] for r in rows] == ["demographics", "effort", "effort"]
    assert {r["factor_contact"] for r in rows[1:]} == {"hard", "soft"}
    person = rows_of(finished.path / "tables/participants.csv")[0]
    assert person["age"] == rows[0]["answer"] and person["complete"] == "1"


def test_a_journal_that_lost_the_end_of_a_trial_is_completed_from_the_recording(
    tmp_path: Path,
) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 1, quiet)
    path = next(study.path.glob("*/S001/session.jsonl"))
    lines = path.read_bytes().splitlines(keepends=True)
    last = max(i for i, line in enumerate(lines) if b'"kind":"trial_end"' in line)
    # What a power cut may take; tables and the seal are written after that.
    path.write_bytes(b"".join(lines[:last]))
    write_notes(study.notes, [note for note in study.records() if note["kind"] != "sealed"])
    recording = read_stored(path.parent / "trials/T006.jsonl").data
    assert run_simulated(study, 1, quiet) is SessionOutcome.COMPLETE
    rows = rows_of(study.path / "tables/trials.csv")
    assert [r["trial"] for r in rows if r["counted"] == "1"] == list("123456")
    assert rows[-1]["recording"].endswith("S001/trials/T006.jsonl.gz")
    assert read_stored(path.parent / "trials/T006.jsonl").data == recording


def contents(study: Path) -> dict[str, bytes]:
    """What is in the files of a study."""
    files = (path for path in study.rglob("*") if path.is_file())
    return {path.relative_to(study).as_posix(): path.read_bytes() for path in files}


def test_to_resume_a_study_that_is_complete_adds_nothing_and_says_what_to_do_next(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "design.toml").write_text(DESIGN)
    simulated = ["study", "simulate", str(tmp_path / "design.toml"), "--out", str(tmp_path)]
    assert main([*simulated, "--participants", "1"]) == 0
    folder = tmp_path / "quick-simulated"
    first = contents(folder)
    capsys.readouterr()
    for _ in range(2):
        assert main([*simulated, "--participants", "1", "--resume"]) == 0
        (line,) = [x for x in capsys.readouterr().out.splitlines() if "nothing was played" in x]
        assert f"sandbox study report {folder}" in line and "--participants 2 or more" in line
        assert contents(folder) == first
    assert main([*simulated, "--resume"]) == 0
    said = capsys.readouterr().out
    assert "participant 1 of 2: complete already" in said
    assert "participant 2 of 2: complete\n" in said and "nothing was played" not in said


def test_to_run_a_session_that_is_complete_adds_nothing_unless_files_of_it_are_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    (tmp_path / "design.toml").write_text(DESIGN)
    study = open_study(tmp_path, mode=PILOT)
    run_simulated(study, 1, quiet)
    person = study.participants()[0].ppid
    run = [*pilot(tmp_path / "design.toml"), "--participant", person]
    first = contents(study.path)
    for more in ([], ["--resume"]):
        capsys.readouterr()
        assert main([*run, *more]) == 0
        said = capsys.readouterr().out
        assert f"{person}: complete, so nothing was played" in said
        assert f"sandbox study report {study.path}; the next person: --participant new" in said
        assert contents(study.path) == first
    # What a killed program has left is still completed, and then the journal says who did it.
    folder = session_path(study.path, person)
    packed = folder / "trials/T001.jsonl.gz"
    stray = packed.with_name("T001.a2.jsonl.gz")
    stray.write_bytes(packed.read_bytes()[:200])
    assert main(run) == 0
    added = read_journal(folder / "session.jsonl")[-2:]
    assert [record["kind"] for record in added] == ["resume", "repaired"]


@given(cut=st.integers(0, 10_000), tail=st.binary(max_size=20))
def test_a_journal_cut_anywhere_keeps_every_whole_record(
    tmp_path_factory: pytest.TempPathFactory, cut: int, tail: bytes
) -> None:
    path = tmp_path_factory.mktemp("journal") / "session.jsonl"
    journal = Journal(path)
    for i in range(8):
        journal.append("command", command="note", text=f"ü {i}")
    journal.close()
    whole = path.read_bytes()
    data = whole[: cut % (len(whole) + 1)]
    path.write_bytes(data + tail.replace(b"\n", b""))
    again = Journal(path)
    kept = data.count(b"\n")
    assert [r["text"] for r in again.records if r.get("command") == "note"][:kept] == [
        f"ü {i}" for i in range(kept)
    ]
    again.append("command", command="note", text="after")
    again.close()
    records = read_journal(path)
    assert [r["n"] for r in records] == list(range(len(records)))
    assert records[-1]["text"] == "after"


def test_damage_in_the_middle_of_a_journal_is_refused_and_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "session.jsonl"
    journal = Journal(path)
    for i in range(3):
        journal.append("command", command="note", text=str(i))
    journal.close()
    lines = path.read_bytes().split(b"\n")
    path.write_bytes(b"\n".join([lines[0], b"{broken", *lines[2:]]))
    before = path.read_bytes()
    with pytest.raises(StudyError, match="line 2"):
        Journal(path)
    assert path.read_bytes() == before


def test_a_last_block_of_zeros_as_a_power_cut_leaves_it_is_cut_off() -> None:
    line = journal_bytes([{"time": now(), "clock": 1.5, "kind": "command", "command": "note"}])
    assert parse_records(line + bytes(500) + b"\n", Path("x")) == ([json.loads(line)], len(line))


def test_real_pilot_and_simulated_data_never_share_a_folder(tmp_path: Path) -> None:
    studies = [open_study(tmp_path, mode=mode) for mode in (REAL, PILOT, SIMULATED)]
    assert len({s.path for s in studies}) == 3
    studies[1].path.rename(tmp_path / "moved")
    studies[0].path.rename(tmp_path / "quick-pilot")
    with pytest.raises(StudyError, match="holds real data"):
        open_study(tmp_path, mode=PILOT)


def test_another_program_is_refused_unless_forced_and_that_is_logged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    open_study(tmp_path).add()
    # As if a line of the program had changed since.
    monkeypatch.setattr(build_module, "code_digest", lambda: "another")
    with pytest.raises(StudyError, match="force-upgrade"):
        open_study(tmp_path)
    study = StudyFolder(tmp_path, design(), SIMULATED, "a fix of the lamp")
    record = study.records()[-1]
    assert (record["kind"], record["reason"]) == ("upgrade", "a fix of the lamp")
    assert record["before"]["program"] != record["after"]["program"] == "another"
    open_study(tmp_path)


def test_a_finished_trial_that_is_repeated_counts_in_its_last_attempt(tmp_path: Path) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 1, quiet)
    person = study.participants()[0]
    with SessionFolder(study, person) as session:
        session.command("repeat", step="trial:3", trial=3, reason="wrong chair")
    assert run_simulated(study, 1, quiet) is SessionOutcome.COMPLETE
    rows = rows_of(study.path / "tables/trials.csv")
    third = [(r["attempt"], r["counted"]) for r in rows if r["trial"] == "3"]
    assert third == [("1", "0"), ("2", "1")]
    assert len(rows) == TRIALS + 1


def test_the_time_limit_of_a_study_ends_a_trial_and_its_recording_replays(tmp_path: Path) -> None:
    text = DESIGN.replace("[trials]", "[trials]\ntime_limit_s = 0.08").replace(
        "repetitions = 2", "repetitions = 1"
    )
    study = open_study(tmp_path, text)
    run_simulated(study, 1, quiet)
    folder = session_path(study.path, study.participants()[0].ppid)
    rows = rows_of(study.path / "tables/trials.csv")
    assert {(r["status"], r["time_s"]) for r in rows} == {("timeout", "0.08")}
    _, found = replay(load_recording(folder / "trials/T001.jsonl"))
    assert found.exact and found.complete


def test_rules_exclude_by_what_was_measured(tmp_path: Path) -> None:
    rule = '[[exclusions]]\nname = "quick"\nmeasure = "time_s"\nbelow = 0.2\n'
    study = open_study(tmp_path, DESIGN + rule)
    run_simulated(study, 1, quiet)
    rows = rows_of(study.path / "tables/trials.csv")
    for row in rows:
        assert (row["excluded"] == "1") == (float(row["time_s"]) < 0.2)
        assert row["exclusion_reason"] == ("rule quick" if row["excluded"] == "1" else "")
    assert len({row["excluded"] for row in rows}) == 2


@given(
    st.lists(
        st.lists(st.none() | st.text() | st.integers() | st.booleans(), min_size=2, max_size=2),
        max_size=4,
    )
)
def test_tables_keep_every_cell(cells: list[list[object]]) -> None:
    data = csv_bytes([dict(zip("ab", row, strict=True)) for row in cells], ["a", "b"])
    read = list(csv.reader(io.StringIO(data.decode(), newline="")))
    told = [
        ["" if c is None else str(int(c)) if isinstance(c, bool) else str(c) for c in row]
        for row in cells
    ]
    one_end = [[c.replace("\r\n", "\n").replace("\r", "\n") for c in row] for row in told]
    assert read == [["a", "b"], *one_end]


def test_simulated_people_differ_in_skill_and_hand_and_are_the_same_every_time() -> None:
    people = [simulated_person(design(), n) for n in range(1, 41)]
    assert people == [simulated_person(design(), n) for n in range(1, 41)]
    skills = [p["user"]["skill"] for p in people]
    sizes = [p["hand_size"] for p in people]
    assert min(skills) < 0.35 and max(skills) > 0.65
    assert min(sizes) < 0.95 and max(sizes) > 1.05
    assert {p["hand"] for p in people} == {"left", "right"}


def test_tables_do_not_change_when_nothing_has(finished: StudyFolder) -> None:
    path = finished.path / "tables/trials.csv"
    before = path.stat().st_ino
    make_tables(finished)
    assert path.stat().st_ino == before
