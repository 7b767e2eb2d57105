"""Texts that tell participants which level is expected to do better, and questions that lead."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import END, START, Design
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import (
    INSTRUCTION,
    QUESTION,
    TITLE,
    Phrases,
    Told,
    quoted,
    sentences,
    told_texts,
)

JUDGED = Phrases(
    {
        "en": (
            r"(better|best|superior|improved|enhanced|innovative|inferior|worse|worst|faster|"
            r"quicker|easier|simpler|slower|clumsy|clumsier|tiring|annoying|cumbersome|intuitive|"
            r"outdated|old-fashioned|state[- ]of[- ]the[- ]art|cutting[- ]edge|advanced|more "
            r"(accurate|precise|efficient|comfortable|natural|difficult|powerful)\w*|less "
            r"(accurate|precise|efficient|comfortable|natural|difficult|effort|tiring))\b|our (own|"
            r"new|novel) |(the|this) (old|new|novel|conventional) (and \w+ )?(way|method|system|"
            r"technique|version|encoder|algorithm|approach|hand|control|design|interface)\b|slow "
            r"and |harder to |(smart|intelligent\w*|modern|powerful|basic|crude|primitive|"
            r"unreliable|error-prone|buggy|faulty|award-winning|prototype)\b"
        ),
        "de": (
            r"(besser\w*|beste[rnms]?|uberlegen\w*|unterlegen\w*|verbessert\w*|innovativ\w*|"
            r"neuartig\w*|fortschrittlich\w*|schlechter\w*|schneller\w*|leichter\w*|einfacher\w*|"
            r"langsamer\w*|muhsam\w*|umstandlich\w*|veraltet\w*|intuitiv\w*|genauer\w*|bequemer\w*|"
            r"anstrengend\w*)\b|unsere?[rnms]? (eigen|neu)\w* |(die|das|der|den|dem) (alte|neue|"
            r"herkommliche)[rnms]? (\w*(weise|art|methode|verfahren|steuerung|system|technik|"
            r"version|encoder|hand))\b|(modern\w*|intelligent\w*|kluge?[rnms]?|neueste[rnms]?|"
            r"ausgereift\w*|primitiv\w*|fehlerhaft\w*|fehleranfallig\w*|altmodisch\w*|"
            r"preisgekront\w*|unzuverlassig\w*)\b"
        ),
        "fr": (
            r"(meilleure?s?|mieux|ameliore\w*|innovant\w*|superieur\w*|inferieur\w*|(plus|moins) "
            r"(rapid|facil|simpl|efficac|lent|difficil|precis|confortabl|fatig|intuiti)\w*|pire|"
            r"depasse\w*|obsolete\w*)\b|notre nouve\w*|l'ancienne (methode|version)|(la|le|une?) "
            r"nouve\w* (methode|version|systeme|technique|commande)|(moderne\w*|intelligent\w*|"
            r"derniere generation|rudimentaire\w*|primiti\w*|peu fiable\w*|defectueu\w*)\b"
        ),
        "es": (
            r"(mejor\w*|peor\w*|innovador\w*|superior|inferior|anticuad\w*|obsolet\w*|(mas|menos) "
            r"(rapid|facil|sencill|efica|eficient|lent|dificil|precis|comod|cansad|intuitiv)\w*)\b|"
            r"nuestr[oa] nuev\w*|(el|la|un|una) (nuev|antigu)[oa] (metodo|sistema|version|tecnica|"
            r"control)|(modern[oa]s?|inteligente\w*|ultima generacion|rudimentari\w*|primitiv\w*|"
            r"defectuos\w*|poco fiable\w*)\b"
        ),
        "it": (
            r"(miglior\w*|peggior\w*|innovativ\w*|superior\w*|inferior\w*|superat\w*|obsolet\w*|"
            r"(piu|meno) (veloc|rapid|facil|semplic|lent|difficil|precis|comod|faticos|"
            r"intuitiv)\w*)\b|(il|la) nostr[oa] nuov\w*|(il|la|un|una) (nuov|vecchi)[oa] (metodo|"
            r"sistema|versione|tecnica)"
        ),
        "nl": (
            r"(beter\w*|beste|slechter\w*|verbeterd\w*|innovatie\w*|sneller\w*|makkelijker|"
            r"gemakkelijker|eenvoudiger|langzamer|trager|verouderd\w*|nauwkeuriger|"
            r"vermoeiend\w*)\b|onze nieuwe|(de|het) (oude|nieuwe) (manier|methode|systeem|versie|"
            r"techniek|besturing)"
        ),
        "pt": (
            r"(melhor\w*|pior\w*|inovador\w*|superior|inferior|ultrapassad\w*|(mais|menos) (rapid|"
            r"facil|facei|simples|eficien|lent|dificil|precis|comod|cansativ)\w*)\b|noss[oa] "
            r"nov[oa]|(o|a|um|uma) (nov|antig)[oa] (metodo|sistema|versao|tecnica)"
        ),
        "zh": (
            r"更(好|快|容易|简单|轻松|准确|慢|差|难)|改进|先进|落后|我们的新|优于|旧(的)?(方法|"
            r"方式|系统)|新(的)?(方法|方式|系统)"
        ),
        "ja": (
            r"より(良|よ|速|早|簡単|使いやす|正確|遅|悪|難し)|改良|改善され|優れ|劣|新しい(方法|"
            r"方式|システム|手法)|(古い|従来の)(方法|方式|システム|手法)"
        ),
    }
)
"""Judgements of a level, in texts that are shown at a factor."""

EXPECTED = Phrases(
    {
        "en": (
            r"(we|i|the (researchers|experimenters|authors|team|designers)) (\w+ )?(expect|believe|"
            r"think|trust|hope|predict|assume|anticipate|suspect|hypothesi[sz]e|are (sure|"
            r"convinced|confident))\b(?! (you|everybody|everyone) (to|will "
            r"enjoy))[^.]*\b(better|worse|fast|"
            r"faster|quick|quicker|slow|slower|easy|easier|hard|harder|simpler|(more|less|fewer) "
            r"(?!than|about|of|on|in|information|details?)\w+|improve\w*|outperform\w*|prefer\w*|"
            r"superior)\b|hypothes[ie]s (is|are|says?)\b|(study|experiment|research|aim|goal|"
            r"purpose|want|hope|wish)\b[^.]* (show|prove|demonstrate|confirm) (that|how much) |(is|"
            r"are) (expected|supposed|known|believed|designed|meant|said) to (be|make|give|let|"
            r"work)\b[^.]*\b(better|worse|faster|slower|easier|harder|quicker|simpler|(more|less|"
            r"fewer) (?!than)\w+)\b|(many|most|other) (people|participants|users|students) "
            r"(prefer\w*|liked?) |(many|most|other|earlier|previous) (people|participants|users|"
            r"students)[^.,;]* (found|find|prefer\w*|liked?|said|say|were|are)\b[^.]*\b(better|"
            r"worse|faster|slower|easier|harder|prefer\w*|like\w*|best)\b|(many|most|other|"
            r"earlier|previous) (people|participants|users|students) (found|find) [^.,;]*(part|"
            r"method|way|version|hand|encoder|one)\b[^.,;]* (slow|easy|hard|tiring)\b|"
            r"(the |this )?(first|second|third|other|next|new|old) (part|method|way|version|one|"
            r"hand|condition|encoder|block|round) (is|will|works?|feels?|makes?|"
            r"was)\b[^.]*\b(better|worse|easier|harder|faster|slower|simpler|(more|less) (accurate|"
            r"precise|comfortable|natural|pleasant|tiring|difficult|reliable))\b|you will (see|"
            r"find|notice|feel) that[^.]*\b(better|worse|easier|harder|faster|slower|simpler)\b|"
            r"(everybody|everyone|people|users) (complain\w*|hate[sd]?|love[sd]?|dislike[sd]?|"
            r"struggle\w*)"
        ),
        "de": (
            r"(wir|ich|die forsch\w+)[^.,;]{0,12} ?(erwarten|vertrauen|erwarte|glauben|glaube|"
            r"hoffen|hoffe|vermuten|vermute|denken|annehmen|nehmen an|rechnen damit|sind (sicher|"
            r"uberzeugt))\b[^.]*\b(besser|schlechter|schneller|langsamer|leichter|schwerer|"
            r"einfacher|(mehr|weniger) (?!uber|als|dazu|von|daruber)\w+|bevorzug\w*|lieber|"
            r"uberlegen)\b|hypothese (ist|lautet)|(studie|versuch|ziel|wollen|"
            r"mochten)\b[^.]*(zeigen|beweisen|belegen), (dass|wie viel)|(viele|die meisten|andere) "
            r"[^.,;]*(fanden|finden|bevorzug|mochten)|(im|der|die|das|mit dem|mit der) (ersten?|"
            r"zweiten?|dritten?|anderen?|nachsten?|neuen?|alten?) (teil|methode|variante|version|"
            r"verfahren|steuerung|bedingung|hand|durchgang)\w*[^.]*\b(besser|schlechter|leichter|"
            r"schwerer|einfacher|schneller|langsamer|angenehmer)\b|sie werden (sehen|merken|"
            r"feststellen|spuren), dass[^.]*\b(besser|schlechter|leichter|schwerer|einfacher|"
            r"schneller|langsamer|angenehmer)\b"
        ),
        "fr": (
            r"(nous|on|je) (nous )?(pens|esper|attend|croy|croi|suppos|prevo|compt|"
            r"sommes (surs|convaincus)|presum)\w*[^.]*\b(mieux|meilleur\w*|(plus|moins) "
            r"(?!de|d'|sur|que)\w+|pire|"
            r"prefer\w*)\b|hypothese est|(etude|but|objectif|voulons|souhaitons|"
            r"cherchons)\b[^.]*(montrer|prouver|demontrer) que|(la plupart|beaucoup) des? "
            r"[^.,;]*(prefer|trouv)|vous (verrez|sentirez|remarquerez|constaterez) "
            r"que[^.]*\b(mieux|meilleur\w*|pire|(plus|moins) \w+)|(la|le) (premiere?|seconde?|"
            r"deuxieme|autre|nouvelle) (methode|partie|version|variante|commande|main|"
            r"technique)[^.]*\b(mieux|meilleur\w*|pire|(plus|moins) (facil|rapid|agreab|precis|"
            r"naturel|fiab|fatig|difficil|lent)\w*)"
        ),
        "es": (
            r"(esperamos|confiamos|creemos|pensamos|suponemos|prevemos|estamos (segur|"
            r"convencid)[oa]s)[^.]*\b(mejor\w*|peor\w*|(mas|menos) "
            r"(?!de|sobre|que)\w+|prefer\w*)\b|hipotesis es|(estudio|objetivo|queremos|"
            r"deseamos)\b[^.]*(mostrar|probar|demostrar) que|(la mayoria|muchas "
            r"personas)[^.,;]*prefi|(vera|notara|sentira|comprobara) que[^.]*\b(mejor|peor|(mas|"
            r"menos) \w+)|(el|la) (primer|primera|segund[oa]|otr[oa]|nuev[oa]) (metodo|parte|"
            r"version|variante|control|mano|tecnica)[^.]*\b(mejor|peor|(mas|menos) (facil|rapid|"
            r"comod|agradab|precis|natural|fiab|cansad|dificil|lent)\w*)"
        ),
        "it": (
            r"(ci aspettiamo|crediamo|pensiamo|speriamo|riteniamo|supponiamo)[^.]*\b(miglior\w*|"
            r"peggior\w*|meglio|(piu|meno) (?!di|su|sul\w*|che)\w+|prefer\w*)\b|ipotesi e |(studio|"
            r"scopo|obiettivo|vogliamo)\b[^.]*(mostrare|provare|dimostrare) che"
        ),
        "nl": (
            r"(wij|we|ik)[^.,;]{0,6} ?(verwacht|denk|geloof|gelov|hoop|hop|"
            r"vermoed)\w*[^.]*\b(beter|slechter|sneller|langzamer|trager|makkelijker|(meer|minder) "
            r"(?!over|dan|van)\w+|voorkeur)\b|hypothese (is|luidt)|(onderzoek|studie|doel|"
            r"willen)\b[^.]*(laten zien|bewijzen|aantonen) dat"
        ),
        "pt": (
            r"(esperamos|acreditamos|achamos|supomos|pensamos)[^.]*\b(melhor\w*|pior\w*|(mais|"
            r"menos) (?!de|sobre|que|do)\w+|prefer\w*)\b|hipotese e |(estudo|objetivo|"
            r"queremos)\b[^.]*(mostrar|provar|demonstrar) que"
        ),
        "zh": (
            r"(我们|研究者)(认为|预期|预计|相信|希望|期望)[^。]*(更(好|快|容易|简单|轻松|准确|慢|"
            r"差|难)|优于|好于)|假设是|(研究|我们)[^。]*证明"
        ),
        "ja": (
            r"(より|ほうが|方が)[^。]*と(予想|考え|期待)|仮説は|(本研究|目的)[^。]*ことを(示|証明)"
        ),
    }
)
"""Expectations, in any text before or between trials."""

BALANCED = Phrases(
    {
        "en": (
            r"(no|not|none|neither|nor|never|nobody|(?<!, )which|whether|how|equally|as (fast|"
            r"quick\w*|well|good|easy|easily) as|try|please|your best|best of luck|as best)\b|"
            r"\w+n't\b"
        ),
        "de": (
            r"(nicht|kein\w*|weder|ob|welche\w*|wie|gleich|versuchen|bitte|ihr bestes|moglichst)\b"
        ),
        "fr": (
            r"(ne|pas|aucun\w*|ni|si|quel\w*|lequel|laquelle|comment|essayez|votre mieux|le "
            r"mieux)\b|n'"
        ),
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
        "en": (
            r"how much (better|faster|easier|more|quicker|worse|slower|harder|less)|(don't you|do "
            r"you not|would you not|wouldn't you|surely|of course)\b|(do|would) you agree that\b|"
            r"isn't it (true )?that|(is|was|did|does|do|are|were)n't (it|you|they|he|she)\?|as "
            r"(most|many|other) (people|users|participants) (say|said|think|found|find)|, right\?"
        ),
        "de": (
            r"(wie viel|um wie viel|wieviel) (besser|schneller|leichter|mehr|einfacher|schlechter|"
            r"langsamer|schwerer|weniger)|(finden|meinen|denken|glauben) sie nicht|stimmen sie "
            r"(mir |uns )?zu, dass|nicht wahr\?|, oder\?|wie die meisten"
        ),
        "fr": (
            r"(combien|a quel point) [^?]*(mieux|meilleur|plus (rapide|facile))|ne (trouvez|pensez|"
            r"croyez)-vous pas|n'est-ce pas|comme la plupart"
        ),
        "es": (
            r"cuanto (mejor|peor|mas (rapid|facil))|no (cree|piensa|le parece) (usted )?que|"
            r"verdad\?|como la mayoria"
        ),
        "it": r"quanto (migliore|meglio|piu (veloce|facile))|non (crede|pensa|trova) che",
        "nl": r"hoeveel (beter|sneller|makkelijker)|vindt u (ook )?niet",
    }
)
"""Questions that tell their answer."""

PRAISED = Phrases(
    {
        "en": (
            r"(our|the|this|your) (own |new |brand-new )?(improved|enhanced|innovative|outdated|"
            r"state[- ]of[- ]the[- ]art|cutting[- ]edge|advanced|clumsy|annoying|awkward)\b|our "
            r"(own|new|novel|better)\b"
        ),
        "de": (
            r"(die|der|das|den|dem|des|diese\w*|unsere?\w*|eine?\w*) (neue\w* )?(verbesserte|"
            r"innovative|neuartige|uberlegene|fortschrittliche|veraltete|umstandliche|"
            r"lastige)[nrms]? |unsere?[rnms]? (eigene|neue|bessere)[nrms]?\b"
        ),
        "fr": (
            r"(main|systeme|commande|version|methode|technique) (amelioree?|innovante?|obsolete|"
            r"depassee?)\b|notre nouve\w*|nos nouve\w*"
        ),
        "es": (
            r"(mano|sistema|control|version|metodo|tecnica) (mejorad[oa]|innovador|innovadora|"
            r"anticuad[oa]|obsolet[oa])\b|nuestr[oa]s? nuev\w*"
        ),
        "it": (
            r"(mano|sistema|controllo|versione|metodo|tecnica) (migliorat[oa]|innovativ[oa]|"
            r"obsolet[oa]|superat[oa])\b|(il|la) nostr[oa] nuov\w*"
        ),
        "nl": r"(de|het|onze|deze) (verbeterde|innovatieve|verouderde)\b|onze nieuwe",
    }
)
"""Praise and blame within a question or a title."""

GROUPED = Phrases(
    {
        "en": (
            r"(control|placebo|experimental|treatment|comparison) (group|condition)|placebo|"
            r"baseline (condition|group)"
        ),
        "de": r"(kontroll|placebo|experimental|versuchs|vergleichs)(gruppe|bedingung)\w*|placebo",
        "fr": r"(groupe|condition) (de )?(controle|temoin|placebo|experimental\w*)|placebo",
        "es": r"(grupo|condicion) (de )?(control|placebo|experimental|tratamiento)|placebo",
        "it": r"(gruppo|condizione) (di )?(controllo|placebo|sperimentale)|placebo",
        "nl": r"(controle|placebo|experimentele) ?(groep|conditie)|placebo",
        "zh": r"(对照|实验|控制)组|安慰剂",
        "ja": r"(統制|対照|実験)(群|条件)|プラセボ",
    }
)
"""Names of groups that tell people whether an effect is expected of them."""

REMEDY = "Say the same of every level, and nothing of how well people will do with it"


def expectation_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of texts that tell what is hoped for."""
    compared = {factor.name for factor in design.factors if len(factor.levels) > 1}
    for told in told_texts(design):
        for language, text in told.text.items():
            hint = None
            if told.kind == QUESTION:
                hint = next((s for s in sentences(text) if _leads(s, language)), None)
                what, remedy = "it leads to an answer", "Ask how it was, for each level alone"
            elif told.kind == TITLE:
                hint = text if PRAISED.match(text, language) else None
                what, remedy = "it leads to an answer", "Write a title that does not judge"
            elif told.at != END or _comes_again(design, told):
                judges = told.kind == INSTRUCTION and told.at in compared and told.at != START
                hint = next((s for s in sentences(text) if _hints(s, language, judges)), None)
                what, remedy = "people are told which level is expected to be better", REMEDY
                if hint is None and judges:
                    hint = next((s for s in sentences(text) if GROUPED.match(s, language)), None)
                    what = "people are told in which group they are"
            if hint is not None:
                yield Flaw(told.path, f"{what}: {quoted(hint)}", remedy)
                break


def _leads(sentence: str, language: str) -> bool:
    return bool(LEADING.match(sentence, language) or PRAISED.match(sentence, language))


def _comes_again(design: Design, told: Told) -> bool:
    """True if a text at the end of a session is shown before another session."""
    number = told.path[1]
    assert isinstance(number, int)
    shown = design.instructions[number].sessions or range(1, design.sessions + 1)
    return min(shown) < design.sessions


def _hints(sentence: str, language: str, judges: bool) -> bool:
    """True if a sentence says what is expected, or judges a level where this is looked for."""
    if EXPECTED.match(sentence, language) and not BALANCED.match(sentence, language):
        return True
    said = judges and JUDGED.match(sentence, language)
    return bool(said) and not BALANCED.match(sentence, language)
