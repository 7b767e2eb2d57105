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
from sandbox.recording.recording import load_recording, packed, read_stored
from sandbox.study.record.folder import PILOT, REAL, SIMULATED, StudyFolder
from sandbox.study.record.journal import Journal, journal_bytes, now, parse_records, read_journal
from sandbox.study.record.trial_files import pack
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulated_study import run_simulated, simulated_person
from sandbox.study.tables.tables import make_tables
from sandbox.trial.replay import replay
from tests.support.study_driver import everything
from tests.support.study_files import (
    DESIGN,
    TRIALS,
    design,
    first_session,
    open_study,
    pilot,
    quiet,
    recordings,
    rows_of,
)


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


def test_to_run_a_session_that_is_complete_adds_nothing_unless_files_of_it_are_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    (tmp_path / "design.toml").write_text(DESIGN)
    study = open_study(tmp_path, mode=PILOT)
    run_simulated(study, 1, quiet)
    person = study.participants()[0].ppid
    run = [*pilot(tmp_path / "design.toml"), "--participant", person]
    first = everything(study.path)
    for more in ([], ["--resume"]):
        capsys.readouterr()
        assert main([*run, *more]) == 0
        said = capsys.readouterr().out
        assert f"{person}: complete, so nothing was played" in said
        assert f"sandbox study report {study.path}; the next person: --participant new" in said
        assert everything(study.path) == first
    # What a killed program has left is still completed, and then the journal says who did it.
    folder = first_session(study)
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


def test_the_time_limit_of_a_study_ends_a_trial_and_its_recording_replays(tmp_path: Path) -> None:
    text = DESIGN.replace("[trials]", "[trials]\ntime_limit_s = 0.08").replace(
        "repetitions = 2", "repetitions = 1"
    )
    study = open_study(tmp_path, text)
    run_simulated(study, 1, quiet)
    folder = first_session(study)
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


def test_simulated_people_differ_in_skill_and_hand_and_are_the_same_every_time() -> None:
    people = [simulated_person(design(), n) for n in range(1, 41)]
    assert people == [simulated_person(design(), n) for n in range(1, 41)]
    skills = [p["user"]["skill"] for p in people]
    sizes = [p["hand_size"] for p in people]
    assert min(skills) < 0.35 and max(skills) > 0.65
    assert min(sizes) < 0.95 and max(sizes) > 1.05
    assert {p["hand"] for p in people} == {"left", "right"}


def test_a_session_that_an_older_version_left_uncompressed_is_compressed_when_it_is_opened(
    tmp_path: Path,
) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 1, quiet)
    folder = first_session(study)
    small = folder / "trials/T002.jsonl.gz"
    before, plain = small.read_bytes(), folder / "trials/T002.jsonl"
    plain.write_bytes(read_stored(plain).data)
    small.unlink()
    run_simulated(study, 1, quiet)
    assert small.read_bytes() == before and not plain.exists()


def test_where_something_else_is_read_than_was_written_the_recording_stays_as_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ((path, data),) = recordings(tmp_path, 1).items()
    monkeypatch.setattr(
        "sandbox.study.record.trial_files.packed", lambda found: packed(found.replace(b"a", b"b"))
    )
    with pytest.raises(StudyError, match="differs from what was written"):
        pack(path)
    assert path.read_bytes() == data and [path] == list(tmp_path.iterdir())


def test_two_that_are_the_same_become_one_and_packing_twice_is_no_error(tmp_path: Path) -> None:
    ((path, data),) = recordings(tmp_path, 1).items()
    small = pack(path)
    path.write_bytes(data)
    assert pack(path) == small == pack(path)
    assert list(tmp_path.iterdir()) == [small]
    assert read_stored(path) == (data, True)
