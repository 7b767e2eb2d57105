"""A session is written down whole, and nothing in it is mixed up or written over."""

from __future__ import annotations

import csv
import gzip
import io
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.recording.recording import load_recording, read_stored
from sandbox.study.record import build as build_module
from sandbox.study.record.folder import PILOT, REAL, SIMULATED, StudyFolder
from sandbox.study.record.journal import Journal, journal_bytes, now, parse_records, read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulate import run_simulated, simulated_person
from sandbox.study.tables.column import csv_bytes
from sandbox.study.tables.tables import rebuild_session, rebuild_study
from sandbox.trial.replay import replay
from tests.support.study_files import DESIGN, TRIALS, design, open_study


def quiet(text: str) -> None:
    """Nobody listens."""


def rows_of(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.open(encoding="utf-8")))


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    study = open_study(tmp_path_factory.mktemp("study"))
    assert run_simulated(study, 0, quiet) is SessionOutcome.COMPLETE
    rebuild_study(study)
    return study


@pytest.fixture
def folder(finished: StudyFolder) -> Path:
    return session_path(finished.path, finished.participants()[0].ppid)


def test_every_trial_has_one_row_one_recording_and_its_tables(folder: Path) -> None:
    rows = rows_of(folder / "trial_results.csv")
    assert [int(r["trial_num"]) for r in rows] == list(range(1, TRIALS + 1))
    assert list(rows[0])[:8] == [
        "experiment",
        "ppid",
        "session_num",
        "trial_num",
        "block_num",
        "trial_num_in_block",
        "start_time",
        "end_time",
    ]
    for row in rows:
        recording = load_recording(folder / row["trial_recording_location_0"])
        assert not recording.damage and recording.end is not None
        assert recording.end["result"]["state_hash"] == row["state_hash"]
        assert recording.header["study"]["ppid"] == row["ppid"]
        table = parquet.read_table(
            folder / row["hand_pose_location_0"].replace(".csv.gz", ".parquet")
        )
        assert table.num_rows == round(recording.end["step"] * 0.002 / 0.016)
        assert sum(name.startswith("q_") for name in table.column_names) == 48


def test_a_trial_of_a_study_just_plays_and_every_state_is_the_same(folder: Path) -> None:
    _, found = replay(load_recording(folder / "trials/T002.jsonl"))
    assert found.exact and found.complete
    assert main(["replay", str(folder / "trials/T003.jsonl")]) == 0


def test_tables_made_again_from_recordings_are_the_same_to_the_byte(
    finished: StudyFolder, folder: Path
) -> None:
    trackers = folder / "trackers"
    names = [*trackers.glob("*T004*"), folder / "trial_results.csv"]
    before = {path: path.read_bytes() for path in names}
    assert len(before) == 5
    for path in before:
        path.unlink()
    run_simulated(finished, 0, quiet)
    assert {path: path.read_bytes() for path in before} == before


def test_every_column_is_in_the_codebook(finished: StudyFolder) -> None:
    told = {
        (r["table"], r["column"]): r["meaning"] for r in rows_of(finished.path / "codebook.csv")
    }
    for table in ("trial_results.csv", "questionnaires.csv"):
        head = (finished.path / table).read_text().splitlines()[0].split(",")
        assert head and all(told[table, name] for name in head)
    touches = next(finished.path.glob("*/S001/trackers/touches_*.csv.gz"))
    names = gzip.decompress(touches.read_bytes()).decode().splitlines()[0].split(",")
    assert names and all(told["trackers/touches_*", name] for name in names)


def test_answers_are_there_once_each(finished: StudyFolder) -> None:
    rows = rows_of(finished.path / "questionnaires.csv")
    assert [r["instrument"] for r in rows] == ["demographics", "effort", "effort"]
    assert {r["factor_contact"] for r in rows[1:]} == {"hard", "soft"}
    person = rows_of(finished.path / "participants.csv")[0]
    assert person["age"] == rows[0]["answer"] and person["complete"] == "1"


def test_a_journal_that_lost_the_end_of_a_trial_is_completed_from_the_recording(
    tmp_path: Path,
) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 0, quiet)
    path = next(study.path.glob("*/S001/journal.jsonl"))
    lines = path.read_bytes().splitlines(keepends=True)
    last = max(i for i, line in enumerate(lines) if b'"kind":"trial_end"' in line)
    # What a power cut may take; tables are written after that.
    path.write_bytes(b"".join(lines[:last]))
    (path.parent / "session_info/log.csv").unlink()
    recording = read_stored(path.parent / "trials/T006.jsonl").data
    assert run_simulated(study, 0, quiet) is SessionOutcome.COMPLETE
    rows = rows_of(path.parent / "trial_results.csv")
    assert [r["trial_num"] for r in rows if r["counted"] == "1"] == list("123456")
    assert rows[-1]["trial_recording_location_0"] == "trials/T006.jsonl.gz"
    assert read_stored(path.parent / "trials/T006.jsonl").data == recording


def test_a_resumed_session_that_is_complete_adds_no_trial(finished: StudyFolder) -> None:
    before = [
        r
        for r in read_journal(next(finished.path.glob("*/S001/journal.jsonl")))
        if r["kind"].startswith("trial")
    ]
    assert run_simulated(finished, 0, quiet) is SessionOutcome.COMPLETE
    after = [
        r
        for r in read_journal(next(finished.path.glob("*/S001/journal.jsonl")))
        if r["kind"].startswith("trial")
    ]
    assert before == after


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
    run_simulated(study, 0, quiet)
    person = study.participants()[0].ppid
    run = ["study", "run", str(tmp_path / "design.toml"), "--out", str(tmp_path), "--pilot"]
    run += ["--device", "simulated", "--view", "none", "--participant", person]
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
    added = read_journal(folder / "journal.jsonl")[-2:]
    assert [record["kind"] for record in added] == ["session_resume", "leftover"]


@given(cut=st.integers(0, 10_000), tail=st.binary(max_size=20))
def test_a_journal_cut_anywhere_keeps_every_whole_record(
    tmp_path_factory: pytest.TempPathFactory, cut: int, tail: bytes
) -> None:
    path = tmp_path_factory.mktemp("journal") / "journal.jsonl"
    journal = Journal(path)
    for i in range(8):
        journal.append("note", text=f"ü {i}")
    journal.close()
    whole = path.read_bytes()
    data = whole[: cut % (len(whole) + 1)]
    path.write_bytes(data + tail.replace(b"\n", b""))
    again = Journal(path)
    kept = data.count(b"\n")
    assert [r["text"] for r in again.records if r["kind"] == "note"][:kept] == [
        f"ü {i}" for i in range(kept)
    ]
    again.append("note", text="after")
    again.close()
    records = read_journal(path)
    assert [r["n"] for r in records] == list(range(len(records)))
    assert records[-1]["text"] == "after"


def test_damage_in_the_middle_of_a_journal_is_refused_and_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    journal = Journal(path)
    for i in range(3):
        journal.append("note", text=str(i))
    journal.close()
    lines = path.read_bytes().split(b"\n")
    path.write_bytes(b"\n".join([lines[0], b"{broken", *lines[2:]]))
    before = path.read_bytes()
    with pytest.raises(StudyError, match="line 2"):
        Journal(path)
    assert path.read_bytes() == before


def test_a_last_block_of_zeros_as_a_power_cut_leaves_it_is_cut_off() -> None:
    line = journal_bytes([{"time": now(), "clock": 1.5, "kind": "note"}])
    assert parse_records(line + bytes(500) + b"\n", Path("x")) == ([json.loads(line)], len(line))


def test_real_pilot_and_simulated_data_never_share_a_folder(tmp_path: Path) -> None:
    studies = [open_study(tmp_path, mode=mode) for mode in (REAL, PILOT, SIMULATED)]
    assert len({s.path for s in studies}) == len({s.id for s in studies}) == 3
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
    record = read_journal(study.path / "study.jsonl")[-1]
    assert (record["kind"], record["reason"]) == ("upgrade", "a fix of the lamp")
    assert record["before"]["program"] != record["after"]["program"] == "another"
    open_study(tmp_path)


def test_another_design_under_the_same_name_is_refused(tmp_path: Path) -> None:
    study = open_study(tmp_path)
    study.add()
    with pytest.raises(StudyError, match="design"):
        open_study(tmp_path, DESIGN.replace("repetitions = 2", "repetitions = 3"))
    assert (study.path / "design.toml").read_text() == DESIGN


def test_newcomers_get_numbers_that_nobody_has_and_those_of_the_excluded(tmp_path: Path) -> None:
    study = open_study(tmp_path)
    people = [study.add() for _ in range(3)]
    assert [p.number for p in people] == [0, 1, 2]
    study.release(people[1].ppid, "fell ill")
    assert study.add().number == 1
    assert len({p.ppid for p in study.participants()}) == 4


def test_a_finished_trial_that_is_repeated_counts_in_its_last_attempt(tmp_path: Path) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 0, quiet)
    person = study.participants()[0]
    with SessionFolder(study, person) as session:
        session.write("repeat", step="trial:3", trial=3, reason="wrong chair")
    assert run_simulated(study, 0, quiet) is SessionOutcome.COMPLETE
    rows = rows_of(session_path(study.path, person.ppid) / "trial_results.csv")
    third = [(r["attempt"], r["counted"]) for r in rows if r["trial_num"] == "3"]
    assert third == [("1", "0"), ("2", "1")]
    assert len(rows) == TRIALS + 1


def test_the_time_limit_of_a_study_ends_a_trial_and_its_recording_replays(tmp_path: Path) -> None:
    text = DESIGN.replace("[trials]", "[trials]\ntime_limit_s = 0.08").replace(
        "repetitions = 2", "repetitions = 1"
    )
    study = open_study(tmp_path, text)
    run_simulated(study, 0, quiet)
    folder = session_path(study.path, study.participants()[0].ppid)
    rows = rows_of(folder / "trial_results.csv")
    assert {(r["status"], r["time_s"]) for r in rows} == {("timeout", "0.08")}
    _, found = replay(load_recording(folder / "trials/T001.jsonl"))
    assert found.exact and found.complete


def test_rules_exclude_by_what_was_measured(tmp_path: Path) -> None:
    rule = '[[exclusions]]\nname = "quick"\nmeasure = "time_s"\nbelow = 0.2\n'
    study = open_study(tmp_path, DESIGN + rule)
    run_simulated(study, 0, quiet)
    rows = rows_of(session_path(study.path, study.participants()[0].ppid) / "trial_results.csv")
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
    people = [simulated_person(design(), n) for n in range(40)]
    assert people == [simulated_person(design(), n) for n in range(40)]
    skills = [p["user"]["skill"] for p in people]
    sizes = [p["hand_size"] for p in people]
    assert min(skills) < 0.35 and max(skills) > 0.65
    assert min(sizes) < 0.95 and max(sizes) > 1.05
    assert {p["hand"] for p in people} == {"left", "right"}


def test_the_tables_of_a_session_do_not_change_when_nothing_has(finished: StudyFolder) -> None:
    person = finished.participants()[0]
    with SessionFolder(finished, person) as session:
        path = session.path / "trial_results.csv"
        before = path.stat().st_ino
        rebuild_session(session)
        assert path.stat().st_ino == before
