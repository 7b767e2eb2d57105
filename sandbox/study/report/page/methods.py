"""Section on methods and software, in sentences that can be used in a paper."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

from sandbox.study.report.models.analysis import Analysis
from sandbox.study.report.models.family import ALPHA, Family
from sandbox.study.report.models.mixed import Mixed
from sandbox.study.report.page import formats
from sandbox.study.report.page.parts import Section, Table

LIBRARIES = ("hand-sandbox", "statsmodels", "pandas", "scipy", "numpy", "matplotlib", "jinja2")
FILES = (
    ("trials.csv", "the trials used, with all inputs of the models"),
    ("means.csv", "means of every measure by condition and by level"),
    ("comparisons.csv", "all differences with intervals, standardised effects and p values"),
    ("interactions.csv", "simple effects and interactions"),
    ("models.csv, contrasts.csv", "coefficients; weights of conditions in each comparison"),
    ("people.csv", "means of every participant"),
    ("order.csv, learning.csv", "effects of order; learning curves"),
    ("scores.csv, score_comparisons.csv", "questionnaires"),
    ("exclusions.csv, endings.csv", "excluded data; how trials ended"),
    ("codebook.csv", "definition of every column of these files"),
    ("analysis.R", "the same models in R: `Rscript analysis.R`"),
)


def methods_section(analysis: Analysis) -> Section:
    """Section on methods, software and files."""
    data = analysis.data
    section = Section("methods", "How this was computed")
    factors = "; ".join(
        f"{f.name} ({', '.join(f.levels)}; {'within' if f.within else 'between'} participants)"
        for f in data.factors
    )
    section.say(
        f"Factors: {factors or 'none'}. One attempt of each finished trial counts. Practice "
        "trials and excluded trials are not used."
    )
    section.say(
        "Means. Each person's trials are averaged within a condition, then over conditions, then "
        "over people (as logarithms for completion time, and for other lengths, times and speeds "
        "that are above 0 in all trials). Intervals of means are "
        "Student's t intervals over people. Intervals for comparing are computed without the "
        "differences between people (Cousineau 2005, Morey 2008). Shares have Wilson intervals, "
        "with the number of trials divided by the design effect of trials of the same person."
    )
    if analysis.time and isinstance(analysis.time.model, Mixed):
        terms = [k for k in analysis.time.model.spreads if k not in ("person", "residual")]
        section.say(
            "Completion time of successful trials: a linear mixed model of its logarithm, with a "
            "mean for every condition, a linear effect of the logarithm of the trial number "
            + ("in the session " if analysis.data.by_session else "")
            + "(practice), and random effects of person"
            + "".join(f", {t}" for t in terms)
            + ", fitted by restricted maximum likelihood. Levels are compared by their means over "
            "the levels of the other factors, with equal weights. The degrees of freedom are those "
            "of a t test over people; for factors within participants of a paired one, over those "
            "who did both levels."
        )
    if analysis.unseen:
        section.say(
            "Completion time of all trials: a Tobit model, in which the logarithm of time is "
            "normally distributed around the same means, and a trial without success would have "
            "taken longer than it lasted. Standard errors are computed by the jackknife over "
            "people. The model assumes that the reason why a trial ended early is independent of "
            "the time that it would have taken in that condition."
        )
    section.say(
        "Success: differences of the shares of successful trials, with intervals from Wilson's "
        "limits (Newcombe 1998; Zou and Donner 2008), p values from permutations over people, and "
        "odds ratios by generalised estimating equations."
    )
    section.say(_tests(analysis.family))
    section.say(
        "docs/report.md of Hand Sandbox reports how often these intervals cover the true value in "
        "simulated studies with known true values."
    )
    for sentence in data.upgrades:
        section.say(sentence, "note")
    for line in (*data.kept, *data.clock_steps):
        section.say(f"{line}.", "note")
    section.parts.append(
        Table("Files of this report", ["File", "Content"], [list(f) for f in FILES])
    )
    software = ", ".join(f"{name} {_version(name)}" for name in LIBRARIES)
    section.say(
        f"Computed from {formats.count(len(data.trials), 'row')} of trial_results.csv (SHA-256 "
        f"{data.digest[:16]}…) with {software}."
    )
    return section


def _tests(family: Family) -> str:
    """Sentences on what was tested."""
    outcomes = list(dict.fromkeys(test.outcome for test in family.tests))
    count = formats.count(len(family.tests), "comparison")
    named = (
        f"The design names {', '.join(family.primary)} as primary. Only these are tested: {count}."
        if family.primary
        else f"The design names no primary outcome, so all that is compared is tested: {count} of "
        f"{', '.join(outcomes) or 'nothing'}."
    )
    missing = f" Without data to compare: {', '.join(family.missing)}." if family.missing else ""
    unknown = len(family.tests) - family.adjusted_for
    if unknown:
        missing += (
            f" Of these, {unknown} cannot be computed from these data and do not count in the "
            "adjustment."
        )
    return (
        f"Tests. {named}{missing} P values are adjusted for all of them together (Holm 1979), so "
        f"that a study without any difference has a finding with probability {ALPHA:g} or less. "
        "Of a questionnaire, its one score is tested. Everything else is exploratory: estimates "
        "with intervals."
    )


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "of this folder"
