"""`study check` finds questions that identify, compare, turn round, or ask two things at once."""

from __future__ import annotations

import pytest

from sandbox.study.design.meaning.findings import findings
from sandbox.study.design.reading import DesignError
from tests.sandbox.study.design.spoken_designs import one as spoken_one
from tests.sandbox.study.design.spoken_designs import spoken
from tests.support.study_files import SOUND, design

ITEM = (
    '\n[[questionnaires]]\nname = "q"\nat = "{}"\ntitle = "Q"\n'
    '[[questionnaires.items]]\nname = "i"\n'
)
MUCH = 'kind = "scale"\nlow_means = "not at all"\nhigh_means = "very"\n'
AGREE = 'kind = "scale"\nlow_means = "strongly disagree"\nhigh_means = "strongly agree"\n'
RULE = '\n[[exclusions]]\nname = "rule"\nof = "trial"\nmeasure = "{}"\nabove = {}\n'
BETWEEN = SOUND.replace('order = "latin"', 'order = "between"').replace("= 24", "= 80")
SHOWN = SOUND.replace("practice = 1", 'practice = 1\nstarts = "shown"', 1)


def told(text: str) -> list[str]:
    return [finding.mistake.what for finding in findings(design(text))]


def one(text: str, wanted: str) -> None:
    found = told(text)
    assert len(found) == bool(wanted) and all(wanted in what for what in found), found


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("Vos initiales", "a name"),
        ("Les quatre derniers chiffres de votre carte d’étudiant", "one person"),
        ("Die letzten vier Ziffern Ihrer Karte", "one person"),
        ("Los últimos cuatro dígitos de su tarjeta", "one person"),
        ("Your employee number", "one person"),
        ("Su código postal", "an address"),
        ("Your Instagram handle", "an account"),
        ("Ihr Benutzername", "an account"),
        ("Your IP address", "an address"),
        ("The license plate of your car", "a number plate"),
        ("Upload a selfie", "a photograph"),
        ("Which apps do you use, such as Instagram?", ""),
        ("How many hours a week do you take pictures?", ""),
        ("Welche Spiele spielen Sie auf der Straße?", ""),
        ("What did you do with your last finger?", ""),
    ],
)
def test_a_question_that_identifies_is_found(text: str, wanted: str) -> None:
    asked = f'\n[[demographics]]\nname = "q"\nkind = "text"\noptional = true\nask = "{text}"\n'
    one(SOUND + asked, wanted)


def test_four_digits_of_a_number_identify_as_well() -> None:
    asked = '\n[[demographics]]\nname = "q"\nkind = "number"\nhigh = 9999\nask = "{}"\n'
    one(SOUND + asked.format("Last four digits of your student number"), "one person")
    one(SOUND + asked.format("Number of hours with a tablet"), "")


@pytest.mark.parametrize(
    ("text", "at", "compares"),
    [
        ("Which of the two methods did you prefer?", "end", True),
        ("Was it easier than the other version?", "end", True),
        ("Which of your two hands did you use?", "end", False),
        ("Which hand do you prefer?", "end", False),
        ("How well did the method work?", "end", False),
        ("Which method was better?", "contact", True),
    ],
)
def test_nobody_compares_what_they_have_not_met(text: str, at: str, compares: bool) -> None:
    asked = ITEM.format(at) + f'kind = "text"\nask = "{text}"\n'
    one(BETWEEN + asked, "meets only one" if compares else "")
    one(SOUND + asked, "")
    if compares:
        one(SOUND + asked.replace(f'at = "{at}"', 'at = "start"'), "nobody has met yet")


@pytest.mark.parametrize(
    ("text", "kind", "double"),
    [
        ("It reacted quickly and did not tire my hand.", AGREE, True),
        ("It was easy and I liked it.", AGREE, True),
        ("It was easy and very comfortable.", AGREE, True),
        ("How fast and accurate was it?", MUCH, True),
        ("My thumb and index finger did what I wanted.", AGREE, False),
        ("It is easy to pick up and place the box.", AGREE, False),
        ("How easy or difficult was it?", MUCH, False),
        ("I often wondered where my hand was.", AGREE, False),
    ],
)
def test_a_question_asks_for_one_thing(text: str, kind: str, double: bool) -> None:
    one(SOUND + ITEM.format("end") + kind + f'ask = "{text}"\n', "two things" if double else "")


@pytest.mark.parametrize(
    ("english", "german", "turned"),
    [
        (("very uncomfortable", "very comfortable"), ("sehr angenehm", "sehr unangenehm"), True),
        (("very uncomfortable", "very comfortable"), ("sehr unangenehm", "sehr angenehm"), False),
        (("strongly disagree", "strongly agree"), ("stimme voll zu", "stimme nicht zu"), True),
        (("strongly disagree", "strongly agree"), ("lehne ab", "stimme zu"), False),
        (("not at all", "very much"), ("gar nicht", "sehr"), False),
        (("not tired", "very tired"), ("gar nicht müde", "sehr müde"), False),
        (("easy", "hard"), ("leicht", "schwer"), False),
        (("easy", "hard"), ("schwer", "leicht"), True),
        (("never", "always"), ("immer", "nie"), True),
    ],
)
def test_a_scale_runs_the_same_way_in_all_languages(
    english: tuple[str, str], german: tuple[str, str], turned: bool
) -> None:
    ends = "".join(
        f'{key} = {{en = "{english[i]}", de = "{german[i]}"}}\n'
        for i, key in enumerate(("low_means", "high_means"))
    )
    text = (
        'name = "two"\nlanguages = ["en", "de"]\nparticipants = 24\n'
        '[settings]\ntask = "box-to-goal"\n[[factors]]\nname = "contact"\norder = "latin"\n'
        'levels = ["hard", "soft"]\n[trials]\npractice = 2\n[consent]\ntext = {en = "We record '
        'data. You may stop.", de = "Wir speichern Daten. Sie können jederzeit aufhören."}\n'
        '[[demographics]]\nname = "q"\nkind = "scale"\nask = {en = "Today?", de = "Heute?"}\n'
    )
    one(text + ends, "opposite directions" if turned else "")


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


@pytest.mark.parametrize(
    ("soft", "wanted"),
    [
        ("Now another part begins. Here is a tip: push from the side.", "advice is said before"),
        ("Now another part begins. Be quick.", "speed is said before"),
        ("Now another part begins. " + "Your hand will follow your fingers. " * 4, "letters"),
        ("The next part begins now.", ""),
    ],
)
def test_all_levels_are_announced_alike(soft: str, wanted: str) -> None:
    text = '\n[[instructions]]\nat = "contact"\nlevel = "{}"\ntext = "{}"\n'
    one(SOUND + text.format("hard", "Now another part begins.") + text.format("soft", soft), wanted)


@pytest.mark.parametrize(
    ("text", "forced"),
    [
        ("Wer abbricht, hat die Übung nicht bestanden.", True),
        ("Otherwise you fail the course.", True),
        ("You will not fail the course. You may stop. We record data.", False),
        ("Participation is a condition of the course.", True),
    ],
)
def test_a_course_is_not_failed_by_those_who_stop(text: str, forced: bool) -> None:
    old = "Your touches are recorded. You may stop at any time. Do you agree?"
    code = "de" if "Wer" in text else "en"
    consent = SOUND.replace(old, text).replace("seed = 3", f'seed = 3\nlanguages = ["{code}"]')
    one(consent, "not given freely" if forced else "")


def test_choices_in_several_languages_are_told_how_they_are_written() -> None:
    asked = '\n[[demographics]]\nname = "q"\nkind = "choice"\nask = "?"\nchoices = '
    asked += '[{en = "a"}, {en = "b"}]\n'
    with pytest.raises(DesignError) as caught:
        design(SOUND + asked)
    (mistake,) = caught.value.mistakes
    assert "stored values" in mistake.what
    assert 'means = [{en = "..."}, ...]' in mistake.remedy


@pytest.mark.parametrize(
    ("code", "text", "double"),
    [
        ("en", "How quick to move and how pleasant to touch were the boxes?", True),
        ("en", "How fast was the hand, and how easy was it to use?", True),
        ("en", "Was the box easy to grasp and comfortable to hold?", True),
        ("en", "How easy was it to see the box and how it turned?", False),
        ("en", "How easy was it to move the box and to let go?", False),
        ("de", "Wie schnell bewegten sich die Dinge und wie angenehm waren sie?", True),
        ("de", "War die Kiste leicht zu greifen und angenehm anzufassen?", True),
        ("de", "Wie leicht war es, die Kiste zu greifen und zu drehen?", False),
        (
            "fr",
            "À quel point la main était-elle rapide et à quel point était-elle agréable ?",
            True,
        ),
        ("fr", "Les objets étaient-ils rapides à déplacer et agréables à toucher ?", True),
        ("fr", "À quel point était-il facile de saisir la boîte et de la tourner ?", False),
        ("es", "¿Cómo de rápida era la mano y cómo de agradable era usarla?", True),
        ("es", "¿Eran los objetos fáciles de mover y agradables de tocar?", True),
        ("es", "¿Cómo de fácil era coger la caja y girarla?", False),
    ],
)
def test_a_question_with_two_judgements_is_found(code: str, text: str, double: bool) -> None:
    asked = ITEM.format("end") + MUCH + f'ask = "{text}"\n'
    spoken_one(spoken(code) + asked, "two things at once" if double else "")


@pytest.mark.parametrize(
    ("code", "text", "relative"),
    [
        ("en", "Compared with the previous hand, how easy was it?", True),
        ("en", "Was this way easier than the one before?", True),
        ("en", "How much effort was it, relative to the previous hand?", True),
        ("en", "Are you more tired than before the study?", False),
        ("en", "Compared with the last week, how did you sleep?", False),
        ("de", "Verglichen mit der vorigen Hand: Wie leicht war es?", True),
        ("de", "War es leichter als bei der vorherigen?", True),
        ("de", "Wie leicht war es, verglichen mit dem, was Sie erwarteten?", False),
        ("fr", "Par rapport à la main précédente, était-ce facile ?", True),
        ("fr", "Était-ce plus facile qu'avec celle d'avant ?", True),
        ("fr", "Par rapport à une vraie main, était-ce facile ?", False),
        ("es", "En comparación con la mano anterior, ¿fue fácil?", True),
        ("es", "¿Fue más fácil que con la anterior?", True),
        ("es", "¿Fue más fácil de lo que esperaba?", False),
    ],
)
def test_a_comparison_with_the_level_before_is_found(code: str, text: str, relative: bool) -> None:
    asked = ITEM + MUCH + f'ask = "{text}"\n'
    wanted = "the one before" if relative else ""
    spoken_one(spoken(code) + asked.format("contact"), wanted)
    spoken_one(spoken(code) + asked.format("end"), "")


def test_choices_with_both_of_their_ends_do_not_overlap() -> None:
    choices = '"less than 1 hour", "1 hour or more, less than 3", "3 hours or more, less than 5"'
    asked = f'\n[[demographics]]\nname = "h"\nkind = "choice"\nchoices = [{choices}]\n'
    one(SOUND + asked + 'ask = "How long do you use tablets?"\n', "")
    wider = asked.replace("more, less than 3", "more, less than 4")
    one(SOUND + wider + 'ask = "How long do you use tablets?"\n', "3 fits two choices")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "Please choose 4 if you do not know.", True),
        ("en", "If it does not apply to you, tick the middle.", True),
        ("en", "Choose a point from 1 to 7; if you do not know, leave it out.", False),
        ("en", "Choose the first answer that comes to your mind, from 1 to 7.", False),
        ("de", "Wählen Sie 4, wenn Sie es nicht wissen.", True),
        ("de", "Was nicht zutrifft, kreuzen Sie in der Mitte an.", True),
        ("de", "Wenn Sie es nicht wissen, lassen Sie die Frage aus.", False),
        ("fr", "Choisissez 4 si vous ne savez pas.", True),
        ("fr", "Cochez le milieu si cela ne vous concerne pas.", True),
        ("fr", "Si vous ne savez pas, laissez la réponse vide.", False),
        ("es", "Marque 4 si no lo sabe.", True),
        ("es", "Elija el centro si no se aplica.", True),
        ("es", "Si no lo sabe, deje la respuesta en blanco.", False),
    ],
)
def test_a_point_for_those_who_do_not_know_is_found(code: str, text: str, wrong: bool) -> None:
    wanted = "who does not know" if wrong else ""
    asked = ITEM.format("end") + MUCH + 'ask = "?"\n'
    spoken_one(spoken(code) + asked.replace('"Q"', f'"{text}"'), wanted)
    told_before = f'[[instructions]]\nat = "end"\ntext = "{text}"\n'
    spoken_one(spoken(code) + asked + told_before, wanted)
    spoken_one(spoken(code) + told_before, "")


@pytest.mark.parametrize(
    ("end", "wrong"),
    [("do not know", True), ("not applicable", True), ("not sure at all", False), ("none", False)],
)
def test_not_to_know_is_no_end_of_a_scale(end: str, wrong: bool) -> None:
    asked = ITEM.format("end") + MUCH.replace("not at all", end) + 'ask = "Was it good?"\n'
    one(SOUND + asked, "no amount" if wrong else "")


_TWICE = (
    '\n[[questionnaires]]\nname = "{}"\nat = "{}"\ntitle = "Q"\n[[questionnaires.items]]\n'
    'name = "{}"\nkind = "scale"\nhigh = {}\nlow_means = "{}"\nhigh_means = "very"\nask = "{}"\n'
)


@pytest.mark.parametrize(
    ("high", "low_means", "ask", "wanted"),
    [
        (10, "not at all", "How sure do you feel with tablets?", ""),
        (10, "not at all", "How sure do you feel with tablets now?", ""),
        (100, "not at all", "How sure do you feel with tablets?", "is from 0 to 100"),
        (10, "not at all", "How much did the hand obey?", "asks something else"),
        (10, "nothing", "How sure do you feel with tablets?", "other words"),
    ],
)
@pytest.mark.parametrize(
    ("first", "second", "title"),
    [
        ("trust-before", "trust-after", ""),
        ("pre_trust", "post_trust", ""),
        ("vertrauen-vorher", "vertrauen-nachher", ""),
        ("a", "b", "Trust before and after a trial"),
    ],
)
def test_before_and_after_are_asked_by_the_same_question(
    high: int, low_means: str, ask: str, wanted: str, first: str, second: str, title: str
) -> None:
    same = "How sure do you feel with tablets?"
    before = _TWICE.format(first, "start", "one", 10, "not at all", same)
    after = _TWICE.format(second, "end", "two", high, low_means, ask)
    titled = SOUND.replace("seed = 3", f'title = "{title}"\nseed = 3')
    one(titled + before + after, wanted)
    if not title:
        one(SOUND + before.replace(first, "other") + after, "")
