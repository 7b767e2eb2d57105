"""`study check` finds designs that are right in form and wrong in meaning, one line a cause."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.study.design.meaning.findings import findings
from sandbox.study.design.plan import BreakStep, TrialStep, session_plan
from sandbox.study.design.reading import DesignError
from tests.support.study_files import SOUND as DESIGN
from tests.support.study_files import design

ROOT = Path(__file__).resolve().parents[4]
CONSENT = DESIGN[DESIGN.index("[consent]") : DESIGN.index("[[demographics]]")]
RULE = '\n[[exclusions]]\nname = "rule"\n'
ASKED = '\n[[demographics]]\nname = "{}"\nkind = "text"\nask = "{}"\n'
TWICE_SET = (
    '\n[[factors]]\nname = "again"\norder = "random"\n'
    'levels = [{name = "a", contact = "hard"}, {name = "b", contact = "soft"}]\n'
)
IDENTIFYING = [
    "What is your full name?",
    "Wie heißen Sie?",
    "Ihr Nachname",
    "Comment vous appelez-vous ?",
    "¿Cuál es su correo electrónico?",
    "Qual è il Suo cognome?",
    "Wat is uw geboortedatum?",
    "Qual é a sua data de nascimento?",
    "Fødselsdato",
    "Hva er ditt etternavn?",
    "Podaj imię i nazwisko",
    "Как ваша фамилия?",
    "您的姓名",
    "お名前は",
    "전화번호",
    "Matrikelnummer",
    "Date de naissance (jj/mm/aaaa)",
    "When? (DD.MM.YYYY)",
    "Geben Sie TT.MM.JJJJ ein",
    "Such as anna@example.org",
    "Such as +49 30 123456",
    "Your student ID",
]


def changed(old: str, new: str) -> str:
    assert old in DESIGN
    return DESIGN.replace(old, new, 1)


@pytest.mark.parametrize(
    ("text", "error", "told"),
    [
        (DESIGN + RULE + 'measure = "time_s"\nbelow = 9\nabove = 2\n', True, "excludes everything"),
        (DESIGN + RULE + 'measure = "success"\nbelow = 1.5\n', True, "is from 0 to 1"),
        (DESIGN + RULE + 'measure = "time_s"\nbelow = 601\n', True, "is from 0 to 600"),
        (DESIGN + RULE + 'measure = "success"\nbelow = 1\n', False, "selects on the outcome"),
        (DESIGN + RULE + 'measure = "time_s"\nabove = 9\n', False, "what takes long"),
        (
            changed("repetitions = 2", "repetitions = 2\ntime_limit_s = 0.05\nexpected_s = 0.05"),
            True,
            "no trial can succeed",
        ),
        (
            changed("repetitions = 2", "repetitions = 2\ntime_limit_s = 9"),
            False,
            "more than the time limit",
        ),
        (changed('order = "latin"', 'order = "blocked"'), False, "told from practice"),
        (changed(CONSENT, ""), False, "consent"),
        (DESIGN + "\n[breaks]\nevery = 4\n", False, "no break ever comes"),
        (changed('["hard", "soft"]', '["hard"]'), False, "one level"),
        (changed("participants = 24", "participants = 25"), False, "contact with practice"),
        (DESIGN + RULE + 'measure = "time_s"\nabove = 600\n', False, "excludes nothing"),
        (
            DESIGN + RULE + 'of = "participant"\nmeasure = "success"\nbelow = 0.1\n',
            False,
            "leaves out people because of success",
        ),
        (
            changed("repetitions = 2", "repetitions = 2\ntime_limit_s = 10\nexpected_s = 9"),
            False,
            "cut off",
        ),
        (changed("practice = 1", "practice = 0"), False, "nobody practises"),
        (changed("practice = 1", "practice = 2") + TWICE_SET, True, "the inner factor wins"),
        (DESIGN + ASKED.format("name", "Who are you?"), False, "identifies people"),
        (DESIGN + ASKED.format("contact", "Your e-mail?"), False, "identifies people"),
        (DESIGN + ASKED.format("birth-date", "When?"), False, "identifies people"),
        (DESIGN + ASKED.format("day", "What is your date of birth?"), False, "identifies people"),
    ],
)
def test_a_mistake_of_meaning_is_one_line_with_its_remedy(
    text: str, error: bool, told: str
) -> None:
    (found,) = findings(design(text))
    assert found.error is error and told in found.mistake.what and found.mistake.remedy
    assert 1 <= found.mistake.line <= text.count("\n") + 1


@pytest.mark.parametrize("repetitions", [2, 3, 6])
def test_a_break_after_practice_is_found_and_the_remedy_s_number_avoids_it(
    repetitions: int,
) -> None:
    text = DESIGN.replace("repetitions = 2", f"repetitions = {repetitions}")
    (found,) = findings(design(f"{text}\n[breaks]\nevery = {repetitions}\n"))
    assert "a break comes between the practice of a level of contact and" in found.mistake.what
    better = int(re.findall(r"Write (\d+)", found.mistake.remedy)[0])
    plan = session_plan(design(f"{text}\n[breaks]\nevery = {better}\n"), 0)
    after = [a for a, b in pairwise(plan) if isinstance(b, BreakStep)]
    assert after and all(isinstance(step, TrialStep) and not step.practice for step in after)
    at_once = text.replace('practice_each = "contact"\n', "").replace(
        "practice = 1", "practice = 2"
    )
    assert findings(design(f"{at_once}\n[breaks]\nevery = {repetitions}\n")) == []


def test_a_sound_design_has_none() -> None:
    assert findings(design(DESIGN)) == []
    assert findings(design(DESIGN + "\n[breaks]\nevery = 3\n")) == []
    assert findings(design(DESIGN + RULE + 'measure = "time_s"\nbelow = 0.5\n')) == []
    assert findings(design(DESIGN + ASKED.format("glasses", "Do you wear glasses?"))) == []


@pytest.mark.parametrize("ask", IDENTIFYING)
def test_a_question_that_identifies_is_found_in_many_languages_and_by_the_form_of_its_answer(
    ask: str,
) -> None:
    (found,) = findings(design(DESIGN + ASKED.format("q", ask)))
    assert "identifies people" in found.mistake.what


@pytest.mark.parametrize(
    "ask",
    [
        "What is your mother tongue?",
        "Welches Instrument spielen Sie?",
        "Which game did you name first in your list of games?",
        "Quel est votre métier ?",
        "Что вам понравилось?",
        "何が難しかったですか",
    ],
)
def test_other_questions_in_words_are_let_be(ask: str) -> None:
    assert findings(design(DESIGN + ASKED.format("q", ask))) == []


def test_how_often_one_uses_a_phone_is_no_telephone_number() -> None:
    hours = '\n[[demographics]]\nname = "phone"\nkind = "number"\nlow = 0\nhigh = 24\n'
    assert findings(design(DESIGN + hours + 'ask = "How many hours do you use a phone?"\n')) == []
    number = hours.replace("24", "999999999")
    (found,) = findings(design(DESIGN + number + 'ask = "And which number has it?"\n'))
    assert "identifies people" in found.mistake.what


def test_a_question_of_a_questionnaire_identifies_people_too() -> None:
    item = '\n[[questionnaires.items]]\nname = "who"\nkind = "text"\nask = "Your surname?"\n'
    (found,) = findings(design(DESIGN + item))
    assert found.mistake.where == "questionnaires[1].items[2]"


def test_a_language_that_instruments_lack_is_one_line_each() -> None:
    text = changed("seed = 3", 'seed = 3\nlanguages = ["fi"]')
    text += '\n[[questionnaires]]\nuse = "nasa-tlx"\nat = "end"\n'
    with pytest.raises(DesignError) as caught:
        design(text)
    (mistake,) = caught.value.mistakes
    assert "nasa-tlx" in mistake.what and "missing in fi in" in mistake.what
    assert "translate it there" in mistake.remedy


def test_check_prints_them_and_fails_on_errors_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "design.toml"
    file.write_text(changed("participants = 24", "participants = 25"))
    assert main(["study", "check", str(file)]) == 0
    assert "warning, line 4: participants: 25 people" in capsys.readouterr().out
    file.write_text(DESIGN + RULE + 'measure = "success"\nbelow = 1.5\n')
    assert main(["study", "check", str(file)]) == 2
    said = capsys.readouterr().out
    assert "error, line" in said and "exclusions[1]" in said and "no mistakes" not in said


@pytest.mark.parametrize(
    "name", ["examples/study/design.toml", "sandbox/study/design/template.toml"]
)
def test_our_own_designs_have_none(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    assert findings(design(text)) == []
