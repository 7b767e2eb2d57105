"""The page's own words in a study: few, and in the participant's language."""

from __future__ import annotations

NAMES = (
    "next", "back", "done", "agree", "decline", "required", "optional", "number", "write", "slide",
    "rest", "rest_over", "wait", "elsewhere", "paused", "first_touch", "let_stay", "success",
    "time_up", "over", "lift_again", "lift", "lost", "ended", "end",
)  # fmt: skip
"""What there are words for, in the order of the lists below."""

_LISTS = {
    "en": (
        "Next", "Back", "Done", "I agree", "I do not agree", "Please answer this question.",
        "may be left out", "Please enter a number from {low} to {high}.", "Your answer",
        "Touch the line", "A short break", "Go on when you are ready.", "One moment, please",
        "Please look at the other window.", "Paused", "Time starts with your first touch",
        "Good. Let it stay there", "Done", "Time is up", "This one is over",
        "Lift your fingers and touch again", "lift", "One moment: the connection is lost",
        "This page is open elsewhere now", "Thank you. You can give the device back.",
    ),
    "de": (
        "Weiter", "Zurück", "Fertig", "Ich bin einverstanden", "Ich bin nicht einverstanden",
        "Bitte beantworten Sie diese Frage.", "freiwillig",
        "Bitte geben Sie eine Zahl von {low} bis {high} ein.", "Ihre Antwort",
        "Berühren Sie die Linie", "Eine kurze Pause", "Machen Sie weiter, wenn Sie bereit sind.",
        "Einen Moment, bitte", "Bitte schauen Sie in das andere Fenster.", "Angehalten",
        "Die Zeit beginnt mit Ihrer ersten Berührung", "Gut. Lassen Sie es dort", "Geschafft",
        "Die Zeit ist um", "Dieser Durchgang ist vorbei",
        "Heben Sie die Finger und berühren Sie neu", "heben",
        "Einen Moment: die Verbindung ist unterbrochen", "Diese Seite ist jetzt woanders offen",
        "Vielen Dank. Sie können das Gerät zurückgeben.",
    ),
    "fr": (
        "Suivant", "Retour", "Terminé", "J’accepte", "Je n’accepte pas",
        "Veuillez répondre à cette question.", "facultatif",
        "Veuillez saisir un nombre de {low} à {high}.", "Votre réponse", "Touchez la ligne",
        "Une courte pause", "Continuez quand vous êtes prêt.", "Un instant, s’il vous plaît",
        "Veuillez regarder l’autre fenêtre.", "En pause",
        "Le temps commence quand vous touchez l’écran", "Bien. Laissez-le là", "Réussi",
        "Le temps est écoulé", "Cet essai est terminé", "Levez les doigts et touchez à nouveau",
        "lever", "Un instant : la connexion est perdue",
        "Cette page est maintenant ouverte ailleurs",
        "Merci. Vous pouvez rendre l’appareil.",
    ),
    "es": (
        "Siguiente", "Atrás", "Listo", "Acepto", "No acepto",
        "Por favor, responda a esta pregunta.",
        "opcional", "Por favor, escriba un número de {low} a {high}.", "Su respuesta",
        "Toque la línea", "Una pausa breve", "Siga cuando esté preparado.", "Un momento, por favor",
        "Por favor, mire la otra ventana.", "En pausa",
        "El tiempo empieza cuando toque la pantalla", "Bien. Déjelo ahí", "Conseguido",
        "Se acabó el tiempo", "Este intento ha terminado", "Levante los dedos y toque de nuevo",
        "levantar", "Un momento: se ha perdido la conexión",
        "Esta página está abierta ahora en otro lugar", "Gracias. Puede devolver el dispositivo.",
    ),
}  # fmt: skip

WORDS = {language: dict(zip(NAMES, words, strict=True)) for language, words in _LISTS.items()}
"""Words by language (ISO 639-1) and what they are for."""


def words_in(language: str) -> dict[str, str]:
    """The words of a language; of one that there are none in, English."""
    return WORDS.get(language.lower().split("-")[0], WORDS["en"])
