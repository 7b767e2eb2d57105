"""Texts that tell participants which level is expected to do better, and questions that lead."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import END, START, Design
from sandbox.study.design.meaning.flaw import Flaw
from sandbox.study.design.meaning.texts import (
    INSTRUCTION,
    QUESTION,
    Phrases,
    quoted,
    sentences,
    told_texts,
)

JUDGED = Phrases(
    {
        "en": (
            r"(better|best|superior|improved|enhanced|innovative|inferior|worse|worst|faster|"
            r"quicker|"
            r"easier|simpler|slower|clumsy|clumsier|tiring|annoying|cumbersome|intuitive|outdated|"
            r"old-fashioned|state[- ]of[- ]the[- ]art|cutting[- ]edge|advanced|"
            r"more (accurate|precise|efficient|comfortable|natural|difficult|powerful)\w*|"
            r"less (accurate|precise|efficient|comfortable|natural|difficult|effort|tiring))\b|"
            r"our (own|new|novel) |(the|this) (old|new|novel|conventional) (and \w+ )?(way|method|"
            r"system|technique|version|encoder|algorithm|approach|hand|control|design|interface)\b|"
            r"slow and |harder to "
        ),
        "de": (
            r"(besser\w*|beste[rnms]?|uberlegen\w*|unterlegen\w*|verbessert\w*|innovativ\w*|"
            r"neuartig\w*|"
            r"fortschrittlich\w*|schlechter\w*|schneller\w*|leichter\w*|einfacher\w*|langsamer\w*|"
            r"muhsam\w*|umstandlich\w*|veraltet\w*|intuitiv\w*|genauer\w*|bequemer\w*|"
            r"anstrengend\w*)\b|"
            r"unsere?[rnms]? (eigen|neu)\w* |(die|das|der|den|dem) (alte|neue|herkommliche)[rnms]? "
            r"(\w*(weise|art|methode|verfahren|steuerung|system|technik|version|encoder|hand))\b"
        ),
        "fr": (
            r"(meilleure?s?|mieux|ameliore\w*|innovant\w*|superieur\w*|inferieur\w*|"
            r"(plus|moins) (rapid|facil|simpl|efficac|lent|difficil|precis|confortabl|fatig|"
            r"intuiti)\w*|"
            r"pire|depasse\w*|obsolete\w*)\b|notre nouve\w*|l'ancienne (methode|version)|"
            r"(la|le|une?) nouve\w* (methode|version|systeme|technique|commande)"
        ),
        "es": (
            r"(mejor\w*|peor\w*|innovador\w*|superior|inferior|anticuad\w*|obsolet\w*|"
            r"(mas|menos) (rapid|facil|sencill|efica|eficient|lent|dificil|precis|comod|cansad|"
            r"intuitiv)\w*)\b|"
            r"nuestr[oa] nuev\w*|(el|la|un|una) (nuev|antigu)[oa] (metodo|sistema|version|tecnica|"
            r"control)"
        ),
        "it": (
            r"(miglior\w*|peggior\w*|innovativ\w*|superior\w*|inferior\w*|superat\w*|obsolet\w*|"
            r"(piu|meno) (veloc|rapid|facil|semplic|lent|difficil|precis|comod|faticos|"
            r"intuitiv)\w*)\b|"
            r"(il|la) nostr[oa] nuov\w*|(il|la|un|una) (nuov|vecchi)[oa] (metodo|sistema|versione|"
            r"tecnica)"
        ),
        "nl": (
            r"(beter\w*|beste|slechter\w*|verbeterd\w*|innovatie\w*|sneller\w*|makkelijker|"
            r"gemakkelijker|"
            r"eenvoudiger|langzamer|trager|verouderd\w*|nauwkeuriger|vermoeiend\w*)\b|onze nieuwe|"
            r"(de|het) (oude|nieuwe) (manier|methode|systeem|versie|techniek|besturing)"
        ),
        "pt": (
            r"(melhor\w*|pior\w*|inovador\w*|superior|inferior|ultrapassad\w*|"
            r"(mais|menos) (rapid|facil|facei|simples|eficien|lent|dificil|precis|comod|"
            r"cansativ)\w*)\b|"
            r"noss[oa] nov[oa]|(o|a|um|uma) (nov|antig)[oa] (metodo|sistema|versao|tecnica)"
        ),
        "zh": r"更(好|快|容易|简单|轻松|准确|慢|差|难)|改进|先进|落后|我们的新|"
        r"优于|旧(的)?(方法|方式|系统)|新(的)?(方法|方式|系统)",
        "ja": r"より(良|よ|速|早|簡単|使いやす|正確|遅|悪|難し)|改良|"
        r"改善され|優れ|劣|新しい(方法|方式|システム|手法)|"
        r"(古い|従来の)(方法|方式|システム|手法)",
    }
)
"""Judgements of a level, in texts that are shown at a factor."""

EXPECTED = Phrases(
    {
        "en": (
            r"(we|i|the (researchers|experimenters|authors|team|designers)) (\w+ )?(expect|"
            r"believe|think|"
            r"hope|predict|assume|anticipate|suspect|hypothesi[sz]e|are (sure|convinced|"
            r"confident))\b"
            r"(?! (you|everybody|everyone) (to|will enjoy))[^.]*\b(better|worse|fast|faster|quick|"
            r"quicker|slow|slower|"
            r"easy|easier|hard|harder|simpler|more|less|fewer|improve\w*|outperform\w*|prefer\w*|"
            r"help\w*|"
            r"win|beat|superior)\b|"
            r"(our|the) hypothes[ie]s|(to|will|should) (show|prove|demonstrate|confirm) (that|how "
            r"much) |"
            r"(is|are) (expected|supposed|known|believed|designed|meant|said) to (be|make|give|"
            r"let|work)\b[^.]*"
            r"\b(better|worse|faster|slower|easier|harder|more|less|fewer|quicker|simpler)\b|"
            r"(many|most|other|earlier|previous|all) (people|participants|users|students)[^.,;]* "
            r"(found|find|"
            r"prefer\w*|liked?|said|say|were|are|did|do)\b[^.]*(better|worse|faster|slower|easier|"
            r"harder|"
            r"slow|easy|hard|tiring|prefer|more|less|like|best)"
        ),
        "de": (
            r"(wir|ich|die forsch\w+)[^.,;]{0,12} ?(erwarten|erwarte|glauben|glaube|hoffen|hoffe|"
            r"vermuten|"
            r"vermute|denken|annehmen|nehmen an|rechnen damit|sind (sicher|"
            r"uberzeugt))\b[^.]*(besser|"
            r"schlechter|schneller|langsamer|leichter|schwerer|einfacher|mehr |weniger|bevorzug|"
            r"lieber|"
            r"uberlegen|hilft|helfen)|hypothese|(zeigen|beweisen|belegen|bestatigen), (dass|wie "
            r"viel)|"
            r"(viele|die meisten|andere) [^.,;]*(fanden|finden|bevorzug|mochten|waren)[^.]*"
        ),
        "fr": (
            r"(nous|on|je) (nous )?(pens|esper|attend|croy|croi|suppos|prevo|"
            r"presum)\w*[^.]*(mieux|meilleur|"
            r"plus|moins|pire|prefer|aider)|hypothese|(montrer|prouver|demontrer|confirmer) que|"
            r"(la plupart|beaucoup) des? [^.,;]*(prefer|trouv)"
        ),
        "es": (
            r"(esperamos|creemos|pensamos|suponemos|prevemos)[^.]*(mejor|peor|mas|menos|prefer|"
            r"ayud)|"
            r"hipotesis|(mostrar|probar|demostrar|confirmar) que|(la mayoria|muchas "
            r"personas)[^.,;]*prefi"
        ),
        "it": (
            r"(ci aspettiamo|crediamo|pensiamo|speriamo|riteniamo|supponiamo)[^.]*(miglior|"
            r"peggior|meglio|"
            r"piu|meno|prefer|aiut)|ipotesi|(mostrare|provare|dimostrare|confermare) che"
        ),
        "nl": (
            r"(wij|we|ik)[^.,;]{0,6} ?(verwacht|denk|geloof|gelov|hoop|hop|vermoed)\w*[^.]*(beter|"
            r"slechter|"
            r"sneller|langzamer|trager|makkelijker|meer|minder|voorkeur|help)|hypothese|"
            r"(laten zien|bewijzen|aantonen|bevestigen) dat"
        ),
        "pt": (
            r"(esperamos|acreditamos|achamos|supomos|pensamos)[^.]*(melhor|pior|mais|menos|prefer|"
            r"ajud)|"
            r"hipotese|(mostrar|provar|demonstrar|confirmar) que"
        ),
        "zh": r"(我们|研究者)(认为|预期|预计|相信|希望|"
        r"期望)[^。]*(更|优于|好于)|假设|(证明|表明|证实)",
        "ja": r"[^。]*(と(予想|考え|期待|思)[わいえてっし])|仮説|ことを(示|証明|確認)",
    }
)
"""Expectations, in any text before or between trials."""

BALANCED = Phrases(
    {
        "en": r"(no|not|none|neither|nor|never|nobody|(?<!, )which|whether|how|equally|as (fast|"
        r"quick\w*|"
        r"well|good|easy|easily) as|try|please|your best|best of luck|as best)\b|\w+n't\b",
        "de": r"(nicht|kein\w*|weder|ob|welche\w*|wie|gleich|versuchen|bitte|ihr bestes|"
        r"moglichst)\b",
        "fr": r"(ne|pas|aucun\w*|ni|si|quel\w*|lequel|laquelle|comment|essayez|votre mieux|le "
        r"mieux)\b|n'",
        "es": r"(no|ningun\w*|ni|si|cual|que tan|como|intente|lo mejor|tan)\b",
        "it": r"(non|nessun\w*|ne|se|quale|come|provi|cerchi|del suo meglio)\b",
        "nl": r"(niet|geen|noch|of|welke|wat|hoe|probeer|uw best|je best|zo)\b",
        "pt": r"(nao|nenhum\w*|nem|se|qual|como|tente|o melhor|tao)\b",
        "zh": r"不|没有|是否|哪|请",
        "ja": r"ない|ません|どちら|かどうか|ください",
    }
)
"""Words of sentences that do not say which level is better, or that ask for it."""

LEADING = Phrases(
    {
        "en": r"how much (better|faster|easier|more|quicker|worse|slower|harder|less)|"
        r"(don't you|do you not|would you not|wouldn't you|surely|of course)\b|"
        r"do you agree that\b.*\b(better|faster|easier|more|worse|slower|harder|less)\b",
        "de": r"(wie viel|um wie viel|wieviel) (besser|schneller|leichter|mehr|einfacher|"
        r"schlechter|"
        r"langsamer|schwerer|weniger)|finden sie nicht|stimmen sie zu, dass .*(besser|schneller|"
        r"leichter)",
        "fr": r"(combien|a quel point) [^?]*(mieux|meilleur|plus (rapide|facile))|ne (trouvez|"
        r"pensez)-vous pas",
        "es": r"cuanto (mejor|peor|mas (rapid|facil))|no (cree|piensa|le parece) (usted )?que",
        "it": r"quanto (migliore|meglio|piu (veloce|facile))|non (crede|pensa|trova) che",
        "nl": r"hoeveel (beter|sneller|makkelijker)|vindt u (ook )?niet",
    }
)
"""Questions that tell their answer."""

REMEDY = "Say the same of every level, and nothing of how well people will do with it"


def expectation_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of texts that tell what is hoped for."""
    compared = {factor.name for factor in design.factors if len(factor.levels) > 1}
    for told in told_texts(design):
        for language, text in told.text.items():
            hint = None
            if told.kind == QUESTION:
                hint = next((s for s in sentences(text) if LEADING.match(s, language)), None)
                what, remedy = "it leads to an answer", "Ask how it was, for each level alone"
            elif told.at != END:
                judges = told.kind == INSTRUCTION and told.at in compared and told.at != START
                hint = next((s for s in sentences(text) if _hints(s, language, judges)), None)
                what, remedy = "people are told which level is expected to be better", REMEDY
            if hint is not None:
                yield Flaw(told.path, f"{what}: {quoted(hint)}", remedy)
                break


def _hints(sentence: str, language: str, judges: bool) -> bool:
    """True if a sentence says what is expected, or judges a level where this is looked for."""
    if EXPECTED.match(sentence, language) and not BALANCED.match(sentence, language):
        return True
    said = judges and JUDGED.match(sentence, language)
    return bool(said) and not BALANCED.match(sentence, language)
