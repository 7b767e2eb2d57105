"""`study check` lets sound texts be: sentences of good consent forms and instructions."""

from __future__ import annotations

import pytest

from sandbox.study.design.meaning.findings import findings
from tests.sandbox.study.design.spoken_designs import CONSENT, TOGETHER, spoken
from tests.support.study_files import design

CONSENTS = {
    "en": (
        "If you stop early, we will pay you for the whole hour. "
        "You do not have to finish to pass the course. "
        "If you leave, you do not have to pay anything back. "
        "You may feel slight discomfort, as after normal use of a tablet. "
        "Pain is not expected. "
        "We record where and when you touch the screen, how long each trial takes, and your "
        "answers. We do not record sound or video. "
        "The program does not record your face. Nobody but the research team sees the data. "
        "Your data are stored on a server of the university and will not be passed to "
        "others, such as your employer or your teacher. "
        "You will not be paid more or less for how well you do. Everybody receives 10 euros, "
        "also those who stop early. "
        "The list that links codes and names is kept apart, in a locked cabinet, and is "
        "destroyed after six months. "
        "If you are under 18, please do not take part. "
        "Nothing can break. If your fingers get tired, take a break at any time. "
        "You take part alone; nobody watches you. The experimenter waits next door. "
        "Your answers are not judged, and there are no right or wrong answers. "
        "After publication we can no longer delete your data, since the code list will have "
        "been destroyed. "
        "We will publish the data without any names, in an archive that anybody can read. "
        "Please tell the experimenter about any pain. The session can be stopped whenever "
        "you like. "
        "We measure your time, but do not store your name, address or e-mail. "
        "Students may get a credit for their course, or write a short report instead. "
        "Only the research team can read your answers. "
        "You do not give up any legal rights, and the university is insured for accidents. "
        "You receive 12 euros an hour, however many trials you finish. "
        "We invite people of all ages who have never used such a hand. "
        "Whoever took part last year may take part again. "
        "Some people find the second part easier than the first. "
        "Most people find the movements easy on the hand, but fingers can get tired. "
        "Please ask us if something is not clear before you begin. "
        "The people who developed the program do not see who gave which answers."
    ),
    "de": (
        "Wer früher geht, muss nichts zurückzahlen. "
        "Schmerzen sind nicht zu erwarten. "
        "Wir zeichnen Berührungen, Zeiten und Antworten auf, jedoch weder Bild noch Ton. "
        "Ihr Name wird nicht gespeichert; die Liste mit Namen und Kürzeln liegt getrennt und "
        "wird nach sechs Monaten vernichtet. "
        "Ihre Daten werden nicht an Dritte weitergegeben, auch nicht an Ihren Arbeitgeber "
        "oder Ihre Lehrkraft. "
        "Sie erhalten 10 Euro, auch wenn Sie vorzeitig aufhören. "
        "Es gibt keine richtigen und falschen Antworten; Sie können nichts falsch machen. "
        "Gespeichert werden Ihre Berührungen, Zeiten und Antworten, aber keine Bilder. "
        "Nach der Veröffentlichung können die anonymen Daten nicht mehr gelöscht werden. "
        "Personen unter 18 Jahren können nicht teilnehmen. "
        "Der Versuchsleiter wartet im Nebenraum. "
        "Bei Schmerzen hören Sie bitte sofort auf; das hat keine Folgen für Sie. "
        "Sie verzichten auf keine Rechte, und die Universität haftet für Schäden. "
        "Sie erhalten 12 Euro pro Stunde, gleich wie viele Durchgänge Sie schaffen. "
        "Eingeladen sind Personen, die noch nie mit so einer Hand gearbeitet haben. "
        "Wer die Antworten gegeben hat, sehen die Entwickler nicht."
    ),
    "fr": (
        "Si vous abandonnez, vous ne devrez rien rembourser ni payer. "
        "Les participants ne doivent rien payer. "
        "Nous enregistrons vos contacts, vos temps et vos réponses, mais ni image ni son. "
        "Votre nom n'est jamais enregistré avec les données. "
        "Vous recevrez 10 euros, même si vous arrêtez avant la fin. "
        "Les résultats ne seront pas transmis à votre employeur. "
        "Il n'y a ni bonne ni mauvaise réponse. "
        "La liste des noms est gardée à part, dans une armoire fermée. "
        "L'expérimentateur attend dans la pièce voisine. "
        "Vous ne renoncez à aucun droit, et l'université est assurée. "
        "Vous recevez 12 euros par heure, quel que soit le nombre d'essais réussis. "
        "Nous invitons des personnes qui n'ont jamais utilisé une telle main. "
        "Dites-nous si quelque chose n'est pas clair."
    ),
    "es": (
        "Quien abandone no tendrá que pagar nada. "
        "Registramos sus toques, los tiempos y sus respuestas, pero no su voz ni su imagen. "
        "Su nombre no se guarda con los datos. "
        "Recibirá 10 euros aunque lo deje antes. "
        "Los resultados no se entregarán a su profesor. "
        "No hay respuestas correctas ni incorrectas. "
        "El investigador espera en la sala de al lado. "
        "Los menores de 18 años no pueden participar. "
        "Usted no renuncia a ningún derecho, y la universidad tiene un seguro. "
        "Recibe 12 euros por hora, termine los ensayos que termine. "
        "Invitamos a personas que nunca han usado una mano así. "
        "Díganos si algo no está claro."
    ),
}

INSTRUCTIONS = {
    "en": (
        "Take your time before you touch the screen. "
        "Bring the box to the marked place as fast as you can. "
        "Please work quickly and accurately. Take your time to read the questions between "
        "the parts. "
        "There are two parts, with a practice before each. The second part begins after a "
        "short break. "
        "Place your fingers on the screen; the hand follows them. Lift them to let go. "
        "If you get stuck, wait until the trial ends. Time does not matter in the practice "
        "trials. "
        "You will use two ways to control the hand, in random order. "
        "The hand may behave differently in each part. Please tell us afterwards how it was. "
        "Try to be as good in the second part as in the first. "
        "Please hold the tablet still. Do not lean on the screen. "
        "Please use the same fingers in both parts. "
        "Each part is followed by a questionnaire. Please answer all questions honestly. "
        "If you do not know an answer, leave it open. Choose a point from 1 to 7. "
        "A trial that is too long ends by itself, and counts like the others. "
        "After the trials we would like to hear what you think. "
        "If you have a question during a trial, say so. You may skip questions. "
        "Watch the second hand, too. Say stop whenever you like. "
        "Between the parts you may stand up and rest as long as you want."
    ),
    "de": (
        "Lassen Sie sich Zeit, bevor Sie den Bildschirm berühren. "
        "Bringen Sie die Kiste so schnell wie möglich an die markierte Stelle. "
        "Arbeiten Sie zügig und genau. Nehmen Sie sich Zeit für die Fragebögen. "
        "Es gibt zwei Teile mit je einer Übung davor. "
        "Legen Sie die Finger auf den Bildschirm; die Hand folgt ihnen. "
        "Die Hand kann sich in den Teilen verschieden verhalten. Sagen Sie uns danach, wie "
        "es war. "
        "In der Übung spielt Zeit keine Rolle. "
        "Bitte benutzen Sie in beiden Teilen dieselben Finger. "
        "Wenn Sie eine Antwort nicht wissen, lassen Sie sie aus. "
        "Ein Durchgang, der zu lange dauert, endet von selbst und zählt wie die anderen. "
        "Nach den Durchgängen würden wir gern hören, was Sie denken. "
        "Achten Sie auch auf die andere Hand. Fragen dürfen Sie überspringen."
    ),
    "fr": (
        "Amenez la boîte au but aussi vite que possible. "
        "Travaillez vite et avec précision. Prenez votre temps pour lire les questions. "
        "Il y a deux parties, chacune précédée d'un entraînement. "
        "Posez les doigts sur l'écran ; la main les suit. "
        "La main peut se comporter autrement dans la seconde partie. "
        "Si vous ne savez pas, laissez la réponse vide. "
        "Un essai trop long se termine de lui-même et compte comme les autres. "
        "Après les essais, dites-nous ce que vous en pensez. "
        "Regardez aussi l'autre main."
    ),
    "es": (
        "Tómese el tiempo que quiera antes de cada ensayo. "
        "Lleve la caja al lugar marcado tan rápido como pueda. "
        "Hay dos partes, cada una con unos ensayos de práctica. "
        "Ponga los dedos en la pantalla; la mano les sigue. "
        "La mano puede comportarse de otro modo en la segunda parte. "
        "Si no lo sabe, deje la respuesta en blanco. "
        "Un ensayo demasiado largo termina por sí solo y cuenta como los demás. "
        "Después de los ensayos nos gustaría oír lo que piensa. "
        "Mire también la otra mano."
    ),
}


def told(text: str) -> list[str]:
    return [finding.mistake.what for finding in findings(design(text))]


@pytest.mark.parametrize("code", sorted(CONSENTS))
def test_sentences_of_a_good_consent_are_let_be(code: str) -> None:
    text = spoken(code)
    assert CONSENT[code] in text
    assert told(text.replace(CONSENT[code], f"{CONSENT[code]} {CONSENTS[code]}")) == []
    two = TOGETHER.format(code=code, consent=CONSENT[code], told=CONSENTS[code])
    assert told(two) == []


@pytest.mark.parametrize("at", ["start", "contact"])
@pytest.mark.parametrize("code", sorted(INSTRUCTIONS))
def test_sentences_of_good_instructions_are_let_be(code: str, at: str) -> None:
    shown = f'\n[[instructions]]\nat = "{at}"\ntext = "{INSTRUCTIONS[code]}"\n'
    assert told(spoken(code) + shown) == []
    assert told(spoken(code) + shown + '[analysis]\nprimary = ["time_s"]\n') == []
