"""`study check` looks at scales: the items of a score, their directions, and their answers."""

from __future__ import annotations

import pytest

from sandbox.study.design.meaning.findings import findings
from tests.sandbox.study.design.spoken_designs import CONSENT, one, spoken
from tests.support.study_files import design

MUCH = {
    "en": ("not at all", "extremely"),
    "de": ("gar nicht", "sehr"),
    "fr": ("pas du tout", "tout à fait"),
    "es": ("nada", "muchísimo"),
    "it": ("per niente", "moltissimo"),
    "nl": ("helemaal niet", "heel erg"),
    "pt": ("nada", "muito"),
    "zh": ("一点也不", "非常"),
    "ja": ("まったくない", "非常に"),
}


def asking(
    asks: list[str],
    code: str = "en",
    ends: list[tuple[str, str]] | None = None,
    reverse: tuple[int, ...] = (),
    bounds: list[tuple[int, int]] | None = None,
    at: str = "contact",
) -> str:
    """The design with a questionnaire of some questions, and the mean of them as its score."""
    text = spoken(code) + f'\n[[questionnaires]]\nname = "own"\nat = "{at}"\ntitle = "Q"\n'
    for i, ask in enumerate(asks):
        low, high = (ends or [MUCH[code]] * len(asks))[i]
        least, most = (bounds or [(1, 7)] * len(asks))[i]
        text += (
            f'[[questionnaires.items]]\nname = "i{i}"\nkind = "scale"\nlow = {least}\n'
            f'high = {most}\nlow_means = "{low}"\nhigh_means = "{high}"\nask = "{ask}"\n'
        )
    names = ", ".join(f'"i{i}"' for i in range(len(asks)))
    turned = ", ".join(f'"i{i}"' for i in reverse)
    return text + (
        f'[[questionnaires.scales]]\nname = "score"\nrule = "mean"\nitems = [{names}]\n'
        f"reverse = [{turned}]\n"
    )


@pytest.mark.parametrize(
    ("asks", "code", "reverse", "wanted"),
    [
        (("How tired were you?", "How tense was your hand?", "How relaxed?"), "en", (), "i2 run"),
        (("I felt in control.", "I enjoyed it.", "I was frustrated."), "en", (), "i2 run against"),
        (("It was easy.", "It was pleasant.", "It was not easy to hold."), "en", (), "i2 run"),
        (("Wie müde sind Sie?", "Wie erholt und ausgeruht sind Sie?"), "de", (), "i1 run"),
        (("Die Hand war zuverlässig.", "Die Bewegung war mühsam."), "de", (), "i1 run against i0"),
        (("Étiez-vous fatigué ?", "Étiez-vous détendu ?"), "fr", (), "i1 run against i0"),
        (("¿Estaba cansado?", "¿Se sentía relajado?"), "es", (), "i1 run against i0"),
        (("È stato faticoso?", "È stato piacevole?"), "it", (), "i1 run against i0"),
        (("Was het vermoeiend?", "Was het prettig?"), "nl", (), "i1 run against i0"),
        (("Foi cansativo ou doloroso?", "Sentiu-se relaxado?"), "pt", (), "i1 run against i0"),
        (("您感到疲劳吗？", "您感到轻松吗？"), "zh", (), "i1 run against i0"),
        (("I was in control.", "It did things that I did not intend."), "en", (), "i1 run"),
        (("Ich fühlte mich gehetzt.", "Alles war unter Kontrolle."), "de", (), "i1 run against i0"),
        (("La main obéissait.", "La main était lente."), "fr", (), "i1 run against i0"),
        (("La mano hacía lo que yo quería.", "Fue incómodo."), "es", (), "i1 run against i0"),
        (("How tired were you?", "How relaxed were you?"), "en", (1,), ""),
        (("How tired were you?", "How tense were you?"), "en", (1,), "i1 run against i0"),
        (("How tired were you?", "How often did you lose the box?"), "en", (), ""),
        (("It was easy.", "It was not difficult.", "I was never tense."), "en", (), ""),
        (("The hand did what I wanted.", "I felt that it was mine."), "en", (), ""),
    ],
)
def test_items_that_run_against_the_others_are_reversed(
    asks: tuple[str, ...], code: str, reverse: tuple[int, ...], wanted: str
) -> None:
    one(asking(list(asks), code, reverse=reverse), wanted)


def test_a_score_says_which_items_to_reverse() -> None:
    (found,) = findings(design(asking(["I was tired.", "I was tense.", "I was relaxed."])))
    assert found.mistake.remedy == 'Write reverse = ["i2"]'
    (found,) = findings(design(asking(["I was tired.", "I was tense."], reverse=(1,))))
    assert found.mistake.remedy == "Remove `reverse`"


@pytest.mark.parametrize(
    ("ends", "wanted"),
    [
        ([("not at all", "very"), ("very", "not at all")], "i1 run against i0"),
        ([("strongly disagree", "strongly agree"), ("fully agree", "do not agree")], "against"),
        ([("exhausted", "rested"), ("tense", "relaxed")], ""),
        ([("exhausted", "rested"), ("relaxed", "tense")], "i1 run against i0"),
        ([("not tired at all", "very tired"), ("not at all", "extremely")], ""),
    ],
)
def test_ends_of_a_scale_decide_in_which_direction_an_item_runs(
    ends: list[tuple[str, str]], wanted: str
) -> None:
    one(asking(["I was tired.", "My hand was tense."], ends=ends), wanted)


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
    one(asking(["How tired were you?", "How tense were you?"], bounds=bounds), wanted)


@pytest.mark.parametrize(
    ("ask", "code", "checks"),
    [
        ("Please select 2 here.", "en", True),
        ("To show that you are reading, leave it in the middle.", "en", True),
        ("This is an attention check: choose “strongly disagree”.", "en", True),
        ("Bitte kreuzen Sie hier die 3 an.", "de", True),
        ("Damit wir prüfen können, ob Sie aufmerksam lesen: ganz links.", "de", True),
        ("Pour vérifier que vous lisez, cochez la case 4.", "fr", True),
        ("Para comprobar que está leyendo, marque aquí el 2.", "es", True),
        ("Per verificare che stia leggendo, scelga il numero 3.", "it", True),
        ("Kies hier alstublieft de 6.", "nl", True),
        ("Para verificar que está a ler, marque o 5.", "pt", True),
        ("请选择数字3。", "zh", True),
        ("ここでは3を選んでください。", "ja", True),
        ("Leave this one at 1, please.", "en", True),
        ("For quality control, please answer 'extremely' here.", "en", True),
        ("Zur Kontrolle: bitte hier ganz links ankreuzen.", "de", True),
        ("Merci de cocher la case tout à droite.", "fr", True),
        ("Si está leyendo esto, pulse la última opción.", "es", True),
        ("How hard did you press with two fingers?", "en", False),
        ("Select how it felt (1 for bad, 7 for good).", "en", False),
        ("How tired? Answer from 1 to 7.", "en", False),
        ("Bitte einen Wert von 1 bis 7 ankreuzen.", "de", False),
        ("Kreuzen Sie einen Wert von 1 bis 7 an.", "de", False),
        ("Cochez une valeur de 1 à 7.", "fr", False),
        ("Marque un valor del 1 al 7.", "es", False),
        ("How much attention did it take?", "en", False),
        ("Wählen Sie 1 für nie und 7 für immer.", "de", False),
        ("Wie aufmerksam waren Sie?", "de", False),
        ("¿Cuánta atención hizo falta?", "es", False),
    ],
)
def test_a_check_of_reading_counts_in_no_score(ask: str, code: str, checks: bool) -> None:
    text = asking(["?", ask], code)
    one(text, "i1 checks whether people read" if checks else "")
    one(text.replace('items = ["i0", "i1"]', 'items = ["i0"]'), "")


AGREE = [("strongly disagree", "strongly agree")]


@pytest.mark.parametrize(
    ("ask", "code", "ends", "wanted"),
    [
        ("How tired was your hand?", "en", AGREE, "nobody can agree or disagree"),
        ("Wie müde war Ihre Hand?", "de", [("stimme nicht zu", "stimme zu")], "nobody can agree"),
        (
            "À quel point était-ce difficile ?",
            "fr",
            [("pas d'accord", "d'accord")],
            "nobody can agree",
        ),
        ("My hand was tired.", "en", AGREE, ""),
        ("I know how the hand moves.", "en", AGREE, ""),
        ("It was never not under control.", "en", AGREE, "two denials"),
        ("The hand was not unreliable.", "en", AGREE, "two denials"),
        (
            "Es war nicht unangenehm.",
            "de",
            [("stimme nicht zu", "stimme zu")],
            "two denials",
        ),
        ("The hand was not tired.", "en", AGREE, ""),
        ("How was it?", "en", [("good", "excellent")], "every answer to i0 is good"),
        ("Wie war es?", "de", [("gut", "hervorragend")], "every answer to i0 is good"),
        ("How was it?", "en", [("tired", "exhausted")], "every answer to i0 is bad"),
        ("How was it?", "en", [("a little tired", "very tired")], ""),
        ("How was it?", "en", [("bad", "excellent")], ""),
        ("How was it?", "en", [("not good", "very good")], ""),
    ],
)
def test_answers_fit_their_question(
    ask: str, code: str, ends: list[tuple[str, str]], wanted: str
) -> None:
    one(asking([ask], code, ends), wanted)


@pytest.mark.parametrize(
    ("ask", "choices", "wanted"),
    [
        ("How tired are you?", '["yes", "no"]', "nobody can say yes or no"),
        ("Are you tired?", '["yes", "no"]', ""),
        ("How was it?", '["good", "very good", "excellent"]', "every answer to c is good"),
        ("How was it?", '["bad", "good", "excellent"]', ""),
        ("At what did you look?", '["speed", "precision"]', ""),
        ("Which of them was it to be?", '["fast", "precise"]', ""),
    ],
)
def test_choices_fit_their_question(ask: str, choices: str, wanted: str) -> None:
    item = f'[[questionnaires.items]]\nname = "c"\nkind = "choice"\nchoices = {choices}\n'
    form = f'\n[[questionnaires]]\nname = "own"\nat = "end"\ntitle = "Q"\n{item}ask = "{ask}"\n'
    one(spoken("en") + form, wanted)


@pytest.mark.parametrize(
    ("english", "german", "wanted"),
    [
        (("not tired at all", "exhausted"), ("erschöpft", "gar nicht müde"), "opposite directions"),
        (("no pain", "severe pain"), ("starke Schmerzen", "keine Schmerzen"), "opposite"),
        (("never", "every time"), ("jedes Mal", "nie"), "opposite directions"),
        (("not tired at all", "exhausted"), ("gar nicht müde", "erschöpft"), ""),
        (("not tired", "very tired"), ("sehr wach", "gar nicht wach"), ""),
        (("no pain", "severe pain"), ("keine Schmerzen", "starke Schmerzen"), ""),
    ],
)
def test_ends_run_the_same_way_in_two_languages(
    english: tuple[str, str], german: tuple[str, str], wanted: str
) -> None:
    one(bilingual(("Today?", "Heute?"), english, german), wanted)


@pytest.mark.parametrize(
    ("asks", "wanted"),
    [
        (("How tired are you?", "Wie ausgeruht sind Sie?"), "asks for opposite things"),
        (("How tired are you?", "Wie müde sind Sie?"), ""),
        (("How are you?", "Wie müde sind Sie?"), ""),
    ],
)
def test_a_question_asks_for_the_same_in_two_languages(asks: tuple[str, str], wanted: str) -> None:
    one(bilingual(asks, ("not at all", "very"), ("gar nicht", "sehr")), wanted)


def bilingual(asks: tuple[str, str], english: tuple[str, str], german: tuple[str, str]) -> str:
    """A design in English and German with one question."""
    told = {
        "ask": asks,
        "low_means": (english[0], german[0]),
        "high_means": (english[1], german[1]),
    }
    item = "".join(
        f'{key} = {{en = "{texts[0]}", de = "{texts[1]}"}}\n' for key, texts in told.items()
    )
    consent = f'text = {{en = "{CONSENT["en"]}", de = "{CONSENT["de"]}"}}\n'
    return (
        'name = "two"\nlanguages = ["en", "de"]\nparticipants = 24\n'
        '[settings]\ntask = "box-to-goal"\n[[factors]]\nname = "contact"\norder = "latin"\n'
        f'levels = ["hard", "soft"]\n[trials]\npractice = 2\n[consent]\n{consent}'
        '[[questionnaires]]\nname = "own"\nat = "end"\ntitle = {en = "Now", de = "Jetzt"}\n'
        f'[[questionnaires.items]]\nname = "q"\nkind = "scale"\n{item}'
    )


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
    text = asking(["How tired were you?", "How tense were you?", "How sore were you?"])
    scale = text.index("[[questionnaires.scales]]")
    pairs = "".join(
        f'[[questionnaires.items]]\nname = "p{i}"\nkind = "choice"\n'
        f'choices = ["{one_of}", "{other}"]\nask = "Which one?"\n'
        for i, (one_of, other) in enumerate(asked)
    )
    rule = 'rule = "weighted"\npairs = ["p0", "p1", "p2"]'
    one(text[:scale] + pairs + text[scale:].replace('rule = "mean"', rule), wanted)


@pytest.mark.parametrize(
    ("ask", "code", "wanted"),
    [
        ("How was the second part?", "en", "it asks about one part"),
        ("Wie war der erste Teil?", "de", "it asks about one part"),
        ("Comment était la seconde partie ?", "fr", "it asks about one part"),
        ("How was the second hand?", "en", ""),
        ("How was it?", "en", ""),
    ],
)
def test_a_question_after_every_level_is_about_every_level(
    ask: str, code: str, wanted: str
) -> None:
    one(asking([ask], code), wanted)
    one(asking([ask], code, at="end"), "")
