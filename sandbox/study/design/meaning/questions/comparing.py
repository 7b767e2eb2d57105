"""Questions that compare levels, asked of people who have not met them."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import START, Design
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import Phrases, asked_forms, quoted

COMPARES = Phrases(
    {
        "en": (
            r"(which|what) (one )?of (the|these|those|your|both) (two |three |four |\d )?"
            r"(?!(two )?(hands?|fingers?))(methods?|variants?|versions?|conditions?|techniques?|"
            r"encoders?|systems?|ways|modes?|settings?|models?|contacts?|"
            r"interfaces?|designs?|two|three|four)\b(?! (hands|fingers))|(which|what) "
            r"(method|variant|version|condition|technique|encoder|system|way|mode|setting|"
            r"interface|design|one)\b.*\b(prefer\w*|better|best|like|liked|easier|easiest|"
            r"faster|fastest|favou?rite|comfortable|harder|worse|worst)\b|(compared (to|with)|"
            r"in comparison (to|with)|better than|worse than|easier than|harder than|faster than|"
            r"slower than|prefer\w*) (the )?(other|previous|earlier|first|second|both) "
            r"(one|method|variant|version|condition|technique|encoder|system|way|mode|setting|"
            r"interface)\b|(both|the two|the three|all three) (methods|variants|versions|"
            r"conditions|techniques|encoders|systems|ways|modes|settings|interfaces)\b|"
            r"rank the \w+"
        ),
        "de": (
            r"welche[nrsm]? (der|von den|dieser|von) (beiden|zwei|drei|vier)(?! (hande|finger))|"
            r"welche[nrsm]? (variante|methode|version|bedingung|verfahren|steuerung|technik|"
            r"system|art|modus|einstellung)\b.*\b(lieber|besser|beste[nrs]?|bevorzug\w*|"
            r"vorgezogen|angenehmer|leichter|schneller|einfacher|gefallen|gefiel)\b|(im vergleich|"
            r"verglichen) (zu|zur|zum|mit) (der|dem|den )?(ander|erst|vorherig|vorig|fruher)\w* "
            r"(variante|methode|version|bedingung|verfahren|steuerung|technik|system)|\w+er als "
            r"(die|der|das|den|dem|mit der|mit dem) (andere|erste|zweite|vorherige)|"
            r"(beide[nr]?|die zwei) (varianten|methoden|versionen|bedingungen|verfahren|"
            r"steuerungen|techniken|systeme)\b"
        ),
        "fr": (
            r"(laquelle|lequel|quelle|quel) (des|de ces|parmi les) (deux|trois|quatre)"
            r"(?! (mains|doigts))|(quelle|quel) (methode|version|variante|technique|commande|"
            r"systeme|condition)\b.*(prefer\w*|mieux|meilleur\w*|plus (facile|rapide|agreable))|"
            r"(par rapport a|compare\w* a|que) (l'autre|la (premiere|seconde|precedente)|le "
            r"(premier|second|precedent)) (methode|version|variante|technique|systeme|condition)?|"
            r"les (deux|trois) (methodes|versions|variantes|techniques|systemes|conditions)\b"
        ),
        "es": (
            r"(cual|que) de (los|las|estos|estas) (dos|tres|cuatro)(?! (manos|dedos))|(que|cual) "
            r"(metodo|version|variante|tecnica|sistema|condicion)\b.*(prefi\w*|mejor|gusto|"
            r"mas (facil|rapid|comod)\w*)|(en comparacion con|comparad[oa] con|que) (el|la) "
            r"(otr[oa]|anterior|primer[oa]?|segund[oa]) (metodo|version|variante|tecnica|sistema|"
            r"condicion)|(ambos|ambas|los dos|las dos) (metodos|versiones|variantes|tecnicas|"
            r"sistemas|condiciones)\b"
        ),
        "it": (
            r"qual[ei]? (dei|delle|dei|tra i|tra le) (due|tre)(?! (mani|dita))|quale (metodo|"
            r"versione|variante|tecnica|sistema|condizione)\b.*(prefer\w*|meglio|miglior\w*)|"
            r"(rispetto|in confronto) (all'altr|al prim|alla prim|al precedent|alla precedent)\w* "
            r"(metodo|versione|variante|tecnica|sistema|condizione)?|entramb[ie] (i|le) (metodi|"
            r"versioni|varianti|tecniche|sistemi|condizioni)\b"
        ),
        "nl": (
            r"welke van de (twee|drie|beide)(?! (handen|vingers))|welke (methode|variant|versie|"
            r"techniek|conditie|systeem)\b.*(voorkeur|liever|beter|beste|prettig\w*|makkelijk\w*)|"
            r"(vergeleken met|in vergelijking met|dan) (de|het) (andere|eerste|tweede|vorige) "
            r"(methode|variant|versie|techniek|conditie|systeem)|(beide|de twee) (methoden|"
            r"methodes|varianten|versies|technieken|condities|systemen)\b"
        ),
        "pt": (
            r"qual (dos dois|das duas|dos tres|das tres)|(qual|que) (metodo|versao|variante|"
            r"tecnica|sistema)\b.*(prefer\w*|melhor|gostou)|em comparacao com (o|a) (outr[oa]|"
            r"anterior|primeir[oa])"
        ),
        "zh": (
            r"哪(一)?(个|种)(方法|方式|版本|条件|系统)|(两|三)(种|个)(方法|方式|版本|条件)|"
            r"与另一(个|种)"
        ),
        "ja": (
            r"(どちら|どっち)の(方法|方式|手法|条件|システム)|どの(方法|方式|手法|条件)|"
            r"他の(方法|手法|条件)と比べ"
        ),
    }
)
"""Comparisons of methods that somebody has used; not of hands, nor of answers to choose from."""


ORDINAL = Phrases(
    {
        "en": (
            r"(first|second|third|1st|2nd|3rd) (part|method|version|condition|half|way|technique|"
            r"encoder|system|variant)\b"
        ),
        "de": (
            r"(erste|zweite|dritte)[rnms]? (teil|methode|variante|version|halfte|verfahren|"
            r"steuerung|"
            r"bedingung|technik)\w*"
        ),
        "fr": (
            r"(premiere?|seconde?|deuxieme|troisieme) (partie|methode|version|variante|technique|"
            r"moitie|condition)\b"
        ),
        "es": (
            r"(primera?|segund[oa]|tercera?) (parte|metodo|version|variante|tecnica|mitad|"
            r"condicion)\b"
        ),
    }
)
"""Parts by their place, of which there is one each."""
BEFORE = Phrases(
    {
        "en": (
            r"(compared (to|with)|in comparison (to|with)|relative to|than|as opposed to) (with |"
            r"in |on |to )?(the |your |that of the )?((previous|preceding|last)(?! (day|night|week|"
            r"month|year|session)s?\b)|others?\b(?! (hand|finger))|one (just )?before|(hand|way|"
            r"method|version|encoder|"
            r"part|one) (just )?(before|(that )?you (have )?(used|had|tried|did) before))\b"
        ),
        "de": (
            r"(verglichen (mit|zu)|im vergleich (mit|zur?|zum)|gegenuber|als) (bei |mit |in |an )?"
            r"(der|dem|den|die|das)? ?((vorig|vorherig|vorangegangen|vorhergehend|letzt)e[nrms]?"
            r"(?! (tag|nacht|woche|monat|jahr|sitzung|mal)\w*)|(hand|art|methode|steuerung|teil|"
            r"zuordnung|bedingung)\w* (da)?vor\b|davor\b)"
        ),
        "fr": (
            r"(par rapport (a|au|aux)|comparee?s? (a|au|avec)|en comparaison (de|avec|du)|que|"
            r"qu'avec) "
            r"(avec |dans |pour )?(la |le |l'|celle |celui )?(?!(jour|semaine|mois|annee|seance)"
            r"\w*)([\w']+ )?(precedente?|d'avant)\b"
        ),
        "es": (
            r"(en comparacion con|comparad[oa]s? con|(con )?respecto a|frente a|que) (con |en )?"
            r"(la|el|lo) (?!(dia|noche|semana|mes|ano|sesion)\w*)(\w+ )?(anterior|previ[oa])\b"
        ),
    }
)
"""Comparisons with what was used just before, which is another thing in every order."""


def comparing_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of questions that compare levels."""
    factors = [factor for factor in design.factors if len(factor.levels) > 1]
    between = [factor for factor in factors if factor.order == "between"]
    yield from _one_part(design)
    yield from _the_last_one(design)
    for path, form in asked_forms(design):
        if form.at != START and not between:
            continue
        for i, item in enumerate(form.items):
            language = next(
                (code for code, text in item.ask.items() if COMPARES.match(text, code)), None
            )
            if language is None:
                continue
            asked = quoted(item.ask[language])
            place = (*path, "items", i, "ask")
            named = any(plain(f.name) in plain(item.ask[language]) for f in between)
            if form.at == START:
                yield Flaw(
                    place,
                    f"it compares what nobody has met yet: {asked}",
                    'Write at = "end"',
                )
            elif len(between) == len(factors) or named:
                names = " and ".join(factor.name for factor in between)
                yield Flaw(
                    place,
                    f"it compares levels, and everybody meets only one of {names}: {asked}",
                    "Ask how it was, of each group alone, or let everybody meet all levels: order "
                    "latin",
                )


def _one_part(design: Design) -> Iterator[Flaw]:
    """Questions about one part, which are asked after every level."""
    several = {factor.name for factor in design.factors if len(factor.levels) > 1}
    for path, form in asked_forms(design):
        for i, item in enumerate(form.items if form.at in several else ()):
            language = next(
                (code for code, text in item.ask.items() if ORDINAL.match(text, code)), None
            )
            if language is not None and not COMPARES.match(item.ask[language], language):
                yield Flaw(
                    (*path, "items", i, "ask"),
                    f"it asks about one part, and is asked after each level of {form.at}: "
                    f"{quoted(item.ask[language])}",
                    "Ask about what has just been done, or ask it once, at the end",
                )


def _the_last_one(design: Design) -> Iterator[Flaw]:
    """Questions that compare with the level before, of which the first one has none."""
    within = {f.name for f in design.factors if len(f.levels) > 1 and f.order != "between"}
    for path, form in asked_forms(design):
        for i, item in enumerate(form.items if form.at in within else ()):
            language = next(
                (code for code, text in item.ask.items() if BEFORE.match(text, code)), None
            )
            titled = next(
                (code for code, text in form.title.items() if BEFORE.match(text, code)), None
            )
            if language is not None or (titled is not None and i == 0):
                place = (*path, "items", i, "ask") if language is not None else (*path, "title")
                asked = item.ask[language] if language is not None else form.title[titled or ""]
                yield Flaw(
                    place,
                    "it compares with the one before, which the first has not, and which differs "
                    f"from order to order: {quoted(asked)}",
                    f"Ask about this level of {form.at} alone; the report compares the answers",
                )
