"""Flaws of what a study concludes from its tests."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import Design
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import Phrases, quoted

EQUAL = Phrases(
    {
        "en": (
            r"equal\w*|equivalen\w*|identical|as (fast|good|quick|accurate|precise|easy|slow) as|"
            r"(no|without) (\w+ )?(difference|effect)|the same|not (slower|worse|different|"
            r"inferior)|does not (differ|matter)|(do|does) (no|not) (\w+ )?differ"
        ),
        "de": (
            r"gleich\w*|aquivalen\w*|ebenso|genauso|kein\w* (\w+ )?(unterschied|effekt|"
            r"wirkung)\w*|nicht (langsamer|schlechter|anders|unterlegen)|unterscheid\w* sich nicht"
        ),
        "fr": (
            r"egal\w*|egaux|equivalen\w*|identique\w*|aussi (rapide|bon|precis|facile)\w*|(aucune?|"
            r"pas de|sans) (\w+ )?(difference|effet)|pas (plus lent|moins bon|differen)\w*|meme\b"
        ),
        "es": (
            r"igual\w*|equivalen\w*|identic\w*|tan (rapid|buen|precis|facil)\w*|(ningun\w*|sin|no "
            r"hay) (\w+ )?(diferencia|efecto)|no (es|son) (mas lent|peor|distint)\w*|mism[oa]s?\b"
        ),
    }
)
UNPROVED = Phrases(
    {
        "en": (
            r"(non-?|not |in|un)significan\w*|p ?[>≥] ?0?[.,]\d+|no (\w+ )?significan\w*|(t|"
            r"significance|difference)[- ]?tests?|anova\b|(null|absence of)"
        ),
        "de": (
            r"(nicht |in|un)(-)?signifikan\w*|p ?[>≥] ?0?[.,]\d+|kein\w* signifikan\w*|(t|"
            r"signifikanz|unterschieds)-?tests?|(varianzanalyse|anova|nullhypothese)\w*"
        ),
        "fr": (
            r"(non|pas|in) ?-?significati\w*|p ?[>≥] ?0?[.,]\d+|(test|epreuve) (t|de student|de "
            r"significativite|de difference)\b|(anova|hypothese nulle)"
        ),
        "es": (
            r"(no|in|sin) ?-?significa\w*|no (es|fue|resulta) significa\w*|p ?[>≥] ?0?[.,]\d+|"
            r"prueba "
            r"(t|de student|de significacion|de diferencias)\b|(anova|hipotesis nula)"
        ),
    }
)
"""That levels are equal, and a test that only finds differences."""
MARGIN = Phrases(
    {
        "en": r"margin|tost|bayes\w*|equivalence (test|bound|interval|region)\w*|non-inferiority",
        "de": r"grenze\w*|schranke\w*|tost|bayes\w*|aquivalenztest\w*|aquivalenzbereich\w*",
        "fr": r"marge|tost|bayes\w*|test d'equivalence|(borne|intervalle)s? d'equivalence",
        "es": r"margen|tost|bayes\w*|prueba de equivalencia|(limite|intervalo)s? de equivalencia",
    }
)
"""A test that shows that a difference is small."""


def concluding_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of what the title concludes."""
    for language in design.languages:
        title = design.title
        if (
            EQUAL.match(title, language)
            and UNPROVED.match(title, language)
            and not MARGIN.match(title, language)
        ):
            yield Flaw(
                ("title",),
                "a test that finds no difference does not show that there is none: "
                f"{quoted(title)}",
                "Name the largest difference that does not matter, and compare the confidence "
                "interval of the report with it",
            )
            return
