"""Flaws of what people are taught: nobody forgets it again, and it comes before what it is for."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.conditions import sets_nothing
from sandbox.study.design.design import START, Design, Factor, Instruction
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import Phrases, quoted, sentences

TAUGHT = re.compile(
    r"(?<!\w)(?:teach\w*|taught|train(?:ed|ing)|tuition|coach\w*|tutorials?|instruct\w*|lessons?|"
    r"learn(?:ed|t|ing)|strateg\w*|explain\w*|explanations?|demonstrat\w*|demo|knowledge|knows?|"
    r"informed|told|videos?|films?|instruiert\w*|informiert\w*|tips?|hints?|advice|advised|"
    r"trick\w*|schulung\w*|geschult\w*|anleitung\w*|angeleitet\w*|unterweis\w*|unterwiesen\w*|"
    r"unterricht\w*|einweis\w*|eingewiesen\w*|trainiert\w*|gelernt\w*|erklart\w*|erklarung\w*|"
    r"tipps?|hinweise?|wissen\w*|formation|forme\w*|apprentissage|appris\w*|enseign\w*|entraine\w*|"
    r"explication\w*|explique\w*|consignes?|astuces?|conseils?|ensen\w*|entrenamiento|entrenad\w*|"
    r"formacion|instruccion\w*|instruid\w*|explicacion\w*|explicad\w*|consejos?|trucos?|"
    r"addestra\w*|insegna\w*|istru\w*|formazione|spiegazion\w*|consigli\w*|uitleg|instructie\w*|"
    r"geinstrueerd\w*|getraind\w*|onderwijs|onderwezen|advies|ensino|ensinad\w*|trein\w*|"
    r"instruc\w*|dicas?)(?!\w)|教|训练|培训|讲解|指導|訓練|教示|تعليم|تدريب"
)
"""Names of factors and levels of which people know more afterwards."""
UNTAUGHT = re.compile(
    r"(?<!\w)(?:untaught|untrained|uninstructed|uninformed|unadvised|untold|unaware|naive|none|no|"
    r"not|without|control|off|free|self|before|baseline|spontaneous|ohne|kein\w*|nicht|"
    r"un(?:geschult|trainiert|gelernt|angeleitet|wissend)\w*|naiv|kontrolle|frei|spontan\w*|vorher|"
    r"sans|aucun\w*|non|naif|naive|temoin|libre|avant|sin|ningun\w*|ingenuo|control|senza|"
    r"nessun\w*|libero|zonder|geen|niet|ongetraind\w*|vrij|controle|sem|nenhum\w*|livre)(?!\w)|无|"
    r"未|没有|なし|بدون"
)
"""Names of levels without it."""
FREELY = Phrases(
    {
        "en": (
            r"(in )?(whatever|any) way|as you (like|please|wish|want|prefer|see fit)|however you|"
            r"in your own way|no (right or wrong|particular|special) way|comes? (naturally )?to "
            r"you|(find|work) (it )?out (for )?yourself"
        ),
        "de": (
            r"(so )?wie (sie|du) (\w+ )?(mochten|wollen|mogen|wunschen|mochtest|willst)|wie es "
            r"ihnen|auf (ihre|deine) (eigene )?(art|weise)|beliebig\w*|nach belieben|ganz frei|"
            r"frei wahlen|keine (richtige|besondere|bestimmte)|wie es ihnen|ganz nach (ihrem "
            r")?(gefuhl|geschmack)"
        ),
        "fr": (
            r"comme (vous|tu) (\w+ )?(voul|prefer|souhait|voud|veu)\w*|a votre (maniere|facon|"
            r"guise)|librement|comme (il|cela) vous|n'importe comment|pas de bonne|comme bon vous|"
            r"a votre gre"
        ),
        "es": (
            r"como (\w+ )?(quiera|prefiera|desee|guste|quieras|prefieras)\w*|a su (manera|modo)|"
            r"libremente|de cualquier (manera|modo|forma)|no hay una (manera|forma)"
        ),
        "it": (
            r"come (\w+ )?(vuole|preferisce|desidera|crede)|a modo suo|liberamente|in qualsiasi "
            r"modo"
        ),
        "nl": r"zoals (u|je) (\w+ )?(wilt|wil|prettig)|op (uw|je) eigen (manier|wijze)|vrij om",
        "pt": (
            r"como (\w+ )?(quiser|preferir|desejar)|a sua maneira|livremente|de qualquer (modo|"
            r"forma)"
        ),
        "zh": r"随意|任意|自由|按(您|你)自己的",
        "ja": r"自由に|好きなように|お好きな",
    }
)
"""Texts that leave it to people in which way they do something."""
TECHNIQUE = Phrases(
    {
        "en": (
            r"thumbs?|fingers?|fingertips?|grip\w*|grasp\w*|hold|pinch\w*|technique|tricks?|"
            r"strateg\w*|hints?|tips?|from (the side|above|below|behind)|edges?|corners?|shown|"
            r"taught|learn\w*"
        ),
        "de": (
            r"daumen|\w*finger\w*|\w*griff\w*|greif\w*|halten|fass\w*|technik|tricks?|tipps?|"
            r"strategie\w*|von der seite|von oben|kante\w*|ecke\w*|gezeigt|gelernt|anleitung"
        ),
        "fr": (
            r"pouce|index|doigts?|prise|ten(ez|ir)|saisi\w*|pinc\w*|technique|astuce|strategie|"
            r"conseil|bords?|montre\w*|enseign\w*"
        ),
        "es": (
            r"pulgar|indice|dedos?|agarr\w*|sujet\w*|pinz\w*|tecnica|truco|estrategia|consejo|"
            r"bordes?|ensen\w*|mostrad\w*"
        ),
        "it": (
            r"pollice|indice|dita|presa|afferr\w*|teng\w*|tecnica|trucco|strategia|consiglio|"
            r"bord\w*"
        ),
        "nl": (
            r"duim|\w*vinger\w*|greep|grijp\w*|vasthoud\w*|houd|techniek|truc|strategie|tip|rand\w*"
        ),
        "pt": r"polegar|indicador|dedos?|pega\w*|segur\w*|tecnica|truque|estrategia|conselho|dica",
        "zh": r"拇指|食指|手指|抓|握|捏|技巧|方法",
        "ja": r"親指|人差し指|指|つかん|握|つまん|コツ|方法",
    }
)
"""Texts that say how to do it."""
CONTROLS = Phrases(
    {
        "en": (
            r"how (to|you (can )?|the hand )(control|move|grasp|grip|release|operate|use|works?|"
            r"follows?|pick|lift|hold)|this is how|works (like|as) (this|follows)|in order to "
            r"(grasp|release|control|let go|pick|lift)|to (control|grasp|release|let go|close|open|"
            r"pick up|grip)\b|(place|put|rest) [^.]*(fingers?|thumb|hand)|(hand|palm) (follows|"
            r"closes|opens|copies)|(bring|move|spread) (your|the) (fingers|thumb)"
        ),
        "de": (
            r"so (steuer|beweg|bedien|greif|funktionier|geht)\w*|wie (sie|man|die hand|du) "
            r"[^.]*(steuer|greif|bedien|beweg|funktionier)\w*|(legen|setzen) sie [^.]*(finger|"
            r"daumen|hand)|hand (folgt|schliesst|offnet)|zum (greifen|loslassen|steuern)|um (zu "
            r"greifen|loszulassen|die hand)|(finger|daumen) (zusammen|auseinander)|hand (zu|"
            r"auf)zumachen|hand (zu )?(schliessen|offnen)"
        ),
        "fr": (
            r"comment|posez [^.]*(doigt|pouce|main)|la main (vous )?(suit|se ferme|s'ouvre)|pour "
            r"(lacher|saisir|commander|attraper|prendre|relacher)|(rapproch|ecart)\w+ (les|vos) "
            r"doigts|(fermer|ouvrir) la main"
        ),
        "es": (
            r"asi se|como (se |puede )?(manej|control|mov|muev|us|agarr|funcion)\w*|pon(ga|gan)? "
            r"[^.]*(dedo|pulgar|mano)|la mano (le |les |lo )?(sigue|se cierra|se abre)|para "
            r"(soltar|agarrar|coger|manejar|mover)|(junt|separ|acer)\w+ [^.]*dedos|(cerrar|abrir) "
            r"la mano"
        ),
        "it": (
            r"(cosi|come) (si|puo) \w+|(metta|appoggi|posi) [^.]*(dita|pollice|mano)|la mano (la "
            r")?(segue|si chiude|si apre)|per (lasciare|afferrare|muovere)"
        ),
        "nl": (
            r"(zo|hoe) (bestuur|beweeg|werk|pak|gebruik)\w*|leg [^.]*(vinger|duim|hand)|de hand "
            r"(volgt|sluit|opent)|om (te pakken|los te laten|te bewegen)"
        ),
        "pt": (
            r"(assim|como) (se|pode|controlar|mover|usar)|ponha [^.]*(dedo|polegar|mao)|a mao "
            r"(segue|fecha|abre)|para (soltar|agarrar|pegar|mover)"
        ),
        "zh": r"(如何|怎么|怎样)(控制|移动|抓|操作|使用)|把[^。]*(手指|手)放|手会(跟随|张开|合)",
        "ja": r"(操作|動かし|つかみ|使い)(方|かた)|指を[^。]*(置|乗せ)|手(は|が)[^。]*(動|閉|開)",
    }
)
"""Texts that explain how the hand is controlled."""


def carry_over(design: Design) -> list[tuple[Factor, str, str]]:
    """Factors of being taught that vary within people, with a level without it and one with it.

    What somebody has been taught or told is not forgotten before the next level, so no order
    balances it.
    """
    return [
        (factor, *levels)
        for factor in design.factors
        if factor.order != "between"
        and len(factor.levels) > 1
        and (levels := _by_names(design, factor) or _by_texts(design, factor))
    ]


def teaching_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of what people are taught."""
    for factor, without, taught in carry_over(design):
        yield Flaw(
            ("factors", design.factors.index(factor), "order"),
            f"who has been through {taught} knows it in {without}, too, and no order balances that",
            'Write order = "between", so that each person has one level',
        )
    yield from _too_late(design)


def _told_at(design: Design, factor: Factor) -> dict[str, Instruction]:
    return {text.level: text for text in design.instructions if text.at == factor.name}


def _by_names(design: Design, factor: Factor) -> tuple[str, str] | None:
    """A level that is named as untaught, and another one, if this is done by words."""
    texts = [text for level, text in _told_at(design, factor).items() if level]
    if not texts and not sets_nothing(design, factor):
        return None
    called = {
        level.name: plain(level.name).replace("-", " ").replace("_", " ") for level in factor.levels
    }
    without = next((name for name, words in called.items() if UNTAUGHT.search(words)), None)
    if without is None:
        return None
    rest = [name for name in called if name != without]
    named = plain(factor.name).replace("-", " ").replace("_", " ")
    if TAUGHT.search(named) or any(TAUGHT.search(called[name]) for name in rest):
        return without, rest[0]
    return None


def _by_texts(design: Design, factor: Factor) -> tuple[str, str] | None:
    """A level before which people may do as they like, and one before which they are told how."""
    texts = _told_at(design, factor)
    for language in design.languages:
        free = [
            level
            for level, told in texts.items()
            if level and FREELY.match(told.text[language], language)
        ]
        taught = [
            level
            for level, told in texts.items()
            if level and level not in free and TECHNIQUE.match(told.text[language], language)
        ]
        if free and taught:
            return free[0], taught[0]
    return None


def _too_late(design: Design) -> Iterator[Flaw]:
    """The first explanation comes in a later session than the first trial."""
    first = [text for text in design.instructions if 1 in (text.sessions or (1,))]
    told = [text for text in first if text.at != "end"]
    for i, text in enumerate(design.instructions):
        if text.at != START or 1 in (text.sessions or (1,)):
            continue
        for language in design.languages:
            explains = [s for s in sentences(text.text[language]) if CONTROLS.match(s, language)]
            before = any(CONTROLS.match(t.text[language], language) for t in told)
            if (explains and not before) or not told:
                said = explains[0] if explains else sentences(text.text[language])[0]
                yield Flaw(
                    ("instructions", i, "sessions"),
                    f"people are told only in session {min(text.sessions)} what they need in the "
                    f"first: {quoted(said)}",
                    "Remove `sessions`, or add 1",
                )
                return
