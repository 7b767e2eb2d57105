"""Flaws of levels that are properties of people, which nobody can assign to them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.conditions import sets_nothing
from sandbox.study.design.design import Design, Factor
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain

TRAITS = re.compile(
    r"(?<!\w)(?:age|ages|age ?groups?|experience|education|culture|cohorts?|erfahrung|bildung|"
    r"kultur|kohorten?|experiencia|educacion|cultura|esperienza|ervaring|generation|gender|sex|"
    r"handedness|expertise|profession|occupation|nationality|ethnicity|diagnosis|disease|"
    r"disability|impairment|personality|alter|altersgruppen?|geschlecht|handigkeit|berufe?|"
    r"nationalitat|krankheit|diagnose|personlichkeit|tranche d age|groupe d age|sexe|genre|"
    r"lateralite|metier|maladie|edad|grupo de edad|grupos de edad|sexo|genero|lateralidad|"
    r"profesion|enfermedad|eta|fascia d eta|sesso|genere|leeftijd|leeftijdsgroep|geslacht|"
    r"handvoorkeur|idade|faixa etaria)(?!\w)|年龄|性别|年齢|性別|العمر|الجنس"
)
"""Names of factors that are properties of people."""

_YEAR = r"(?:years?|jahre?|ans|anos|anni|jaar)"
_YEARS = rf"\d{{2}} (?:to |bis |a |tot )?\d{{2}}(?: {_YEAR})?|\d{{2}} ?{_YEAR}"
KINDS = tuple(
    re.compile(rf"(?:{words})$")
    for words in (
        r"(?:the )?(?:young\w*|youths?|old(?:er)?|elderly|seniors?|aged|adults?|children|kids|"
        r"teens?|teenagers|over \d+|under \d+|below \d+|above \d+|jung\w*|alt|alte|altere\w*|"
        r"senior\w*|kinder|erwachsene\w*|jugendliche\w*|jeunes?|agee?s?|vieux|aines|enfants?|"
        r"adultes?|jovenes?|joven|mayores|ancianos|adultos|ninos|giovani|anziani|adulti|bambini|"
        r"jong\w*|oud|oude|ouderen|kinderen|volwassenen|jovens|idosos|criancas)(?: (?:adults?|"
        r"people|persons?|group|"
        rf"participants?|erwachsene|personen|menschen|adultes|adultos|adulti))?|{_YEARS}|"
        r"老年人?|年轻人?|青年人?|若年者?|高齢者?|儿童|成人|شباب|كبار السن",
        r"males?|females?|men|women|man|woman|boys|girls|m|f|w|manner|frauen|mannlich|weiblich|"
        r"jungen|madchen|hommes?|femmes?|garcons|filles|hombres?|mujeres|mujer|chicos|chicas|"
        r"uomini|donne|"
        r"mannen|vrouwen|homens|mulheres|男性?|女性?|ذكور|إناث",
        r"(?:left|right)[ -]?hand(?:ed|ers?)(?: people)?|(?:links|rechts)hander\w*|gauchers?|"
        r"droitiers?|zurdos?|diestros?|mancini|destrimani|destrorsi|(?:links|rechts)handig\w*|"
        r"canhotos|destros|左利き|右利き",
        r"novices?|experts?|beginners?|lay ?people|professionals?|experienced|inexperienced|"
        r"amateurs?|anfanger\w*|experten|expertinnen|laien|profis?|erfahrene?|unerfahrene?|"
        r"debutants?|confirmes?|novatos?|expertos?|principiantes|profesionales|esperti|"
        r"principianti|"
        r"gevorderden|experten|leken|iniciantes|especialistas|新手|专家|初心者|専門家",
        r"retire\w+|pensioners|(?:un)?employed|workers|employees|students?|school|university|"
        r"rentner\w*|studierende|studenten|schuler\w*|berufstatige|retraites?|etudiants?|salaries|"
        r"jubilados?|"
        r"estudiantes|pensionati|studenti|gepensioneerden|scholieren",
        r"(?:no|non|without|ohne|sans|sin|mit|with|avec|con)? ?(?:glasses|brille|lunettes|gafas)",
        r"(?:non|nicht|no|not)?[ -]?(?:musicians?|gamers?|patients?|surgeons?|dancers?|athletes?|"
        r"smokers?|musiker\w*|patient\w*|spieler\w*|chirurg\w*|musicien\w*|joueur\w*|pacientes?|"
        r"musicos?|jugadores|pazienti|musicisti|patienten|muzikanten|students?|studierende|"
        r"etudiants?|estudiantes)|healthy(?: \w+)?|controls?|control group|kontrollgruppe|"
        r"gesunde\w*|sains?|"
        r"sanos|sani|gezonde|kontrollen",
    )
)
"""Names of levels that are people of one kind, without accents."""


def assigned_traits(design: Design) -> list[Factor]:
    """Factors whose levels are properties of people."""
    return [
        factor for factor in design.factors if len(factor.levels) > 1 and _is_trait(design, factor)
    ]


def group_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of factors that would assign people a property."""
    traits = assigned_traits(design)
    for i, factor in enumerate(design.factors):
        if factor in traits:
            names = ", ".join(level.name for level in factor.levels)
            yield Flaw(
                ("factors", i, "levels"),
                f"{factor.name} is a property of people ({names}), and the program would assign it "
                "to them by their number",
                "Remove the factor, and ask for it in [[demographics]]; or make a design for each "
                "group",
            )


def _is_trait(design: Design, factor: Factor) -> bool:
    if factor.order != "between" and not sets_nothing(design, factor):
        return False
    if any(TRAITS.search(words) for words in _words(factor.name)):
        return True
    names = [_words(level.name) for level in factor.levels]
    return any(
        all(any(kind.match(words) for words in spellings) for spellings in names) for kind in KINDS
    )


def _words(name: str) -> tuple[str, str]:
    """A name without accents and hyphens, and with umlauts that are written as two letters."""
    words = plain(name).replace("_", " ").replace("-", " ").strip()
    return words, re.sub("([aou])e", r"\1", words)
