"""`study check` looks at levels: people who are levels, teaching, nesting, pay, and outcomes."""

from __future__ import annotations

import pytest

from sandbox.study.design.meaning.findings import findings
from tests.sandbox.study.design.spoken_designs import one, spoken
from tests.support.study_files import SOUND, design

FACTOR = 'name = "contact"\norder = "latin"\nlevels = ["hard", "soft"]\n'
TEXT = '\n[[instructions]]\nat = "{}"\nlevel = "{}"\ntext = "{}"\n'
LATER = '\n[[instructions]]\nat = "start"\n{}text = "{}"\n'


def varied(name: str, order: str, levels: str, code: str = "en") -> str:
    """A sound design with another factor, and more people for groups."""
    text = spoken(code).replace(FACTOR, f'name = "{name}"\norder = "{order}"\nlevels = {levels}\n')
    text = text.replace('practice_each = "contact"', f'practice_each = "{name}"')
    return text.replace("participants = 24", "participants = 60")


def same(*names: str) -> str:
    """Levels that set the same."""
    return "[" + ", ".join(f'{{name = "{name}", contact = "soft"}}' for name in names) + "]"


def unlike(one_name: str, other: str) -> str:
    return f'[{{name = "{one_name}", contact = "soft"}}, {{name = "{other}", contact = "hard"}}]'


@pytest.mark.parametrize(
    ("name", "order", "levels", "trait"),
    [
        ("groupe", "between", same("jeunes", "seniors"), True),
        ("age-group", "between", same("a", "b"), True),
        ("gruppe", "between", unlike("maenner", "frauen"), True),
        ("gruppe", "between", unlike("Männer", "Frauen"), True),
        ("who", "between", unlike("left-handed", "right-handed"), True),
        ("group", "between", unlike("novices", "experts"), True),
        ("grupo", "between", same("pacientes", "sanos"), True),
        ("group", "between", same("musicians", "non-musicians"), True),
        ("group", "between", unlike("18-30", "65-80"), True),
        ("geschlecht", "latin", same("eins", "zwei"), True),
        ("kohorte", "between", same("a", "b"), True),
        ("gruppe", "between", same("junge-erwachsene", "aeltere-erwachsene"), True),
        ("people", "between", unlike("students", "retirees"), True),
        ("version", "between", unlike("old", "new"), False),
        ("version", "latin", unlike("novice", "expert"), False),
        ("feel", "between", unlike("hard", "soft"), False),
        ("side", "between", unlike("left", "right"), False),
    ],
)
def test_nobody_is_assigned_to_an_age_or_a_sex(
    name: str, order: str, levels: str, trait: bool
) -> None:
    one(varied(name, order, levels), "is a property of people" if trait else "")


@pytest.mark.parametrize(
    ("name", "levels", "texts", "code", "taught"),
    [
        ("teaching", same("untaught", "taught"), ("Begin.", "Begin now."), "en", True),
        ("training", same("none", "video"), ("Begin.", "Begin now."), "en", True),
        ("anleitung", same("ohne", "mit"), ("Los.", "Also los."), "de", True),
        ("consigne", same("sans", "avec"), ("Allez.", "Allez-y."), "fr", True),
        ("ayuda", same("sin-consejo", "consejo"), ("Ya.", "Ahora."), "es", True),
        (
            "way",
            same("a", "b"),
            ("Do it as you like.", "Hold it with your thumb and two fingers."),
            "en",
            True,
        ),
        (
            "art",
            same("a", "b"),
            ("Greifen Sie, wie Sie möchten.", "Greifen Sie mit Daumen und Zeigefinger."),
            "de",
            True,
        ),
        ("gruppe", same("naiv", "instruiert"), ("Los.", "Also los."), "de", True),
        (
            "partie",
            same("a", "b"),
            ("Faites comme bon vous semble.", "Utilisez la technique que nous avons montrée."),
            "fr",
            True,
        ),
        ("priority", same("a", "b"), ("Be quick.", "Be accurate."), "en", False),
        ("instruction", same("fast", "careful"), ("Be quick.", "Be accurate."), "en", False),
        ("way", same("a", "b"), ("Use two fingers.", "Use three fingers."), "en", False),
    ],
)
def test_those_who_have_been_taught_know_it_afterwards(
    name: str, levels: str, texts: tuple[str, str], code: str, taught: bool
) -> None:
    names = [part.partition('"')[0] for part in levels.split('name = "')[1:]]
    told = "".join(TEXT.format(name, level, text) for level, text in zip(names, texts, strict=True))
    one(varied(name, "latin", levels, code) + told, "and no order balances" if taught else "")
    one(varied(name, "between", levels, code) + told, "")


def test_an_encoder_that_was_trained_teaches_nobody() -> None:
    one(varied("training", "latin", unlike("trained", "untrained")), "")


def test_levels_that_set_the_same_differ_by_what_is_said_before_them_alone() -> None:
    one(varied("words", "latin", same("a", "b")), "are the same: they set the same")
    told = TEXT.format("words", "a", "Be quick.") + TEXT.format("words", "b", "Take care.")
    one(varied("words", "latin", same("a", "b")) + told, "")


@pytest.mark.parametrize(
    ("levels", "wanted"),
    [
        ('["hard", {name = "usual", solid = "fingertips"}]', "by default"),
        ('["soft", {name = "usual", solid = "fingertips"}]', ""),
        ('["soft", {name = "whole", solid = "hand"}]', "several settings at once"),
        ('["hard", {name = "usual", contact = "soft"}]', ""),
        (
            '["hard", "soft", {name = "other", contact = "none", encoder = "best"}]',
            "other in contact and encoder",
        ),
        (
            '["hard", "soft", {name = "c", contact = "hard", encoder = "best"}, '
            '{name = "d", contact = "soft", encoder = "best"}]',
            "",
        ),
    ],
)
def test_every_level_differs_from_another_one_in_one_setting(levels: str, wanted: str) -> None:
    one(varied("contact", "latin", levels), wanted)


NESTED = (
    'name = "turn"\norder = "latin"\nlevels = [0, 90]\n[[factors]]\nname = "contact"\n'
    'inside = "turn"\norder = "latin"\nlevels = {{0 = {}, 90 = {}}}\n'
)


@pytest.mark.parametrize(
    ("first", "second", "title", "wanted"),
    [
        ('["hard", "soft"]', '["none", "soft"]', "", "hard and none never occur in the same"),
        ('["hard"]', '["soft"]', "", "has one level in each level of turn"),
        ('["hard", "soft"]', '["soft", "hard"]', "", ""),
        ('["hard", "soft", "none"]', '["hard", "soft"]', "", ""),
        (
            '["hard", "soft"]',
            '["none", {name = "firm", impulse = "safe"}]',
            "Is hard better than firm?",
            "hard and firm never occur",
        ),
        ('["hard", "soft"]', '["none", {name = "firm", impulse = "safe"}]', "Contacts", None),
    ],
)
def test_levels_that_never_meet_are_not_compared(
    first: str, second: str, title: str, wanted: str | None
) -> None:
    text = spoken("en").replace(FACTOR, NESTED.format(first, second))
    text = text.replace("seed = 3", f'title = "{title}"\nseed = 3').replace(
        "practice = 1", "practice = 6"
    )
    told = [f.mistake.what for f in findings(design(text))]
    never = [what for what in told if "never occur" in what or "one level in each" in what]
    assert len(never) == bool(wanted) and all((wanted or "") in what for what in never), told


@pytest.mark.parametrize(
    ("encoders", "wanted"),
    [
        ('["paper", "best"]', "are the same where encoder is paper"),
        ('["best", "paper"]', "are the same where encoder is paper"),
        ('["linear", "best"]', ""),
    ],
)
def test_levels_that_are_the_same_in_a_part_of_a_design_are_told_with_that_part(
    encoders: str, wanted: str
) -> None:
    """The first combination spoke for all: these were the same, or were not, by what came first."""
    outer = f'name = "encoder"\norder = "latin"\nlevels = {encoders}\n[[factors]]\n'
    text = varied("labels", "latin", '["history", "population"]')
    text = text.replace('encoder = "linear"\n', "").replace(
        "[[factors]]\n", "[[factors]]\n" + outer
    )
    one(text, wanted)


@pytest.mark.parametrize(
    ("hard", "soft", "code", "wanted"),
    [
        ("Your pay is as before.", "You get 50 cents for each success.", "en", "pay is promised"),
        ("Now the next part.", "Now you can earn a bonus.", "en", "pay is promised before soft"),
        ("You get 10 cents for each.", "You get 50 cents for each.", "en", "other pay"),
        ("Nun der nächste Teil.", "Nun gibt es eine Prämie je Erfolg.", "de", "pay is promised"),
        ("Voici la suite.", "Vous gagnez 20 centimes par essai.", "fr", "pay is promised"),
        ("Ahora sigue otra parte.", "Ahora se paga un premio.", "es", "pay is promised"),
        ("You get 10 cents for each.", "You get 10 cents for each.", "en", ""),
        ("No bonus is paid here.", "Here, too, nothing is paid.", "en", ""),
    ],
)
def test_pay_is_the_same_at_all_levels(hard: str, soft: str, code: str, wanted: str) -> None:
    told = TEXT.format("contact", "hard", hard) + TEXT.format("contact", "soft", soft)
    one(spoken(code) + told, wanted)


@pytest.mark.parametrize(
    ("hard", "soft", "code", "watched"),
    [
        ("Now the next part.", "Your results are shown on a ranking.", "en", True),
        ("Nun der nächste Teil.", "In diesem Teil werden Sie beobachtet.", "de", True),
        ("Voici la suite.", "Un classement sera affiché.", "fr", True),
        ("Nobody watches you.", "Now the next part.", "en", False),
    ],
)
def test_nobody_is_watched_at_one_level_alone(
    hard: str, soft: str, code: str, watched: bool
) -> None:
    told = TEXT.format("contact", "hard", hard) + TEXT.format("contact", "soft", soft)
    one(spoken(code) + told, "being watched or ranked" if watched else "")


@pytest.mark.parametrize(
    ("first", "text", "code", "late"),
    [
        ("", "Put two fingers and your thumb on the screen.", "en", True),
        ("Welcome!", "This is how you control the hand.", "en", True),
        ("Willkommen!", "So steuern Sie die Hand: mit den Fingern.", "de", True),
        ("Bonjour.", "Posez les doigts : la main vous suit.", "fr", True),
        ("", "Bienvenido otra vez.", "es", True),
        ("Hola.", "Así se maneja la mano.", "es", True),
        ("Put your fingers on the screen.", "Put your fingers on the screen again.", "en", False),
        ("Move the box.", "Welcome back.", "en", False),
    ],
)
def test_what_people_need_is_told_before_the_first_trial(
    first: str, text: str, code: str, late: bool
) -> None:
    two = spoken(code).replace("seed = 3", "seed = 3\nsessions = 2")
    begun = LATER.format("", first) if first else ""
    one(two + begun + LATER.format("sessions = [2]\n", text), "only in session 2" if late else "")
    one(two + begun + LATER.format("", text), "")


EFFORT = SOUND[SOUND.index("[[questionnaires]]") :] + (
    '[[questionnaires.scales]]\nname = "effort"\nrule = "mean"\nitems = ["effort"]\n'
)
TURN = '[[factors]]\nname = "turn"\norder = "latin"\nlevels = [0, 90]\n[trials]'


@pytest.mark.parametrize(
    ("title", "primary", "wanted"),
    [
        ("Is soft contact faster?", "effort", "the title asks for speed"),
        ("Speed with two contacts", "drops", "the title asks for speed"),
        ("More accurate by touch?", "time_s", "the title asks for accuracy"),
        ("Is soft contact faster?", "time_s", ""),
        ("Fast and accurate", "time_s", ""),
        ("More accurate by touch?", "placement_error_m", ""),
        ("Two contacts", "effort", ""),
    ],
)
def test_the_outcome_answers_the_title(title: str, primary: str, wanted: str) -> None:
    text = spoken("en").replace("seed = 3", f'title = "{title}"\nseed = 3') + EFFORT
    one(text + f'[analysis]\nprimary = ["{primary}"]\n', wanted)


@pytest.mark.parametrize(
    ("title", "at", "wanted"),
    [
        ("Effort with two contacts", "turn", "names contact, and effort is asked at turn"),
        ("Effort, hard or soft", "turn", "names contact, and effort is asked at turn"),
        ("Effort with two contacts", "contact", ""),
        ("Effort", "turn", ""),
    ],
)
def test_a_score_is_asked_at_the_factor_of_the_title(title: str, at: str, wanted: str) -> None:
    text = spoken("en").replace("seed = 3", f'title = "{title}"\nseed = 3')
    text = text.replace("[trials]", TURN).replace("practice = 1", "practice = 2")
    asked = EFFORT.replace('at = "contact"', f'at = "{at}"')
    one(text + asked + '[analysis]\nprimary = ["effort"]\n', wanted)


@pytest.mark.parametrize(
    ("times", "primary", "wanted"),
    [
        ("expected_s = 10\ntime_limit_s = 300", '"success"', "nearly all succeed"),
        ("expected_s = 10\ntime_limit_s = 300", '"time_s", "success"', ""),
        ("expected_s = 10\ntime_limit_s = 20", '"success"', ""),
        ("time_limit_s = 300", '"success"', ""),
    ],
)
def test_success_can_differ(times: str, primary: str, wanted: str) -> None:
    text = spoken("en").replace('task = "tests/support/regress_tasks.py:Quick"', 'task = "stack"')
    text = text.replace("practice = 1", f"practice = 1\n{times}")
    one(text + f"[analysis]\nprimary = [{primary}]\n", wanted)


@pytest.mark.parametrize(
    ("title", "ask", "code", "early"),
    [
        ("About the last trials", "How was it?", "en", True),
        ("Now", "How tired did the trials that you just did make you?", "en", True),
        ("Zu den letzten Durchgängen", "Wie war es?", "de", True),
        ("À propos des derniers essais", "Était-ce bien ?", "fr", True),
        ("Sobre los últimos ensayos", "¿Qué tal?", "es", True),
        ("Before we begin", "How tired are you now?", "en", False),
        ("Vor Beginn", "Wie müde sind Sie gerade?", "de", False),
    ],
)
def test_nobody_is_asked_about_trials_that_are_still_to_come(
    title: str, ask: str, code: str, early: bool
) -> None:
    form = '\n[[questionnaires]]\nname = "own"\nat = "{}"\ntitle = "{}"\n[[questionnaires.items]]\n'
    form += 'name = "i"\nkind = "text"\noptional = true\nask = "{}"\n'
    one(spoken(code) + form.format("start", title, ask), "before anything" if early else "")
    one(spoken(code) + form.format("contact", title, ask), "")


@pytest.mark.parametrize(
    ("title", "code", "last"),
    [
        ("About the last trials", "en", True),
        ("How was this part?", "en", True),
        ("Zu den letzten Durchgängen", "de", True),
        ("À propos des derniers essais", "fr", True),
        ("About all trials", "en", False),
        ("Zum Schluss", "de", False),
    ],
)
def test_a_form_at_the_end_asks_about_all_parts(title: str, code: str, last: bool) -> None:
    form = '\n[[questionnaires]]\nname = "own"\nat = "end"\ntitle = "{}"\n'
    form += '[[questionnaires.items]]\nname = "i"\nkind = "text"\noptional = true\nask = "?"\n'
    one(spoken(code) + form.format(title), "the last part alone" if last else "")
    one(varied("contact", "between", '["hard", "soft"]', code) + form.format(title), "")


def test_a_hand_in_the_air_rests_sooner() -> None:
    text = spoken("en").replace('encoder = "linear"', 'device = "leap"')
    text = text.replace('"tests/support/regress_tasks.py:Quick"', '"box-to-goal"')
    text = text.replace("repetitions = 2", "repetitions = 30\nexpected_s = 15")
    one(text, "with the hand in the air")
    one(text.replace('"leap"', '"touch"'), "")


@pytest.mark.parametrize(
    ("device", "levels", "wanted"),
    [
        ("leap", '["paper", "best"]', "are the same with device leap"),
        ("webcam", '["paper", "best"]', "are the same with device webcam"),
        ("touch", '["paper", "best"]', ""),
        ("leap", '[{name = "a", contact = "hard"}, {name = "b", contact = "soft"}]', ""),
    ],
)
def test_only_touches_go_through_an_encoder(device: str, levels: str, wanted: str) -> None:
    text = varied("encoder", "latin", levels)
    text = text.replace('encoder = "linear"', f'device = "{device}"')
    one(text.replace('"tests/support/regress_tasks.py:Quick"', '"box-to-goal"'), wanted)


@pytest.mark.parametrize(
    ("hard", "soft", "code", "wanted"),
    [
        ("Now the next part.", "Please try especially hard.", "en", "effort is said before soft"),
        ("Nun der nächste Teil.", "Strengen Sie sich an.", "de", "effort is said before soft"),
        ("Now the next part.", "Do not be frustrated.", "en", "reassurance is said before soft"),
        ("Use your thumb.", "Use two fingers.", "en", "thumb is asked for before hard"),
        ("Mit dem Daumen.", "Mit drei Fingern.", "de", "daumen is asked for before hard"),
        ("Do it standing.", "Do it sitting.", "en", "standing is asked for before hard"),
        ("Use two fingers.", "Again, use two fingers.", "en", ""),
        ("Now let it stand there.", "Now let it go.", "en", ""),
        ("Now comes the smart hand.", "Now comes the other.", "en", "expected to be better"),
    ],
)
def test_people_are_told_to_do_the_same_at_all_levels(
    hard: str, soft: str, code: str, wanted: str
) -> None:
    told = TEXT.format("contact", "hard", hard) + TEXT.format("contact", "soft", soft)
    one(spoken(code) + told, wanted)


def test_tasks_need_other_fingers() -> None:
    text = varied("task", "latin", '["box-to-goal", "stack"]').replace(
        'task = "tests/support/regress_tasks.py:Quick"\n', ""
    )
    told = TEXT.format("task", "box-to-goal", "Use your thumb.")
    told += TEXT.format("task", "stack", "Use two fingers.")
    one(text + told, "")
