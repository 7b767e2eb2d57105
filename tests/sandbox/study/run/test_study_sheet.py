"""The sheet of a session tells the steps and texts that a session really has, in their order."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.study.design.design import Form
from sandbox.study.record.journal import read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.run.answers import Answers, Draft, question
from sandbox.study.run.forms import Poll, SimulatedForms
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.sheet import SessionSheet, session_sheet, sheet_lines
from sandbox.study.run.simulated_study import simulated_person
from tests.sandbox.study.report.study_reports import Page
from tests.support.study_files import DESIGN, TWICE, open_study, simulated_runner

TEXTS = """
[breaks]
every = 1
least_s = 7
[[instructions]]
at = "start"
text.en = "Move it."
text.de = "Bewegen Sie es."
[[instructions]]
at = "contact"
level = "soft"
text.en = "Now <softly>."
text.de = "Jetzt <sanft>."
[[questionnaires]]
name = "liking"
at = "end"
title = "Q & A"
[[questionnaires.items]]
name = "one"
kind = "choice"
choices = ["a", "b", "c"]
shuffle = true
optional = true
ask = "Which?"
[[questionnaires.items]]
name = "two"
kind = "text"
shuffle = true
ask = "Why?"
"""
BOTH = 'seed = 3\nlanguages = ["en", "de"]'
STEPS = {"consent", "done", "form"}
"""Kinds of the records that end a step that is no trial."""


def both_languages(text: str) -> str:
    """A design in English and German, each text with its language in front."""
    lines = []
    for line in text.replace("seed = 3", BOTH).splitlines():
        key, _, told = line.partition(" = ")
        if key in ("ask", "text", "title"):
            line = f'{key} = {{en = "en {told[1:-1]}", de = "de {told[1:-1]}"}}'
        lines.append(line)
    return "\n".join(lines) + "\n"


class Witness(SimulatedForms):
    """A simulated participant who keeps what was shown."""

    def __init__(self) -> None:
        super().__init__(1)
        self.shown: list[str] = []

    def consent(self, text: str, poll: Poll) -> bool:
        self.shown.append(text)
        return super().consent(text, poll)

    def instruct(self, text: str, poll: Poll) -> None:
        self.shown.append(text)
        super().instruct(text, poll)

    def rest(self, least: float, poll: Poll) -> None:
        self.shown.append(f"{least:g} s")
        super().rest(least, poll)

    def ask(self, form: Form, language: str, poll: Poll, draft: Draft) -> Answers:
        self.shown += [question(item, language) for item in form.items]
        return super().ask(form, language, poll, draft)


def told(sheet: SessionSheet) -> list[str]:
    """What a sheet says is shown, in the words of `Witness`."""
    found = []
    for part in sheet.parts:
        if part.questions:
            found += [asked.partition(" [")[0] for asked in part.questions]
        elif part.heading.startswith("break of "):
            found.append(part.heading.removeprefix("break of ").removesuffix(" or longer"))
        elif not part.steps[0].startswith("trial:"):
            found.append(part.texts[0])
    return found


@pytest.mark.parametrize("base", [DESIGN, TWICE])
@pytest.mark.parametrize("number", [1, 2])
def test_a_sheet_has_the_steps_and_texts_of_the_session_that_is_run(
    tmp_path: Path, base: str, number: int
) -> None:
    study = open_study(tmp_path, both_languages(base + TEXTS))
    person = study.add(number, **simulated_person(study.design, number))
    assert person.language == ("en", "de")[number - 1]
    for n in range(1, study.design.sessions + 1):
        forms = Witness()
        with SessionFolder(study, person, n) as session:
            assert simulated_runner(session, person, forms).run() is SessionOutcome.COMPLETE
            records = read_journal(session.path / "session.jsonl")
        taken = [
            f"trial:{r['trial']}" if r["kind"] == "trial" else r["step"]
            for r in records
            if r["kind"] in STEPS or r["kind"] == "trial"
        ]
        sheet = session_sheet(study.design, number, n, person.language)
        assert [step for part in sheet.parts for step in part.steps] == taken
        met = [
            ("practice, " * r["practice"], f"contact = {r['levels']['contact']}")
            for r in records
            if r["kind"] == "trial"
        ]
        named = [
            ("practice, " * part.heading.startswith("practice, "), part.heading.partition(": ")[2])
            for part in sheet.parts
            for step in part.steps
            if step.startswith("trial:")
        ]
        assert named == met
        assert told(sheet) == forms.shown and len(forms.shown) > 5
        breaks = [step for step in taken if step.startswith("break:")]
        assert sum("break of 7 s" in line for line in sheet_lines(sheet)) == len(breaks) > 0


def test_the_page_to_print_has_all_that_the_terminal_shows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, out = tmp_path / "design.toml", tmp_path / "sheet.html"
    file.write_text(both_languages(TWICE + TEXTS))
    command = ["study", "sheet", str(file), "--participant-number", "2", "--language", "de"]
    assert main(command) == 0
    shown = capsys.readouterr().out
    assert "Jetzt <sanft>." in shown and "session 2 of 2" in shown and "softly" not in shown
    assert main([*command, "--out", str(out)]) == 0
    assert "open it in a browser" in capsys.readouterr().out
    page = Page(out.read_text(encoding="utf-8"))
    assert not page.fetches
    for line in shown.splitlines():
        assert " ".join(line.removeprefix("   - ").split()) in page.text
    assert main([*command, "--out", str(out)]) == 2
    assert "exists already" in capsys.readouterr().err
