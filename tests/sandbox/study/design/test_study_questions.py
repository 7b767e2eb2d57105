"""`study check` looks at scores, answers, translations, and rules that nothing can reach."""

from __future__ import annotations

import pytest

from sandbox.study.design.checks import findings
from sandbox.study.design.reading import DesignError
from tests.support.study_files import SOUND, design

TWO = SOUND[: SOUND.index("[consent]")].replace("seed = 3", 'seed = 3\nlanguages = ["en", "de"]')
TWO += '[consent]\ntext = {en = "Do you agree?", de = "Stimmen Sie zu?"}\n'
ASKED = '\n[[demographics]]\nname = "q"\n'
RULE = '\n[[exclusions]]\nname = "rule"\nof = "trial"\nmeasure = "{}"\nabove = {}\n'
SHOWN = SOUND.replace("practice = 1", 'practice = 1\nstarts = "shown"', 1)


def one(text: str, wanted: str) -> None:
    """Asserts that a design has one finding, with these words; none if there are no words."""
    found = [finding.mistake for finding in findings(design(text))]
    assert len(found) == bool(wanted), found
    assert all(wanted in mistake.what and mistake.remedy for mistake in found), found


def asking(bounds: list[tuple[int, int]]) -> str:
    """The design with a questionnaire of questions with some bounds, and their mean as score."""
    text = SOUND + '\n[[questionnaires]]\nname = "own"\nat = "contact"\ntitle = "Q"\n'
    for i, (low, high) in enumerate(bounds):
        text += (
            f'[[questionnaires.items]]\nname = "i{i}"\nkind = "scale"\nlow = {low}\n'
            f'high = {high}\nlow_means = "no"\nhigh_means = "yes"\nask = "Was it so {i}?"\n'
        )
    names = ", ".join(f'"i{i}"' for i in range(len(bounds)))
    return text + (f'[[questionnaires.scales]]\nname = "score"\nrule = "mean"\nitems = [{names}]\n')


@pytest.mark.parametrize(
    ("bounds", "wanted"),
    [
        ([(0, 100), (1, 5)], "i0 goes from 0 to 100, and i1 from 1 to 5"),
        ([(1, 5), (1, 7)], "mostly that of i1"),
        ([(1, 7), (1, 7)], ""),
        ([(0, 6), (1, 7)], ""),
    ],
)
def test_items_of_a_score_have_the_same_range(bounds: list[tuple[int, int]], wanted: str) -> None:
    one(asking(bounds), wanted)


@pytest.mark.parametrize(
    ("asked", "wanted"),
    [
        ((("i0", "i1"), ("i0", "i2"), ("i1", "i2")), ""),
        ((("i0", "i1"), ("i0", "i2"), ("i0", "i1")), "i0 is in 3 comparisons of score, and i2"),
    ],
)
def test_weights_come_from_equally_many_comparisons(
    asked: tuple[tuple[str, str], ...], wanted: str
) -> None:
    text = asking([(1, 7)] * 3)
    scale = text.index("[[questionnaires.scales]]")
    pairs = "".join(
        f'[[questionnaires.items]]\nname = "p{i}"\nkind = "choice"\n'
        f'choices = ["{one_of}", "{other}"]\nask = "Which one?"\n'
        for i, (one_of, other) in enumerate(asked)
    )
    rule = 'rule = "weighted"\npairs = ["p0", "p1", "p2"]'
    one(text[:scale] + pairs + text[scale:].replace('rule = "mean"', rule), wanted)


@pytest.mark.parametrize(
    ("item", "wanted"),
    [
        ('ask = "Was it hard?"\nkind = "scale"', "nobody is told"),
        ('ask = "Was it hard, from 0 (no) to 100 (yes)?"\nkind = "scale"', ""),
        (
            'ask = "Was it hard?"\nkind = "scale"\nlow_means = "no"\nhigh_means = "no"',
            "the same words",
        ),
        (
            'ask = "Which?"\nkind = "choice"\nchoices = ["a", "b"]\nmeans = ["one", "One"]',
            "are both called",
        ),
        ('ask = "How old are you?"\nkind = "number"\nlow = 18', "asks the same as age"),
    ],
)
def test_answers_are_told_from_each_other(item: str, wanted: str) -> None:
    one(SOUND + ASKED + item + "\n", wanted)


@pytest.mark.parametrize(
    ("english", "german", "wanted"),
    [
        ("Move the box onto its twin.", "Move the box onto its twin.", "is the same in en and de"),
        ("There are 2 parts.", "Es gibt 3 Teile.", "numbers differ: 2 in en, 3 in de"),
        ("There are 2 parts.", "Es gibt zwei Teile.", ""),
        ("Move the box onto its twin.", "Bringen Sie die Kiste dahin.", ""),
    ],
)
def test_texts_are_translated_with_the_same_numbers(english: str, german: str, wanted: str) -> None:
    one(f'{TWO}\n[[instructions]]\ntext = {{en = "{english}", de = "{german}"}}\n', wanted)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (SOUND + RULE.format("waited_s", 20000), "from 0 to 900 s"),
        (SOUND + RULE.format("away_s", 10), ""),
        (SOUND + RULE.format("placement_error_m", 50), "from 0 to 1 m"),
        (SOUND + RULE.format("latency_p95_ms", 0.1), "is in milliseconds"),
        (SOUND + RULE.format("latency_p95_ms", 100), ""),
        (SHOWN + RULE.format("waited_s", 5), "from 0 to 0 s"),
        (SHOWN + '[analysis]\nprimary = ["waited_s"]\n', "0 in every trial"),
        (SOUND + '[analysis]\nprimary = ["waited_s"]\n', ""),
        (SOUND + '[analysis]\nprimary = ["first_contact_s"]\n', "0 in every trial"),
        (SOUND + '[analysis]\nprimary = ["lost_s"]\n', "how well the machine ran"),
    ],
)
def test_rules_and_outcomes_can_be_reached(text: str, wanted: str) -> None:
    one(text, wanted)


def test_choices_in_several_languages_are_told_how_they_are_written() -> None:
    asked = '\n[[demographics]]\nname = "q"\nkind = "choice"\nask = "?"\nchoices = '
    asked += '[{en = "a"}, {en = "b"}]\n'
    with pytest.raises(DesignError) as caught:
        design(SOUND + asked)
    (mistake,) = caught.value.mistakes
    assert "stored values" in mistake.what
    assert 'means = [{en = "..."}, ...]' in mistake.remedy
