"""Scales on which a point means that somebody does not know, which is no amount."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import Design
from sandbox.study.design.meaning.conduct.sayings import said
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import (
    INSTRUCTION,
    QUESTION,
    TITLE,
    Phrases,
    asked_items,
    quoted,
)

UNKNOWN = Phrases(
    {
        "en": (
            r"(do not|don't|cannot|can't|can not) (\w+ )?(know|say|tell|judge|decide|answer|rate)|"
            r"(does|do) not (\w+ )?apply|doesn't apply|not applicable|no (opinion|experience|"
            r"answer)\b|n/a\b"
        ),
        "de": (
            r"(nicht|keine) (\w+ )?(wissen|wisst|beurteilen|beantworten|sagen konnen|zutrifft|"
            r"zutreffen|passt|"
            r"angabe|meinung)|weiss (ich )?(es )?nicht"
        ),
        "fr": (
            r"(savez|sais|pouvez) pas|ne (vous )?(s'applique|concerne)|sans (avis|opinion|objet)|"
            r"pas (d'avis|applicable)"
        ),
        "es": (
            r"no (lo )?(sabe|sabes|se\b|puede (decir|juzgar))|no (se |le )?aplica|no procede|sin "
            r"opinion|ns/nc"
        ),
    }
)
"""That somebody has no answer."""
POINT = Phrases(
    {
        "en": (
            r"(choose|select|pick|tick|mark|click|take|use|give|enter|answer|circle|put|set|write|"
            r"leave)\b[^.]*\b(\d+|zero|middle|centre|center|neutral\w*|midpoint|lowest)\b|\d+ (=|"
            r"means|stands for|is for)"
        ),
        "de": (
            r"(wahl|nehm|kreuz|antwort|geb|schreib|setz|stell|lass|klick|markier)\w*\b[^.]*\b(\d+|"
            r"null|mitte|mittlere\w*|neutral\w*)\b|\d+ (=|bedeutet|heisst|steht fur)"
        ),
        "fr": (
            r"(choisi|coch|indiqu|mett|donn|repond|laiss|selectionn)\w*\b[^.]*\b(\d+|zero|milieu|"
            r"centre|neutre|median\w*)\b|\d+ (=|signifie|veut dire)"
        ),
        "es": (
            r"(elij\w*|elegir|escoja|marque|indique|ponga|de|responda|deje|"
            r"seleccione)\b[^.]*\b(\d+|"
            r"cero|medio|centro|neutr\w*|central)\b|\d+ (=|significa|quiere decir)"
        ),
    }
)
"""A point of a scale that somebody is to choose."""
OPEN = Phrases(
    {
        "en": r"leave (it|them|this|that|the \w+) (out|open|empty|blank)|skip\w*|nothing",
        "de": r"(lass\w*|bleib\w*)\b[^.]*\b(aus|offen|leer|frei)|uberspring\w*|auslassen",
        "fr": r"(laiss\w*)\b[^.]*\b(vide|blanc|ouvert)|saut\w*|pass(ez|er)",
        "es": r"dej\w*\b[^.]*\b(en blanco|vaci\w*|sin)|salt\w*|omit\w*",
    }
)
"""That it is left out."""


def unknown_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of what somebody answers who does not know, the first in texts and all in ends."""
    remedy = "Write optional = true, and ask people to leave it out; a missing answer stays missing"
    scales = [(path, item) for path, item in asked_items(design) if item.kind == "scale"]
    for path, item in scales:
        for end, key in zip(item.ends or (), ("low_means", "high_means"), strict=False):
            text = next((t for code, t in end.items() if UNKNOWN.match(t, code)), None)
            if text is not None:
                yield Flaw(
                    (*path, key),
                    f"not to know is no amount, and an end of {item.name}: {quoted(text)}",
                    remedy,
                )
    if scales:
        kinds = (TITLE, QUESTION, INSTRUCTION)
        for told, _, statement in said(design, (UNKNOWN, POINT), (OPEN,), kinds):
            yield Flaw(
                told.path,
                f"who does not know is to choose a point of the scale, and is counted with those "
                f"who mean it: {quoted(statement)}",
                remedy,
            )
            return
