"""Answers that do not fit their question: of another kind, on one side, or after two denials."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.design import Design, Item
from sandbox.study.design.meaning.questions.double import AGREES
from sandbox.study.design.meaning.questions.polarity import NONE, sign
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import Phrases, asked_forms, is_own, quoted
from sandbox.words.words import base

HOW = Phrases(
    {
        "en": r"how (?!about|come)\w+[^.]*\?|to what extent[^.]*\?",
        "de": r"(wie|inwieweit|in welchem masse)\b[^.,]*\?",
        "fr": r"(comment|a quel point|dans quelle mesure|combien)\b[^.]*\?",
        "es": r"(como de|cuan|que tan|cuant[oa]s?|en que medida|hasta que punto)\b[^.]*\?",
        "it": r"(quanto|quanta|in che misura|fino a che punto)\b[^.]*\?",
        "nl": r"(hoe|in hoeverre|in welke mate)\b[^.]*\?",
        "pt": r"(quao|quant[oa]s?|em que medida|ate que ponto)\b[^.]*\?",
    }
)
"""Questions that ask how much, so that nobody can agree with them."""
_YES_NO = frozenset(
    ("yes", "no", "ja", "nein", "oui", "non", "si", "sim", "nao", "nee", "是", "否", "نعم", "لا")
)

SLIGHT = Phrases(
    {
        "en": r"(a little|little|a bit|slight\w*|somewhat|less|rather|fairly|moderate\w*|quite)\b",
        "de": r"(etwas|ein wenig|wenig\w*|leicht|ein bisschen|massig|eher|ziemlich)\b",
        "fr": r"(un peu|peu|legerement|assez|plutot|moins|moderement)\b",
        "es": r"(un poco|poco|ligeramente|algo|bastante|menos)\b",
        "it": r"(un po|poco|leggermente|abbastanza|meno)\b",
        "nl": r"(een beetje|weinig|licht|enigszins|minder|tamelijk)\b",
        "pt": r"(um pouco|pouco|ligeiramente|bastante|menos)\b",
    }
)
"""Words of a small amount, which begin a scale of amounts."""

_NOT = {
    "en": re.compile(
        r"\b(?:not|never|no|nothing|nobody|cannot|without|\w+n't)\b[^,.;]*\b(?:not|never|no|"
        r"nothing|nobody|without|unable|impossible|lack|failed|un(?:comfort|predict|reli|pleas|"
        r"natur|cert|easy|sure|safe|control)\w*|in(?:accurat|secur|precis|convenient)\w*|"
        r"imprecise\w*)\b"
    ),
    "de": re.compile(
        r"\b(?:nicht|nie|niemals|kein\w*|nichts|ohne)\b[^,.;]*\b(?:nicht|nie|niemals|kein\w*|"
        r"nichts|ohne|un(?:angenehm|bequem|zuverlass|genau|sicher|naturlich|vorherseh|kontroll|"
        r"klar|moglich|fahig)\w*)\b"
    ),
    "fr": re.compile(
        r"\b(?:pas|jamais|sans|aucun\w*)\b[^,.;]*\b(?:in(?:confort|precis|certain|stabl|"
        r"capable)\w*|imprevis\w*|impossib\w*|desagreab\w*|sans)\b"
    ),
    "es": re.compile(
        r"\b(?:no|nunca|sin)\b[^,.;]*\b(?:in(?:comod|segur|establ|capaz)\w*|impre(?:cis|vis)\w*|"
        r"imposib\w*|desagradab\w*|sin)\b"
    ),
}
"""Two denials in one clause."""


def answering_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of the answers of questionnaires whose wording is the design's own."""
    for path, form in asked_forms(design):
        for i, item in enumerate(form.items if is_own(form) else ()):
            place = (*path, "items", i)
            for language in design.languages:
                wrong = (
                    _other_kind(item, language)
                    or _denied_twice(item, language)
                    or _one_sided(item, language)
                )
                if wrong is not None:
                    yield Flaw(place, *wrong)
                    break


def _agrees(item: Item, language: str) -> bool:
    return item.ends is not None and all(AGREES.match(end[language], language) for end in item.ends)


def _other_kind(item: Item, language: str) -> tuple[str, str] | None:
    """Answers of another kind than the question asks for."""
    ask = item.ask[language]
    if not HOW.match(ask, language):
        return None
    if item.kind == "scale" and _agrees(item, language):
        said = "agree or disagree"
    elif (
        item.kind == "choice"
        and {plain(item.called(choice, language)) for choice in item.choices} <= _YES_NO
    ):
        said = "say yes or no"
    else:
        return None
    return (
        f"nobody can {said} when it is asked how: {quoted(ask)}",
        "Make a statement of it, or write ends such as not at all and very much",
    )


def _denied_twice(item: Item, language: str) -> tuple[str, str] | None:
    pattern = _NOT.get(base(language))
    ask = item.ask[language]
    if item.kind != "scale" or pattern is None or not pattern.search(plain(ask)):
        return None
    return (
        f"two denials are hard to answer: {quoted(ask)}",
        "Say it without one of them, and list the item in `reverse` where it turns round",
    )


def _one_sided(item: Item, language: str) -> tuple[str, str] | None:
    """Answers that are all good, or all bad."""
    if item.kind == "scale" and item.ends is not None:
        texts = [end[language] for end in item.ends]
    elif item.kind == "choice" and HOW.match(item.ask[language], language):
        texts = [item.called(choice, language) for choice in item.choices]
    else:
        return None
    signs = {sign(text, language) for text in texts}
    if len(signs) > 1 or signs == {0} or _open(texts, language):
        return None
    good = signs == {1}
    return (
        f"every answer to {item.name} is {'good' if good else 'bad'}: {texts[0]!r} to "
        f"{texts[-1]!r}",
        f"Give an answer to those who found it {'bad' if good else 'good'}",
    )


def _open(texts: list[str], language: str) -> bool:
    """True if a scale of amounts begins or ends near none."""
    return any(
        NONE.match(text, language) or SLIGHT.match(text, language) for text in (texts[0], texts[-1])
    )
