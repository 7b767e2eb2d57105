"""Directions of questions and of the ends of scales, by their words.

A question that asks for something good ("How relaxed did you feel?") runs upwards, one that asks
for something bad ("How tense were you?") downwards. The ends of a scale may turn it round.
"""

from __future__ import annotations

import re

from sandbox.study.design.reading import Text
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import Phrases
from sandbox.words.words import base

NEAR = 4
"""Words before a word of feeling in which a denial turns it round."""

GOOD = Phrases(
    {
        "en": (
            r"((what|as|how) i (had )?(want|intend|expect|plan)\w*|obey\w*|under control|relax\w*|"
            r"effortless\w*|eas[ey]|easily|easier|comfortabl\w*|pleasant\w*|natural\w*|"
            r"predictab\w*|reliab\w*|accurate\w*|precise\w*|secure\w*|confident\w*|calm\w*|"
            r"clear\w*|useful\w*|helpful\w*|fun|enjoy\w*|happy|satisf\w*|good|well|smooth\w*|"
            r"fluent\w*|intuitiv\w*|rested|fresh|simple|fast|quick\w*|responsive\w*|trust\w*|rely|"
            r"in control|pleased|safe\w*|excellent\w*|perfect\w*|great|outstanding|painless\w*)\b"
        ),
        "de": (
            r"((was|wie) ich (es )?(wollte|will|erwartet\w*)|gehorch\w*|unter kontrolle|kontrolle "
            r"uber|entspann\w*|muhelos\w*|leicht\w*|einfach\w*|bequem\w*|angenehm\w*|naturlich\w*|"
            r"vorherseh\w*|vorhersag\w*|zuverlassig\w*|genau\w*|prazise\w*|sicher\w*|ruhig\w*|klar|"
            r"nutzlich\w*|hilfreich\w*|spass|freude|zufrieden\w*|gute?|flussig\w*|intuitiv\w*|"
            r"ausgeruht|frisch\w*|wach|munter|fit|schnell\w*|locker\w*|schmerzfrei|problemlos|wohl|"
            r"gelassen|ausgezeichnet|hervorragend|perfekt)\b"
        ),
        "fr": (
            r"((ce que|comme) je (le )?(voul|souhait)\w*|obe(i|it|iss)\w*|controlais|maitris\w*|"
            r"detend\w*|repose\w*|facil\w*|a l'aise|confortab\w*|agreab\w*|naturel\w*|previsib\w*|"
            r"fiab\w*|precis\w*|confiance|calme\w*|clair\w*|util\w*|plaisir|satisf\w*|content\w*|"
            r"bien|bonn?e?s?|fluid\w*|intuiti\w*|rapid\w*|simple\w*|serein\w*|excellent\w*|"
            r"parfait\w*)\b"
        ),
        "es": (
            r"((lo que|como) (yo )?(queria|quise|esperaba)|obedec\w*|bajo control|controlaba|"
            r"relajad\w*|descansad\w*|facil\w*|comod\w*|agradab\w*|natural\w*|previsib\w*|"
            r"predecib\w*|fiab\w*|precis\w*|segur[oa]s?|tranquil\w*|clar[oa]s?|util\w*|divert\w*|"
            r"disfrut\w*|satisf\w*|satisfech\w*|content\w*|bien|buen\w*|fluid\w*|intuitiv\w*|"
            r"rapid\w*|sencill\w*|excelente\w*|perfect\w*)\b"
        ),
        "it": (
            r"(rilassat\w*|riposat\w*|facil\w*|comod\w*|piacevol\w*|natural\w*|prevedibil\w*|"
            r"affidabil\w*|precis\w*|sicur[oaie]|calm\w*|chiar\w*|util\w*|divert\w*|soddisf\w*|"
            r"content\w*|bene|buon\w*|fluid\w*|intuitiv\w*|veloc\w*|rapid\w*|semplic\w*|"
            r"eccellent\w*|ottim\w*|perfett\w*)\b"
        ),
        "nl": (
            r"(ontspannen|uitgerust|makkelijk\w*|gemakkelijk\w*|comfortabel\w*|aangenaam|aangename|"
            r"prettig\w*|natuurlijk\w*|voorspelbaar|betrouwbaar|nauwkeurig\w*|zeker|rustig\w*|"
            r"duidelijk\w*|nuttig\w*|leuk\w*|plezier|tevreden|goede?|soepel\w*|vloeiend|intuitief|"
            r"snel\w*|eenvoudig\w*|moeiteloos|uitstekend|perfect)\b"
        ),
        "pt": (
            r"(relaxad\w*|descansad\w*|facil|faceis|facilmente|confortav\w*|agradav\w*|natural\w*|"
            r"previsiv\w*|fiav\w*|confiav\w*|precis[oa]s?|segur[oa]s?|calm\w*|clar[oa]s?|util|"
            r"divert\w*|satisf\w*|content\w*|bem|bo[am]|fluid\w*|intuitiv\w*|rapid\w*|simples|"
            r"excelente|perfeit\w*)\b"
        ),
        "zh": (
            r"轻松|放松|容易|舒服|舒适|愉快|自然|可靠|准确|精确|自信|平静|清楚|有用|有趣|满意|流畅|"
            r"直观|快"
        ),
    }
)
BAD = Phrases(
    {
        "en": (
            r"(i (did not|didn't|had not|hadn't|never) (want|intend|expect|mean)\w*|unexpected\w*|"
            r"unwanted|gave up|tired|tiredness|tiring|fatigu\w*|exhaust\w*|weary|weariness|tens(e|"
            r"ion|ed)|stress\w*|strain\w*|strenuous\w*|pain(?!less|-?free)\w*|ach(e|es|ed|ing)|"
            r"hurts?|sore\w*|stiff\w*|cramp\w*|numb\w*|frustrat\w*|annoy\w*|irritat\w*|bored\w*|"
            r"boring|confus\w*|difficult\w*|hard(?! (contact|objects?|boxes|did you|do you))|"
            r"uncomfortabl\w*|unpleasant\w*|awkward\w*|clums\w*|cumbersome|slow\w*|sluggish\w*|"
            r"unnatural\w*|unpredictab\w*|unreliab\w*|inaccurate\w*|imprecise\w*|insecure\w*|"
            r"unsure|uncertain\w*|nervous\w*|anxious\w*|worried|discouraged|effort|demanding|"
            r"burden\w*|complicated|unclear|useless|disturb\w*|distract\w*|struggl\w*|trouble\w*|"
            r"problems?|bad|badly|poor\w*|worse|worst|dissatisf\w*|unhappy|dizzy|nause\w*|hurried|"
            r"rushed|overwhelm\w*|helpless\w*|terrib\w*|awful\w*)\b"
        ),
        "de": (
            r"(ich nicht (wollte|will)|unerwartet\w*|ungewollt\w*|aufgegeben|mude\w*|mudigkeit|"
            r"ermud\w*|erschopf\w*|angespannt\w*|verspannt\w*|anspannung|stress\w*|gestresst\w*|"
            r"anstreng\w*|muhsam\w*|muhe|schmerz(?!frei|los)\w*|weh|steif\w*|verkrampf\w*|"
            r"krampf\w*|frustr\w*|arger\w*|verarger\w*|genervt|nervig|nervte|gereizt|langweil\w*|"
            r"gelangweilt|verwirr\w*|schwierig\w*|schwer|unangenehm\w*|unbequem\w*|umstandlich\w*|"
            r"trage|langsam\w*|unnaturlich\w*|unvorherseh\w*|unzuverlassig\w*|ungenau\w*|"
            r"unsicher\w*|nervos\w*|angstlich|beschwer\w*|belast\w*|kompliziert\w*|unklar\w*|"
            r"nutzlos|storend|storte|uberfordert|hilflos|probleme?|unzufrieden\w*|schlecht\w*|"
            r"gehetzt|furchtbar\w*|schrecklich\w*)\b"
        ),
        "fr": (
            r"(je ne voulais pas|inattendu\w*|abandonn\w*|fatig\w*|epuis\w*|tendue?s?|crisp\w*|"
            r"stress\w*|tension|efforts?|penible\w*|douleur\w*|douloureu\w*|mal|raid\w*|crampes?|"
            r"frustr\w*|agac\w*|enerv\w*|irrit\w*|ennuy\w*|confus\w*|difficil\w*|inconfortab\w*|"
            r"desagreab\w*|maladroit\w*|lente?s?|lentement|imprevisib\w*|imprecis\w*|incertain\w*|"
            r"nerveu\w*|inquiet\w*|gene[es]?|genant\w*|complique\w*|inutil\w*|perturb\w*|"
            r"problemes?|insatisf\w*|mauvais\w*|terrible\w*)\b"
        ),
        "es": (
            r"((yo )?no queria|inesperad\w*|sin querer|cansad\w*|cansanci\w*|cans(a|o|aba|aron|ar)|"
            r"fatig\w*|agotad\w*|tens[oa]s?|tension|estres\w*|esfuerzos?|dolor\w*|doli\w*|duel\w*|"
            r"rigid\w*|calambres?|frustr\w*|molest\w*|irrit\w*|aburr\w*|confus\w*|dificil\w*|"
            r"incomod\w*|desagradab\w*|torpe\w*|lent[oa]s?|lentamente|imprevisib\w*|imprecis\w*|"
            r"insegur\w*|nervios\w*|inquiet\w*|complicad\w*|inutil\w*|problemas?|insatisf\w*|"
            r"mal[oa]?|terribl\w*)\b"
        ),
        "it": (
            r"(stanc\w*|affatic\w*|fatic\w*|esaust\w*|tes[oaie]|tension\w*|stress\w*|sforz\w*|"
            r"dolor\w*|rigid\w*|crampi|frustr\w*|irrit\w*|annoi\w*|noios\w*|confus\w*|difficil\w*|"
            r"scomod\w*|spiacevol\w*|goff\w*|lent[oaie]|lentamente|imprevedibil\w*|imprecis\w*|"
            r"insicur\w*|nervos\w*|complicat\w*|inutil\w*|problem[ai]|insoddisf\w*|male|"
            r"terribil\w*)\b"
        ),
        "nl": (
            r"(moe|vermoei\w*|uitgeput|gespannen|spanning|stress\w*|gestrest|inspann\w*|"
            r"pijn(?!loos)\w*|stijf|stijve|kramp\w*|frustr\w*|irritant\w*|geirriteerd|saaie?|"
            r"verwar\w*|moeilijk\w*|lastig\w*|oncomfortabel\w*|ongemakkelijk\w*|onaangenaam|"
            r"onprettig\w*|trage?|traag|langza\w*|onnatuurlijk|onvoorspelbaar|onbetrouwbaar|"
            r"onnauwkeurig|onzeker|nerveus|ingewikkeld|onduidelijk|probleem|problemen|ontevreden|"
            r"slechte?|vreselijk)\b"
        ),
        "pt": (
            r"(cansad\w*|cansaco|fatig\w*|exaust\w*|tens[oa]s?|tensao|stress\w*|estress\w*|esforco|"
            r"dor|dores|dolor\w*|rigid\w*|frustr\w*|irrit\w*|aborrec\w*|entedi\w*|confus\w*|"
            r"dificil|dificeis|dificuldade|desconfort\w*|desagradav\w*|lent[oa]s?|imprevisiv\w*|"
            r"imprecis\w*|insegur\w*|nervos\w*|complicad\w*|inutil|mal|mau|ma)\b"
        ),
        "zh": r"累|疲劳|疲惫|疲倦|紧张|压力|费力|吃力|疼|痛|僵硬|沮丧|烦|无聊|困惑|困难|难|慢|糟",
    }
)
"""Words of what people want, and of what they do not want."""

_DENIALS = {
    "en": r"not|no|never|without|hardly|barely|neither|nor|free|less|un|\w+n't",
    "de": r"nicht|kein\w*|nie|niemals|ohne|kaum|weder|wenig|weniger|nichts",
    "fr": r"pas|sans|aucun\w*|jamais|peu|moins|non|rien",
    "es": r"no|nunca|sin|nada|ningun\w*|poco|menos|jamas",
    "it": r"non|mai|senza|nessun\w*|poco|meno|niente|affatto|nulla",
    "nl": r"niet|geen|nooit|zonder|nauwelijks|weinig|minder",
    "pt": r"nao|nunca|sem|nada|nenhum\w*|pouco|menos",
}
_DENIED = {code: re.compile(rf"(?:{words})$") for code, words in _DENIALS.items()}
_STOP = re.compile(r"[,.;:?!]")

NONE = Phrases(
    {
        "en": r"(not|none|never|no|nothing|disagree|hardly|minimal\w*|lowest|false|least|\w+n't)\b",
        "de": r"(nicht|kein\w*|nie|niemals|nichts|lehne|kaum|minimal\w*|niedrigst\w*|null)\b",
        "fr": r"(pas|aucun\w*|jamais|rien|nulle?|non|desaccord|minim\w*)\b",
        "es": r"(nada|ningun\w*|nunca|no|desacuerdo|minim\w*|cero)\b",
        "it": r"(niente|nulla|affatto|nessun\w*|mai|non|disaccordo|minim\w*)\b",
        "nl": r"(niet|geen|nooit|niets|oneens|minim\w*)\b",
        "pt": r"(nada|nenhum\w*|nunca|nao|discordo|minim\w*)\b",
        "sv": r"(inte|ingen|inget|inga|aldrig)\b",
        "da": r"(ikke|ingen|intet|aldrig)\b",
        "no": r"(ikke|ingen|aldri)\b",
        "pl": r"(wcale|nie|nigdy|zaden|zadna|brak)\b",
        "cs": r"(vubec|nikdy|zadn\w*|nesouhlas\w*)\b",
        "ru": r"(не|нет|никогда|нисколько)\b",
        "zh": r"不|没|无",
        "ja": r"ない|ません|なし",
        "ko": r"전혀|않|없",
        "ar": r"(?<!\w)(لا|غير|ليس|أبدا|ابدا|مطلقا)(?!\w)",
    }
)
"""Words of the end of a scale at which there is none of it."""


def sign(text: str, language: str) -> int:
    """1 if a text speaks of something good, -1 of something bad; 0 of neither, or of both."""
    words = plain(text)
    signs = {
        value * (-1 if _denied(words[: match.start()], language) else 1)
        for value, phrases in ((1, GOOD), (-1, BAD))
        for match in phrases.all_matches(words, language)
    }
    return signs.pop() if len(signs) == 1 else 0


def amount(ends: tuple[Text, Text], language: str) -> int:
    """1 if a scale goes from none of something upwards, -1 if downwards; 0 if this is unknown."""
    low, high = (NONE.match(end[language], language) is not None for end in ends)
    return int(low) - int(high)


def valence(ends: tuple[Text, Text], language: str) -> int:
    """1 if a scale's ends go from bad to good, -1 from good to bad; 0 if they tell neither."""
    low, high = (sign(end[language], language) for end in ends)
    return 0 if low == high else 1 if high > low else -1


def direction(ask: str, ends: tuple[Text, Text] | None, language: str) -> int:
    """1 if a larger answer is a better one, -1 if it is a worse one; 0 if this is unknown."""
    if ends is None:
        return sign(ask, language)
    if way := valence(ends, language):
        return way
    same = sign(ends[0][language], language)
    return (amount(ends, language) or 1) * (same or sign(ask, language))


def _denied(before: str, language: str) -> bool:
    clause = _STOP.split(before)[-1]
    if base(language) == "zh":
        return clause.endswith(("不", "没", "不太", "没有", "毫不", "一点也不"))
    pattern = _DENIED.get(base(language))
    return pattern is not None and any(
        pattern.match(word) for word in re.findall(r"[\w']+", clause)[-NEAR:]
    )
