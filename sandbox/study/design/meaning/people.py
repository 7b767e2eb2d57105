"""Flaws of what people are told and asked: consent, instructions, and questions that identify."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import END, START, Design
from sandbox.study.design.meaning.flaw import Flaw
from sandbox.study.design.meaning.identifying import asks_for, birth_parts
from sandbox.study.design.meaning.texts import asked_items

AGE = "Remove it; keep names and addresses apart, beside the pseudonym; ask for an age"


def people_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of texts and questions."""
    if not design.consent:
        yield Flaw(
            ("consent",),
            "participants are not asked for their consent",
            'Add [consent] with text = "..."',
        )
    yield from _told_of_some_levels(design)
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
