"""Flawed designs, written from docs/studies.md alone, are each found with line and remedy.

The first line of every file names its flaw. Of the first twenty, the check of that day found 6. The
others are eight each of a second and a third twenty, twelve of a fourth, seventeen of a fifth, and
five of a sixth, by other writers, that the check of that day did not find. Some have
a mistake of form as well.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.study.design.design_file import load_design, read_draft
from sandbox.study.design.meaning.findings import findings
from tests.sandbox.study.design.spoken_designs import CONSENT, spoken

FOLDER = Path(__file__).with_name("flawed")
FOUND = {
    "01-spanish-name": ("demographics[1]", "asks for a name"),
    "02-where-to-send-the-voucher": ("demographics[2]", "asks for an address"),
    "03-born-on": ("demographics[1]", "birth date together"),
    "04-three-by-three": ("participants", "the interaction of encoder x task with practice"),
    "05-five-in-two-groups": ("participants", "groups differ in size"),
    "06-one-each": ("factors[1].order", "cannot be told from who met it"),
    "07-only-good-people": ("exclusions[1]", "leaves out people because of success"),
    "08-only-fast-trials": ("exclusions[1]", "leaves out what takes long"),
    "09-rule-that-never-applies": ("exclusions[1]", "excludes nothing"),
    "10-always-the-old-one-first": ("factors[1].order", "told from practice"),
    "11-one-level": ("factors[1].levels", "nothing is compared"),
    "12-the-same-twice": ("factors[1].levels", "best and new are the same"),
    "13-two-things-at-once": ("factors[1].levels", "several settings at once"),
    "14-a-second-is-enough": ("trials.time_limit_s", "cut off"),
    "15-a-whole-day": ("breaks.every", "without a break"),
    "16-no-practice": ("trials.practice", "nobody practises"),
    "17-told-which-is-better": ("instructions[2]", "only best is announced"),
    "18-day-and-condition": ("factors[1].order", "told from the session"),
    "19-the-same-goal-again": ("trials.seeds", "remembered"),
    "20-by-chance": ("factors[1].order", "paper comes first in 3 of 4 orders"),
    "21-credit-for-those-who-stay": ("consent.text", "not given freely"),
    "22-practised-on-the-first-day": ("trials.practice_sessions", "before anybody has practised"),
    "23-four-people": ("participants", "even a large effect"),
    "24-the-old-and-the-new": ("instructions[2].text", "expected to be better"),
    "25-at-most-sixty": ("demographics[1]", "speaks of people of 65"),
    "26-fast-here-careful-there": ("instructions[1].text", "speed in en and not in de"),
    "27-twelve-trials": ("consent.text", "12 trials, and a session has 72"),
    "28-time-goes-on": ("trials.when_gone", "while the page is gone"),
    "29-in-milliseconds": ("exclusions[1]", "waited_s is from 0 to 900 s"),
    "30-a-part-of-the-course": ("consent.text", "not given freely"),
    "31-initials-and-a-card": ("demographics[2]", "asks for a name"),
    "32-advice-for-one": ("instructions[3].text", "216 letters are said before best"),
    "33-which-did-you-prefer": ("questionnaires[1].items[1].ask", "everybody meets only one"),
    "34-no-waiting": ("analysis.primary", "is 0 in every trial"),
    "35-one-scale-turned-round": ("questionnaires[1].items[1]", "in opposite directions"),
    "36-two-things-in-one": ("questionnaires[1].items[1].ask", "two things at once"),
    "37-tired-and-relaxed": ("questionnaires[1].scales[1]", "relaxed and effortless run against"),
    "38-a-hundred-and-five": ("questionnaires[1].scales[1].items", "mostly that of ermuedung"),
    "39-mark-the-two": ("questionnaires[1].scales[1].items", "checks whether people read"),
    "40-exhausted-at-both-ends": ("questionnaires[1].items[1]", "in opposite directions"),
    "41-told-in-the-second-session": ("instructions[1].sessions", "only in session 2"),
    "42-a-bonus-for-one": ("instructions[3].text", "pay is promised before best"),
    "43-taught-and-untaught": ("factors[1].order", "no order balances"),
    "44-young-and-old": ("factors[1].levels", "is a property of people"),
    "45-nothing-is-recorded": ("consent.text", "every touch, movement and time is recorded"),
    "46-children-alone": ("consent.text", "people below 18 consent alone"),
    "47-the-partner-next-door": ("consent.text", "somebody who moves the second hand"),
    "48-never-in-the-same-task": ("factors[2].levels", "best and paper never occur"),
    "49-quick-and-pleasant": ("questionnaires[1].items[1].ask", "two things at once"),
    "50-the-slowest-again": ("consent.text", "extreme earlier result"),
    "51-thinking-aloud": ("instructions[1].text", "talk while their time"),
    "52-paid-by-the-minute": ("consent.text", "who is slow is paid more"),
    "53-skip-what-is-hard": ("instructions[1].text", "finds a trial hard"),
    "54-in-twos": ("consent.text", "see how others do it"),
    "55-ten-sessions-before": ("consent.text", "know one of the compared levels"),
    "56-95-of-100": ("instructions[2].text", "how well others do"),
    "57-equal-by-a-t-test": ("title", "does not show that there is none"),
    "58-go-on-at-home": ("instructions[3].text", "practise between the sessions"),
    "59-only-24-of-30": ("consent.text", "only those who did well"),
    "60-choose-4": ("questionnaires[1].title", "who does not know"),
    "61-low-mood": ("questionnaires[1].items[4].ask", "no text names help"),
    "62-release-from-claims": ("consent.text", "give up rights"),
    "63-the-previous-hand": ("questionnaires[1].items[1].ask", "the one before"),
    "64-to-the-engineer": ("instructions[1].text", "rate to somebody's face"),
    "65-other-scale-after": ("questionnaires[2]", "is no gain"),
    "66-or-repeat-the-course": ("consent.text", "not given freely"),
    "67-our-own-method": ("instructions[1].text", "expected to be better"),
    "68-grit-your-teeth": ("instructions[1].text", "told to bear pain"),
    "69-never-asked": ("questionnaires[1]", "never asked"),
    "70-tired-fingers": ("analysis.primary", "speaks of tires"),
}


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.toml")))
def test_its_flaw_is_found_with_line_and_remedy(name: str) -> None:
    place, told = FOUND[name]
    path = FOLDER / f"{name}.toml"
    design = read_draft(path) or load_design(path)
    found = [f.mistake for f in findings(design) if told in f.mistake.what]
    mistake = found[0]
    assert mistake.where == place and mistake.remedy
    line = path.read_text(encoding="utf-8").splitlines()[mistake.line - 1]
    key = place.rpartition(".")[2]
    table = "[[" + re.sub(r"\[\d+\]", "", place) + "]]"
    assert line.startswith(table if key.endswith("]") else key)


def test_simulate_shows_them_before_it_begins(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design = FOLDER / "10-always-the-old-one-first.toml"
    assert main(["study", "check", str(design)]) == 0
    warning = capsys.readouterr().out.splitlines()[0]
    (tmp_path / "always-the-old-one-first-simulated").write_text("in the way")
    assert main(["study", "simulate", str(design), "--out", str(tmp_path)]) == 2
    assert warning.startswith("warning, line 15") and warning in capsys.readouterr().out


def test_a_mistake_in_the_outcomes_hides_no_flaw_of_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (FOLDER / "36-two-things-in-one.toml").read_text(encoding="utf-8")
    design = tmp_path / "design.toml"
    design.write_text(text.replace('primary = ["opinion"]', 'primary = ["opinions"]'))
    assert main(["study", "check", str(design)]) == 2
    told = "".join(capsys.readouterr())
    assert "two things at once" in told and "unknown outcome 'opinions'" in told
    assert read_draft(FOLDER / "34-no-waiting.toml") is None


def test_a_text_that_lacks_a_language_hides_no_flaw_of_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    in_two = (
        '\n[[questionnaires]]\nname = "q"\nat = "end"\ntitle = {en = "Q", fr = "Q"}\n'
        '[[questionnaires.items]]\nname = "i"\nkind = "scale"\n'
        'low_means = {en = "not at all"}\nhigh_means = {en = "very", fr = "beaucoup"}\n'
        'ask = {en = "Was it quick?", fr = "Était-ce rapide et agréable ?"}\n'
    )
    consent = f'text = {{en = "{CONSENT["en"]}"}}'
    text = re.sub('text = "[^"]*"', consent, spoken("en")).replace('["en"]', '["en", "fr"]')
    text = text.replace('ask = "How old are you?"', 'ask = {en = "Your age?", fr = "Âge ?"}')
    design = tmp_path / "design.toml"
    design.write_text(text + in_two + '[[questionnaires]]\nuse = "sus"\nat = "end"\n', "utf-8")
    assert main(["study", "check", str(design)]) == 2
    told = "".join(capsys.readouterr())
    assert "two things at once" in told and told.count("warning") == 1
    assert "3 mistakes" in told and "the text is missing in fr" in told
