"""`sandbox study share` and the withdrawal of `sandbox study note`, as somebody types them."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.cli.study.run import find_participant
from sandbox.cli.study.run_options import StudyRunOptions
from sandbox.study.design.session_plan import session_plan, trials_of
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.share.verify import verify
from tests.support.study_driver import everything, note
from tests.support.study_files import rows_of


@pytest.fixture
def folder(study: StudyFolder) -> Path:
    return study.path


def withdraw(folder: Path, ppid: str, *typed: str) -> int:
    """Withdraws a participant in the terminal, where something is typed; its exit status."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in typed)))
        return note(folder, ppid, "--withdraw")


def people_of(folder: Path) -> list[str]:
    return [row["participant"] for row in rows_of(folder / "tables/participants.csv")]


def test_a_report_counts_who_withdrew_and_so_does_that_of_an_anonymous_copy(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shared = tmp_path / "shared"
    assert main(["study", "report", str(folder)]) == 0
    page = folder / "report" / "report.html"
    assert "Nobody withdrew." in page.read_text() and "withdrew" not in capsys.readouterr().out
    gone = people_of(folder)[0]
    assert withdraw(folder, gone, gone) == 0
    assert main(["study", "share", str(folder), "--out", str(shared)]) == 0
    assert gone not in "".join(p.read_text() for p in shared.glob("*.json*"))
    for copy in (folder, shared):
        capsys.readouterr()
        assert main(["study", "report", str(copy)]) == 0
        told = "1 person withdrew. All their data were deleted"
        assert told in capsys.readouterr().out
        text = (copy / "report" / "report.html").read_text()
        assert told in text and "of 1 who began; 1 more withdrew" in text and gone not in text
    assert main(["replay", str(shared), "--verify"]) == 0


def test_a_table_changed_by_hand_is_named_and_the_records_decide(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "tables/trials.csv"
    before = path.read_bytes()
    names, *lines = before.decode().splitlines()
    at = names.split(",").index("time_s")
    cells = lines[3].split(",")
    lines[3] = ",".join([*cells[:at], "0.001", *cells[at + 1 :]])
    for action in (["report", str(folder)], ["tables", str(folder)]):
        path.write_text("\n".join([names, *lines, ""]))
        assert main(["study", *action]) == 0
        said = " ".join(capsys.readouterr().out.split())
        changed = f"row 5, time_s: '0.001', not '{cells[at]}' as in the records"
        assert f"tables/trials.csv differed from the records, and was made again: {changed}" in said
        assert path.read_bytes() == before
    path.write_text("\n".join([names, *lines[:-1], ""]))
    for more in (["--uxf-names"], []):
        assert main(["study", "tables", str(folder), *more]) == 0
    said = capsys.readouterr().out
    assert said.count("differed from the records") == 1


def test_nothing_is_deleted_unless_the_id_is_typed_again(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first, second = people_of(folder)
    for answer in ("no", "", second):
        assert withdraw(folder, first, answer) == 1
        assert "cannot be undone" in capsys.readouterr().out and (folder / first).exists()
    assert withdraw(folder, first) == 2
    assert "before the id was typed" in capsys.readouterr().err and (folder / first).exists()


def test_exclusions_afterwards_are_in_every_table_and_taken_back_leave_none_of_it(
    folder: Path,
) -> None:
    """No command excluded, included or released anybody after the session."""
    ppid, other = people_of(folder)
    names = ("trials.csv", "participants.csv", "scores.csv")
    before = {name: (folder / "tables" / name).read_bytes() for name in names}
    recordings = {p: p.read_bytes() for p in folder.glob("*/S001/*.jsonl*")}
    assert note(folder, ppid, "--trial", "3", "--exclude", "the phone rang") == 0
    excluded = [r for r in rows_of(folder / "tables/trials.csv") if r["excluded"] == "1"]
    assert [(r["participant"], r["trial"], r["exclusion_reason"]) for r in excluded] == [
        (ppid, "3", "the phone rang")
    ]
    assert note(folder, ppid, "--exclude", "left early") == 0
    assert {
        r["participant"] for r in rows_of(folder / "tables/trials.csv") if r["excluded"] == "0"
    } == {other}
    for more in (["--include", "stayed"], ["--trial", "3", "--include", "it was silent"]):
        assert note(folder, ppid, *more) == 0
    assert {name: (folder / "tables" / name).read_bytes() for name in names} == before
    assert note(folder, ppid, "--trial", "99", "--exclude", "r") == 2
    assert note(folder, ppid, "--remark", "asked for the results") == 0
    said = [r["text"] for r in rows_of(folder / "tables/events.csv")]
    assert {"the phone rang", "left early", "stayed", "asked for the results"} <= set(said)
    assert {p: p.read_bytes() for p in recordings} == recordings
    assert main(["replay", str(folder), "--verify"]) == 0


def test_a_number_that_was_freed_goes_to_a_newcomer_or_is_taken_back(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = StudyFolder.at(folder)
    first, second = study.participants()
    assert note(folder, first.ppid, "--release", "did not come") == 0
    assert study.is_released(first.ppid)
    options = StudyRunOptions(Path("design.toml"), participant=first.ppid)
    with pytest.raises(StudyError, match=r"freed for another participant.*--include"):
        find_participant(options, study, Console())
    assert note(folder, first.ppid, "--include", "came after all") == 0
    assert "has number 1 again" in capsys.readouterr().out and not study.is_released(first.ppid)
    assert study.add().number == 3
    assert note(folder, second.ppid, "--release", "did not come") == 0
    newcomer = study.add()
    assert newcomer.number == second.number
    assert note(folder, second.ppid, "--include", "came after all") == 0
    told = capsys.readouterr().out
    assert f"number 2 was given to {newcomer.ppid}" in told and "both count" in told


def test_who_takes_part_after_all_before_any_trial_gets_the_next_free_number(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = StudyFolder.at(folder)
    person = study.add()
    with SessionFolder(study, person) as session:
        session.seal()
    study.release(person.ppid, "no consent")
    newcomer = study.add()
    assert newcomer.number == person.number
    assert note(folder, person.ppid, "--include", "agrees now") == 0
    told = capsys.readouterr().out
    assert f"{person.ppid} has number {person.number + 1} now, and its orders" in told
    now = study.find(person.ppid)
    assert now.number == person.number + 1
    assert study.add().number == person.number + 2
    with SessionFolder(study, now) as session:
        trial = trials_of(session.steps)[0]
        plan = trials_of(session_plan(study.design, now.number))
        assert trial.seed == plan[0].seed and session.state.start["number"] == now.number
        session.begin(trial)
    with SessionFolder(study, now):
        pass
    assert not [f for f in verify(folder, replays=False).found.values() if "number" in str(f)]


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["share", "{}", "--out", "{}/inside"], "inside its study"),
        (["share", "{}", "--bin", "age", "--out", "x"], "not an item and width"),
        (["share", "{}", "--bin", "age:1e-300", "--out", "x"], "from 1e-06 to"),
        (["share", "{}", "--drop", "wage", "--out", "x"], "no such demographic item"),
        (["share", "{}/..", "--out", "x"], "not a study folder"),
        (["note", "{}", "--participant", "ABCDEF", "--withdraw"], "no such participant in this"),
        (["note", "{}", "--participant", "ZZZZZZ"], "exactly one decision is required"),
    ],
)
def test_a_mistake_costs_one_line_and_nothing_else(
    folder: Path,
    words: list[str],
    what: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    before = everything(folder)
    assert main(["study", *(word.format(folder) for word in words)]) == 2
    said = capsys.readouterr().err
    assert what in said and "Traceback" not in said
    assert everything(folder) == before
    assert not (tmp_path / "x").exists()
