"""Numbers of trials, minutes, seconds and sessions that people are told, beside the plan's."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import chain

from sandbox.study.design.conditions import tasks_of
from sandbox.study.design.design import START, Design
from sandbox.study.design.plan import BreakStep, Step, duration, session_plan, trials_of
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import CONSENT, Told, quoted, sentences, told_texts

SHORT = 1.5
"""A visit may take so many times as long as promised: the plan's durations are guesses."""
ABOUT = 0.1
"""Relative difference between a number of trials and its round number."""
FEW = 3
"""Numbers up to this one often mean some of the trials, as in "the first two trials"."""

_WORDS = {
    # English, German, French, Spanish, Italian, Dutch
    "one eine ein une una een": 1,
    "two zwei deux dos due twee": 2,
    "three drei trois tres tre drie": 3,
    "four vier quatre cuatro quattro": 4,
    "five funf cinq cinco cinque vijf": 5,
    "six sechs seis sei zes": 6,
    "eight acht huit ocho otto": 8,
    "ten zehn dix diez dieci tien": 10,
    "twelve zwolf douze doce dodici twaalf": 12,
    "fifteen funfzehn quinze quince quindici vijftien": 15,
    "sixteen sechzehn seize dieciseis sedici zestien": 16,
    "eighteen achtzehn dix-huit dieciocho diciotto achttien": 18,
    "twenty zwanzig vingt veinte venti twintig": 20,
    "twenty-four vierundzwanzig vingt-quatre veinticuatro ventiquattro vierentwintig": 24,
    "twenty-five funfundzwanzig vingt-cinq veinticinco venticinque vijfentwintig": 25,
    "thirty dreissig trente treinta trenta dertig": 30,
    "thirty-six sechsunddreissig trente-six": 36,
    "forty vierzig quarante cuarenta quaranta veertig": 40,
    "forty-five funfundvierzig quarante-cinq cuarentaycinco quarantacinque": 45,
    "fifty funfzig cinquante cincuenta cinquanta vijftig": 50,
    "sixty sechzig soixante sesenta sessanta zestig": 60,
    "ninety neunzig quatre-vingt-dix noventa novanta negentig": 90,
    "hundred hundert cent cien cento honderd": 100,
}
NUMBERS = {word: number for words, number in _WORDS.items() for word in words.split()}
_ONE = r"\d+(?:[.,]\d+)?|(?:" + "|".join(sorted(NUMBERS, key=len, reverse=True)) + r")(?!s\b)"
# "cents" are no hundred seconds.
_NUMBER = rf"(?<![\w.,-])(?:(?:{_ONE}) ?(?:-|–|to|bis|a|tot|or|oder|~) ?)?(?P<n>{_ONE})"

_MINUTES = re.compile(rf"{_NUMBER}[ -]?min(?:\.|s?\b|ut)|(?P<c>\d+) ?分")
_HOURS = re.compile(
    rf"{_NUMBER}[ -]?(?:h\b|hours?\b|std\b|stunden?\b|heures?\b|horas?\b|or[ae]\b|uur\b)|"
    r"(?P<c>\d+) ?(?:小时|時間)"
)
_SECONDS = re.compile(
    rf"{_NUMBER}[ -]?(?:s\b|secs?\b|sek\b|second|sekunde|segundo|secondi|seconde)|(?P<c>\d+) ?秒"
)
_TRIAL = (
    r"(?:trials?|attempts?|durchgange?n?|durchlaufe?n?|essais?|ensayos?|intentos?|prov[ae]|"
    r"tentativ[oi]|tentativas?|proeven|pogingen?|试次|試行)"
)
_FOR_EACH = (
    r"(?:per|an?|each|every|for|pro|je|jede[rnms]?|fur|par|pour|chaque|por|cada|ogni|elke?|voor)\b"
)
"""Words of a rate, as in "20 cents a trial"."""
_TRIALS = re.compile(
    rf"{_NUMBER} (?:(?!{_FOR_EACH})[a-z-]+ ){{0,2}}?{_TRIAL}\b|"
    r"(?P<c>\d+) ?(?:次|个|回の)?(?:试次|試行)"
)
_SESSIONS = re.compile(
    rf"{_NUMBER} (?:[a-z-]+ )?(?:sessions?|visits?|appointments?|sitzung(?:en)?|termine?n?|"
    rf"besuche?n?|"
    r"seances?|sesion(?:es)?|visitas?|session[ei]|sessies?|afspraken)\b"
)
_PIECES = re.compile(
    r"(?<!\w)(?:parts?|blocks?|sections?|sets?|rounds?|each|every|per|after|first|last|then|"
    r"practi[cs]e|half|teil\w*|block\w*|je|jede\w*|pro|nach|erste\w*|letzte\w*|ubung\w*|partie\w*|"
    r"bloc\w*|chaque|apres|premiers?|parte\w*|bloque\w*|cada|despues|primer\w*|blocc\w*|ogni|dopo|"
    r"prim[ei]|deel|elke?|na|eerste)(?!\w)"
)
_EVERY_TRIAL = re.compile(
    rf"(?:each|every|per|one|a single|an?|jede[rnms]?|pro|je|ein(?:en|em|er)?|chaque|par|un|cada|"
    rf"por|ogni|"
    rf"elke?) (?:\w+ )?{_TRIAL}\b"
)
_LIMIT = re.compile(
    r"at most|up to|limit|ends? (?:\w+ )?after|(?:no|not) (?:more|longer) than|within|maximum|"
    r"hochstens|maximal|endet nach|spatestens|innerhalb|au plus|au maximum|como maximo|al massimo|"
    r"hoogstens|you (?:have|get)|(?:haben sie|sie haben|bekommen sie)"
)
_WHOLE = re.compile(
    r"(?<!\w)(?:takes?|lasts?|duration|visits?|sessions?|altogether|overall|in total|whole|"
    r"stud(?:y|ies)|experiment|needs?|spend|dauer\w*|sitzung\w*|insgesamt|besuch\w*|studie|"
    r"versuch|termin\w*|brauch\w*|benotig\w*|dure\w*|seance\w*|au total|etude|dura\w*|sesion\w*|"
    r"en total|estudio|experimento|session[ei]|in totale|studio|esperimento|du(?:ur|re)\w*|"
    r"sessies?|in totaal|onderzoek)(?!\w)|大约|约|需要|持续|共|約|かか|所要"
)
_BESIDE = re.compile(
    r"(?<!\w)(?:breaks?|rest|paus\w*|descans\w*|pauz\w*|early|earlier|late|before|questionnaires?|"
    r"forms?|introduction|instructions?|explanation|practi[cs]e|calibration|parts?|blocks?|"
    r"fragebog\w*|einfuhrung|ubung\w*|teil\w*|vor|fruher|introduction|avant|partie\w*|antes|"
    r"parte\w*|prima|introduzione|deel|vragenlijst\w*)(?!\w)|休|问卷|練習"
)
_ALL = re.compile(r"altogether|in total|overall|insgesamt|au total|en total|in totale|in totaal")
_BREAKS_COME = re.compile(
    r"(?:there (?:are|will be)|you (?:will )?(?:have|get|make|take)|regular|after (?:each|every)|"
    r"every|between) (?:[^.;]*\W)?(?:breaks?|pauses?|rests?)\b|(?:es gibt|gibt es|"
    r"nach jede[rnms]?|regelmassig|zwischen)[^.;]*\bpausen?\b|(?:il y (?:a|aura)|apres chaque|"
    r"entre)[^.;]*\bpauses?\b|(?:habra|hay|despues de cada|entre)[^.;]*\b(?:pausas?|descansos?)\b"
)
_AT_WILL = re.compile(
    r"any ?time|whenever|as (?:often|long)|if you|when you|you (?:may|can|could)|ask for|"
    r"jederzeit|wenn sie|konnen|a tout moment|si vous|pouvez|cualquier momento|si (?:lo )?desea|"
    r"puede"
)


def promise_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of numbers in the consent and in the texts at the start."""
    plans = [session_plan(design, 0, n + 1) for n in range(design.sessions)]
    counts = _Counts(design, plans)
    for told in told_texts(design):
        if told.kind == CONSENT or told.at:
            for text in told.text.values():
                wrong = next(
                    chain.from_iterable(_wrong(told, s, counts) for s in sentences(text)), None
                )
                if wrong:
                    what, remedy = wrong
                    yield Flaw(told.path, what, remedy)
                    break


class _Counts:
    """Numbers of a design: trials, durations and limits."""

    def __init__(self, design: Design, plans: list[list[Step]]) -> None:
        self.sessions = design.sessions
        self.breaks = any(isinstance(step, BreakStep) for plan in plans for step in plan)
        self.shortest = min(duration(design, plan) for plan in plans)
        trials = [trials_of(plan) for plan in plans]
        counted = [sum(not t.practice for t in some) for some in trials]
        practised = [len(some) - n for some, n in zip(trials, counted, strict=True)]
        whole = {*counted, *practised, *map(len, trials), sum(counted), sum(map(len, trials))}
        self.whole = whole | {sum(practised), design.practice}
        self.typical = counted[0]
        parts = {design.repetitions, design.break_every}
        for depth in range(1, len(design.factors) + 1):
            for names in (
                [f.name for f in design.factors[:depth]],
                [design.factors[depth - 1].name],
            ):
                for some in trials:
                    for chosen in (some, [t for t in some if not t.practice]):
                        per = Counter(tuple(t.levels[n] for n in names) for t in chosen)
                        parts |= set(per.values())
        self.parts = self.whole | parts
        limits = {min(design.time_limit, task.time_limit) for task in tasks_of(design).values()}
        self.limits = limits | {design.time_limit, design.expected, design.break_time}
        self.limit = max(limits)


def _wrong(told: Told, sentence: str, counts: _Counts) -> Iterator[tuple[str, str]]:
    """What is wrong with the numbers of a sentence, and what to do about it."""
    words, quote = plain(sentence), quoted(sentence)
    for number in _numbers(_TRIALS, words):
        known = counts.whole if told.kind == CONSENT and not _PIECES.search(words) else counts.parts
        if number > FEW and not any(abs(number - n) <= ABOUT * n for n in known):
            yield (
                f"it speaks of {number:g} trials, and a session has {counts.typical}: {quote}",
                "Write the numbers that `sandbox study plan` prints, or change [trials]",
            )
    one = _EVERY_TRIAL.search(words) is not None
    if (_LIMIT.search(words) and one) or re.search(r"limit of|zeitlimit", words):
        seconds = [*_numbers(_SECONDS, words), *(60 * n for n in _numbers(_MINUTES, words))]
        for number in seconds:
            if not any(abs(number - n) <= 0.05 * n for n in counts.limits):
                yield (
                    f"it speaks of {number:g} s, and a trial ends after {counts.limit:g} s: "
                    f"{quote}",
                    "Write the limit as it is, or change time_limit_s",
                )
    elif (told.kind == CONSENT or told.at == START) and _WHOLE.search(words):
        minutes = [*_numbers(_MINUTES, words), *(60 * n for n in _long(words))]
        whole = not one and (_ALL.search(words) or not _BESIDE.search(words))
        if whole and minutes and max(minutes) * 60 * SHORT < counts.shortest:
            yield (
                f"it promises {max(minutes):g} min, and a session takes about "
                f"{counts.shortest / 60:.0f}: {quote}",
                "Write how long it takes, or plan fewer trials",
            )
    if told.kind == CONSENT:
        for number in _numbers(_SESSIONS, words):
            if number != counts.sessions and number > 1 and not _PIECES.search(words):
                yield (
                    f"it speaks of {number:g} sessions, and the design has {counts.sessions}: "
                    f"{quote}",
                    "Write sessions = as many as people are told",
                )
    if not counts.breaks and _BREAKS_COME.search(words) and not _AT_WILL.search(words):
        yield (
            f"it promises breaks, and none comes: {quote}",
            "Write [breaks] with `every`, or leave them out of the text",
        )


def _numbers(pattern: re.Pattern[str], words: str) -> list[float]:
    return [number for match in pattern.finditer(words) if (number := _value(match)) is not None]


def _value(match: re.Match[str]) -> float | None:
    word = match.groupdict().get("n") or match.groupdict().get("c")
    if word is None:
        return None
    return float(NUMBERS[word]) if word in NUMBERS else float(word.replace(",", "."))


_FRACTIONS = (
    (
        re.compile(
            r"half an hour|halbe stunde|halbstundig|demi-heure|media hora|mezz'?ora|half uur"
        ),
        0.5,
    ),
    (re.compile(r"quarter of an hour|viertelstunde|quart d'heure|cuarto de hora|kwartier"), 0.25),
    (re.compile(r"(?<!half )(?<!quarter of )\ban hour\b|(?<!\w)un'ora"), 1.0),
)


def _long(words: str) -> Iterable[float]:
    """Durations in hours."""
    short = [hours for pattern, hours in _FRACTIONS if pattern.search(words)]
    return short or _numbers(_HOURS, words)
