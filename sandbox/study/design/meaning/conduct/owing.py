"""Flaws of what people are owed: their rights, help, the truth, and pay that steers nobody."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from sandbox.study.design.design import END, Design
from sandbox.study.design.meaning.conduct.sayings import measures_time, said
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import (
    INSTRUCTION,
    QUESTION,
    Phrases,
    quoted,
    told_texts,
)
from sandbox.study.design.told.words import DENIES, PAID

WAIVES = Phrases(
    {
        "en": (
            r"(release[sd]?|releasing|waiv(e|es|ing)|give up|giving up|renounc(e|es|ing)|forgo|"
            r"relinquish\w*|surrender)\b[^.]*\b(rights?|claims?|liabilit\w*|legal action|sue|"
            r"lawsuits?)\b|at your own risk|cannot (make|bring|raise) (any )?claims?|hold (\w+ "
            r"){1,6}harmless|(agree|undertake|promise) not to (sue|claim)"
        ),
        "de": (
            r"auf eigene[sn]? (gefahr|risiko)|(verzicht\w*|entbind\w*|stell\w* "
            r"[^.]*frei)\b[^.]*\b(\w*recht\w*|\w*anspruch\w*|"
            r"haftung\w*|klage\w*|forderung\w*)|(\w*recht|\w*anspruch|haftung|klage|forderung)\w*\b"
            r"[^.]*\b(verzicht\w*|entbind\w*|entbunden)"
        ),
        "fr": (
            r"a vos (propres )?risques|(renonc\w*|degag\w*|decharg\w*)\b[^.]*\b(droits?|recours|"
            r"responsabilites?|"
            r"reclamations?|poursuites?|action en justice|indemnisation\w*)"
        ),
        "es": (
            r"bajo su propi[oa] (responsabilidad|riesgo)|(renunci\w*|liber\w*|exim\w*|"
            r"exoner\w*)\b[^.]*\b(derechos?|reclam\w*|"
            r"responsabilidad\w*|demandas?|accion(es)? legal\w*|indemnizacion\w*)"
        ),
    }
)
_HOUSE = {
    "en": r"(university|institut\w*|department|lab\w*|researchers?|sponsors?|we|company|team)",
    "de": r"(universitat|institut\w*|hochschule|labor|wir|versuchsleitung|firma|veranstalter\w*)",
    "fr": r"(universite|institut|laboratoire|nous|chercheurs?|equipe|entreprise)",
    "es": r"(universidad|instituto|laboratorio|investigador\w*|equipo|empresa)",
}
UNLIABLE = Phrases(
    {
        "en": (
            rf"{_HOUSE['en']}\b[^.]{{0,60}}\b(not|no|never|cannot|nor)\b[^.]{{0,25}}\b(liable|"
            r"liability|responsib\w* for (any|your|all|injur\w*|damage\w*|harm))"
        ),
        "de": (
            rf"{_HOUSE['de']}\b[^.]{{0,60}}\b(haftet|haften|ubernimmt|ubernehmen)\b[^.]{{0,40}}\b"
            rf"(nicht|kein\w*)|(haftet|haften|ubernimmt|ubernehmen) {_HOUSE['de']}\b[^.]{{0,40}}\b"
            r"(nicht|kein\w*)|haftung\b[^.]{0,60}\bausgeschlossen"
        ),
        "fr": (
            r"declin\w* toute responsabilite|(n'est|ne sont|ne sera|ne pourra\w*)\b[^.]{0,40}\b"
            r"(tenue?s? )?responsables? (de|des|en cas) (\w+ )?(dommage|blessure|accident)\w*"
        ),
        "es": (
            rf"{_HOUSE['es']}\b[^.]{{0,60}}\bno (se hac\w*|se responsabiliz\w*|asum\w*|es|son|"
            r"sera\w*)\b[^.]{0,25}(respons\w*|danos?|lesion\w*)"
        ),
    }
)
"""Rights that people are to give up, and houses that are never liable."""

HARM = Phrases(
    {
        "en": (
            r"suicid\w*|self[- ]?harm\w*|(hurt|harm|kill|injur)\w* (your|my)self|better off dead|"
            r"(thoughts? (of|about)|wish\w* (to|for)|want\w* to) (\w+ )?(dying|death|die|be dead)|"
            r"end(ing)? (your|my) (own )?life|(you|i) were dead"
        ),
        "de": (
            r"suizid\w*|selbst(mord|totung|verletz|tot)\w*|(sich|mir|mich)( selbst)? (\w+ )?"
            r"(an(zu)?tun|zu verletzen|verletzen|umzubringen|umbringen|zu toten|toten)|lieber tot|"
            r"besser tot|(ihr|mein|das) leben zu beenden|nicht mehr (zu )?leben|gedanken an den tod"
        ),
        "fr": (
            r"suicid\w*|automutil\w*|(vous|me) (faire du mal|faire mal|blesser|tuer)|envie de "
            r"mourir|(vous seriez|etre|serais) mieux mort\w*|mettre fin a (vos|mes) jours"
        ),
        "es": (
            r"suicid\w*|autolesi\w*|hacer(se|me) dano|lesionar(se|me)|matar(se|me)|quitar(se|me) "
            r"la "
            r"vida|ganas de morir|mejor muert[oa]|estar muert[oa]"
        ),
    }
)
HELP = Phrases(
    {
        "en": (
            r"help[- ]?lines?|hot ?lines?|lifeline|crisis|samaritans|emergency|counsel\w*|"
            r"psycholog\w*|psychiatr\w*|therap\w*|doctor|support (line|service|centre|center)|"
            r"(find|get|offer\w*|need|seek) (\w+ )?(help|support)|somebody to talk"
        ),
        "de": (
            r"telefonseelsorge|hilfe\w*|notruf\w*|\w*krise\w*|\w*beratung\w*|psycholog\w*|"
            r"therap\w*|\w*arzt\w*|\w*arztin"
        ),
        "fr": r"aide|ecoute|urgences?|crise|psycholog\w*|psychiatr\w*|therap\w*|medecins?|soutien",
        "es": r"ayuda|emergencias?|crisis|psicolog\w*|psiquiatr\w*|terap\w*|medic[oa]s?|apoyo",
    }
)
"""Questions about harming oneself, and where help is."""

SHARE = Phrases(
    {
        "en": (
            r"\d+ (out )?(of|in) (every )?\d+|\d+ ?(%|per ?cent)|(nearly |almost )?(all|everybody|"
            r"everyone)\b|most|(the|on) average|a majority"
        ),
        "de": (
            r"\d+ (von|der) \d+|\d+ ?(%|prozent)|(fast )?(alle|jede[rn]?)\b|die meisten|"
            r"durchschnittlich\w*|im (durchschnitt|mittel)|die mehrheit"
        ),
        "fr": r"sur (\d+|cent|dix)|\d+ ?(%|pour ?cent)|la plupart|presque tou\w*|en moyenne",
        "es": r"de cada \d+|\d+ ?(%|por ciento)|la mayoria|casi tod[oa]s|de media",
    }
)
OTHERS = Phrases(
    {
        "en": (
            r"(people|persons?|participants?|students?|adults?|users|players|men|women|children|"
            r"others|everybody|everyone)\b"
        ),
        "de": (
            r"(menschen|personen?|leute\w*|teilnehm\w*|student\w*|studierende\w*|erwachsene\w*|"
            r"kinder\w*|anderen)\b"
        ),
        "fr": r"(personnes?|gens|participants?|etudiants?|adultes?|enfants?|autres)\b",
        "es": r"(personas?|gente|participantes?|estudiantes?|adultos?|ninos|demas)\b",
    }
)
DOES = Phrases(
    {
        "en": (
            r"(finish\w*|manage\w*|reach\w*|solve\w*|complete\w*|succeed\w*|master\w*|needs?|"
            r"takes?|"
            r"did|do|does|are|is)\b[^.]*\b(trials?|tasks?|seconds?|faster|better|without (a |any )?"
            r"(mistake|error)s?|success\w*)\b"
        ),
        "de": (
            r"(schaff\w*|brauch\w*|benotig\w*|erreich\w*|losen|lost|beend\w*|meister\w*|sind)\b|"
            r"(sekunden?|durchg\w*|aufgabe\w*)\b[^.]*\b(schaff\w*|brauch\w*|los(t|en))"
        ),
        "fr": (
            r"(finiss|termin|reuss|mett|arriv|parvien|font|sont)\w*\b[^.]*\b(essais?|taches?|"
            r"secondes?|plus (vite|rapid\w*)|mieux|sans (faute|erreur))"
        ),
        "es": (
            r"(termin|acab|logr|consig|necesit|tard|resuelv|hac|son)\w*\b[^.]*\b(ensayos?|tareas?|"
            r"segundos?|mas rapid\w*|mejor\w*|sin error\w*)"
        ),
    }
)
"""How many other people do how well."""
RANKED = Phrases(
    {
        "en": (
            r"you(r (\w+ )?(results?|scores?|times?|performance))?\b[^.]*\b(are|were|is|was|lies?|"
            r"did)"
            r"\b[^.]*\b((worse|slower|better|faster) than (that of |those of )?(the )?(most|"
            r"others?|"
            r"average)|(below|above) (the )?average)"
        ),
        "de": (
            r"(unter|uber) dem (durchschnitt|mittel)|(schlechter|langsamer|besser|schneller) als "
            r"(die (der )?meisten|(die )?anderen?\b|der durchschnitt)"
        ),
        "fr": (
            r"au-des(sous|sus) de la moyenne|en dessous de la moyenne|(moins bien|moins bon\w*|"
            r"plus "
            r"lent\w*|mieux) que (la plupart|celui de|les autres)"
        ),
        "es": (
            r"por (debajo|encima) de la media|(peor|mejor|mas (lent|rapid)[oa]) que (la mayoria|"
            r"l[oa]s demas|el de)"
        ),
    }
)
"""How somebody does beside others."""
TRUTH = Phrases(
    {
        "en": (
            r"(not|never|n't) (\w+ )?(true|real|correct)|untrue|invented|made up|fictitious|false|"
            r"purpose|deceiv\w*|in (truth|fact|reality)|really|the reason (why|for)"
        ),
        "de": (
            r"nicht (\w+ )?(wahr|echt|richtig)|unwahr|erfunden\w*|ausgedacht|falsch\w*|zweck\w*|"
            r"getauscht|in wahrheit|tatsachlich|der grund"
        ),
        "fr": (
            r"(pas|n'est) vrai\w*|invente\w*|fictif\w*|faux|fausse\w*|but de|en (fait|realite|"
            r"verite)"
        ),
        "es": (
            r"no (\w+ )?(verdad|ciert|real)\w*|inventad\w*|fictici\w*|fals\w*|proposito|en "
            r"(realidad|verdad)"
        ),
    }
)
"""Texts that tell afterwards what was not true."""

ENDURED = Phrases(
    {
        "en": (
            r"grit (your )?teeth|(pain|hurt|ache|cramp)\w*\b[^.]*\b((is|are) (\w+ )?(normal|"
            r"usual|natural)\b|part of it|ignore|endure|bear it|push through|(keep|go|carry) "
            r"(on|going)|nothing to worry)|(it is (\w+ )?(normal|usual|natural)\b|ignore|endure|"
            r"push through|despite|in spite of)\b[^.]*\b(pain|hurt|ache|cramp)\w*"
        ),
        "de": (
            r"zahne zusammen|(schmerz|krampf)\w*\b[^.]*\b(normal|ublich|gehor\w*|ignor\w*|"
            r"aushalt\w*|durchhalt\w*|weiter\w*)|(normal|ublich|ignor\w*|trotz|aushalt\w*)\b[^.]*"
            r"\b(schmerz\w*|krampf\w*|weh ?(tut|tun)|wehtut)"
        ),
        "fr": (
            r"serr\w* les dents|(douleur|crampe|mal aux?)\w*\b[^.]*\b(normal\w*|habituel\w*|"
            r"ignor\w*|support\w*|continu\w*)|(normal\w*|ignor\w*|malgre|support\w*)\b[^.]*\b"
            r"(douleur\w*|crampe\w*|mal aux?|fasse mal)"
        ),
        "es": (
            r"apriet\w* los dientes|(dolor|calambre|duel)\w*\b[^.]*\b(normal\w*|habitual\w*|"
            r"ignor\w*|aguant\w*|sig[au]\w*|continu\w*)|(normal\w*|ignor\w*|aguant\w*|a pesar)"
            r"\b[^.]*\b(dolor\w*|calambre\w*|duel\w*)"
        ),
    }
)
MAY_STOP = Phrases(
    {
        "en": (
            r"stop|tell|say so|let us know|inform|call|not (go|carry|keep|continue|bear|endure|"
            r"ignore)|don't|never|break off|rest\b|without pain|pain-?free|painless"
        ),
        "de": (
            r"horen sie|aufhor\w*|abbrech\w*|brechen sie|sagen|melden|rufen|nicht (weiter|"
            r"aushalt|ignor)\w*|nie\b|unterbrech\w*|schmerzfrei|ohne schmerz\w*"
        ),
        "fr": r"arret\w*|dites|signal\w*|prevenez|appel\w*|ne (continu|support|ignor)\w*|sans",
        "es": r"par[ae]\b|detenga\w*|diga\w*|avis\w*|llam\w*|no (sig|continu|aguant|ignor)\w*|sin",
    }
)
"""Pain that people are to bear, and what they may do about it."""

BY_TIME = Phrases(
    {
        "en": (
            r"(grows?|rises?|increases?) with the time|(per|for (each|every)) \d+ seconds|"
            r"(per|(for )?(each|every)) (\w+ )?minutes?\b|(per|for (each|every)) second\b(?! "
            r"(session|"
            r"visit|trial|part|day))|a minute\b|by the (minute|second)\b|the longer you|the more "
            r"time"
        ),
        "de": r"(pro|je|(fur )?jede) (\w+ )?(minute|sekunde)\b|minutenweise|nach minuten|je langer",
        "fr": (
            r"(par|(pour )?chaque|a la) minute\b|par seconde\b|plus (vous|longtemps)\b[^.]*\bplus"
        ),
        "es": (
            r"(por|(por )?cada|al) minuto\b|por (cada )?segundo\b(?! (dia|sesion|ensayo|bloque))|"
            r"cuanto mas (tard|tiempo)\w*"
        ),
    }
)
"""Pay by the time that somebody takes."""


def owing_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of what people are owed, one line for each cause."""
    yield from _rights(design)
    yield from _endured(design)
    yield from _without_help(design)
    yield from _deceived(design)
    yield from _paid_for_time(design)


def _rights(design: Design) -> Iterator[Flaw]:
    for phrases, unless in ((WAIVES, (DENIES,)), (UNLIABLE, ())):
        for told, _, statement in said(design, (phrases,), unless):
            yield Flaw(
                told.path,
                f"nobody may be made to give up rights by taking part: {quoted(statement)}",
                "Remove it; say who pays if something happens",
            )
            return


def _endured(design: Design) -> Iterator[Flaw]:
    for told, _, statement in said(design, (ENDURED,), (MAY_STOP, DENIES)):
        yield Flaw(
            told.path,
            f"people are told to bear pain: {quoted(statement)}",
            "Tell them to stop when something hurts, and to say so",
        )
        return


def _without_help(design: Design) -> Iterator[Flaw]:
    for told, language, statement in said(design, (HARM,), (), (QUESTION,)):
        texts = [text.text[language] for text in told_texts(design)]
        if not any(HELP.match(text, language) for text in texts):
            yield Flaw(
                told.path,
                "it asks whether somebody harms themselves, and no text names help: "
                f"{quoted(statement)}",
                'Name a helpline and a person in a text at = "end", and let somebody read the '
                "answers at once; or remove the question",
            )
            return


def _deceived(design: Design) -> Iterator[Flaw]:
    ends = [t for t in told_texts(design) if t.kind == INSTRUCTION and t.at == END]
    # A consent may say how long a session takes most people.
    every = ((SHARE, OTHERS, DOES), (RANKED,))
    for told, language, statement in chain.from_iterable(
        said(design, all_of, (DENIES,), (INSTRUCTION,)) for all_of in every
    ):
        if told.at != END and not any(TRUTH.match(text.text[language], language) for text in ends):
            yield Flaw(
                told.path,
                "people are told how well others do, and nobody tells them at the end what is true "
                f"of it: {quoted(statement)}",
                'Remove it, or tell them with at = "end" if it was untrue, and why it was said',
            )
            return


def _paid_for_time(design: Design) -> Iterator[Flaw]:
    if not measures_time(design):
        return
    for told, _, statement in said(design, (PAID, BY_TIME)):
        yield Flaw(
            told.path,
            f"who is slow is paid more, and time is an outcome: {quoted(statement)}",
            "Pay everybody the same, or by the appointment",
        )
        return
