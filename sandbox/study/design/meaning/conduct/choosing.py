"""Flaws of whom a study chooses, and of what they know before or learn between its sessions."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.design import START, Design
from sandbox.study.design.meaning.conduct.sayings import said
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import CONSENT, Phrases, quoted, told_texts
from sandbox.study.design.told.words import DENIES

INVITED = Phrases(
    {
        "en": (
            r"(invit(e|es|ed)|chosen|choose|chose|select(ed)?|pick(ed)?|recruit(ed)?|come back|"
            r"return|take part in|admitted|asked (back|to come)|belong)\b"
        ),
        "de": (
            r"(eingeladen|einlad\w*|lad(en|et) wir|laden|ausgewahlt\w*|wahl(en|ten)|ausgesucht\w*|"
            r"wiederkomm\w*|teilnehm\w*|kommen|gehoren)\b"
        ),
        "fr": (
            r"(invit\w*|choisi\w*|selectionn\w*|retenu\w*|convi\w*|revi?en\w*|reviendr\w*|"
            r"particip\w*|"
            r"faites partie)\b"
        ),
        "es": (
            r"(invit\w*|eleg\w*|elig\w*|escog\w*|seleccion\w*|convoc\w*|volver\w*|vuelv\w*|"
            r"particip\w*)\b"
        ),
    }
)
"""To be chosen for a study, or for one of its sessions."""
EXTREME = Phrases(
    {
        "en": (
            r"(slowest|fastest|worst|best|weakest|strongest|lowest|highest|poorest|top|bottom|most "
            r"(time|errors|mistakes)|fewest|least)\b"
        ),
        "de": (
            r"(langsamste|schnellste|schlechteste|beste|schwachste|starkste)\w*|(am|die) (meiste|"
            r"wenigste|langste|kurzeste)[nr]?\b"
        ),
        "fr": (
            r"(les|des|le|aux) (plus (lent|rapide|faible|fort|mauvais)\w*|moins (bons?|bonnes?|"
            r"rapides?|d'erreurs)|pires?|meilleur\w*|plus (de temps|d'erreurs))"
        ),
        "es": (
            r"(los|las|el|la) (mas (lent|rapid)\w*|peor\w*|mejor\w*)|mas (tiempo|errores)|menos "
            r"(tiempo|errores|aciertos)"
        ),
    }
)
"""Ends of a ranking."""
EARLIER = Phrases(
    {
        "en": (
            r"(in (january|february|march|april|may|june|july|august|september|october|november|"
            r"december|spring|summer|autumn|winter|an? (earlier|previous|first))|last (time|year|"
            r"month|week|spring|summer|autumn|winter|term)|earlier|previous\w*|then|pre-?test|"
            r"before|ago|in (our|the) (first|earlier|last))\b"
        ),
        "de": (
            r"(damals|im (januar|februar|marz|april|mai|juni|juli|august|september|oktober|"
            r"november|dezember|fruhjahr|fruhling|sommer|herbst|winter)|letzt\w*|fruher\w*|"
            r"vorig\w*|"
            r"beim ersten|vortest\w*|zuvor|vorher\w*)\b"
        ),
        "fr": (
            r"(alors|en (janvier|fevrier|mars|avril|mai|juin|juillet|aout|septembre|octobre|"
            r"novembre|decembre)|derni\w*|precedent\w*|anterieur\w*|auparavant|pre-?test|passee?)\b"
        ),
        "es": (
            r"(entonces|en (enero|febrero|marzo|abril|mayo|junio|julio|agosto|septiembre|octubre|"
            r"noviembre|diciembre)|anterior\w*|pasad[oa]|antes|previ[oa]s?|pretest)\b"
        ),
    }
)
COMPARED = Phrases(
    {
        "en": r"compar\w*|improv\w*|(faster|better|slower|more|less) than|gain\w*",
        "de": r"vergl(ei|i)ch\w*|verbesser\w*|(schneller|besser|langsamer) als|zuwachs|gewinn\w*",
        "fr": r"compar\w*|amelior\w*|par rapport|plus (vite|rapide) qu\w*|progr\w*",
        "es": r"compar\w*|mejora\w*|respecto a|mas rapid\w* que|progres\w*",
    }
)
"""An earlier result, and a comparison with it."""

AGAIN = Phrases(
    {
        "en": (
            r"(second|next|third|later|following|further|last) (session|visit|appointment|day|"
            r"part|meeting)\w*|invited again|session (two|three|2|3)|come back|asked back"
        ),
        "de": (
            r"(zweite|nachste|dritte|weitere|spatere|letzte)[nrms]? (sitzung|termin|besuch|tag|"
            r"treffen)\w*|zum zweiten\b|wiederkomm\w*|sitzung (zwei|2)"
        ),
        "fr": r"(deuxieme|seconde|prochaine|troisieme|derniere) (seance|session|visite)|revi?en\w*",
        "es": r"(segunda|siguiente|proxima|tercera|ultima) (sesion|visita|cita)|volver\w*|vuelv\w*",
    }
)
ONLY = Phrases(
    {
        "en": r"only|just|solely|provided|if you|if they|those who|who(ever)?\b|the best",
        "de": (
            r"nur|ausschliesslich|lediglich|wenn sie|falls sie|sofern|wer\b|diejenigen|die besten"
        ),
        "fr": (
            r"seul\w*|uniquement|que (ceux|celles|les)|si vous|ceux qui|celles qui|les meilleur\w*"
        ),
        "es": r"solo|solamente|unicamente|si (usted )?\w+|quien(es)?\b|l[oa]s que|l[oa]s mejores",
    }
)
WELL = Phrases(
    {
        "en": (
            r"(finish|succe|solv|complet|reach|manag|master|pass|score)\w*\b[^.]*\b(trials?|tasks?|"
            r"attempts?|goals?|boxes|in time|points?|at least|per ?cent)|(did|do|does|done) (very |"
            r"so )?well|(the )?(best|fastest)\b|(good|fast|quick) enough|success\w*|at least \d+ "
            r"of|slower than"
        ),
        "de": (
            r"(halfte|durchg|aufgabe|versuch|punkt|rechtzeitig|mindestens|ziel)\w*\b[^.]*\b(schaff|"
            r"los|"
            r"beend|erreich|gelung|geling|abschl|abgeschl|besteh|bestand)\w*|(besten|schnellsten|"
            r"erfolgreich\w*)\b|gut (genug )?(abgeschnitten|abschneid\w*|waren|sind)|schnell genug"
        ),
        "fr": (
            r"(reuss|termin|parv|resol|attein|fini)\w*\b[^.]*\b(essais?|taches?|a temps|points?|au "
            r"moins|buts?)|meilleur\w*|(bien|assez) (reussi|rapide\w*)|bons? resultat\w*"
        ),
        "es": (
            r"(termin|acab|consig|log|resuelv|resolv|complet|alcan|super)\w*\b[^.]*\b(ensayos?|"
            r"tareas?|intentos?|a tiempo|objetivos?|puntos?|al menos)|l[oa]s mejores|buen[oa]s? "
            r"resultado\w*|les (vaya|haya ido) bien|exito"
        ),
    }
)
"""A later session, for those alone who did well in an earlier one."""

EXPERIENCED = Phrases(
    {
        "en": (
            r"(have|has) been (using|trained|taught)|(completed|attended)\b|you know\b|(have|had|"
            r"has) (already |previously |long |often )?(taken part|trained|practi[cs]ed|"
            r"used|worked|learn(ed|t)|played)\b|(took part|trained|practi[cs]ed|worked|played|"
            r"learn(ed|t)|used)\b|already (know|knew|use|familiar)|(familiar|experienced|"
            r"experience|at home) with|know (it|them|this|that)"
        ),
        "de": (
            r"(kennen sie|sie kennen)\b|(haben|hat|hatten|habt) [^.]*\b(gearbeitet|geubt|trainiert|"
            r"benutzt|gespielt|gelernt|"
            r"kennengelernt|teilgenommen|verwendet)|(gearbeitet|geubt|trainiert|benutzt|gespielt|"
            r"gelernt|verwendet|teilgenommen) haben|(schon|bereits) (\w+ ){0,3}(kennen|kennt|"
            r"vertraut|geubt|benutzt)|vertraut (mit|sind)|erfahrung\w* mit"
        ),
        "fr": (
            r"(avez|ont|avaient) (deja |longtemps |souvent )?(travaille|pratique|utilise|appris|"
            r"joue|exerce|suivi|participe)|(connaissez|connaissent) deja|familier\w* (avec|de)|"
            r"(vous etes|etes-vous|deja) entraine\w*|experience (de|avec)"
        ),
        "es": (
            r"(ha|han|habia|habian) (ya )?(trabajado|practicado|usado|utilizado|aprendido|jugado|"
            r"participado|entrenado)|ya (\w+ )?(conoc|us|practic|ha|han)\w*|familiarizad\w*|"
            r"experiencia (con|en)|(entrenaron|practicaron|usaron|trabajaron) (con|en)"
        ),
    }
)
"""To know something from before."""
ONE_OF = Phrases(
    {
        "en": (
            r"(one|only one) of (them|these|those|the (two|three|four)|(the )?(\w+ )?(hands|ways|"
            r"methods|versions|encoders))\b"
        ),
        "de": (
            r"eine[snrm]? (davon|von ihnen|dieser|(der|von (diesen|den)) (\w+ )?(hande\w*|arten|"
            r"methoden|varianten|zuordnungen|verfahren|zwei|drei|vier|beiden))\b"
        ),
        "fr": (
            r"(l'une?|une?) (d'elles|d'entre (elles|eux)|d'eux|de(s| ces) (deux|trois|quatre|"
            r"\w+s))\b"
        ),
        "es": (
            r"un[oa] de (ell[oa]s|est[oa]s|l[oa]s (dos|tres|cuatro|man|maneras|metod|version)\w*)"
        ),
    }
)
_MARKS = "\"'“”„‚‘»«`"

PLAYS = {
    "en": r"(use (the|it|this)|play|practi[cs]e|train|try|exercise|go on|continue)\w*",
    "de": r"(\w*spiel|\w*uben|\w*ubt|trainier|\w*probier)\w*",
    "fr": r"(jou|entrain|exerc|pratiqu|continu|essay)\w*",
    "es": r"(jueg|jug|practi|practiqu|entren|ejercit|prob|prueb|siga)\w*",
}
_APART = {
    "en": (
        r"(at home|between (the |your |our )?(\w+ )?(sessions|visits|appointments)|in the "
        r"(meantime|(week|days|time) between)|until (then|we (see|meet)|next|the (next|second))|in "
        r"between)"
    ),
    "de": (
        r"(zu hause|zuhause|daheim|zwischen den (\w+ )?(sitzungen|terminen)|bis (dahin|zu[mr] "
        r"(nachsten|zweiten)|wir uns)|in der zwischenzeit|zwischendurch)"
    ),
    "fr": (
        r"(chez vous|a la maison|entre les (\w+ )?(seances|sessions|visites)|d'ici (la|a)|"
        r"entre-temps|jusqu'a (la|notre))"
    ),
    "es": (
        r"(en (su )?casa|entre (las |una y otra )?(\w+ )?(sesion\w*|visitas)|hasta (entonces|la "
        r"(proxima|segunda)|que nos)|mientras tanto)"
    ),
}
AT_HOME = Phrases(
    {
        code: rf"{plays}\b[^.]*\b{_APART[code]}|{_APART[code]}\b[^.]*\b{plays}"
        for code, plays in PLAYS.items()
    }
)
AS_LIKED = Phrases(
    {
        "en": (
            r"if you (like|want|wish|feel)|as (often|much|long|many)|whenever|(you are |feel )?"
            r"free to|you (may|can|could)|welcome to"
        ),
        "de": (
            r"wenn sie (\w+ )?(mochten|wollen|mogen|lust)|so (oft|viel|lange)|gern\w*|(konnen|"
            r"durfen) sie|sie (konnen|durfen)|jederzeit|nach belieben"
        ),
        "fr": (
            r"si vous (\w+ )?(voul|souhait|desir|en avez)\w*|autant (que|de)|aussi (souvent|"
            r"longtemps)|pouvez|librement|n'hesitez"
        ),
        "es": (
            r"si (lo |le )?(quiere|desea|apetece|gusta)|cuanto quiera|tantas veces|todo el "
            r"tiempo|puede|libremente|cuando quiera"
        ),
    }
)
"""Practice between sessions, of which everybody does as much as they like."""


def choosing_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of whom a study chooses, one line for each cause."""
    yield from _extremes(design)
    yield from _only_the_good(design)
    yield from _known_before(design)
    yield from _practised_between(design)


def _extremes(design: Design) -> Iterator[Flaw]:
    """People who are chosen by an extreme result, with which theirs are compared afterwards."""
    if any(factor.order == "between" for factor in design.factors):
        # The groups come back to their means alike.
        return
    for told, language, statement in said(design, (INVITED, EXTREME, EARLIER)):
        texts = [design.title, *(text.text[language] for text in told_texts(design))]
        if any(COMPARED.match(text, language) for text in texts):
            yield Flaw(
                told.path,
                "people are chosen by an extreme earlier result, and the next one is nearer to the "
                f"mean anyhow: {quoted(statement)}",
                'Let a group of them go on as before, with a factor of order "between", or choose '
                "by something else",
            )
            return


def _only_the_good(design: Design) -> Iterator[Flaw]:
    if design.sessions < 2:
        return
    for told, _, statement in said(design, (INVITED, AGAIN, ONLY, WELL), ()):
        yield Flaw(
            told.path,
            f"only those who did well are in the later session: {quoted(statement)}",
            "Invite everybody again",
        )
        return


def _known_before(design: Design) -> Iterator[Flaw]:
    """People who know one of the levels that are compared, and not the others."""
    levels = [
        (factor.name, level.name)
        for factor in design.factors
        for level in factor.levels
        if len(factor.levels) > 1
    ]
    for told, language, statement in said(design, (EXPERIENCED,)):
        if told.kind != CONSENT and told.at != START:
            continue
        named = {name for name in levels if _names(statement, *name)}
        alone = len({level for _, level in named}) == 1
        if alone or ONE_OF.match(statement, language):
            yield Flaw(
                told.path,
                "people know one of the compared levels from before, so that its effect cannot be "
                f"told from that of practice: {quoted(statement)}",
                "Invite people who know none of them, or let them practise the others as long",
            )
            return


def _names(statement: str, factor: str, level: str) -> bool:
    """True if a statement names a level: in quotation marks, or beside the name of its factor."""
    words, name = plain(statement), re.escape(plain(level))
    beside = re.escape(plain(factor))
    return bool(
        re.search(rf"[{_MARKS}] ?{name} ?[{_MARKS}]|\b{name} {beside}\b|\b{beside} {name}\b", words)
    )


def _practised_between(design: Design) -> Iterator[Flaw]:
    if design.sessions < 2:
        return
    for told, _, statement in said(design, (AT_HOME, AS_LIKED), (DENIES,)):
        yield Flaw(
            told.path,
            "people practise between the sessions as much as they like, so that the next one does "
            f"not measure what was kept: {quoted(statement)}",
            "Ask them not to, or give everybody the same practice",
        )
        return
