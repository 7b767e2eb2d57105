"""Description of methods and software, in words that can go into a paper."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

from sandbox.study.report.models.analysis import Analysis
from sandbox.study.report.models.mixed import Mixed
from sandbox.study.report.page import formats
from sandbox.study.report.page.parts import Section, Table

LIBRARIES = ("hand-sandbox", "statsmodels", "pandas", "scipy", "numpy", "matplotlib", "jinja2")
FILES = (
    ("trials.csv", "the trials used, with everything that the models see"),
    ("means.csv", "means of every measure by condition and by level"),
    ("comparisons.csv", "all differences with intervals and p values"),
    ("models.csv, contrasts.csv", "coefficients; how conditions are weighed in each comparison"),
    ("people.csv", "everybody's own means"),
    ("order.csv, learning.csv", "places in the order; learning curves"),
    ("scores.csv, score_comparisons.csv", "questionnaires"),
    ("exclusions.csv, endings.csv", "what was left out; how trials ended"),
    ("codebook.csv", "every column of these files"),
    ("analysis.R", "the same models in R: `Rscript analysis.R`"),
)


def methods_section(found: Analysis) -> Section:
    """Methods, software, files."""
    data = found.data
    section = Section("methods", "How this was computed")
    factors = "; ".join(
        f"{f.name} ({', '.join(f.levels)}; {'within' if f.within else 'between'} participants)"
        for f in data.factors
    )
    section.say(
        f"Factors: {factors or 'none'}. One attempt of each finished trial counts; practice and "
        "excluded trials are left out."
    )
    section.say(
        "Means. Each person's trials are averaged within a condition, then over conditions, then "
        "over people (of logarithms for measures that are lengths, times and speeds). Intervals of "
        "means are Student's over people. Intervals for comparing have the differences between "
        "people taken out (Cousineau 2005, Morey 2008). Shares have Wilson's intervals, the number "
        "of trials divided by the design effect of trials of the same person."
    )
    if found.time and isinstance(found.time.model, Mixed):
        terms = [k for k in found.time.model.spreads if k not in ("person", "residual")]
        section.say(
            "Completion time of trials that succeeded: a linear mixed model of its logarithm, with "
            "a mean for every condition and a linear effect of the logarithm of the trial's number "
            "(practice), random effects of person"
            + "".join(f", {t}" for t in terms)
            + ", fitted by restricted maximum likelihood. Levels are compared by their means over "
            "the levels of the other factors, weighed equally; degrees of freedom are those of a "
            "paired t test over people, or of groups."
        )
    if found.unseen:
        section.say(
            "Completion time of all trials: log time is normal around the same means, and a trial "
            "without success says that its time is longer than it lasted (Tobit model); errors by "
            "the jackknife over people. It assumes that what ends a trial early has nothing to do "
            "with how long it would have taken in that condition."
        )
    section.say(
        "Success: differences of people's own shares, with intervals made of Wilson's limits "
        "(Newcombe 1998; Zou and Donner 2008); p by permutation over people; odds ratios by "
        "generalised estimating equations. P values of pairs of one factor are also adjusted after "
        "Holm 1979."
    )
    section.say(
        "docs/report.md of Hand Sandbox tells how often these intervals cover the truth in "
        "studies whose truth is known."
    )
    section.parts.append(
        Table("Files beside this page", ["File", "What it has"], [list(f) for f in FILES])
    )
    software = ", ".join(f"{name} {_version(name)}" for name in LIBRARIES)
    section.say(
        f"Made of {formats.count(len(data.trials), 'row')} of trial_results.csv (SHA-256 "
        f"{data.digest[:16]}…) with {software}."
    )
    return section


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "of this folder"
