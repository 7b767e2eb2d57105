"""Ends of scales, and orders of choices, that run in opposite directions in two languages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sandbox.study.design.design import Design, Item
from sandbox.study.design.meaning.questions.polarity import amount, valence
from sandbox.study.design.reading import Text
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import Phrases, asked_items
from sandbox.study.design.toml_lines import Path

MORE = Phrases(
    {
        "en": (
            r"((very |extremely )?(good|well|easy|easily|comfortabl\w+|pleasant\w*|satisf\w+|happy|"
            r"fast|quick\w*|high\w*|much|often|always|strong\w* agree|agree|natural\w*|accurate\w*|"
            r"precise\w*|clear\w*|useful|intuitive\w*|reliabl\w+|calm|relaxed|likely|perfect\w*|"
            r"excellent\w*|best|true|important|confident|rested|yes))\b"
        ),
        "de": (
            r"(gut|leicht|einfach|angenehm|bequem|komfortabel|zufrieden|schnell|hoch|hohe?|viel|"
            r"stark|oft|haufig|immer|stimme\w* (\w+ ){0,3}zu|zustimm\w*|trifft \w* ?\w* ?zu|"
            r"zutreffend|naturlich|genau|prazise|klar|nutzlich|intuitiv|zuverlassig|ruhig|"
            r"entspannt|wahrscheinlich|perfekt|ausgezeichnet|hervorragend|beste\w*|wichtig|sicher|"
            r"ausgeruht|ja)\b"
        ),
        "fr": (
            r"(bien|bonne?|facile(ment)?|confortable|agreable|satisfaite?|content|rapide(ment)?|"
            r"elevee?|beaucoup|fort|souvent|toujours|d'accord|naturel\w*|precis\w*|claire?|utile|"
            r"intuitif|fiable|calme|detendue?|probable|parfait\w*|excellente?|meilleur\w*|"
            r"important|oui)\b"
        ),
        "es": (
            r"(bien|buen[oa]?|facil(mente)?|comod[oa]|agradable|satisfech[oa]|content[oa]|"
            r"rapid[oa](mente)?|alt[oa]|mucho|fuerte|siempre|(a menudo|de acuerdo)|natural|"
            r"precis[oa]|clar[oa]|util|intuitiv[oa]|fiable|tranquil[oa]|relajad[oa]|probable|"
            r"perfect[oa]|excelente|mejor|importante|si)\b"
        ),
    }
)
LESS = Phrases(
    {
        "en": (
            r"(bad|badly|poor\w*|difficult|hard|uncomfortabl\w+|unpleasant\w*|dissatisf\w+|"
            r"unsatisf\w+|unhappy|slow\w*|low\w*|little|never|rarely|seldom|disagree|unnatural\w*|"
            r"inaccurate\w*|imprecise\w*|unclear\w*|useless|unintuitive|unreliabl\w+|tense|"
            r"stressed|unlikely|terrib\w+|awful\w*|worst|false|unimportant|unsure|tired|none|no)\b"
        ),
        "de": (
            r"(schlecht|schwer|schwierig|unangenehm|unbequem|unkomfortabel|unzufrieden|langsam|"
            r"niedrig\w*|gering|wenig|schwach|nie|niemals|selten|lehne \w* ?ab|unnaturlich|ungenau|"
            r"unprazise|unklar|nutzlos|unzuverlassig|angespannt|gestresst|unwahrscheinlich|"
            r"furchtbar|schrecklich|schlechteste\w*|unwichtig|unsicher|mude|nein|keine?)\b"
        ),
        "fr": (
            r"(mal|mauvaise?|difficile(ment)?|inconfortable|desagreable|insatisfaite?|mecontent|"
            r"lente?(ment)?|faible|basse?|peu|jamais|rarement|pas d'accord|desaccord|imprecis\w*|"
            r"confuse?|inutile|tendue?|stressee?|improbable|terrible|pire|fatiguee?|aucune?|non)\b"
        ),
        "es": (
            r"(mal|mal[oa]|dificil(mente)?|incomod[oa]|desagradable|insatisfech[oa]|descontent[oa]|"
            r"lent[oa](mente)?|baj[oa]|poco|nunca|raramente|en desacuerdo|imprecis[oa]|confus[oa]|"
            r"inutil|tens[oa]|estresad[oa]|improbable|terrible|peor|cansad[oa]|ningun[oa]?|no)\b"
        ),
    }
)
"""Words of the upper and of the lower end of a scale."""
DENIED = Phrases(
    {
        "en": r"not\b|\w+n't\b",
        "de": r"(nicht|gar nicht|uberhaupt nicht|wenig|kaum)\b",
        "fr": r"(pas|ne|peu|aucunement)\b",
        "es": r"(no|nada|poco)\b",
    }
)
"""Words that turn a word into its opposite."""


def end_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of scales and choices in several languages, one line for equal ends in a form."""
    if len(design.languages) < 2:
        return
    alike: dict[tuple[Path, str], list[tuple[Path, Item, tuple[Text, Text]]]] = {}
    for path, item in asked_items(design):
        ends = item.ends if item.kind == "scale" else None
        if item.means:
            ends = item.means[0], item.means[-1]
        if ends is not None:
            alike.setdefault((path[:-1], repr(ends)), []).append((path, item, ends))
    for some in alike.values():
        path, _, (low, high) = some[0]
        opposite = _opposite((low, high), design.languages)
        if opposite is not None:
            up, down = opposite
            names = " and ".join(item.name for _, item, _ in some)
            yield Flaw(
                path,
                f"{names} {'run' if len(some) > 1 else 'runs'} in opposite directions: from "
                f"{low[up]!r} to {high[up]!r} in {up}, and from {low[down]!r} to {high[down]!r} in "
                f"{down}",
                f"Exchange the two ends in {up} or in {down}",
            )


def _opposite(ends: tuple[Text, Text], languages: Sequence[str]) -> tuple[str, str] | None:
    """A language in which a scale goes up, and one in which it goes down; None if all agree.

    The first of three readings that tells something about two languages decides: words of both
    ends, words of what is good or bad, and words of none.
    """
    for reading in (_way, valence, amount):
        ways = {code: way for code in languages if (way := reading(ends, code))}
        up = next((code for code, way in ways.items() if way > 0), None)
        down = next((code for code, way in ways.items() if way < 0), None)
        if up is not None and down is not None:
            return up, down
        if len(ways) > 1:
            return None
    return None


def _way(ends: tuple[Text, Text], language: str) -> int:
    """1 if a scale goes up in a language, -1 if it goes down, 0 if this cannot be told."""
    low, high = (_sign(text[language], language) for text in ends)
    return 0 if low == high else 1 if high > low else -1


def _sign(text: str, language: str) -> int:
    less, more = LESS.match(text, language), MORE.match(text, language)
    if less:
        return 0 if _turned(text, language) and not more else -1
    if more:
        return -1 if _turned(text, language) else 1
    return 0


def _turned(text: str, language: str) -> bool:
    return DENIED.match(text, language) is not None
