"""Flaws of what people are told and asked: consent, instructions, and questions that identify."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.design import END, START, Design
from sandbox.study.design.meaning.questions.identifying import asks_for, birth_parts
from sandbox.study.design.meaning.translations import CARE, SPEED
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import (
    Phrases,
    asked_items,
    quoted,
    sentences,
    told_texts,
)

MORE, MORE_LETTERS = 1.8, 60
"""How many times as long, and by how many letters, a text before one level says more."""

ASKED = {
    "advice": Phrases(
        {
            "en": (
                r"(hint|tip|trick|advice|it helps|we (advise|recommend|suggest)|you should|"
                r"works best|saves? (a lot of )?time|make sure|avoid|best way)\b"
            ),
            "de": (
                r"(tipp|trick|hinweis|rat|ratschlag|es hilft|wir (raten|empfehlen)|sie sollten|"
                r"am besten|spart|achten sie|vermeiden)\b"
            ),
            "fr": (
                r"(conseil|astuce|il est utile|nous (conseillons|recommandons)|vous devriez|"
                r"evitez|veillez)\b"
            ),
            "es": r"(consejo|truco|recomendamos|aconsejamos|conviene|deberia|evite|procure)\b",
            "it": r"(consiglio|trucco|consigliamo|raccomandiamo|conviene|dovrebbe|eviti)\b",
            "nl": r"(tip|hint|advies|raden aan|het helpt|vermijd|let op)\b",
        }
    ),
    "speed": SPEED,
    "care": CARE,
}
"""Advice and demands, which every level is to have alike."""

AGE = "Remove it; keep names and addresses apart, beside the pseudonym; ask for an age"

UNWRITTEN = re.compile(
    r"\b(?:TODO|TBD|TBA|FIXME|XXX+|[Ll]orem ipsum|to be (?:written|added|completed|translated))\b|"
    r"\[(?:your|name|insert|add|university|contact|amount|date|number|title|text|"
    r"researcher)[^\]]*\]|<(?:your|name|insert|add)[^>]*>|_{4,}"
)
"""Marks of a text that somebody has still to write."""
AHEAD = Phrases(
    {
        "en": r"(the |all )?(following|next|coming|upcoming) (trials?|tasks?|parts?|block)|"
        r"you will (now|see|do|move|put|bring|have to|be asked to)|as (fast|quick|quickly|"
        r"accurately|precisely) as (you can|possible)|put your (fingers|hand)",
        "de": r"(folgende|nachste|kommende)[nrs]? (durchgang|aufgabe|teil|block)\w*|"
        r"sie werden (jetzt|nun|gleich)|so (schnell|genau) (wie|sie)|"
        r"legen sie (ihre|die) (finger|hand)",
        "fr": (
            r"(prochain|suivant)\w* (essai|tache|partie)|aussi (vite|rapidement) que|posez (vos|"
            r"les) doigts"
        ),
        "es": r"(proxim|siguiente)\w* (ensayo|tarea|parte)|tan rapido como|ponga (sus|los) dedos",
        "it": r"(prossim|seguent)\w* (prov|compit|part)|il piu (veloce|rapida)\w* possibile|"
        r"(metta|appoggi) le dita",
        "nl": (
            r"(volgende|komende) (taak|taken|poging\w*|deel)|zo (snel|nauwkeurig) mogelijk|"
            r"leg uw vingers"
        ),
    }
)
"""Texts about trials that are still to come."""


def people_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of texts and questions."""
    if not design.consent:
        yield Flaw(
            ("consent",),
            "participants are not asked for their consent",
            'Add [consent] with text = "..."',
        )
    yield from _told_of_some_levels(design)
    yield from _told_more_of_one(design)
    yield from _unready(design)
    for path, item in asked_items(design):
        if asked := asks_for(item):
            yield Flaw(path, f"{item.name} identifies people: it asks for {asked}", AGE)
    parts = birth_parts(design.demographics)
    if parts:
        names = ", ".join(item.name for item in parts)
        yield Flaw(
            ("demographics", design.demographics.index(parts[0])),
            f"{names} identify people: they are a birth date together",
            AGE,
        )


def _unready(design: Design) -> Iterator[Flaw]:
    """Texts that are not written yet, or that come after what they explain."""
    for told in told_texts(design):
        for language, text in told.text.items():
            if unwritten := UNWRITTEN.search(text):
                yield Flaw(
                    told.path, f"the text is not ready: {quoted(unwritten[0])}", "Write all of it"
                )
                break
            late = next((s for s in sentences(text) if AHEAD.match(s, language)), None)
            if told.at == END and late is not None:
                yield Flaw(
                    told.path,
                    f"it explains trials, and comes after the last one: {quoted(late)}",
                    'Write at = "start", or a factor',
                )
                break


def _told_more_of_one(design: Design) -> Iterator[Flaw]:
    """Texts before levels that all have one, of which one says much more, or asks for other things.

    The first of them for each factor.
    """
    for factor in design.factors:
        texts = [(i, t) for i, t in enumerate(design.instructions) if t.at == factor.name]
        told = {t.level for _, t in texts}
        if {level.name for level in factor.levels} <= told and len(told) > 1:
            for language in design.languages:
                by_level = {
                    name: " ".join(t.text[language] for _, t in texts if t.level == name)
                    for name in (level.name for level in factor.levels)
                }
                wrong = _uneven(by_level, language)
                if wrong is not None:
                    level, what = wrong
                    first = next(i for i, t in texts if t.level == level)
                    yield Flaw(
                        ("instructions", first, "text"),
                        f"{what}, so the effect of {factor.name} cannot be told from that of the "
                        "words",
                        "Say as much before all levels, and give advice before all of them or none",
                    )
                    break


def _uneven(by_level: dict[str, str], language: str) -> tuple[str, str] | None:
    """The level of which more is said than of another, and what; None if there is none."""
    by_length = sorted(by_level, key=lambda level: len(by_level[level]))
    short, long = by_length[0], by_length[-1]
    few, many = len(by_level[short]), len(by_level[long])
    if many > MORE * few and many - few > MORE_LETTERS:
        return long, f"{many} letters are said before {long}, and {few} before {short}"
    for what, phrases in ASKED.items():
        asks = [level for level, text in by_level.items() if phrases.match(text, language)]
        rest = [level for level in by_level if level not in asks]
        if asks and rest:
            return asks[0], f"{what} is said before {asks[0]}, and not before {rest[0]}"
    return None


def _told_of_some_levels(design: Design) -> Iterator[Flaw]:
    """Texts before some levels of a factor only, so that words are part of the comparison."""
    for factor in design.factors:
        texts = [(i, t) for i, t in enumerate(design.instructions) if t.at == factor.name]
        told = {t.level for _, t in texts if t.level}
        rest = [level.name for level in factor.levels if level.name not in told]
        if told and rest and factor.name not in (START, END):
            first = next(i for i, t in texts if t.level)
            yield Flaw(
                ("instructions", first),
                f"of the levels of {factor.name}, only {', '.join(sorted(told))} is announced, not "
                f"{', '.join(rest)}, so its effect cannot be told from that of the words",
                "Write as much before the other levels, or one text without `level`",
            )
