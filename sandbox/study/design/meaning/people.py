"""Flaws of what people are told and asked: consent, instructions, and questions that identify."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.design import END, START, Design
from sandbox.study.design.meaning.flaw import Flaw
from sandbox.study.design.meaning.identifying import asks_for, birth_parts
from sandbox.study.design.meaning.texts import (
    Phrases,
    asked_items,
    quoted,
    sentences,
    told_texts,
)

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
