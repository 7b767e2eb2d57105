"""Where a replay does not give the recorded states, measures stay as they were recorded."""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.main import main
from sandbox.recording.recording import read_stored, stored
from sandbox.study.measures.measure import TrialMeasure
from sandbox.study.measures.registry import register, unregister
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.simulate import run_simulated
from sandbox.study.tables import frames
from sandbox.study.tables.frames import complete_tables, rebuild_tables
from tests.support.study_files import DESIGN, open_study, rows_of

SHORT = DESIGN.replace(
    'repetitions = 2\npractice = 1\npractice_each = "contact"\n', "repetitions = 1\npractice = 0\n"
)
ADDED = TrialMeasure(
    "palm_top_m",
    "m",
    "Highest palm",
    "largest height of the palm",
    of_trial=lambda trial: trial.table.numbers("q_position_z").max(),
)
LIBM = "the system's libm (musl 1.2, 0123456789ab there"


@pytest.fixture
def study(tmp_path: Path) -> StudyFolder:
    found = open_study(tmp_path, SHORT)
    run_simulated(found, 0, lambda text: None)
    return found


@pytest.fixture
def added() -> Iterator[None]:
    register(ADDED)
    yield
    unregister(ADDED.name)


def session_of(study: StudyFolder) -> Path:
    return session_path(study.path, study.participants()[0].ppid)


def forge(session: Path, elsewhere: bool, **settings: object) -> None:
    """Changes recordings as if another machine or, with settings, another program had made them."""
    for name in ("T001", "T002"):
        path = session / "trials" / f"{name}.jsonl"
        lines = read_stored(path).data.split(b"\n")
        header = json.loads(lines[0])
        if elsewhere:
            header["versions"] |= {
                "fingerprint": "another machine",
                "libm": "musl 1.2, 0123456789ab",
            }
        header["settings"]["physics"] |= settings
        lines[0] = json.dumps(header).encode()
        stored(path).write_bytes(gzip.compress(b"\n".join(lines)))


def contents(session: Path) -> dict[str, bytes]:
    return {p.name: p.read_bytes() for p in sorted((session / "trackers").iterdir())}


def told(session: Path, name: str = "T001") -> dict[str, Any]:
    return dict(json.loads((session / "trackers" / f"measures_{name}.json").read_bytes()))


def recorded_cells(study: StudyFolder, rows: list[dict[str, str]]) -> list[dict[str, str]]:
    """The rows without what a measure that was added changes."""
    return [
        {k: v for k, v in row.items() if k not in (ADDED.name, "replay_differs")} for row in rows
    ]


def test_where_states_differ_recorded_values_stay_and_an_added_measure_is_empty_with_its_reason(
    study: StudyFolder, added: None
) -> None:
    session = session_of(study)
    files, before = contents(session), rows_of(study.path / "trial_results.csv")
    values = told(session)
    forge(session, True, impulse=0.02)
    said: list[str] = []
    run_simulated(study, 0, said.append)
    (line,) = [text for text in said if "as recorded" in text]
    assert "Measures of 2 trials stay" in line and LIBM in line
    again = told(session)
    assert {name: again[name] for name in values if name != "reasons"} == {
        name: value for name, value in values.items() if name != "reasons"
    }
    assert again[ADDED.name] is None and LIBM in again["reasons"][ADDED.name]
    assert {n: d for n, d in contents(session).items() if "measures" not in n} == {
        n: d for n, d in files.items() if "measures" not in n
    }
    after = rows_of(study.path / "trial_results.csv")
    assert recorded_cells(study, after) == recorded_cells(study, before)
    assert {row[ADDED.name] for row in after} == {""}
    assert all(LIBM in row["replay_differs"] for row in after)


def test_on_another_machine_whose_states_are_equal_an_added_measure_is_computed(
    study: StudyFolder, added: None
) -> None:
    session = session_of(study)
    forge(session, True)
    said: list[str] = []
    run_simulated(study, 0, said.append)
    assert told(session)[ADDED.name] > 0.0 and not any("as recorded" in text for text in said)
    assert {row["replay_differs"] for row in rows_of(study.path / "trial_results.csv")} == {""}


def test_back_where_states_are_equal_everything_is_computed_and_the_files_are_as_at_first(
    study: StudyFolder,
) -> None:
    session, files = session_of(study), contents(session_of(study))
    recordings = {p: p.read_bytes() for p in (session / "trials").iterdir()}
    forge(session, True, impulse=0.02)
    for name in ("T001", "T002"):
        (session / "trackers" / f"frames_{name}.csv.gz").unlink()
        (session / "trackers" / f"measures_{name}.json").unlink()
        rebuilt = complete_tables(session / "trials" / f"{name}.jsonl", session / "trackers")
        assert LIBM in rebuilt.differs
    kept = told(session)
    assert all(kept[name] is None and LIBM in kept["reasons"][name] for name in ("grasps", "drops"))
    for path, data in recordings.items():
        path.write_bytes(data)
    # As if the machine that differed was another one than this.
    for path in (session / "trackers").glob("measures_*"):
        path.write_text(path.read_text().replace('"by": "', '"by": "another '))
    run_simulated(study, 0, lambda text: None)
    assert contents(session) == files


def test_a_replay_that_differed_is_not_done_again_here(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = session_of(study)
    forge(session, True, impulse=0.02)
    (session / "trackers" / "frames_T001.csv.gz").unlink()
    recording = session / "trials" / "T001.jsonl"
    assert complete_tables(recording, session / "trackers").differs
    monkeypatch.setattr(frames, "rebuild_tables", lambda *_: pytest.fail("it is replayed"))
    assert complete_tables(recording, session / "trackers").differs == ""


def test_another_program_on_this_machine_changes_no_recorded_value_either(
    study: StudyFolder,
) -> None:
    session, files = session_of(study), contents(session_of(study))
    values = told(session)
    forge(session, False, impulse=0.02)
    rebuilt = rebuild_tables(session / "trials" / "T001.jsonl", session / "trackers")
    assert "the program" in rebuilt.differs
    kept = told(session)
    assert {name: kept[name] for name in values} == values
    assert {n: d for n, d in contents(session).items() if n != "measures_T001.json"} == {
        n: d for n, d in files.items() if n != "measures_T001.json"
    }


def test_a_recording_that_is_refused_costs_no_recorded_value_and_no_folder_is_named(
    study: StudyFolder, added: None
) -> None:
    session = session_of(study)
    values = told(session)
    path = session / "trials" / "T001.jsonl"
    lines = read_stored(path).data.split(b"\n")
    header = json.loads(lines[0])
    header["digests"] = {"encoder": "another"}
    lines[0] = json.dumps(header).encode()
    stored(path).write_bytes(gzip.compress(b"\n".join(lines)))
    said: list[str] = []
    run_simulated(study, 0, said.append)
    assert any("of the same name changed" in text for text in said)
    kept = told(session)
    assert {n: kept[n] for n in values if n != "reasons"} == {
        n: v for n, v in values.items() if n != "reasons"
    }
    assert kept[ADDED.name] is None and "of the same name changed" in kept["reasons"][ADDED.name]
    assert str(study.path) not in json.dumps(kept)


def test_measures_of_other_definitions_are_put_aside_and_not_mixed_with_these(
    study: StudyFolder,
) -> None:
    session = session_of(study)
    path = session / "trackers" / "measures_T001.json"
    old = {"version": 0, "truth": "", "grasps": 7}
    path.write_text(json.dumps(old))
    forge(session, True, impulse=0.02)
    run_simulated(study, 0, lambda text: None)
    kept = told(session)
    assert kept["grasps"] is None and kept["older"] == old
    assert rows_of(study.path / "trial_results.csv")[0]["grasps"] == ""


def test_console_and_report_say_what_differs(
    study: StudyFolder, added: None, capsys: pytest.CaptureFixture[str]
) -> None:
    forge(session_of(study), True, impulse=0.02)
    run_simulated(study, 0, lambda text: None)
    assert main(["study", "report", str(study.path)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    page = (study.path / "report" / "report.html").read_text(encoding="utf-8")
    for text in (said, page.replace("&#39;", "'")):
        assert text.count("Measures of 2 trials stay as recorded") == 1 and LIBM in text
