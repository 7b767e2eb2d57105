"""Whoever sits at the terminal is heard and asked, and what they say is written down."""

from __future__ import annotations

import io
import os
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.cli.study.run import LONG_PAUSE, offer_to_begin_again
from sandbox.study.design.design import DEMOGRAPHICS, Form, Item
from sandbox.study.design.session_plan import FormStep
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.run.answers import Answers, Draft, question, read_answer
from sandbox.study.run.controls import Command, Controls, Terminal, parse_command
from sandbox.study.run.forms import SimulatedForms
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulated_study import run_simulated, simulated_person
from tests.support.processes import until
from tests.support.study_files import (
    DESIGN,
    TRIALS,
    open_study,
    pilot,
    quiet,
    rows_of,
    simulated_runner,
)


class Typist:
    """An experimenter who types at set moments: before the nth look at the controls."""

    def __init__(self, lines: dict[int, str]) -> None:
        self.lines, self.looks, self.said = lines, 0, [""]
        self.controls = Controls(self.said.append)
        take = self.controls.take

        def watched() -> Iterator[Command]:
            self.looks += 1
            if self.looks in self.lines:
                self.controls.type(self.lines[self.looks])
            yield from take()

        self.controls.take = watched  # type: ignore[method-assign]


def run_with(
    out: Path, lines: dict[int, str]
) -> tuple[StudyFolder, SessionState, SessionOutcome, Typist]:
    study = open_study(out)
    person = study.add(**simulated_person(study.design, 1))
    typist = Typist(lines)
    with SessionFolder(study, person) as session:
        forms = SimulatedForms(1)
        runner = simulated_runner(session, person, forms, typist.controls, typist.said.append)
        outcome = runner.run()
        return study, session.state, outcome, typist


def test_a_trial_repeated_in_the_middle_gets_a_file_of_its_own_and_counts_once(
    tmp_path: Path,
) -> None:
    _, state, outcome, _ = run_with(tmp_path, {10: "r the phone rang"})
    assert outcome is SessionOutcome.COMPLETE
    attempts = state.attempts[1]
    assert [a.start["file"] for a in attempts] == ["trials/T001.jsonl", "trials/T001.a2.jsonl"]
    assert attempts[0].end is None and state.counted(1) is attempts[1]
    assert all(state.counted(t) for t in range(1, TRIALS + 1))


def test_notes_exclusions_and_skips_are_written_down_and_delete_nothing(tmp_path: Path) -> None:
    study, state, outcome, typist = run_with(
        tmp_path, {8: "n a note", 9: "x sneezed", 10: "zzz", 100: "s broken chair"}
    )
    assert outcome is SessionOutcome.COMPLETE
    assert state.excluded == {1: "sneezed"}
    assert len(state.skipped) == 1 and "broken chair" in state.skipped.values()
    assert any("keys" in line for line in typist.said)
    rows = rows_of(study.path / "tables/trials.csv")
    assert rows[0]["exclusion_reason"] == "sneezed" and rows[0]["counted"] == "1"
    assert len(rows) == TRIALS - 1


def test_consent_cannot_be_skipped(tmp_path: Path) -> None:
    _, state, _, _ = run_with(tmp_path, {1: "s in a hurry", 20: "q"})
    assert not state.skipped and state.consent is True


class Leaving(SimulatedForms):
    """A participant who is gone when they are asked about what they did."""

    controls: Controls

    def ask(self, form: Form, language: str, poll: Callable[[], None], draft: Draft) -> Answers:
        if form.name != DEMOGRAPHICS:
            self.controls.type("q")
            poll()
        return super().ask(form, language, poll, draft)


def test_the_last_trial_can_be_excluded_after_the_program_was_started_again(tmp_path: Path) -> None:
    study = open_study(tmp_path)
    person = study.add(**simulated_person(study.design, 1))
    leaving, outcomes, last = Leaving(1), list[SessionOutcome](), 0
    runs: list[tuple[SimulatedForms, dict[int, str]]] = [
        (leaving, {}),
        (SimulatedForms(1), {1: "x the phone rang"}),
    ]
    for forms, lines in runs:
        typist = Typist(lines)
        leaving.controls = typist.controls
        with SessionFolder(study, person) as session:
            step = session.state.next_step(session.steps)
            runner = simulated_runner(session, person, forms, typist.controls, typist.said.append)
            outcomes.append(runner.run())
            state = session.state
        last = last or max(state.attempts)
    assert outcomes == [SessionOutcome.STOPPED, SessionOutcome.COMPLETE]
    assert isinstance(step, FormStep) and state.excluded == {last: "the phone rang"}


def test_a_note_in_another_encoding_is_kept_and_the_keys_after_it_still_work() -> None:
    controls = Controls()
    typed = io.TextIOWrapper(io.BytesIO("i\nn grüße\nq\n".encode("latin-1")), encoding="utf-8")
    terminal = Terminal(controls, typed)
    until(lambda: terminal.ended)
    heard = list(controls.take())
    assert [command.key for command in heard] == ["i", "n", "q"]
    assert heard[1].words == "gr\ufffd\ufffde"


def test_a_session_in_the_terminal_asks_plays_and_hears_the_experimenter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "design.toml"
    file.write_text(DESIGN)
    command = pilot(file)
    monkeypatch.setattr(
        "sys.stdin", io.StringIO("maybe\n/n hello\nyes\n17\n33\n\n\n25\n\n\n101\n95\n")
    )
    assert main([*command, "--participant", "new"]) == 0
    told = capsys.readouterr().out
    assert told.count("type 1 yes, 2 no, then Enter") == 2, "`maybe` was asked again"
    folder = tmp_path / "quick-pilot"
    assert [r["answer"] for r in rows_of(folder / "tables/answers.csv")] == ["33", "25", "95"]
    assert {r["mode"] for r in rows_of(folder / "tables/trials.csv")} == {"pilot"}
    records = read_journal(next(folder.glob("*/S001/session.jsonl")))
    assert [r["text"] for r in records if r.get("command") == "note"] == ["hello"]
    assert main([*command]) == 2
    assert main([*(c for c in command if c != "--pilot"), "--participant", "new"]) == 2
    assert not (tmp_path / "quick").exists()


def test_a_question_that_nobody_can_answer_is_an_error_with_a_way_out_and_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "design.toml"
    file.write_text(DESIGN)
    command = [*pilot(file), "--participant"]
    monkeypatch.setattr("sys.stdin", io.StringIO("yes\n17\n33\n\n"))
    assert main([*command, "new"]) == 2
    left = capsys.readouterr().err
    ppid = StudyFolder.at(tmp_path / "quick-pilot").participants()[0].ppid
    again = f"`sandbox study run {file} --participant {ppid} --out {tmp_path} --pilot --device "
    assert again + "simulated --view none` resumes" in left and len(left.splitlines()) == 1
    journal = next((tmp_path / "quick-pilot").glob("*/S001/session.jsonl"))
    before = [r for r in read_journal(journal) if r["kind"] == "trial_end"]
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert main([*command, ppid]) == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1 and "--resume goes on without asking" in error
    monkeypatch.setattr("sys.stdin", io.StringIO("no\n"))
    assert main([*command, ppid]) == 0
    assert "nothing was played" in capsys.readouterr().out
    assert [r for r in read_journal(journal) if r["kind"] == "trial_end"] == before
    monkeypatch.setattr("sys.stdin", io.StringIO("\n25\n\n\n95\n"))
    assert main([*command, ppid, "--resume"]) == 0
    assert "How old" not in capsys.readouterr().out
    ends = [r["trial"] for r in read_journal(journal) if r.get("result")]
    assert sorted(ends) == list(range(1, TRIALS + 1))


def test_a_choice_in_the_terminal_is_its_word_or_its_number() -> None:
    means = ({"en": "R"}, {"en": "L"})
    item = Item("hand", "choice", {"en": "Hand?"}, choices=("right", "left"), means=means)
    assert question(item, "en", numbered=True) == "Hand? (1 R / 2 L)"
    typed = [read_answer(item, t, "en") for t in ("2", " l", "LEFT", "1")]
    assert typed == ["left", "left", "left", "right"]
    for text in ("0", "3", "-1", "1.0"):
        with pytest.raises(StudyError, match="not one of the choices"):
            read_answer(item, text, "en")
    years = replace(item, choices=("2", "1"), means=())
    assert question(years, "en", numbered=True) == "Hand? (2 / 1)"
    assert [read_answer(years, t, "en") for t in ("1", "2")] == ["1", "2"]


def test_what_is_typed_in_a_terminal_before_a_question_is_open_is_no_key_and_no_answer() -> None:
    """An answer `q` that was typed a moment too early ended the session."""
    said: list[str] = []
    controls = Controls(said.append)
    master, slave = os.openpty()
    terminal = Terminal(controls, os.fdopen(slave), answers=True)
    os.write(master, b"q\n")
    until(lambda: bool(said))
    assert "no question is open" in said[0] and not list(controls.take())
    asked = threading.Timer(0.2, lambda: os.write(master, b"/n a key\nq\n"))
    asked.start()
    assert terminal.ask() == "q"
    assert [command.key for command in controls.take()] == ["n"]
    os.close(master)


def test_lines_of_a_pipe_answer_the_questions_that_come() -> None:
    controls = Controls()
    terminal = Terminal(controls, io.StringIO("/n early\nq\n2\n"), answers=True)
    until(lambda: terminal.ended)
    assert [terminal.ask(), terminal.choose(("yes", "no"), quiet)] == ["q", 1]
    assert [command.key for command in controls.take()] == ["n"]


def test_after_a_long_pause_a_block_begins_again_with_its_practice_if_the_experimenter_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study, state, outcome, _ = run_with(tmp_path, {250: "q"})
    (person,) = study.participants()
    done = sorted(t for t in state.attempts if state.counted(t))
    # Each of two blocks has a practice trial and two others.
    assert outcome is SessionOutcome.STOPPED and len(done) == 4
    said: list[str] = []
    for answer, after in (("go on", done), ("2", done[:3])):
        with SessionFolder(study, person) as session:
            assert 0.0 <= session.away < 600.0
            offer_to_begin_again(session, Terminal(Controls(), io.StringIO("")), said.append)
            assert not said, "nobody is asked after a short pause"
            session.away = LONG_PAUSE + 60.0
            typed = Terminal(Controls(), io.StringIO(f"{answer}\n"), answers=True)
            offer_to_begin_again(session, typed, said.append)
            assert "31 min" in said.pop(0) and "1 go on, 2 begin again" in said.pop()
            assert sorted(t for t in state.attempts if session.state.counted(t)) == after
            assert SessionState.of(session.journal.records).finished == session.state.finished
    assert run_simulated(study, 1, quiet) is SessionOutcome.COMPLETE
    rows = rows_of(study.path / "tables/trials.csv")
    counted = [r["trial"] for r in rows if r["counted"] == "1"]
    assert counted == [str(t) for t in range(1, TRIALS + 1)] and len(rows) == TRIALS + 1
    events = [r["event"] for r in rows_of(study.path / "tables/events.csv")]
    assert events.count("begin_again") == 1
    with SessionFolder(study, person) as session:
        assert session.state.block_under_way(session.steps) == []


@given(st.text(max_size=12))
def test_whatever_is_typed_is_a_command_or_is_answered(line: str) -> None:
    found = parse_command(line)
    assert isinstance(found, Command) or "keys" in found or "needs a text" in found


@pytest.mark.parametrize("text", ["", "nan", "inf", "five", "1e400"])
def test_what_is_no_number_is_no_answer(text: str) -> None:
    with pytest.raises(StudyError):
        read_answer(Item("x", "number", {"en": "?"}), text)
