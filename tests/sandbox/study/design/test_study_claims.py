"""`study check` reads claims that are untrue, and who consents for whom."""

from __future__ import annotations

import pytest

from tests.sandbox.study.design.spoken_designs import CONSENT, TOGETHER, consenting, one, spoken

AGE = '\n[[demographics]]\nname = "years"\nkind = "number"\nlow = {}\nhigh = {}\nask = "{}"\n'


@pytest.mark.parametrize(
    ("text", "code", "untrue"),
    [
        ("Your movements are not recorded.", "en", True),
        ("We do not measure how fast you are, and times are never stored.", "en", True),
        ("Nothing of what you do is recorded.", "en", True),
        ("Only your answers to the questionnaires are stored.", "en", True),
        ("We store only your answers.", "en", True),
        ("No time is measured.", "en", True),
        ("Es werden keine Zeiten gemessen.", "de", True),
        ("Ihre Bewegungen werden nicht aufgezeichnet.", "de", True),
        ("Gespeichert werden ausschließlich Ihre Antworten.", "de", True),
        ("Vos gestes ne sont pas enregistrés.", "fr", True),
        ("Nous n'enregistrons que vos réponses.", "fr", True),
        ("Aucun temps n'est mesuré.", "fr", True),
        ("Sus movimientos no se graban.", "es", True),
        ("No se registran los tiempos ni los toques.", "es", True),
        ("Solo se guardan sus respuestas.", "es", True),
        ("Non registriamo i Suoi movimenti.", "it", True),
        ("Uw bewegingen worden niet opgenomen.", "nl", True),
        ("Os seus movimentos não são gravados.", "pt", True),
        ("我们不会记录您的动作。", "zh", True),
        ("動作は記録しません。", "ja", True),
        ("The only thing we keep is your questionnaire.", "en", True),
        ("No recordings are made of your hand.", "en", True),
        ("Das Programm zeichnet nichts auf.", "de", True),
        ("Wir speichern nur, was Sie im Fragebogen ankreuzen.", "de", True),
        ("La tablette ne mémorise ni vos gestes ni vos temps.", "fr", True),
        ("No se mide cuánto tarda.", "es", True),
        ("Your name and your face are not recorded.", "en", False),
        ("Touches and times are recorded, but your voice is not recorded.", "en", False),
        ("Times are not recorded with your name.", "en", False),
        ("We record touches, but we do not record your voice or face.", "en", False),
        ("Your touches are not recorded during practice.", "en", False),
        ("No personal data are stored.", "en", False),
        ("Nothing is recorded beyond what is said here.", "en", False),
        ("Your data will not be kept longer than ten years.", "en", False),
        ("Only your answers and touches are recorded.", "en", False),
        ("Ihr Name und Ihre Stimme werden nicht aufgezeichnet.", "de", False),
        ("Es werden keine Daten im Internet gespeichert.", "de", False),
        ("Votre nom n'est pas enregistré.", "fr", False),
        ("No se graba su voz ni su rostro.", "es", False),
        ("我们不会记录您的姓名。", "zh", False),
    ],
)
def test_nobody_is_told_that_nothing_is_recorded(text: str, code: str, untrue: bool) -> None:
    one(consenting(text, code), "every touch, movement and time is recorded" if untrue else "")


def test_what_is_recorded_is_told_in_instructions_too() -> None:
    text = '\n[[instructions]]\nat = "start"\ntext = "Relax: your times are not measured."\n'
    one(consenting("") + text, "it is untrue")


@pytest.mark.parametrize(
    ("text", "code", "hidden"),
    [
        ("Another participant in the next room moves the second hand.", "en", True),
        ("You carry it together with your partner.", "en", True),
        ("Somebody else controls the other hand.", "en", True),
        ("Eine andere Person im Nebenraum bewegt die zweite Hand.", "de", True),
        ("Sie tragen es gemeinsam mit einem Partner.", "de", True),
        ("Une autre personne déplace la seconde main.", "fr", True),
        ("Votre partenaire porte l'objet avec vous.", "fr", True),
        ("Otra persona mueve la segunda mano desde la sala de al lado.", "es", True),
        ("另一位参与者移动第二只手。", "zh", True),
        ("Your teammate is another student sitting next door.", "en", True),
        ("The experimenter waits in the next room.", "en", False),
        ("The second hand is moved by a program.", "en", False),
        ("A simulated partner moves the second hand.", "en", False),
        ("Your partner is played by the computer, and holds the other side.", "en", False),
        ("You carry a thing with two hands.", "en", False),
        ("Do not tell another participant of the study.", "en", False),
        ("Ihr Partner wird vom Computer gesteuert, und trägt mit.", "de", False),
        ("L'ordinateur guide votre partenaire, qui porte l'objet.", "fr", False),
        ("Su compañero es un programa: el ordenador mueve su mano.", "es", False),
    ],
)
def test_a_partner_who_is_simulated_is_no_secret(text: str, code: str, hidden: bool) -> None:
    told = TOGETHER.format(code=code, consent=CONSENT[code], told=text)
    one(told, "somebody who moves the second hand" if hidden else "")
    if hidden:
        one(consenting(text, code), "")
    if hidden and code == "en":
        end = '\n[[instructions]]\nat = "end"\ntext = "The second hand was moved by a program."\n'
        one(told + end, "")


@pytest.mark.parametrize(
    ("low", "high", "ask", "code", "consent", "alone"),
    [
        (8, 11, "How old are you?", "en", "", True),
        (6, 10, "Wie alt bist du?", "de", "Du darfst allein entscheiden.", True),
        (8, 11, "¿Cuántos años tienes?", "es", "Tu propio sí nos basta.", True),
        (12, 16, "How old are you?", "en", "Your parents need not know.", True),
        (12, 16, "Wie alt bist du?", "de", "Deine Eltern müssen nicht gefragt werden.", True),
        (8, 11, "How old are you?", "en", "Your parents have agreed.", False),
        (8, 11, "Wie alt bist du?", "de", "Deine Eltern haben zugestimmt.", False),
        (8, 11, "Quel âge as-tu ?", "fr", "Tes parents sont d'accord.", False),
        (18, 99, "How old are you?", "en", "", False),
        (8, 11, "For how many years have you had a tablet?", "en", "", False),
    ],
)
def test_children_do_not_consent_alone(
    low: int, high: int, ask: str, code: str, consent: str, alone: bool
) -> None:
    text = consenting(consent, code)
    text = text[: text.index("[[demographics]]")]
    one(text + AGE.format(low, high, ask), "consent alone" if alone else "")


@pytest.mark.parametrize(
    ("title", "wanted"),
    [
        ("Touch screens for primary school pupils", "children consent alone"),
        ("Manipulation chez les enfants", "children consent alone"),
        ("Geschick von Grundschulkindern und Kindern", "children consent alone"),
        ("Hands of people with dementia", "may not be able to consent"),
        ("Hands of 8- to 11-year-olds", "people below 18 consent alone"),
        ("Hands of 18- to 30-year-olds", ""),
        ("A study of 10 to 15 minutes", ""),
        ("Hard and soft contact", ""),
    ],
)
def test_who_takes_part_is_told_by_the_title(title: str, wanted: str) -> None:
    text = consenting("").replace("seed = 3", f'title = "{title}"\nseed = 3')
    text = text[: text.index("[[demographics]]")]
    one(text, wanted)
    one(text.replace("at any time.", "at any time. A parent or guardian has agreed."), "")


@pytest.mark.parametrize(
    ("text", "code", "exposes"),
    [
        ("Touches and times are stored under your full name.", "en", True),
        ("Your scores will be sent to your employer.", "en", True),
        ("Your supervisor will see your results.", "en", True),
        ("Alle Daten werden mit Ihrem Namen gespeichert.", "de", True),
        ("Ihre Ergebnisse werden Ihrem Vorgesetzten mitgeteilt.", "de", True),
        ("Vos données sont conservées avec votre nom.", "fr", True),
        ("Vos résultats seront transmis à votre employeur.", "fr", True),
        ("Los datos se guardan con su nombre.", "es", True),
        ("Sus tiempos se enviarán a su jefe.", "es", True),
        ("We keep a list of names and results.", "en", True),
        ("Your data may be sold to other companies.", "en", True),
        ("El profesor recibirá una lista con los resultados.", "es", True),
        ("Touches are stored without your name.", "en", False),
        ("Your results are never shown to your employer.", "en", False),
        ("Ihre Ergebnisse werden nicht Ihrem Vorgesetzten mitgeteilt.", "de", False),
        ("Please sign with your name.", "en", False),
        ("Results are published in a journal.", "en", False),
    ],
)
def test_data_stay_apart_from_names_and_superiors(text: str, code: str, exposes: bool) -> None:
    one(consenting(text, code), "exposes people" if exposes else "")


@pytest.mark.parametrize(
    ("text", "code", "forced"),
    [
        ("Your treatment depends on your participation.", "en", True),
        ("Die weitere Behandlung hängt von der Teilnahme ab.", "de", True),
        ("Votre traitement dépend de votre participation.", "fr", True),
        ("La nota depende de su participación.", "es", True),
        ("You may stop, but then your supervisor will hear of it.", "en", True),
        ("Stopping costs half of the payment.", "en", True),
        ("Votre chef saura si vous avez arrêté.", "fr", True),
        ("Your treatment does not depend on your participation.", "en", False),
        ("Die Behandlung hängt nicht von der Teilnahme ab.", "de", False),
        ("Votre traitement ne dépend pas de votre participation.", "fr", False),
        ("La nota no depende de su participación.", "es", False),
    ],
)
def test_nothing_depends_on_taking_part(text: str, code: str, forced: bool) -> None:
    one(consenting(text, code), "not given freely" if forced else "")


@pytest.mark.parametrize(
    ("device", "text", "code", "wanted"),
    [
        ("touch", "Hold your hand above the sensor.", "en", "and it is a touch screen"),
        ("touch", "Halten Sie die Hand über den Sensor.", "de", "and it is a touch screen"),
        ("touch", "Tenez la main devant la caméra.", "fr", "and it is a touch screen"),
        ("leap", "Put your fingers on the screen.", "en", "hands are in the air"),
        ("leap", "Legen Sie die Finger auf den Bildschirm.", "de", "hands are in the air"),
        ("leap", "Ponga los dedos en la pantalla.", "es", "hands are in the air"),
        ("leap", "Hold your hand above the sensor.", "en", ""),
        ("leap", "Do not put your hand on the screen.", "en", ""),
        ("touch", "Put your fingers on the screen.", "en", ""),
    ],
)
def test_people_are_told_of_the_device_that_they_use(
    device: str, text: str, code: str, wanted: str
) -> None:
    told = spoken(code).replace('encoder = "linear"', f'device = "{device}"')
    told = told.replace('"tests/support/regress_tasks.py:Quick"', '"box-to-goal"')
    one(told + f'\n[[instructions]]\nat = "start"\ntext = "{text}"\n', wanted)


@pytest.mark.parametrize(
    ("task", "text", "code", "other"),
    [
        ("wrench-turn", "Move the box to the marked place.", "en", True),
        ("box-to-goal", "Turn the wrench.", "en", True),
        ("box-to-goal", "Drehen Sie den Schraubenschlüssel.", "de", True),
        ("wrench-turn", "Empilez les boîtes.", "fr", True),
        ("wrench-turn", "Lleve la caja a su sitio.", "es", True),
        ("stack", "Put one block on the other.", "en", False),
        ("wrench-turn", "Turn the wrench; no box is in its way.", "en", False),
        ("wrench-turn", "Tick the box when you have finished.", "en", False),
        ("box-to-goal", "Do what the page says.", "en", False),
        ("wrench-turn", "There are three blocks of trials.", "en", False),
        ("dial", "Turn the knob, not the box.", "en", False),
    ],
)
def test_people_are_told_of_the_task_that_they_play(
    task: str, text: str, code: str, other: bool
) -> None:
    told = spoken(code).replace("tests/support/regress_tasks.py:Quick", task)
    told += f'\n[[instructions]]\nat = "start"\ntext = "{text}"\n'
    one(told, f"another task than {task}" if other else "")


def test_the_goal_of_a_task_tells_of_its_things() -> None:
    goal = '\n[[tasks]]\ntask = "{}"\nname = "It"\ngoal = "Turn the wrench."\n'
    told = spoken("en").replace("tests/support/regress_tasks.py:Quick", "box-to-goal")
    one(told + goal.format("box-to-goal"), "another task than box-to-goal")


@pytest.mark.parametrize(
    ("text", "code", "untrue"),
    [
        (
            "Nobody, not even we, can tell whose data are whose. Tell us your code, and we delete "
            "them.",
            "en",
            True,
        ),
        (
            "Die Daten sind vollständig anonym. Mit Ihrem Kürzel können Sie sie löschen lassen.",
            "de",
            True,
        ),
        (
            "Vos données sont totalement anonymes. Donnez votre code pour les faire effacer.",
            "fr",
            True,
        ),
        ("Data are kept under a code. Tell us your code, and we delete them.", "en", False),
        ("Data are completely anonymous, and cannot be deleted.", "en", False),
        (
            "Tell us your code, and we delete them. After a year not even we can tell whose they "
            "are.",
            "en",
            False,
        ),
    ],
)
def test_what_nobody_can_link_nobody_can_delete(text: str, code: str, untrue: bool) -> None:
    one(consenting(text, code), "a code links the data" if untrue else "")


def test_sessions_of_a_person_are_linked() -> None:
    text = consenting("Everything is completely anonymous.")
    one(text, "")
    one(text.replace("seed = 3", "seed = 3\nsessions = 2"), "a code links the sessions")


@pytest.mark.parametrize(
    ("text", "code", "word"),
    [
        ("How good was the encoder?", "en", "encoder"),
        ("Wie gut war der Encoder?", "de", "encoder"),
        ("Comment était l'encodeur ?", "fr", "encodeur"),
        ("How good was the hand?", "en", ""),
    ],
)
def test_people_know_the_words_of_a_question(text: str, code: str, word: str) -> None:
    item = '\n[[demographics]]\nname = "q"\nkind = "text"\noptional = true\n'
    one(spoken(code) + f'{item}ask = "{text}"\n', f"the word '{word}'" if word else "")
