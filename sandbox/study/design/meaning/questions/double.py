"""Questions that ask for two things at once, so that nobody knows which an answer is about."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import Design, Item
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import Phrases, asked_forms, is_own, quoted

_GOOD = {
    "en": (
        "good|bad|easy|easily|fast|quick|quickly|slow|accurate|accurately|precise|precisely|"
        "comfortable|comfortably|natural|naturally|fun|useful|reliable|reliably|pleasant|"
        "intuitive|simple|responsive|stable|smooth|realistic|enjoyable|tiring|difficult|hard|"
        "exhausting|predictable|effective|efficient|helpful|clear|interesting|boring|frustrating|"
        "satisfying|annoying|safe|confident|relaxed|tired"
    ),
    "de": (
        "gut|schlecht|einfach|leicht|schnell|langsam|genau|prazise|bequem|angenehm|unangenehm|"
        "naturlich|nutzlich|zuverlassig|intuitiv|stabil|flussig|realistisch|anstrengend|schwer|"
        "schwierig|ermudend|vorhersehbar|hilfreich|klar|interessant|langweilig|frustrierend|"
        "sicher|entspannt|mude"
    ),
    "fr": (
        "bon|bonne|facile|rapide|lente?|precise?|confortable|agreable|naturel|naturelle|utile|"
        "fiable|intuitif|intuitive|simple|stable|fluide|realiste|fatigante?|difficile|"
        "previsible|efficace|claire?|interessante?|ennuyeux|frustrante?|amusante?"
    ),
    "es": (
        "buen[oa]|facil|rapid[oa]|lent[oa]|precis[oa]|comod[oa]|agradable|natural|util|fiable|"
        "intuitiv[oa]|sencill[oa]|estable|fluid[oa]|realista|cansad[oa]|dificil|previsible|eficaz|"
        "clar[oa]|interesante|aburrid[oa]|frustrante|divertid[oa]"
    ),
}
_AND = {"en": "and", "de": "und", "fr": "et", "es": "y|e"}
_VERY = {
    "en": "very|also|not|how",
    "de": "sehr|auch|nicht|wie",
    "fr": "tres|aussi|pas",
    "es": "muy|tambien|no",
}
TWO = Phrases(
    {
        code: rf"(?:{good})\b,? (?:{_AND[code]}) (?:(?:{_VERY[code]}) )?(?:{good})\b"
        for code, good in _GOOD.items()
    }
)
"""Two judgements of one thing."""
_EACH = {
    "en": (
        r"how (?:{0})\b[^.;:?]{{0,40}}\band how (?:{0})\b|"
        r"to what extent\b[^.;:?]*\band to what extent\b|"
        r"(?:{0}) to (?:\w+ ){{1,3}}and (?:{0}) to\b"
    ),
    "de": (
        r"wie (?:{0})(?:e[nrs]?)?\b[^.;:?]{{0,40}}\bund wie (?:{0})\b|"
        r"(?:{0}) (?:zu \w+|\w+zu\w+),? und (?:{0}) (?:zu \w+|\w*zu\w+)"
    ),
    "fr": (
        r"(?:a quel point|combien|dans quelle mesure)\b[^.;:?]*\b(?:{0})s?\b[^.;:?]*\bet "
        r"(?:a quel point|combien|dans quelle mesure)\b[^.;:?]*\b(?:{0})s?\b|"
        r"(?:{0})s? (?:a|de) (?:\w+ ){{1,3}}et (?:{0})s? (?:a|de)\b"
    ),
    "es": (
        r"(?:como de|que tan|cuan) (?:{0})s?\b[^.;:?]*\b[ye] (?:(?:como de|que tan|cuan) )"
        r"(?:{0})s?\b|(?:{0})(?:e?s)? (?:de|para) (?:\w+ ){{1,3}}[ye] (?:{0})(?:e?s)? (?:de|para)\b"
    ),
}
EACH = Phrases({code: words.format(_GOOD[code]) for code, words in _EACH.items()})
"""Two judgements, each with words of its own: "how quick to move and how pleasant to touch"."""
CLAUSES = Phrases(
    {
        "en": (
            r"\w+,? (and|but) (also )?(did|does|do|was|were|is|are|felt|feels|made|makes|helped|"
            r"gave|had|has|could|would|reacted|tired|seemed|i (was|am|felt|feel|could|can|would|"
            r"did|enjoyed|liked|had|found)|it (was|is|felt|did|made|reacted))\b"
        ),
        "de": (
            r"\w+,? (und|aber) (auch )?(hat|hatte|war|waren|ist|sind|machte|macht|konnte|kann|"
            r"reagierte|reagiert|ermudete|ermudet|fuhlte|fuhlt|half|wurde|habe|bin|"
            r"(ich|sie|er|es) (war|habe|hatte|konnte|fuhlte|ist|hat|bin))\b"
        ),
        "fr": (
            r"\w+,? (et|mais) (aussi )?(etait|est|n'a|ne|n'etait|j'ai|j'etais|a ete|m'a|je|elle|il|"
            r"a fatigue|a reagi)\b"
        ),
        "es": (
            r"\w+,? (y|pero) (tambien )?(era|fue|es|no (me|era|fue|es|cans)\w*|me (senti|gusto|"
            r"cans\w*)|pude|podia|estaba)\b"
        ),
    }
)
"""Two statements, of which somebody may agree with one."""
AGREES = Phrases(
    {
        "en": r"(\w+ly )?(dis)?agree\b|(not )?(at all )?true\b|(does not |do not )?appl(y|ies)\b",
        "de": r"stimme\b|stimmt\b|trifft\b|(volle )?zustimmung|lehne\b",
        "fr": r"(pas |tout a fait )?d'accord|desaccord|vrai\b|faux\b",
        "es": r"(de |en )?(des)?acuerdo|cierto\b|verdadero\b",
    }
)
"""Ends of a scale by which people agree with a statement."""


def double_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of questions of questionnaires whose wording is the design's own."""
    for path, form in asked_forms(design):
        if not is_own(form):
            continue
        for i, item in enumerate(form.items):
            asked = _double(item) if item.kind == "scale" else None
            if asked is not None:
                yield Flaw(
                    (*path, "items", i, "ask"),
                    f"it asks for two things at once: {quoted(asked)}",
                    "Make a question of each",
                )


def _double(item: Item) -> str | None:
    """The text of a question that asks for two things; None if it does not, or this is unsure."""
    for language, text in item.ask.items():
        if TWO.match(text, language) or EACH.match(text, language):
            return text
        agreed = item.ends is not None and any(
            AGREES.match(end[language], language) for end in item.ends
        )
        if agreed and CLAUSES.match(text, language):
            return text
    return None
