"""`study check` finds what people must not be asked to do, told or made to sign in a study."""

from __future__ import annotations

import pytest

from tests.sandbox.study.design.spoken_designs import consenting, one, spoken

TIME = '\n[analysis]\nprimary = ["time_s"]\n'


def instructing(text: str, code: str) -> str:
    """A sound design in one language, with a text at the start."""
    return f'{spoken(code)}\n[[instructions]]\nat = "start"\ntext = "{text}"\n'


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "Please think aloud in every trial.", True),
        ("en", "Keep talking during the trials and say whatever you think.", True),
        ("de", "Kommentieren Sie jeden Schritt, während Sie arbeiten.", True),
        ("en", "While you move the boxes, tell us what you are doing and why.", True),
        ("en", "After the last trial, please tell us aloud what you think.", False),
        ("en", "Please do not speak while you move a box.", False),
        ("en", "Tell us if anything hurts during the trials.", False),
        ("de", "Bitte denken Sie bei der Aufgabe laut.", True),
        ("de", "Erklären Sie während der Durchgänge fortlaufend, was Sie tun.", True),
        ("de", "Nach der Aufgabe erzählen Sie bitte, was Sie gedacht haben.", False),
        ("de", "Sagen Sie Bescheid, wenn der Ton zu laut ist.", False),
        ("fr", "Pensez à voix haute pendant les essais.", True),
        ("fr", "Dites en même temps ce que vous faites.", True),
        ("fr", "Dites-nous après les essais ce que vous pensez.", False),
        ("es", "Piense en voz alta durante los ensayos.", True),
        ("es", "Describa lo que hace mientras mueve la caja.", True),
        ("es", "Después de los ensayos, diga lo que piensa.", False),
    ],
)
def test_thinking_aloud_beside_a_measured_time_is_found(code: str, text: str, wrong: bool) -> None:
    one(instructing(text, code) + TIME, "talk while their time" if wrong else "")
    one(instructing(text, code) + TIME.replace("time_s", "success"), "")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "If a trial is too hard, say so: we skip it.", True),
        ("en", "You may leave a task out if you like.", True),
        ("de", "Wenn Ihnen ein Durchgang nicht gefällt, können Sie ihn überspringen.", True),
        ("es", "Si un ensayo le resulta difícil, puede saltárselo.", True),
        ("en", "If a box does not come, wait; no trial is skipped because it is too long.", False),
        ("en", "You may skip any question that is too personal, also after a task.", False),
        ("de", "Zu schwere Durchgänge kommen nicht vor, und keiner wird übersprungen.", False),
        ("de", "Ist ein Durchgang zu schwer, lassen wir ihn weg.", True),
        ("de", "Aufgaben, die Ihnen zu lang sind, werden übersprungen.", True),
        ("fr", "Si une tâche est trop longue, nous la sautons.", True),
        ("fr", "Vous pouvez sauter un essai si vous le souhaitez.", True),
        ("fr", "Si un essai est trop long, il se termine tout seul.", False),
        ("es", "Si un ensayo es demasiado difícil, lo saltamos.", True),
        ("es", "Puede saltar una tarea si lo desea.", True),
        ("es", "Si un ensayo es demasiado largo, termina por sí solo.", False),
    ],
)
def test_trials_that_people_may_have_left_out_are_found(code: str, text: str, wrong: bool) -> None:
    one(instructing(text, code), "left out" if wrong else "")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "One of you plays, and the other person watches.", True),
        ("en", "While you wait, watch how the others do it.", True),
        ("fr", "Vous pouvez regarder les autres participants.", True),
        ("es", "Puede mirar a los demás participantes.", True),
        ("en", "You first look on while the previous participant plays: watch closely.", True),
        ("en", "No other participant watches you.", False),
        ("en", "The experimenter watches the screen.", False),
        ("en", "Watch how the box moves, and then the other one.", False),
        ("de", "Die andere Person schaut Ihnen zu.", True),
        ("de", "Sie beobachten zuerst den vorigen Teilnehmer.", True),
        ("de", "Niemand schaut Ihnen zu, auch keine andere Person.", False),
        ("de", "Beobachten Sie die andere Hand.", False),
        ("fr", "L'autre participant vous regarde jouer.", True),
        ("fr", "Vous allez observer une autre personne.", True),
        ("fr", "Regardez bien l'autre main.", False),
        ("es", "La otra persona mira mientras tanto.", True),
        ("es", "Primero va a observar a otro participante.", True),
        ("es", "Mire bien la otra mano.", False),
    ],
)
def test_participants_who_watch_each_other_are_found(code: str, text: str, wrong: bool) -> None:
    one(consenting(text, code), "see how others do it" if wrong else "")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "Please say your ratings aloud.", True),
        ("en", "The developer asks you for your answers and enters your ratings.", True),
        ("en", "Give your answers on the tablet. The experimenter does not see them.", False),
        ("en", "If you have questions, ask the experimenter aloud.", False),
        ("de", "Bitte sagen Sie Ihre Antworten laut.", True),
        ("de", "Der Entwickler notiert Ihre Bewertung.", True),
        ("de", "Ihre Antworten geben Sie auf dem Tablet.", False),
        ("fr", "Dites vos réponses à voix haute.", True),
        ("fr", "L'ingénieur note vos réponses.", True),
        ("fr", "Donnez vos réponses sur la tablette.", False),
        ("es", "Diga sus respuestas en voz alta.", True),
        ("es", "El investigador anota sus respuestas.", True),
        ("es", "Dé sus respuestas en la tableta.", False),
    ],
)
def test_ratings_to_the_face_of_somebody_are_found(code: str, text: str, wrong: bool) -> None:
    asked = (
        '\n[[questionnaires]]\nname = "q"\nat = "end"\ntitle = "Q"\n'
        '[[questionnaires.items]]\nname = "i"\nkind = "scale"\nask = "0 – 100?"\n'
    )
    one(instructing(text, code) + asked, "rate to somebody's face" if wrong else "")
    one(instructing(text, code), "")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "You waive all claims against the university.", True),
        ("en", "You take part at your own risk.", True),
        ("de", "Die Teilnahme erfolgt auf eigene Gefahr.", True),
        ("fr", "Vous participez à vos propres risques.", True),
        ("es", "Participa bajo su propia responsabilidad.", True),
        ("en", "By agreeing you give up your right to sue.", True),
        ("en", "The institute is not liable for any injury.", True),
        ("en", "You do not give up any rights by agreeing.", False),
        ("en", "You are not liable for damage to the tablet.", False),
        ("en", "The university is insured and liable for what happens here.", False),
        ("de", "Sie verzichten auf alle Ansprüche.", True),
        ("de", "Die Universität haftet nicht, auch nicht bei Fahrlässigkeit.", True),
        ("de", "Sie verzichten damit auf keine Rechte.", False),
        ("de", "Die Universität haftet für Schäden.", False),
        ("fr", "Vous renoncez à tout recours.", True),
        ("fr", "L'université décline toute responsabilité.", True),
        ("fr", "Vous ne renoncez à aucun droit.", False),
        ("es", "Usted renuncia a toda reclamación.", True),
        ("es", "La universidad no se hace responsable de daños.", True),
        ("es", "Usted no renuncia a ningún derecho.", False),
    ],
)
def test_rights_that_a_consent_takes_away_are_found(code: str, text: str, wrong: bool) -> None:
    one(consenting(text, code), "give up rights" if wrong else "")


@pytest.mark.parametrize(
    ("code", "ask", "help_"),
    [
        ("en", "Thoughts of hurting yourself", "A helpline is there for you: 116 123."),
        ("en", "Did you think of suicide?", "Our psychologist is next door."),
        ("de", "Gedanken, sich selbst zu verletzen", "Die Telefonseelsorge: 0800 1110111."),
        ("de", "Hatten Sie Suizidgedanken?", "Eine Ärztin ist im Haus."),
        ("fr", "Des idées de suicide", "Le numéro d'écoute est le 3114."),
        ("fr", "L'envie de mourir", "Un médecin est là."),
        ("es", "Ideas de suicidio", "Hay ayuda en el 024."),
        ("es", "Ganas de morir", "Un psicólogo está aquí."),
    ],
)
def test_a_question_about_self_harm_without_help_is_found(code: str, ask: str, help_: str) -> None:
    asked = (
        '\n[[questionnaires]]\nname = "q"\nat = "start"\ntitle = "Q"\n'
        f'[[questionnaires.items]]\nname = "i"\nkind = "text"\noptional = true\nask = "{ask}"\n'
    )
    one(spoken(code) + asked, "no text names help")
    told = f'\n[[instructions]]\nat = "end"\ntext = "{help_}"\n'
    one(spoken(code) + asked + told, "")
    one(spoken(code) + asked.replace(ask, "?"), "")


@pytest.mark.parametrize(
    ("code", "text", "truth", "wrong"),
    [
        (
            "en",
            "Nine of ten people: 9 of 10 people finish the task in 3 seconds.",
            "invented",
            True,
        ),
        ("en", "Most participants need 2 seconds for a trial.", "not true", True),
        ("en", "Your result is worse than that of most people.", "not true", True),
        ("de", "Ihr Ergebnis liegt unter dem Durchschnitt.", "erfunden", True),
        ("fr", "Votre temps est au-dessous de la moyenne.", "inventé", True),
        ("es", "Su tiempo está por debajo de la media.", "inventado", True),
        ("en", "Most trials take ten seconds.", "invented", False),
        ("en", "All participants play the same tasks.", "invented", False),
        ("de", "Die meisten Menschen schaffen das in 3 Sekunden.", "erfunden", True),
        ("de", "95 von 100 Personen brauchen weniger Zeit.", "nicht wahr", True),
        ("de", "Alle Aufgaben sind gleich lang.", "erfunden", False),
        ("fr", "La plupart des gens finissent un essai en 3 secondes.", "inventé", True),
        ("fr", "95 personnes sur 100 terminent la tâche.", "faux", True),
        ("fr", "La plupart des essais sont courts.", "inventé", False),
        ("es", "La mayoría de la gente termina un ensayo en 3 segundos.", "inventado", True),
        ("es", "9 de cada 10 personas logran la tarea.", "falso", True),
        ("es", "La mayoría de los ensayos son cortos.", "inventado", False),
    ],
)
def test_a_norm_that_nobody_takes_back_is_found(
    code: str, text: str, truth: str, wrong: bool
) -> None:
    one(instructing(text, code), "how well others do" if wrong else "")
    one(instructing(text, code) + f'[[instructions]]\nat = "end"\ntext = "{truth}"\n', "")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "You get 20 cents for each minute.", True),
        ("en", "The longer you play, the more you earn.", True),
        ("en", "You get 12 euros an hour.", False),
        ("en", "You are not paid by the minute: everybody gets 10 euros.", False),
        ("en", "You get 8 euros for the second session.", False),
        ("de", "Sie erhalten 20 Cent pro Minute.", True),
        ("de", "Je länger Sie spielen, desto mehr Geld verdienen Sie.", True),
        ("de", "Sie erhalten 12 Euro pro Stunde.", False),
        ("fr", "Vous recevez 20 centimes par minute.", True),
        ("fr", "Chaque minute est payée : 20 centimes.", True),
        ("fr", "Vous recevez 12 euros par heure.", False),
        ("es", "Recibe 20 céntimos por minuto.", True),
        ("es", "Cuanto más tiempo juegue, más euros recibe.", True),
        ("es", "Recibe 12 euros por hora.", False),
    ],
)
def test_pay_for_slowness_is_found(code: str, text: str, wrong: bool) -> None:
    one(consenting(text, code) + TIME, "who is slow is paid more" if wrong else "")
    one(consenting(text, code) + TIME.replace("time_s", "success"), "")


def in_two_sessions(text: str, code: str) -> str:
    """A sound design of two sessions in one language, whose consent says something more."""
    return consenting(text, code).replace("participants = 24", "participants = 24\nsessions = 2")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "In May we chose the slowest people; now we compare both times.", True),
        ("en", "We invited those with the most errors last year, to see if they improve.", True),
        ("en", "We invited everybody who took part last year.", False),
        ("en", "Please do your best, as before.", False),
        (
            "de",
            "Eingeladen sind die Langsamsten vom letzten Jahr; wir vergleichen beide Zeiten.",
            True,
        ),
        (
            "de",
            "Wir haben die Schwächsten des Vortests ausgewählt und vergleichen mit damals.",
            True,
        ),
        ("de", "Eingeladen sind alle vom letzten Jahr; wir vergleichen beide Zeiten.", False),
        ("fr", "Nous invitons les plus lents de l'an dernier et comparons les temps.", True),
        ("fr", "Vous êtes choisi parmi les moins bons de mars dernier, pour comparer.", True),
        ("fr", "Nous invitons tous ceux de l'an dernier et comparons les temps.", False),
        ("es", "Invitamos a los más lentos del año pasado y comparamos los tiempos.", True),
        ("es", "Elegimos a los peores del ensayo anterior y comparamos sus tiempos.", True),
        ("es", "Invitamos a todos los del año pasado y comparamos los tiempos.", False),
    ],
)
def test_people_who_are_chosen_by_an_extreme_result_are_found(
    code: str, text: str, wrong: bool
) -> None:
    wanted = "chosen by an extreme" if wrong else ""
    one(consenting(text, code), wanted)
    groups = consenting(text, code).replace('order = "latin"', 'order = "between"')
    one(groups.replace("participants = 24", "participants = 80"), "")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "We invite only those who solve most tasks to the second session.", True),
        ("en", "If you finish 20 trials in time, you may come back for the next visit.", True),
        ("en", "Those who are slower than 10 s will not be invited again.", True),
        ("en", "We invite everybody to the second session, whatever they reach.", False),
        ("en", "You take part in the second session only if you want to.", False),
        ("de", "Zur zweiten Sitzung laden wir nur ein, wer 20 Durchgänge schafft.", True),
        ("de", "Nur die Besten kommen zum zweiten Termin.", True),
        ("de", "Zur zweiten Sitzung laden wir alle ein.", False),
        ("fr", "Seuls ceux qui réussissent 20 essais reviennent.", True),
        ("fr", "Nous invitons uniquement les meilleurs à la deuxième séance.", True),
        ("fr", "Nous invitons tout le monde à la deuxième séance.", False),
        ("es", "Solo invitamos a los mejores a la segunda sesión.", True),
        ("es", "Si termina 20 ensayos a tiempo, participa en la segunda sesión.", True),
        ("es", "Invitamos a todos a la segunda sesión.", False),
    ],
)
def test_a_later_session_of_the_good_alone_is_found(code: str, text: str, wrong: bool) -> None:
    read = in_two_sessions(text, code)
    if "20" in text:
        read = read.replace("repetitions = 2", "repetitions = 10")
    one(read, "only those who did well" if wrong else "")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "You have worked with the 'soft' contact for weeks.", True),
        ("en", "You have already used one of the ways in our course.", True),
        ("en", "You know the hard contact from a course; the soft one is new to you.", True),
        ("en", "You have not worked with any of these ways.", False),
        ("en", "You have used the tablet before. One of the boxes is soft.", False),
        ("en", "You trained both the 'soft' and the 'hard' contact.", False),
        ("de", "Sie haben im Frühjahr mit der Art „soft“ gearbeitet.", True),
        ("de", "Sie haben bereits eine der Arten benutzt.", True),
        ("de", "Sie haben noch mit keiner der Arten gearbeitet.", False),
        (
            "fr",
            "Vous avez déjà travaillé avec « soft ».",
            True,
        ),
        ("fr", "Vous avez déjà utilisé une de ces mains.", True),
        ("fr", "Vous n'avez pas encore utilisé une de ces mains.", False),
        ("es", "Usted ya ha trabajado con «soft».", True),
        ("es", "Ya ha usado una de las maneras.", True),
        ("es", "Todavía no ha usado ninguna de las maneras.", False),
    ],
)
def test_a_level_that_people_know_from_before_is_found(code: str, text: str, wrong: bool) -> None:
    one(consenting(text, code), "from before" if wrong else "")


@pytest.mark.parametrize(
    ("code", "text", "wrong"),
    [
        ("en", "If you like, play at home as well.", True),
        ("en", "Between the sessions you may practise as often as you want.", True),
        ("en", "Please do not practise at home.", False),
        ("en", "Practise for ten minutes every day at home.", False),
        ("de", "Wenn Sie möchten, können Sie zu Hause weiterspielen.", True),
        ("de", "Zwischen den Sitzungen dürfen Sie üben, so oft Sie wollen.", True),
        ("de", "Bitte üben Sie zu Hause nicht.", False),
        ("fr", "Vous pouvez jouer chez vous autant que vous le voulez.", True),
        ("fr", "Entre les séances, entraînez-vous si vous le souhaitez.", True),
        ("fr", "Ne jouez pas chez vous.", False),
        ("es", "Si quiere, puede seguir y jugar en casa.", True),
        ("es", "Juegue en casa todo el tiempo.", True),
        ("es", "Puede practicar entre las sesiones.", True),
        ("es", "No practique en casa.", False),
    ],
)
def test_practice_at_will_between_sessions_is_found(code: str, text: str, wrong: bool) -> None:
    one(in_two_sessions(text, code), "practise between the sessions" if wrong else "")
    one(consenting(text, code), "")


@pytest.mark.parametrize(
    ("code", "title", "wrong"),
    [
        ("en", "Both contacts are equal: no significant effect", True),
        ("en", "Soft is as good as hard, by p > 0.05", True),
        ("en", "Soft is as good as hard: an equivalence test with a margin of 10 %", False),
        ("en", "Are both contacts the same?", False),
        ("de", "Beide sind gleich, da nicht signifikant verschieden", True),
        ("de", "Kein Unterschied: p > 0,05 im t-Test", True),
        ("de", "Gleich gut? Ein Äquivalenztest mit Schranken", False),
        ("fr", "Aucune différence : p > 0,05", True),
        ("fr", "Les deux sont égaux, effet non significatif", True),
        ("fr", "Les deux sont-ils égaux ? Marge et test d'équivalence", False),
        ("es", "Son iguales: diferencia no significativa", True),
        ("es", "Sin diferencia, p > 0,05", True),
        ("es", "¿Son iguales? Prueba de equivalencia con margen", False),
    ],
)
def test_equality_that_is_concluded_from_a_difference_test_is_found(
    code: str, title: str, wrong: bool
) -> None:
    titled = spoken(code).replace("seed = 3", f'title = "{title}"\nseed = 3')
    one(titled, "does not show that there is none" if wrong else "")


@pytest.mark.parametrize(
    ("code", "comfort", "what"),
    [
        ("en", "Please rest for five minutes.", "rest"),
        ("en", "Have a coffee.", "food"),
        ("en", "The assistant helps you.", "help"),
        ("de", "Ruhen Sie sich aus.", "rest"),
        ("de", "Es gibt Kaffee.", "food"),
        ("de", "Die Leitung hilft Ihnen.", "help"),
        ("fr", "Reposez-vous un peu.", "rest"),
        ("fr", "Prenez un café.", "food"),
        ("fr", "L'assistant vous aide.", "help"),
        ("es", "Descanse un poco.", "rest"),
        ("es", "Tome un café.", "food"),
        ("es", "El asistente le ayuda.", "help"),
    ],
)
def test_a_comfort_before_one_level_alone_is_found(code: str, comfort: str, what: str) -> None:
    before = '\n[[instructions]]\nat = "contact"\nlevel = "{}"\ntext = "2 {}"\n'
    one(
        spoken(code) + before.format("hard", comfort) + before.format("soft", ""), f"{what} is said"
    )
    one(spoken(code) + before.format("hard", comfort) + before.format("soft", comfort), "")
