"""Flaws of what people do during a study, beside moving things."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.conditions import combinations, values_of
from sandbox.study.design.design import END, Design
from sandbox.study.design.meaning.conduct.sayings import measures_time, measures_trials, said
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import INSTRUCTION, Phrases, quoted
from sandbox.study.design.told.words import DENIES, LEADER, PRACTICE

ALOUD = Phrases(
    {
        "en": (
            r"(think|thinking) (out )?(loud|aloud)|keep (on )?(talking|speaking)|(say|speak|talk|"
            r"tell|comment|describe|explain|"
            r"report|verbali[sz]e)\w*\b[^.]*\b(aloud|out loud|what (you are|you're|you) (\w+ )?"
            r"(think|do|plan|try|feel)\w*|(your|all) thoughts|why you|what goes through)"
        ),
        "de": (
            r"(kommentier|erlauter)\w*\b[^.]*\b(schritt|bewegung|vorgehen)\w*|"
            r"(denk\w*|sprech\w*|sag\w*|kommentier\w*|beschreib\w*|erklar\w*|erzahl\w*|"
            r"berichte\w*)\b[^.]*\b(laut\b|was sie (\w+ )?(denk|tun|mach|vorhab|plan)\w*|gedanken|"
            r"was ihnen (\w+ )?durch)|laut(es)? (zu )?denken"
        ),
        "fr": (
            r"(pens\w*|parl\w*|dites|dire|comment\w*|decri\w*|expliqu\w*|verbalis\w*|enonc\w*)\b"
            r"[^.]*\b(a (voix haute|haute voix)|tout haut|ce que vous (\w+ )?(pens|fait|faites)\w*|"
            r"vos pensees|ce qui vous passe)"
        ),
        "es": (
            r"(piens\w*|pens\w*|diciendo|habl\w*|diga\w*|decir|coment\w*|describ\w*|expli\w*|"
            r"verbali\w*)\b"
            r"[^.]*\b(en voz alta|lo que (\w+ )?(piens|hac|esta)\w*|sus pensamientos|que piensa)"
        ),
    }
)
WHILE = Phrases(
    {
        "en": (
            r"while|during|as you (move|play|work|do|go)|in (each|every) trial|throughout|all the "
            r"time|all along|continuous\w*|constantly|meanwhile|at the same time|think(ing)? (out "
            r")?(loud|aloud)"
        ),
        "de": (
            r"wahrend\w*|dabei|(in|bei) jedem|fortlaufend|standig|die ganze zeit|durchgehend|"
            r"gleichzeitig|bei (der|den) (aufgabe|durchg|arbeit)\w*|laut(es)? (zu )?denken|denken "
            r"sie (\w+ )?laut"
        ),
        "fr": (
            r"pendant|durant|en (meme temps|jouant|travaillant|deplacant|continu)|(a|dans) chaque "
            r"essai|tout au long|constamment|sans arret|pensez (a voix haute|tout haut)"
        ),
        "es": (
            r"mientras|durante|en cada ensayo|al mismo tiempo|todo el tiempo|continuamente|"
            r"constantemente|piense en voz alta|a la vez"
        ),
    }
)
"""To say what one thinks, and to do so while something else is done."""
AFTER = Phrases(
    {
        "en": r"after\w*|then|between|at the end|later",
        "de": r"nach\w*|danach|hinterher|zwischen|am ende|spater",
        "fr": r"apres|ensuite|entre|a la fin|plus tard",
        "es": r"despues|luego|entre|al final|mas tarde",
    }
)

TRIAL = Phrases(
    {
        "en": r"trials?|tasks?|attempts?|box(es)?|rounds?",
        "de": r"durchg\w*|durchl\w*|aufgabe\w*|versuch\w*|runde\w*",
        "fr": r"essais?|taches?|tentatives?|manches?",
        "es": r"ensayos?|tareas?|intentos?|pruebas?|rondas?",
    }
)
SKIPS = Phrases(
    {
        "en": (
            r"skip(s|ped|ping)?\b|(leave|leaving) (it|this one|that one|them|any|a|the|some)\b"
            r"[^.]*\bout|(is|are|be) (left out|passed over|omitted)|(go|move) (straight )?on to "
            r"the "
            r"next"
        ),
        "de": (
            r"ubersprung\w*|uberspring\w*|auslassen|ausgelassen|weglassen|weggelassen|(lassen|"
            r"lass) "
            r"(wir|sie) [^.]*\b(aus|weg)\b"
        ),
        "fr": r"saut(er|ons|ez|e|era|erons|erez)\b|passe(r|z|rons|ons)? (directement )?au suivant",
        "es": (r"salt(ar\w*|amos|e|a|aremos|emos)\b|pas(ar|amos|aremos) al siguiente"),
    }
)
HARD = Phrases(
    {
        "en": (
            r"(too|very|so) (hard|difficult|long|tiring|tedious|annoying|boring|complicated)|(do "
            r"not|don't|no longer) (want|like|feel like|manage|succeed)|give up|takes? too|as "
            r"(many|"
            r"often) as you|if you (like|want|wish|prefer)|at will"
        ),
        "de": (
            r"nicht gefallt|zu (schwer|schwierig|lang\w*|anstrengend|muhsam|kompliziert)|nicht "
            r"(mochten|wollen|"
            r"mogen|schaffen|gelingt|weiterkommen)|keine lust|nach belieben|wenn sie (mochten|"
            r"wollen)|so (viele|oft)"
        ),
        "fr": (
            r"trop (\w+ ou )?(difficile|dur|long|penible|complique)\w*|(pas|plus) (envie|vouloir|y "
            r"arriver)|n'y arriv\w* pas|autant|si vous (le )?(voulez|souhaitez|preferez)"
        ),
        "es": (
            r"(demasiado|muy|resulta|parece) (dificil|larg[oa]|dur[oa]|complicad[oa]|pesad[oa])|no "
            r"(quier|le "
            r"apetec|consig|logr)\w*|cuantos quiera|si (lo )?(quiere|desea|prefiere)"
        ),
    }
)
"""Trials that are left out because somebody finds them hard."""
UNSKIPPED = Phrases(
    {
        "en": (
            r"(not|never|n't) (be )?(skip|leave|left|omit)\w*|no (trial|task)s?\b|questions?|"
            r"answers?|practi\w*"
        ),
        "de": r"(nicht|nichts|nie|kein\w*) (\w+ )?(uberspr|ausl|ausg|wegl)\w*|frage\w*|ubung\w*",
        "fr": r"ne (le |la |les |pas )?(saut|pass)\w*|questions?|reponses?|entrain\w*",
        "es": r"no (se |lo |la |los |las |puede |debe )*salt\w*|preguntas?|respuestas?|practi\w*",
    }
)

WATCHES = Phrases(
    {
        "en": (
            r"watch(es|ing)?\b|see (how|what) the others|see each other|looks? on\b|looking on\b|"
            r"look over|observ(e|es|ing)\b"
        ),
        "de": (
            r"zuschau\w*|zuseh\w*|zusieht|zuschaut|beobacht\w*|(schau|sieh|seh)(t|en|en sie)\b[^.]*"
            r"\bzu\b"
        ),
        "fr": r"regard(e|er|ez|ent|era|erez)\b|observ(e|er|ez|ent|era|erez)\b|assist(e|er|ez) a",
        "es": r"mir(a|ar|e|an|ara|aran)\b|observ(a|ar|e|an|ara|aran)\b|contempl\w*",
    }
)
COMPANIONS = Phrases(
    {
        "en": (
            r"the others (do|play|work|take)|(the|an|each) ?other (person|participant|player|"
            r"student|volunteer)s?|each other|one "
            r"another|(first|second|next|previous) (person|participant|player|student)|one of you|"
            r"your (partner|friend|colleague|classmate|companion|sibling)|(participants?|people) "
            r"(before|after) you"
        ),
        "de": (
            r"(die|der|den|dem|eine?[nmr]?) (andere|zweite|nachste|vorige|erste)[nmr]? (person|"
            r"teilnehm|versuchsperson|spieler|student|proband)\w*|einander|gegenseitig|ein[er]? "
            r"von "
            r"ihnen|ihre?[nmr]? (partner|freund|kolleg|nachbar)\w*"
        ),
        "fr": (
            r"les autres (participant|personne|joueu)\w*|(l'|une? )autre (personne|participant|"
            r"joueu|etudiant)\w*|l'une? (de vous|l'autre)|"
            r"mutuellement|(votre|un|une) (partenaire|camarade|ami|amie|collegue)\b|"
            r"(participant|personne)\w* (suivant|precedent)\w*"
        ),
        "es": (
            r"l[oa]s (demas|otr[oa]s) (participantes|personas|jugadores)|"
            r"(la |el )?(otr[oa]|siguiente|anterior) (persona|participante|jugador|estudiante)\w*|"
            r"un[oa] de (ustedes|vosotros)|mutuamente|(su|un|una) (companer|pareja|amig)\w*|entre "
            r"si\b"
        ),
    }
)
"""Participants who look on while another one takes part."""

RATES = Phrases(
    {
        "en": (
            r"(experimenter|researcher|developer|engineer)\b[^.]*\basks you\b[^.]*\bwrites? down|"
            r"(say|tell|call|read|speak|state|report|give|name|answer)\w*\b[^.]*\b(ratings?|"
            r"answers?"
            r"|scores?|marks?|questionnaires?|questions)\b[^.]*\b(aloud|out loud|orally|to (the|"
            r"our|"
            r"your) (\w+ )?(experimenter|researcher|developer|engineer|inventor|designer|"
            r"investigator|assistant|author))|(experimenter|researcher|developer|engineer|inventor|"
            r"designer|investigator|assistant|author)s?\b[^.]*\b(enters?|writes? down|notes?( "
            r"down)?"
            r"|fills? in|types?|asks? (you )?for) [^.]*\b(ratings?|answers?|scores?|marks?)"
        ),
        "de": (
            r"(bewertung|antwort|urteil)\w*\b[^.]*\b(nennen|sagen) sie\b[^.]*\b(laut\b|(dem|der) "
            r"(versuchsleit|entwickl|ingenieur|forsch)\w*)|"
            r"(sag|nenn|teil|sprech|beantwort)\w*\b[^.]*\b(bewertung|antwort|wert|note|urteil|"
            r"frage|"
            r"einschatzung)\w*[^.]*\b(laut\b|mundlich|(der|dem|unser\w*) (versuchsleit|entwickl|"
            r"ingenieur|erfind|forsch|betreu)\w*)|(versuchsleit|entwickler|ingenieur|erfinder|"
            r"forscher|betreuer)\w*[^.]*\b(tragt|notiert|schreibt|erfragt|fragt|gibt|"
            r"tippt)\b[^.]*\b"
            r"(antwort|bewertung|wert|urteil|note|einschatzung)\w*"
        ),
        "fr": (
            r"(dites|dire|donnez|repondez|annoncez|enoncez|indiquez|communiquez)\b[^.]*\b(notes?|"
            r"reponses?|evaluations?|avis|scores?|questions?)\b[^.]*\b(a (voix haute|haute voix)|"
            r"oralement|(a l'|au |a la |a notre )(experimentat|ingenieur|assistant|chercheu|"
            r"developpeu|concept)\w*)|(experimentat|ingenieur|developpeu|concepteu|"
            r"chercheu)\w*[^.]*"
            r"\b(note|saisit|inscrit|entre|demande)\b[^.]*\b(reponses?|notes|evaluations?|avis)"
        ),
        "es": (
            r"(diga|decir|responda|de|comunique|indique)\b[^.]*\b(respuestas?|puntuacion\w*|"
            r"valoracion\w*|notas?|preguntas)\b[^.]*\b(en voz alta|oralmente|(al|a la|a "
            r"nuestr[oa]) "
            r"(investigador|desarrollador|ingenier|experimentador|disenador)\w*)|(investigador|"
            r"desarrollador|ingenier|experimentador|disenador)\w*[^.]*\b(anota|escribe|introduce|"
            r"apunta|pide|teclea)\b[^.]*\b(respuestas?|puntuacion\w*|valoracion\w*)"
        ),
    }
)
"""Answers that people give to somebody's face."""


def during_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of what people do, one line for each cause."""
    yield from _thinking_aloud(design)
    yield from _skipped(design)
    yield from _watching(design)
    yield from _rated_aloud(design)


def _thinking_aloud(design: Design) -> Iterator[Flaw]:
    if not measures_time(design):
        return
    none_of = (DENIES, AFTER, PRACTICE)
    for told, _, statement in said(design, (ALOUD, WHILE), none_of, (INSTRUCTION,)):
        if told.at != END:
            yield Flaw(
                told.path,
                f"people talk while their time is measured, which is a second task: "
                f"{quoted(statement)}",
                "Ask for it after the trials, or in trials of their own that do not count",
            )
            return


def _skipped(design: Design) -> Iterator[Flaw]:
    if not measures_trials(design):
        return
    for told, _, statement in said(design, (TRIAL, SKIPS, HARD), (UNSKIPPED,)):
        yield Flaw(
            told.path,
            "who finds a trial hard has it left out, so that the harder level keeps its easy "
            f"trials: {quoted(statement)}",
            "Let the time limit end such trials, and count them as failed",
        )
        return


def _watching(design: Design) -> Iterator[Flaw]:
    every = (values_of(design, levels) for levels in combinations(design))
    if any("second_device" in values for values in every):
        # Two people move one thing together.
        return
    for told, _, statement in said(design, (WATCHES, COMPANIONS), (DENIES, LEADER)):
        if told.at != END:
            yield Flaw(
                told.path,
                "people see how others do it, so that they are not independent and learn of other "
                f"levels: {quoted(statement)}",
                "Let everybody take part alone",
            )
            return


def _rated_aloud(design: Design) -> Iterator[Flaw]:
    if not any(item.kind == "scale" for form in design.questionnaires for item in form.items):
        return
    for told, _, statement in said(design, (RATES,)):
        yield Flaw(
            told.path,
            f"people rate to somebody's face, and then answer what pleases: {quoted(statement)}",
            "Let them answer on the page, with nobody beside them who sees it",
        )
        return
