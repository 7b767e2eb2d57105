"""`study check` reads texts: consent, promises, expectations, questions, and their translations."""

from __future__ import annotations

import pytest

from sandbox.study.design.meaning.findings import findings
from tests.support.study_files import SOUND, design

FREE = "Your touches are recorded. You may stop at any time."
TWO = SOUND.replace("seed = 3", 'seed = 3\nlanguages = ["en", "de"]')
ASKED = '\n[[demographics]]\nname = "q"\n'


def consenting(text: str, code: str = "en") -> str:
    """The design with another consent, in a language."""
    assert FREE in SOUND
    told = SOUND.replace(FREE, text)
    return told.replace("seed = 3", f'seed = 3\nlanguages = ["{code}"]')


def instructed(text: str, at: str = "start", code: str = "en") -> str:
    """The design with an instruction more, in a language."""
    english = {
        "en": FREE,
        "de": "Daten werden aufgezeichnet. Sie können jederzeit aufhören.",
        "fr": "Vos données sont enregistrées. Vous pouvez arrêter à tout moment.",
        "zh": "我们会记录数据，您可以随时停止。",
    }
    return consenting(english[code], code) + f'\n[[instructions]]\nat = "{at}"\ntext = "{text}"\n'


def told(text: str) -> list[str]:
    return [f.mistake.what for f in findings(design(text))]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("Participation is mandatory for everybody in this course.", "en"),
        ("If you quit before the last trial, you will not be paid.", "en"),
        ("Once you have begun, you cannot stop.", "en"),
        ("Data that were recorded will never be deleted.", "en"),
        ("Payment is made only if you finish.", "en"),
        ("Your teacher will be told if you refuse.", "en"),
        ("Die Teilnahme ist für alle Studierenden verpflichtend.", "de"),
        ("Wer vorzeitig abbricht, erhält keine Vergütung.", "de"),
        ("Les données ne pourront pas être effacées.", "fr"),
        ("您必须完成所有试次。", "zh"),
    ],
)
def test_a_consent_that_is_forced_is_found(text: str, code: str) -> None:
    (what,) = told(consenting(text, code))
    assert "not given freely" in what and text in what


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("We record data. You may stop at any time, and are paid in full anyway.", "en"),
        ("We record data. If you stop, you will not lose your credit.", "en"),
        ("You can stop. After data have been made anonymous, they cannot be deleted.", "en"),
        ("You are not required to take part, and free to leave. We record data.", "en"),
        ("The information sheet says the rest.", "en"),
        ("Nobody is required to finish all trials. You can stop. We record data.", "en"),
        ("You can stop, and get 5 euros even if you do not finish. We record data.", "en"),
        ("We record data, and hope to learn more about hands. You can stop any time.", "en"),
        ("We record data. You can stop. We expect that it takes less than an hour.", "en"),
        ("Die Teilnahme ist nicht verpflichtend. Sie müssen nicht alle Daten angeben.", "de"),
        ("Wir zeichnen Daten auf. Sie können aufhören, ohne etwas zu verlieren.", "de"),
        ("Nous enregistrons vos données. Vous pouvez arrêter sans conséquence.", "fr"),
    ],
)
def test_a_consent_that_is_free_is_let_be(text: str, code: str) -> None:
    assert told(consenting(text, code)) == []


def test_a_consent_says_that_people_may_stop_and_what_is_recorded() -> None:
    (what,) = told(consenting("This is a study."))
    assert what == "consent does not say that people may stop and what is recorded"
    (what,) = told(consenting("Sie können jederzeit aufhören.", "de"))
    assert what == "consent does not say what is recorded"


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("There are 40 trials.", "it speaks of 40 trials, and a session has 4"),
        ("There are forty trials.", "it speaks of 40 trials, and a session has 4"),
        ("It takes half a minute.", ""),
        ("You get 50 cents for each trial, and 20 cents a trial.", ""),
        ("You come to three sessions.", "it speaks of 3 sessions, and the design has 1"),
        ("There are regular breaks.", "it promises breaks, and none comes"),
        ("You may have breaks whenever you like.", ""),
        ("Each trial ends after 45 seconds.", "it speaks of 45 s, and a trial ends after 0.3 s"),
        ("There are 4 trials, and 6 with practice.", ""),
        ("It takes about 20 minutes.", ""),
        ("It takes about 1 minute.", "it promises 1 min, and a session takes about 4"),
        ("The questionnaire takes about 1 minute.", ""),
        ("You get 10 euros. Data are kept for 10 years.", ""),
    ],
)
def test_numbers_that_people_are_told_are_those_of_the_plan(text: str, wanted: str) -> None:
    found = told(consenting(f"{FREE} {text}"))
    assert [what.partition(":")[0] for what in found] == ([wanted] if wanted else [])


@pytest.mark.parametrize(
    ("text", "code", "judges"),
    [
        ("Now comes our improved hand.", "en", True),
        ("In this part you use our new way, which is much better.", "en", True),
        ("This one is known to be slower.", "en", True),
        ("Jetzt kommt unser neues Verfahren.", "de", True),
        ("Voici la méthode la plus rapide.", "fr", True),
        ("现在的方法更快。", "zh", True),
        ("The hand will now follow your fingers in another way.", "en", False),
        ("Now another part begins. Be as fast as you can, and do your best.", "en", False),
        ("We want to know which way is better.", "en", False),
        ("Bitte arbeiten Sie so schnell wie möglich.", "de", False),
        ("请尽快完成。", "zh", False),
    ],
)
def test_nobody_is_told_which_level_is_better(text: str, code: str, judges: bool) -> None:
    found = told(instructed(text, "contact", code))
    assert ["expected to be better" in what for what in found] == [True] * judges


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("Most people find the second part much easier.", "en"),
        ("The first method is the one that everybody complains about.", "en"),
        ("Im zweiten Teil wird es Ihnen leichter fallen.", "de"),
        ("Vous verrez que la seconde méthode est plus agréable.", "fr"),
    ],
)
def test_what_others_found_is_not_told(text: str, code: str) -> None:
    (what,) = told(instructed(text, "start", code))
    assert "expected to be better" in what


def test_a_hypothesis_is_found_in_any_text_before_trials() -> None:
    (what,) = told(instructed("We expect that soft things are easier to hold."))
    assert "expected to be better" in what
    assert told(instructed("We hope that you enjoy it.")) == []
    assert told(instructed("We had expected that soft things are easier.", "end")) == []


@pytest.mark.parametrize(
    ("item", "wanted"),
    [
        ('ask = "Your age"\nkind = "number"\nlow = 18\nhigh = 60', "older than 60"),
        ('ask = "Your age"\nkind = "number"\nlow = 18\nhigh = 99', ""),
        ('ask = "Your age"\nkind = "number"\nlow = 18\nhigh = 60\noptional = true', ""),
        ('ask = "How long?"\nkind = "choice"\nchoices = ["0-5", "5-10", "over 10"]', "5 fits two"),
        ('ask = "How long?"\nkind = "choice"\nchoices = ["0-4", "6-10", "over 10"]', "5 fits no"),
        ('ask = "How long?"\nkind = "choice"\nchoices = ["0", "1-5", "6 or more"]', ""),
        ('ask = "Your gender?"\nkind = "choice"\nchoices = ["female", "male"]', "is personal"),
        ('ask = "Your gender?"\nkind = "choice"\nchoices = ["f", "m", "prefer not to say"]', ""),
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
        ('ask = "Any comments?"\nkind = "text"', "nothing to say"),
        ('ask = "Any comments?"\nkind = "text"\noptional = true', ""),
        ('ask = "How much faster was it?"\nkind = "text"', "it leads to an answer"),
        ('ask = "How old are you?"\nkind = "number"\nlow = 18', "asks the same as age"),
    ],
)
def test_everybody_can_answer_every_question(item: str, wanted: str) -> None:
    found = told(SOUND + ASKED + item + "\n")
    assert len(found) == bool(wanted) and all(wanted in what for what in found)


@pytest.mark.parametrize(
    ("english", "german", "wanted"),
    [
        ("Be as fast as you can.", "Arbeiten Sie in aller Ruhe.", "asks for speed in en"),
        ("Be careful.", "Fangen Sie an.", "asks for care in en"),
        ("Be quick.", "Bitte beeilen Sie sich.", ""),
        ("Move the box onto its twin.", "Move the box onto its twin.", "is the same in en and de"),
        ("There are 2 parts.", "Es gibt 3 Teile.", "numbers differ: 2 in en, 3 in de"),
        ("There are 2 parts.", "Es gibt zwei Teile.", ""),
        ("Now begin.", "Now you will see the box on the left.", "for de is written in en"),
        (
            "Bring the box onto its twin, then let it go and take your hand off the screen.",
            "Bringen Sie die Kiste dahin.",
            "the text in en is much longer",
        ),
    ],
)
def test_texts_say_the_same_in_all_languages(english: str, german: str, wanted: str) -> None:
    text = f'\n[[instructions]]\ntext = {{en = "{english}", de = "{german}"}}\n'
    both = (
        f'name = "two"\nlanguages = ["en", "de"]\ntitle = {{en = "Two", de = "Zwei"}}\n'
        '[settings]\ntask = "box-to-goal"\n[[factors]]\nname = "contact"\norder = "latin"\n'
        'levels = ["hard", "soft"]\n[trials]\npractice = 2\n[consent]\n'
        f'text = {{en = "{FREE}", de = "Wir speichern Daten. Sie können jederzeit aufhören."}}\n'
    )
    found = told(both + text)
    assert len(found) == bool(wanted) and all(wanted in what for what in found)


@pytest.mark.parametrize(
    ("text", "at", "wanted"),
    [
        ("TODO: what is to be done", "start", "is not ready"),
        ("Ask [name of the researcher] for help.", "start", "is not ready"),
        ("Put your fingers down, and be as fast as you can.", "end", "comes after the last one"),
        ("That was all. Thank you! Ask us what you would like to know.", "end", ""),
    ],
)
def test_a_text_is_ready_and_comes_in_time(text: str, at: str, wanted: str) -> None:
    found = told(instructed(text, at))
    assert len(found) == bool(wanted) and all(wanted in what for what in found)


def test_time_matters_where_it_is_the_outcome() -> None:
    text = instructed("Take your time.")
    assert told(text) == []
    (what,) = told(text + '\n[analysis]\nprimary = ["time_s"]\n')
    assert "time does not matter" in what
    assert told(text + '\n[analysis]\nprimary = ["success"]\n') == []
    read = instructed("Take your time to read this.")
    assert told(read + '\n[analysis]\nprimary = ["time_s"]\n') == []


@pytest.mark.parametrize(
    ("text", "code", "twice"),
    [
        ("Be as fast as you can. Take as long as you like, time does not matter.", "en", True),
        ("Arbeiten Sie so schnell wie möglich. Lassen Sie sich Zeit.", "de", True),
        ("Soyez rapide. Prenez votre temps.", "fr", True),
        ("Be as fast as you can. In practice, time does not matter.", "en", False),
        ("Be careful. Time does not matter.", "en", False),
    ],
)
def test_nobody_is_told_to_hurry_and_not_to(text: str, code: str, twice: bool) -> None:
    found = told(instructed(text, "start", code))
    assert ["told to be quick" in what for what in found] == [True] * twice


@pytest.mark.parametrize(
    ("text", "code", "leads"),
    [
        ("How easily did our improved hand move?", "en", True),
        ("Would you agree that it was fun?", "en", True),
        ("It was easy, wasn't it?", "en", True),
        ("Hat Ihnen die verbesserte Hand gefallen?", "de", True),
        ("Das war leicht, nicht wahr?", "de", True),
        ("C'était facile, n'est-ce pas ?", "fr", True),
        ("How easily did the hand move?", "en", False),
        ("Which way was better, and why?", "en", False),
        ("Was hat sich verbessert?", "de", False),
    ],
)
def test_a_question_does_not_tell_its_answer(text: str, code: str, leads: bool) -> None:
    item = f'{ASKED}kind = "text"\noptional = true\nask = "{text}"\n'
    found = told(instructed("1, 2, 3!", "start", code) + item)
    assert ["leads to an answer" in what for what in found] == [True] * leads


def test_a_title_of_a_questionnaire_does_not_judge() -> None:
    form = '\n[[questionnaires]]\nname = "own"\nat = "end"\ntitle = "{}"\n'
    item = '[[questionnaires.items]]\nname = "i"\noptional = true\nask = "Was it well?"\n'
    (what,) = told(SOUND + form.format("About our improved hand") + item)
    assert "leads to an answer" in what
    assert told(SOUND + form.format("About the hand") + item) == []


@pytest.mark.parametrize(
    ("text", "code", "grouped"),
    [
        ("You are now in the control condition.", "en", True),
        ("Sie gehören zur Kontrollgruppe.", "de", True),
        ("Vous êtes dans le groupe témoin.", "fr", True),
        ("You control the hand with your fingers.", "en", False),
    ],
)
def test_nobody_is_told_their_group(text: str, code: str, grouped: bool) -> None:
    found = told(instructed(text, "contact", code))
    assert ["in which group" in what for what in found] == [True] * grouped


def test_what_is_hoped_for_is_not_told_between_sessions() -> None:
    end = '\n[[instructions]]\nat = "end"\n{}text = "We expect that soft is easier."\n'
    two = SOUND.replace("seed = 3", 'seed = 3\nsessions = 2\nlanguages = ["en"]')
    (what,) = told(two + end.format(""))
    assert "expected to be better" in what
    assert told(two + end.format("sessions = [2]\n")) == []
    assert told(SOUND + end.format("")) == []


def test_a_title_in_several_languages_is_that_of_the_first() -> None:
    title = 'title = {en = "Two", de = "Zwei"}\n'
    text = SOUND[: SOUND.index("[consent]")].replace("seed = 3\n", f"seed = 3\n{title}")
    assert design(text.replace("seed = 3", 'seed = 3\nlanguages = ["de", "en"]')).title == "Zwei"
