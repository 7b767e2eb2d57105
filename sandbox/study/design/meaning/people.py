"""Flaws of what people are told and asked: consent, instructions, and questions that identify."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.conditions import sets_nothing
from sandbox.study.design.design import END, START, Design
from sandbox.study.design.meaning.questions.identifying import asks_for, birth_parts
from sandbox.study.design.meaning.translations import CARE, SPEED
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import (
    CONSENT,
    Phrases,
    asked_items,
    quoted,
    sentences,
    told_texts,
)
from sandbox.study.design.told.words import DENIES, PAID

MORE, MORE_LETTERS = 1.8, 60
"""How many times as long, and by how many letters, a text before one level says more."""

ASKED = {
    "advice": Phrases(
        {
            "en": (
                r"(hint|tip|trick|advice|it helps|we (advise|recommend|suggest)|you should|works "
                r"best|saves? (a lot of )?time|make sure|avoid|best way)\b"
            ),
            "de": (
                r"(tipp|trick|hinweis|rat|ratschlag|es hilft|wir (raten|empfehlen)|sie sollten|am "
                r"besten|spart|achten sie|vermeiden)\b"
            ),
            "fr": (
                r"(conseil|astuce|il est utile|nous (conseillons|recommandons)|vous devriez|evitez|"
                r"veillez)\b"
            ),
            "es": r"(consejo|truco|recomendamos|aconsejamos|conviene|deberia|evite|procure)\b",
            "it": r"(consiglio|trucco|consigliamo|raccomandiamo|conviene|dovrebbe|eviti)\b",
            "nl": r"(tip|hint|advies|raden aan|het helpt|vermijd|let op)\b",
        }
    ),
    "speed": SPEED,
    "care": CARE,
    "effort": Phrases(
        {
            "en": (
                r"(try|work) (\w+ )?hard|do your best|(special|extra) effort|concentrate|your "
                r"best\b"
            ),
            "de": r"strengen sie sich|ihr bestes|konzentrier\w*|geben sie sich (\w+ )?muhe",
            "fr": r"de votre mieux|effort|concentrez|appliquez-vous",
            "es": r"esfuerce\w*|concentre\w*|lo mejor (que|posible)|esmere\w*",
        }
    ),
    "reassurance": Phrases(
        {
            "en": (
                r"(do not|don't) (worry|be (frustrated|discouraged|disappointed|surprised|upset))"
            ),
            "de": (
                r"keine sorge|nicht (entmutig|frustrier|arger|verzag|wunder)\w*|machen sie sich "
                r"nichts"
            ),
            "fr": r"ne vous (decouragez|inquietez|enervez|etonnez)",
            "es": r"no se (preocupe|desanime|frustre|extrane)",
        }
    ),
    "rest": Phrases(
        {
            "en": r"rest (for|a|your|until)|relax\b|(have|take) (a|some) (\w+ )?(rest|break|pause)",
            "de": r"ruhen sie|ausruhen|erhol\w*|(machen|legen) sie (\w+ ){0,2}(pause|rast)",
            "fr": r"reposez|reposer|detendez|faites (\w+ )?pause",
            "es": r"descans(e|ar|a)\b|relaj\w*|(haga|tome) (\w+ )?(pausa|descanso)",
        }
    ),
    "food": Phrases(
        {
            "en": r"coffee|tea\b|chocolate|snacks?|sweets|drink\b|eat\b|food|lunch",
            "de": r"kaffee|tee\b|schokolade|imbiss|sussigkeit\w*|trinken|essen|snack\w*",
            "fr": r"cafe|the\b|chocolat|collation|boi(re|vez)|mang(er|ez)|gouter",
            "es": r"cafe|te\b(?= (con|caliente|frio))|chocolate|tentempie|beb(a|er)|com(a|er)\b",
        }
    ),
    "help": Phrases(
        {
            "en": (
                r"(experimenter|assistant|we|somebody|someone) (\w+ )?helps? you|may ask for help"
            ),
            "de": r"(hilft|helfen|unterstutzt) ihnen|(hilft|unterstutzt) sie|um hilfe bitten",
            "fr": r"(vous aide|vous aidera|vous aidons)|demander de l'aide",
            "es": r"le (ayuda|ayudara|ayudamos)|pedir ayuda",
        }
    ),
}
"""Advice, demands and comforts, which every level is to have alike."""

AGE = "Remove it; keep names and addresses apart, beside the pseudonym; ask for an age"

JUDGING = Phrases(
    {
        "en": (
            r"watch(ed|ing|es)?\b|observ\w*|filmed|rank(ing|ed|s)|punish\w*|penali\w*|competit\w*|"
            r"compared with|audience|look at your|shown (to|on)|best list|high ?score"
        ),
        "de": (
            r"beobacht\w*|gefilmt|rangliste\w*|bestraf\w*|strafe|verglichen|wettbewerb|zuschau\w*|"
            r"bestenliste"
        ),
        "fr": r"observ\w*|film\w*|classement|puni\w*|penali\w*|compare\w*|competition|public\b",
        "es": r"observ\w*|film\w*|clasificacion|castig\w*|penali\w*|compar\w*|compet\w*|publico\b",
        "it": r"osserv\w*|film\w*|classifica|puni\w*|penali\w*|confront\w*|competi\w*",
        "nl": r"bekeken|gefilmd|ranglijst|bestraf\w*|vergeleken|wedstrijd",
        "zh": r"观察|排名|惩罚|比赛",
        "ja": r"観察|順位|罰|競争",
    }
)
"""Being watched, ranked or punished, which changes how people do."""

UNPAID = Phrases(
    {
        "en": r"(no|not|nothing|without|unchanged|fixed|usual|none|\w+n't|same)\b",
        "de": r"(nicht|kein\w*|nichts|ohne|unverandert|fest\w*|bleibt|ublich\w*|gleich\w*)\b",
        "fr": r"(pas|aucun\w*|sans|rien|fixe|inchange\w*|habituel\w*|meme)\b",
        "es": r"(no|ningun\w*|sin|nada|fij[oa]|habitual|mism[oa])\b",
        "it": r"(non|nessun\w*|senza|niente|fiss[oa]|solit[oa]|stess[oa])\b",
        "nl": r"(niet|geen|zonder|niets|vaste|gewone|zelfde)\b",
        "pt": r"(nao|nenhum\w*|sem|nada|fix[oa]|habitual|mesm[oa])\b",
        "zh": r"不|没|无",
        "ja": r"ない|ません|なし",
        "ar": r"لا|بدون|دون",
    }
)
_SUM = re.compile(
    r"(?:[€$£¥] ?(\d+(?:[.,]\d+)?)|(\d+(?:[.,]\d+)?) ?(?:[€$£¥]|euros?|cents?|dollars?|pounds|"
    r"pence|centimes?|centimos?|centesimi|chf|eur|usd|元|円))"
)
"""A sum of money."""

LIMBS = Phrases(
    {
        "en": (
            r"thumbs?|index|forefingers?|middle fingers?|ring fingers?|little fingers?|(one|two|"
            r"three|four|five|all|both) (\w+ )?(fingers?|hands?)|(left|right|dominant|other) hand|"
            r"standing|stand up|sitting|sit down"
        ),
        "de": (
            r"daumen|zeigefinger|mittelfinger|ringfinger|kleine\w* finger|(einem|ein|zwei|drei|"
            r"vier|funf|allen?|beiden?) (\w+ )?(finger|hand|hande)n?|(linke|rechte|dominante)[rn]? "
            r"hand|im (stehen|sitzen)|stehen sie auf|setzen sie sich"
        ),
        "fr": (
            r"pouces?|index|majeur|annulaire|auriculaire|(un|deux|trois|quatre|cinq) doigts?|tous "
            r"les doigts|(main (gauche|droite)|deux mains)|debout|assise?"
        ),
        "es": (
            r"pulgar\w*|indice|(un|dos|tres|cuatro|cinco) dedos?|todos los dedos|mano (izquierda|"
            r"derecha)|(dos|ambas) manos|de pie|sentad[oa]"
        ),
    }
)
"""Fingers, hands and postures with which people are told to do it."""

HANDLED_OTHERWISE = {"task", "device", "second_device", "second_hand", "one_surface", "surface"}
"""Settings of what people do with which fingers."""

JARGON = Phrases(
    {
        "en": (
            r"(encoders?|servos?|mujoco|inverse kinematics|degrees? of freedom|regression|latin "
            r"square|(within|between)-(subjects?|participants?)|(in)?dependent variables?|"
            r"quadratic|posterior)\b"
        ),
        "de": (
            r"(encoder\w*|servo\w*|freiheitsgrad\w*|regression\w*|(un)?abhangige variable\w*|"
            r"quadratisch\w*|lateinische\w* quadrat\w*)\b"
        ),
        "fr": r"(encodeurs?|servo\w*|degres? de liberte|regression|carre latin|quadratiques?)\b",
        "es": r"(codificador\w*|servo\w*|grados? de libertad|regresion|cuadratic[oa]s?)\b",
    }
)
"""Words of this program and of its field, which people who take part do not know."""

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
            r"(volgende|komende) (taak|taken|poging\w*|deel)|zo (snel|nauwkeurig) mogelijk|leg uw "
            r"vingers"
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
    yield from _jargon(design)
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


def _jargon(design: Design) -> Iterator[Flaw]:
    """Questions and instructions in words that nobody knows, one line for each word."""
    named: set[str] = set()
    for told in told_texts(design):
        for language, text in told.text.items() if told.kind != CONSENT else ():
            word = JARGON.match(text, language)
            if word is not None and word[0] not in named:
                named.add(word[0])
                yield Flaw(
                    told.path,
                    f"people who take part do not know the word {word[0]!r}",
                    "Say what they see or do, such as: the way in which the hand moves",
                )
                break


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
        if sets_nothing(design, factor):
            # Then words are what is compared.
            continue
        # Other tasks and devices need other fingers.
        alike = not {n for level in factor.levels for n in level.settings} & HANDLED_OTHERWISE
        if {level.name for level in factor.levels} <= told and len(told) > 1:
            for language in design.languages:
                by_level = {
                    name: " ".join(t.text[language] for _, t in texts if t.level == name)
                    for name in (level.name for level in factor.levels)
                }
                if not all(text.strip() for text in by_level.values()):
                    # A level's text lacks this language, which is a mistake of form.
                    continue
                wrong = _uneven(by_level, language) or (
                    _limbs(by_level, language) if alike else None
                )
                if wrong is not None:
                    level, what = wrong
                    first = next(i for i, t in texts if t.level == level)
                    yield Flaw(
                        ("instructions", first, "text"),
                        f"{what}, so the effect of {factor.name} cannot be told from that of the "
                        "words",
                        "Say as much before all levels, and the same of pay and of what helps",
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
    judged = [
        level
        for level, text in by_level.items()
        if any(
            JUDGING.match(s, language) and not DENIES.match(s, language) for s in sentences(text)
        )
    ]
    rest = [level for level in by_level if level not in judged]
    if judged and rest:
        return judged[
            0
        ], f"being watched or ranked is said before {judged[0]}, not before {rest[0]}"
    return _paid(by_level, language)


def _limbs(by_level: dict[str, str], language: str) -> tuple[str, str] | None:
    """The level before which other fingers are asked for than before another; None if none is."""
    limbs = {
        level: {match[0] for match in LIMBS.all_matches(text, language)}
        for level, text in by_level.items()
    }
    for level, some in limbs.items():
        for other, others in limbs.items():
            if some and others and some != others:
                return (
                    level,
                    f"{' and '.join(sorted(some))} is asked for before {level}, and "
                    f"{' and '.join(sorted(others))} before {other}",
                )
    return None


def _paid(by_level: dict[str, str], language: str) -> tuple[str, str] | None:
    """The level before which other pay is promised than before another; None if there is none."""
    pays = {level: _pay(text, language) for level, text in by_level.items()}
    promised = [level for level, sums in pays.items() if sums is not None]
    for level in promised:
        for other, sums in pays.items():
            if sums is None:
                return level, f"pay is promised before {level}, and not before {other}"
            if sums != pays[level]:
                return level, f"other pay is promised before {level} than before {other}"
    return None


def _pay(text: str, language: str) -> frozenset[str] | None:
    """Sums of money that a text promises, which may be none; None if it promises no pay."""
    sums: set[str] = set()
    promised = False
    for sentence in sentences(text):
        words = plain(sentence)
        given = [a or b for a, b in _SUM.findall(words)]
        unpaid = UNPAID.match(sentence, language) and not given
        if (PAID.match(sentence, language) or given) and not unpaid:
            promised = True
            sums |= set(given)
    return frozenset(sums) if promised else None


def _told_of_some_levels(design: Design) -> Iterator[Flaw]:
    """Texts before some levels of a factor only, so that words are part of the comparison."""
    for factor in design.factors:
        texts = [(i, t) for i, t in enumerate(design.instructions) if t.at == factor.name]
        told = {t.level for _, t in texts if t.level}
        rest = [level.name for level in factor.levels if level.name not in told]
        if told and rest and not sets_nothing(design, factor) and factor.name not in (START, END):
            first = next(i for i, t in texts if t.level)
            yield Flaw(
                ("instructions", first),
                f"of the levels of {factor.name}, only {', '.join(sorted(told))} is announced, not "
                f"{', '.join(rest)}, so its effect cannot be told from that of the words",
                "Write as much before the other levels, or one text without `level`",
            )
