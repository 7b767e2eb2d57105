"""Flaws of a consent that people cannot give alone: children, and adults with a guardian."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.design import Design, Item
from sandbox.study.design.meaning.questions.answers import ages_of, asks_age
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import Phrases, quoted, sentences

ADULT = 18
"""Years; people below this age need somebody else's consent, too, nearly everywhere."""

_CHILDREN = (
    r"(?<!\w)(?:child|children|kids?|pupils?|school ?children|school ?(?:boy|girl)s?|teenagers?|"
    r"adolescents?|minors|toddlers?|preschool\w*|(?:primary|elementary|secondary|high) school|\w+ "
    r"graders|kinder\w*|kindern|schuler\w*|jugendliche\w*|minderjahrig\w*|grundschul\w*|"
    r"vorschul\w*|enfants?|eleves?|ecoliers?|ecolieres?|collegiens?|lyceens?|mineurs|nin[oa]s?|"
    r"escolares|alumn[oa]s de (?:primaria|secundaria)|(?:escuela|educacion) (?:primaria|"
    r"secundaria)|adolescentes?|menores(?: de edad)?|bambin[ieoa]|ragazz[ie]|adolescenti|minorenni|"
    r"alunni|scolari|kinderen|leerlingen|scholieren|jongeren|tieners|minderjarig\w*|"
    r"criancas?)(?!\w)|儿童|小学生|中学生|孩子|青少年|未成年|子ども|子供|児童|اطفال|الاطفال|تلاميذ"
)
_CARED_FOR = (
    r"(?<!\w)(?:dementia|alzheimer\w*|intellectual disabilit\w*|learning disabilit\w*|"
    r"cognitive(?:ly)? (?:impair|declin)\w*|demenz\w*|demenzkrank\w*|geistige[rn]? behinderung\w*|"
    r"kognitive\w* (?:beeintracht|einschrank)\w*|demence|deficien\w* intellectuel\w*|demencia|"
    r"discapacidad intelectual|deterioro cognitivo|demenza|disabilita intellettiv\w*|dementie|"
    r"verstandelijke beperking\w*)(?!\w)|痴呆|認知症|الخرف"
)
_WHO = (
    (re.compile(_CHILDREN), "children"),
    (re.compile(_CARED_FOR), "people who may not be able to consent"),
)
_AGES = re.compile(
    r"(?<![\d.,-])(\d{1,2})(?:-| )*(?:to|and|bis|und|a|et|y|e|en|tot|–|-|~|至|から)[ -]*(\d{1,2})[ "
    r"-]*(?:years?\b|jahre?n?\b|ans\b|anos\b|anni\b|jaar\b|jahrig\w*|year-olds?|jarigen?|岁|歳)|"
    r"(?<![\d.,-])(\d{1,2})[ -]*(?:year-olds?|jahrig\w*|jarigen?)\b"
)

GUARDIANS = Phrases(
    {
        "en": (
            r"parent\w*|guardian\w*|mother|father|carers?|custod\w*|representative|proxy|relatives?"
        ),
        "de": (
            r"eltern\w*|erziehungsberechtigt\w*|sorgeberechtigt\w*|mutter|vater|vormund\w*|"
            r"gesetzliche\w* vertret\w*|betreuer\w*|betreuungsperson\w*|angehorige\w*"
        ),
        "fr": (
            r"parent\w*|tuteur\w*|tutrice\w*|mere|pere|representant\w*|responsables? lega\w*|"
            r"curateur\w*|proches?\b"
        ),
        "es": r"padres?|madres?|tutor\w*|representante\w*|progenitor\w*|familia\w*",
        "it": r"genitor\w*|madre|padre|tutor\w*|rappresentant\w*|famil\w*",
        "nl": r"ouders?\b|voogd\w*|verzorger\w*|moeder|vader|vertegenwoordiger\w*",
        "pt": r"pais\b|mae|pai\b|encarregad\w*|responsave\w*|representante\w*",
        "zh": r"父母|家长|监护人",
        "ja": r"保護者|両親|親権|後見",
        "ar": r"والد|ولي|الأهل|الاهل|وصي",
    }
)
"""Those who consent for somebody."""
NEEDLESS = Phrases(
    {
        "en": (
            r"needs? not|(do|does|will) not (need|have) to|(don't|doesn't) (need|have) to|no need|"
            r"not (necessary|needed|required|asked|told|informed)|without (asking|telling|the "
            r"(consent|permission|knowledge))|(is|are) enough|suffices"
        ),
        "de": (
            r"(mussen|muss|musst|brauchen|braucht|brauchst)\b[^.]*\bnicht|nicht (\w+ )?(notig|"
            r"notwendig|erforderlich|gefragt|fragen|informiert|erfahren)|ohne (\w+ )?(zustimmung|"
            r"wissen|erlaubnis|einwilligung)|genugt|reicht"
        ),
        "fr": (
            r"pas (besoin|necessaire|oblige)|(n'est|n'ont) pas|inutile|sans (l'accord|en parler|"
            r"demander|prevenir)|suffi"
        ),
        "es": (
            r"no (hace falta|es necesario|necesit|hay que|tienen que)|sin (preguntar|permiso|decir|"
            r"avisar|el consentimiento)|basta"
        ),
        "it": (
            r"non (serve|occorre|e necessario|devono|c'e bisogno)|senza (il consenso|chiedere|"
            r"dirlo)|basta"
        ),
        "nl": (
            r"(hoeft|hoeven)\b[^.]*\bniet|niet nodig|zonder (toestemming|te vragen)|genoeg|volstaat"
        ),
        "pt": (
            r"nao (e preciso|precisa|e necessario)|sem (autorizacao|perguntar|o consentimento)|"
            r"basta"
        ),
        "zh": r"不(需要|必|用)|无需",
        "ja": r"必要(は|が)?(ありません|ない)|なしで",
        "ar": r"لا (حاجة|يلزم|يحتاج)|دون",
    }
)
"""That their consent is not asked for."""


def guardian_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of the consent of people who cannot give it alone, one line at most."""
    who = _who(design)
    if not who or not design.consent:
        return
    for language, text in design.consent.items():
        if not GUARDIANS.knows(language):
            continue
        named = [s for s in sentences(text) if GUARDIANS.match(s, language)]
        needless = next((s for s in named if NEEDLESS.match(s, language)), None)
        if named and needless is None:
            continue
        yield Flaw(
            ("consent", "text"),
            f"{who} consent alone: "
            + (f"it says {quoted(needless)}" if needless else "no parent or guardian is named"),
            "Write that a parent or guardian has agreed, and ask the participants themselves, too",
        )
        return


def _who(design: Design) -> str:
    """People who cannot consent alone, in words; empty if nothing tells of such people."""
    asked = [ages for item in design.demographics if (ages := _ages(item)) is not None]
    if any(high < ADULT for _, high in asked):
        return "people below 18"
    if any(low >= ADULT for low, _ in asked):
        return ""
    called = (design.name.replace("-", " ").replace("_", " "), design.title)
    for words in map(plain, called):
        for pattern, who in _WHO:
            if pattern.search(words):
                return who
    for text in (design.title, *design.consent.values()):
        for match in _AGES.finditer(plain(text)):
            if int(match[2] or match[3]) < ADULT:
                return "people below 18"
    return ""


def _ages(item: Item) -> tuple[float, float] | None:
    """Ages that can be answered; None if another thing is asked."""
    return ages_of(item) if asks_age(item) else None
