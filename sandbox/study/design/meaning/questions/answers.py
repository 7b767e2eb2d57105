"""Questions that somebody cannot answer: no answer fits, two do, or nobody knows what one means."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from math import inf

from sandbox.study.design.design import Design, Item
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import asked_forms, asked_items
from sandbox.study.design.toml_lines import Path

OLD = 80
"""Years; a compulsory question for the age that ends below this shuts people out."""

CHILD = 18
"""Years; a question that ends below this is asked of children."""

_AGE = re.compile(
    r"(?<!\w)(?:age|how old|years old|alter|wie alt|quel age|edad|cuantos anos|eta|quanti anni|"
    r"leeftijd|hoe oud|idade|alder|wiek|vek|возраст)(?!\w)|年龄|年齢|何歳|나이"
)
_SENSITIVE = re.compile(
    r"(?<!\w)(?:gender|sex|income|salary|religio\w*|ethnic\w*|racial|disabilit\w*|illness\w*|"
    r"diseases?|diagnos\w*|medication|sexual|politic\w*|geschlecht|einkommen|konfession|"
    r"behinderung\w*|krankheit\w*|genre|sexe|revenus?|handicap|maladies?|genero|sexo|ingresos|"
    r"etnia|discapacidad|enfermedad\w*|genere|sesso|reddito|disabilita|malatti\w*|geslacht|"
    r"inkomen|religie|ziektes?|пол)(?!\w)|性别|性別|성별|收入|宗教"
)
_DECLINES = re.compile(
    r"prefer|rather not|no answer|not (?:to )?(?:say|answer|tell)|declin|keine (?:angabe|antwort)|"
    r"k\. ?a\.|mochte (?:ich )?nicht|ne (?:souhaite|veux|prefere) pas|sans reponse|non precise|"
    r"no (?:contest|respond|decir)|non (?:rispond|dire|specific)|geen antwoord|zeg ik liever|"
    r"liever niet|不愿|不想|答えたくない|回答しない|無回答"
)
_REMARKS = re.compile(
    r"(?<!\w)(?:comments|(?:any|your) comment|remarks?|anything (?:else|to add|more)|suggestions?|"
    r"anmerkung\w*|kommentar\w*|bemerkung\w*|vorschlag\w*|verbesserung\w*|commentaires?|"
    r"remarques?|suggestions?|comentarios?|observacion\w*|sugerencias?|commenti|osservazioni|"
    r"suggerimenti|opmerking\w*)(?!\w)|意见|备注|感想|コメント"
)

_RANGE = re.compile(
    r"^(\d+)\s*(?:years?|jahre?|ans|anos|anni|jaar)?\s*(?:-|–|—|to|bis|a|tot|until|up to|~|至|"
    r"から)\s*(\d+)(?!\d)"
)
_OPEN = re.compile(
    r"(\d+)\s*(?:years?|jahre?|ans|anos|anni|jaar)?\s*(?:\+|(?:or|and|oder|und|et|ou|y|o|e|en|"
    r"of)\s*(?:more|older|over|above|up|alter|mehr|daruber|plus|mas|mayor|oltre|piu|ouder|meer)|"
    r"以上)"
)
_ABOVE = re.compile(
    r"(?:over|above|more than|older than|uber|mehr als|alter als|plus de|mas de|mayor de|piu di|"
    r"oltre|meer dan|ouder dan|>)\s*(\d+)"
)
_FROM = re.compile(r"(?:from|ab|a partir de|desde|vanaf|at least|mindestens|>=|≥)\s*(\d+)")
_BELOW = re.compile(
    r"(?:under|below|less than|younger than|fewer than|unter|weniger als|junger als|moins de|"
    r"menos de|menor de|meno di|minder dan|jonger dan|<)\s*(\d+)"
)
_BETWEEN = re.compile(rf"^(?:[a-z]+ ){{0,2}}(\d+)\D+(?:{_BELOW.pattern})")
"""A choice with both of its ends: "1 hour or more, less than 3"."""
_ALONE = re.compile(r"^(\d+)$")

_AGES = r"(?P<{}>\d{{2}})(?: ?(?:-|–|to|and|bis|und|a|et|y|e|en|tot) ?(?P<{}>\d{{2}}))?(?!\d)"
_STATED = re.compile(
    r"(?<!\w)(?:aged?|ages|(?:people|adults|persons|participants|men|women|users|everybody|"
    r"personen|erwachsene|menschen|teilnehmende|leute|personnes|adultes|personas|adultos|persone|"
    r"adulti|mensen|volwassenen)) (?:of |from |between |over |above |older than |aged |ab |von |"
    r"uber |zwischen |de |entre |mayores de |oltre |tra |van |vanaf |boven )?"
    + _AGES.format("a", "b")
    + "|"
    + _AGES.format("c", "d")
    + r" ?-?(?:years?|jahren?|ans|anos|anni|jaar)(?: of age)? ?-?"
    r"(?:old|of age|(?:and|or|und|oder|et|ou|y|o|e|en|of) (?:older|over|above|more|up|alter|plus|"
    r"mas|mayor|oltre|piu|ouder))|ab (?P<e>\d{2}) jahren"
)
"""Ages of people who are wanted, as in "adults of 65 and older" or "18 to 30 years old"."""


def answer_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of all questions, one line for each question."""
    stated = _stated_ages(design)
    for path, item in asked_items(design):
        wrong = (
            _of_ages(item, stated)
            or _of_ranges(item)
            or _of_meanings(item)
            or (_of_privacy(item) if path[0] == "demographics" else None)
            or _of_remarks(item)
        )
        if wrong is not None:
            yield Flaw(path, *wrong)
    yield from _twice(design)


Wrong = tuple[str, str] | None


def _asks(item: Item, pattern: re.Pattern[str]) -> bool:
    """True if an item's name or text has some words."""
    name = item.name.replace("_", " ").replace("-", " ")
    return any(pattern.search(plain(text)) for text in (name, *item.ask.values()))


def asks_age(item: Item) -> bool:
    """True if a question asks for the age."""
    return _asks(item, _AGE)


def ages_of(item: Item) -> tuple[float, float] | None:
    """Smallest and largest number that can be answered; None if answers are no numbers."""
    if item.kind == "number":
        return item.low, item.high
    ranges = _ranges(item) if item.kind == "choice" else []
    if ranges and len(ranges) == len(item.choices):
        return min(a for a, _ in ranges), max(b for _, b in ranges)
    return None


def _stated_ages(design: Design) -> list[int]:
    """Ages of the people who are wanted, from the title, the consent and the texts at the start."""
    texts = [design.title, *design.consent.values()]
    for instruction in design.instructions:
        texts += instruction.text.values()
    return [
        int(age)
        for text in texts
        for match in _STATED.finditer(plain(text))
        for age in match.groupdict().values()
        if age
    ]


def _of_ages(item: Item, stated: list[int]) -> Wrong:
    """Ages that have no answer."""
    ages = ages_of(item) if asks_age(item) else None
    if ages is None or ages[1] > 200:
        return None
    low, high = ages
    shut = [age for age in stated if not low <= age <= high]
    if shut:
        return (
            f"{item.name} takes {low:g} to {high:g}, and the study speaks of people of {shut[0]}",
            "Let the answers hold everybody who takes part",
        )
    if CHILD <= high < OLD and not item.optional:
        return (
            f"who is older than {high:g} cannot answer {item.name}, and has to",
            "Write an answer for everybody, such as high = 120, or optional = true",
        )
    return None


def _ranges(item: Item) -> list[tuple[float, float]]:
    """Ranges of whole numbers that the choices of an item are, without other choices."""
    texts = [plain(choice).strip() for choice in item.choices]
    found = [_range_of(text) for text in texts]
    if item.means and not any(found):
        first = next(iter(item.means[0]), "")
        found = [_range_of(plain(means[first]).strip()) for means in item.means]
    return [some for some in found if some is not None]


def _range_of(text: str) -> tuple[float, float] | None:
    if match := _RANGE.search(text):
        return float(match[1]), float(match[2])
    if match := _BETWEEN.search(text):
        return float(match[1]), float(match[2]) - 1
    if match := _OPEN.search(text):
        return float(match[1]), inf
    if match := _ABOVE.search(text):
        return float(match[1]) + 1, inf
    if match := _FROM.search(text):
        return float(match[1]), inf
    if match := _BELOW.search(text):
        return -inf, float(match[1]) - 1
    if match := _ALONE.search(text):
        return float(match[1]), float(match[1])
    return None


def _of_ranges(item: Item) -> Wrong:
    """Ranges that overlap, or leave a gap."""
    ranges = _ranges(item) if item.kind == "choice" else []
    wide = [some for some in ranges if some[0] < some[1]]
    if len(wide) < 2 or len(ranges) < len(item.choices) - 1:
        return None
    ordered = sorted(ranges)
    for (_, end), (start, _) in pairwise(ordered):
        if start <= end:
            return (
                f"{start:g} fits two choices of {item.name}",
                "Let each choice begin one above the end of the one before",
            )
        if start > end + 1 and len(ranges) == len(item.choices):
            gap = f"{end + 1:g}" if start == end + 2 else f"{end + 1:g} to {start - 1:g}"
            return (
                f"{gap} fits no choice of {item.name}",
                "Let each choice begin one above the end of the one before",
            )
    return None


def _of_meanings(item: Item) -> Wrong:
    """Answers that cannot be told from each other, or that mean nothing."""
    if item.kind == "scale":
        if item.ends is None:
            if not any(re.search(r"\d", text) for text in item.ask.values()):
                return (
                    f"nobody is told what {item.low:g} and {item.high:g} of {item.name} mean",
                    'Write low_means = "..." and high_means = "..."',
                )
        elif any(text and text == item.ends[0][code] for code, text in item.ends[1].items()):
            return (
                f"both ends of {item.name} have the same words",
                "Change low_means or high_means",
            )
    for language in item.means[0] if item.means else ():
        texts = Counter(plain(means[language]).strip() for means in item.means)
        text, count = texts.most_common(1)[0]
        if text and count > 1:
            return (
                f"two choices of {item.name} are both called {text!r} in {language}",
                "Give each choice a text of its own",
            )
    return None


def _of_privacy(item: Item) -> Wrong:
    """Personal questions that have to be answered."""
    texts = [*item.choices, *(text for means in item.means for text in means.values())]
    if item.optional or not _asks(item, _SENSITIVE):
        return None
    if any(_DECLINES.search(plain(text)) for text in texts):
        return None
    return (
        f"{item.name} is personal, and everybody has to answer",
        'Write optional = true, or a choice such as "prefer not to say"',
    )


def _of_remarks(item: Item) -> Wrong:
    """Remarks that have to be made."""
    if item.kind != "text" or item.optional or not _asks(item, _REMARKS):
        return None
    return (
        f"who has nothing to say to {item.name} cannot go on",
        "Write optional = true",
    )


def _twice(design: Design) -> Iterator[Flaw]:
    """Questions that a form asks twice."""
    groups: list[tuple[Path, tuple[Item, ...]]] = [(("demographics",), design.demographics)]
    groups += [((*path, "items"), form.items) for path, form in asked_forms(design)]
    for path, items in groups:
        seen: dict[tuple[str, ...], str] = {}
        for i, item in enumerate(items):
            # Pairs of a weighted scale all have the same question.
            if item.kind == "choice":
                continue
            text = tuple(plain(text) for text in item.ask.values())
            if text in seen and any(text):
                yield Flaw(
                    (*path, i),
                    f"{item.name} asks the same as {seen[text]}",
                    "Change its text, or remove it",
                )
            seen.setdefault(text, item.name)
