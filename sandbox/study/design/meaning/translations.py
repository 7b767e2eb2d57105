"""Texts that do not say the same in all languages of a design."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.design import Design
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import GOAL, INSTRUCTION, Phrases, Told, told_texts
from sandbox.words.words import base

LONGER = 2.2
"""A text that is so many times as long as its translation says more."""
LONG = 60
"""Letters of a text whose length is compared."""
COPIED = 15
"""Letters of a text that is not the same in two languages by chance."""
READ = 4
"""Words of another language, and none of its own, that show what a text is written in."""

SPEED = Phrases(
    {
        "en": r"fast|quick|speed|rapid|hurry|swift|soon as|prompt|brisk",
        "de": r"schnell|zugig|rasch|tempo|geschwind|beeil|flott|eilig|kurze\w* zeit",
        "fr": r"vite|rapid|promptement|depech|hate",
        "es": r"rapid|aprisa|deprisa|prisa|velo|pronto|agil",
        "it": r"veloc|rapid|fretta|svelt|presto",
        "nl": r"snel|vlug|tempo|haast|gauw",
        "pt": r"rapid|depressa|pressa|velo|agil",
        "sv": r"snabb|fort|hastig|kvick",
        "da": r"hurtig|rask|skynd",
        "no": r"rask|fort|hurtig|kjapp",
        "pl": r"szybk|predk|pospiesz",
        "cs": r"rychl|spech",
        "ru": r"быстр|скор",
        "zh": r"快|速|迅",
        "ja": r"速|早|急|すばや",
        "ko": r"빨|빠르|신속|서둘",
        "ar": r"سرع|سريع|عجل",
    }
)
CARE = Phrases(
    {
        "en": r"accura|careful|precis|exact|cautious|thorough|as (correct|neat)",
        "de": r"genau|sorgfalt|sorgsam|prazis|exakt|vorsicht|umsicht|gewissenhaft|behutsam",
        "fr": r"preci|soign|soin|exact|attenti|prudent|prudemment|minuti|delicat",
        "es": r"preci|cuidad|exact|atenci|esmer",
        "it": r"preci|accurat|attent|esatt|cura\b|cautel|delicat",
        "nl": r"nauwkeurig|zorgvuldig|precies|voorzichtig|nauwgezet",
        "pt": r"preci|cuidad|exat|atenc",
        "zh": r"准确|精确|小心|仔细|谨慎|认真|精准",
        "ja": r"正確|慎重|注意|丁寧|気をつけ",
        "ar": r"دق|حذر|عناي",
    }
)
"""Speed and care, of which people give up one for the other."""

_SMALL = {
    "en": "the and you your with for that this are will please it from not they how what when",
    "de": "der die das und sie ihre ihren mit fur nicht ist sind werden bitte wie auf den dem ein "
    "eine",
    "fr": "le les des et vous votre vos avec pour est sont dans une du au que pas sur ne",
    "es": "el los las y usted su sus con para es son una por del al que en como lo",
    "it": "il gli le di e con per che sono una del della nel non si la lo alla sul",
    "nl": "de het een en u uw met voor is zijn niet van op dat deze wordt worden hoe",
    "pt": "o os as e voce seu sua com para sao uma por do da que em nao no na",
}
_SMALL_WORDS = {language: set(words.split()) for language, words in _SMALL.items()}
_NUMBER = re.compile(r"(?<![\w.,])\d+(?:[.,]\d+)?")
_DENSE = ("zh", "ja", "ko")
# Languages that say the same with fewer letters.


def translation_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of texts in several languages, the first of them for each text."""
    for told in told_texts(design):
        wrong = next(_differences(told), None) or next(_foreign(told), None)
        if wrong is not None:
            what, remedy = wrong
            yield Flaw(told.path, what, remedy)


def _differences(told: Told) -> Iterator[tuple[str, str]]:
    written = [(language, text) for language, text in told.text.items() if text.strip()]
    pairs = ((written[0], other) for other in written[1:])
    for one, two in (pair for pair in pairs if base(pair[0][0]) != base(pair[1][0])):
        (a, text_a), (b, text_b) = one, two
        if text_a.strip() == text_b.strip() and len(text_a.strip()) >= COPIED:
            yield f"the text is the same in {a} and {b}", f"Translate it, in {b} or in {a}"
            return
        numbers = [
            sorted(float(n.replace(",", ".")) for n in _NUMBER.findall(t)) for t in (text_a, text_b)
        ]
        if all(numbers) and set(numbers[0]) != set(numbers[1]):
            said = [", ".join(f"{n:g}" for n in some) for some in numbers]
            yield (
                f"the numbers differ: {said[0]} in {a}, {said[1]} in {b}",
                "Write the same numbers in all languages",
            )
        if told.kind in (INSTRUCTION, GOAL):
            for name, phrases in (("speed", SPEED), ("care", CARE)):
                if not (phrases.knows(a) and phrases.knows(b)):
                    continue
                asked = [lang for lang, text in (one, two) if phrases.match(text, lang)]
                if len(asked) == 1:
                    other = b if asked == [a] else a
                    yield (
                        f"it asks for {name} in {asked[0]} and not in {other}, so that results "
                        "depend on the language",
                        "Ask for the same in all languages",
                    )
        if not {base(a), base(b)} & set(_DENSE):
            short, long = sorted((one, two), key=lambda some: len(some[1].strip()))
            if len(long[1].strip()) >= LONG and len(long[1].strip()) > LONGER * len(
                short[1].strip()
            ):
                yield (
                    f"the text in {long[0]} is much longer than that in {short[0]}, which says "
                    f"less",
                    "Say the same in all languages",
                )


def _foreign(told: Told) -> Iterator[tuple[str, str]]:
    """Texts that are written in another language than the one that they are for."""
    for language, text in told.text.items():
        own = _SMALL_WORDS.get(base(language))
        if own is None:
            continue
        words = re.findall(r"\w+", plain(text))
        if any(word in own for word in words):
            continue
        for other, small in _SMALL_WORDS.items():
            if sum(word in small for word in words) >= READ:
                yield (
                    f"the text for {language} is written in {other}",
                    f"Write it in {language}, or change `languages`",
                )
                return
