"""Sections on completion time, success, and requested measures."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp

from sandbox.study.report.models.analysis import Analysis, MeasureModel, MeasureSummary
from sandbox.study.report.models.comparisons import Difference, Pair, titles_of
from sandbox.study.report.models.data import BETWEEN_NAMES, StudyData, to_numbers
from sandbox.study.report.models.family import EXPLORATORY, Family
from sandbox.study.report.models.intervals import Estimate
from sandbox.study.report.models.mixed import Mixed, practice_effect
from sandbox.study.report.models.quantities import LOG, RATIO_UNITS, SHARE, Quantity
from sandbox.study.report.models.success import ShareDifference
from sandbox.study.report.models.summaries import Summary, median_with_unseen
from sandbox.study.report.page import formats, plots
from sandbox.study.report.page.parts import Picture, Section, Table

HOW_TO_READ = (
    "Points are means over people, with equal weights. Thin lines: 95 % intervals of these means. "
    "Thick lines: 95 % intervals for comparing conditions, without the differences between people "
    "(Cousineau and Morey)."
)


EFFECT_NOTE = (
    "SD: standard deviation over people of the difference; dz: difference divided by SD; between "
    "groups of people, SD within groups and Cohen's d."
)


THROUGHPUT = "throughput_bit_s"
"""Measure that has a standard error and a bias of its own."""


def time_section(analysis: Analysis) -> Section:
    """Section on completion times."""
    section = Section("time", "Completion time")
    if analysis.time is None:
        section.say("No trial succeeded, so there are no completion times.")
        return section
    data = analysis.data
    unseen = int(data.used["censored"].sum())
    section.say(
        f"Of {formats.count(len(data.used), 'trial')}, {len(data.used) - unseen} succeeded; their "
        "times are averaged as logarithms (geometric means)."
        + (
            f" {unseen} did not: their completion times are only known to be longer than the "
            "trials lasted."
            if unseen
            else ""
        )
    )
    section.parts.append(means_picture(data, analysis.time.described, "time"))
    _compare_times(section, analysis, unseen)
    return section


def _compare_times(section: Section, analysis: Analysis, unseen: int) -> None:
    assert analysis.time is not None
    model, seen, leading = analysis.time.model, analysis.time.differences, analysis.leading
    ways: list[tuple[str, Sequence[Difference]]] = []
    if unseen and analysis.unseen:
        ways.append(("all trials", analysis.unseen))
    if seen:
        ways.append(("successes only", seen))
    if isinstance(model, str):
        section.say(f"No mixed model: {model}.", "note")
    if unseen and isinstance(analysis.censored, str):
        section.say(f"No model with trials that did not succeed: {analysis.censored}.", "note")
    if unseen and analysis.unseen:
        section.say(
            "Trials without success are mostly those that would have taken long. Without them, "
            "conditions with many such trials look faster than they are. Therefore read the "
            "comparison of all trials first; the mixed model uses successful trials only.",
            "note",
        )
    if not leading:
        return
    titles = titles_of(leading)
    by_title = [dict(zip(titles_of(some), some, strict=True)) for _, some in ways]
    rows = [
        [
            title,
            name,
            formats.change(d.estimate.value),
            formats.interval(formats.change(d.estimate.low), formats.change(d.estimate.high)),
            *effect_cells(d),
            *p_cells(analysis.family, "time_s" if some is leading else "", d.pair),
        ]
        for title in titles
        for (name, some), known in zip(ways, by_title, strict=True)
        if (d := known.get(title)) is not None
    ]
    nothing = Estimate(float("nan"), float("nan"), float("nan"))
    values = [
        [known[t].estimate.mapped(exp) if t in known else nothing for t in titles]
        for known in by_title
    ]
    section.parts.append(
        Picture(
            plots.forest(
                "time-pairs",
                "Ratios of completion times with 95 % intervals",
                "ratio of completion times (1: no difference)",
                titles,
                values,
                [name for name, _ in ways],
                1.0,
                True,
            ),
            "How much longer (right of the line) or shorter (left) the first-named level takes, "
            "averaged over the other factors, with 95 % intervals. In the comparison of all "
            "trials, those without success are assumed to take longer than they lasted.",
            Table(
                "Differences in completion time",
                ["Levels", "From", "Change", "95 % interval", "SD, log", "dz", "p", "p, Holm"],
                rows,
                f"Successes only: by the mixed model. {EFFECT_NOTE} "
                f"{test_note(analysis.family, 'time_s')}",
            ),
        )
    )
    if isinstance(model, Mixed):
        section.parts.append(_model_table(model, LOG))
    _depend(section, analysis.time)


def _model_table(model: Mixed, scale: str) -> Table:
    rows = [[f"{k} (standard deviation)", formats.number(v)] for k, v in model.spreads.items()]
    practice = practice_effect(model)
    if practice:
        value = formats.change(practice[0]) if scale == LOG else formats.number(practice[0])
        rows.append(["change per doubling of the trials done", value])
    trials = formats.count(model.trials, "trial")
    note = f"{trials} of {formats.count(model.people, 'person', 'people')}"
    if model.left_out:
        note += "; left out: " + "; ".join(model.left_out)
    if model.singular:
        note += (
            f"; the fit is singular: {', '.join(model.singular)} is estimated as zero, so these "
            "data do not show how much people differ in it"
        )
    if not model.converged:
        note += "; the optimiser did not converge, so the estimates are uncertain"
    kind = " of the logarithm" if scale == LOG else ""
    return Table(
        f"Random effects and practice in the mixed model{kind}",
        ["Term", "Estimate"],
        rows,
        note + ".",
    )


def success_section(analysis: Analysis) -> Section:
    """Section on success."""
    section = Section("success", "Success")
    if analysis.success is None:
        section.say("No trials are used.")
        return section
    section.parts.append(means_picture(analysis.data, analysis.success.described, "success"))
    if analysis.success.shares:
        section.parts.append(_share_pairs("success", analysis.success.shares, analysis.family))
    _depend(section, analysis.success)
    if isinstance(analysis.odds, str):
        section.say(f"Odds ratios: {analysis.odds}.", "note")
    elif analysis.odds:
        rows = [
            [
                title,
                formats.number(exp(d.estimate.value)),
                formats.interval(
                    formats.number(exp(d.estimate.low)), formats.number(exp(d.estimate.high))
                ),
            ]
            for title, d in zip(titles_of(analysis.odds), analysis.odds, strict=True)
        ]
        section.parts.append(
            Table(
                "Odds ratios of success, by generalised estimating equations",
                ["Levels", "Odds ratio", "95 % interval"],
                rows,
                "Not tested. Exchangeable correlation of one person's trials; standard errors by "
                "Mancl and DeRouen.",
            )
        )
    return section


def _share_pairs(name: str, some: Sequence[ShareDifference], family: Family) -> Picture:
    titles = titles_of(some)
    rows = [
        [
            title,
            formats.percent(d.first.value),
            formats.percent(d.second.value),
            formats.points(d.estimate.value),
            formats.interval(formats.points(d.estimate.low), formats.points(d.estimate.high)),
            formats.number(100.0 * d.spread),
            formats.number(d.size),
            *p_cells(family, name, d.pair),
        ]
        for title, d in zip(titles, some, strict=True)
    ]
    percentages = [d.estimate.mapped(lambda v: 100 * v) for d in some]
    return Picture(
        plots.forest(
            f"{name}-pairs",
            "Differences of shares with 95 % intervals",
            "percentage points (0: no difference)",
            titles,
            [percentages],
            ["shares"],
            0.0,
        ),
        "How much more often (right of the line) or less often (left) trials with the first-named "
        "level succeed, with 95 % intervals.",
        Table(
            "Differences in shares of trials",
            [
                *("Levels", "second", "first", "Points", "95 % interval"),
                *("SD, points", "dz", "p", "p, Holm"),
            ],
            [[r[0], r[2], r[1], *r[3:]] for r in rows],
            f"p is from a permutation test over people. {EFFECT_NOTE} {test_note(family, name)}",
        ),
    )


def asked_section(one: MeasureModel) -> Section:
    """Section on a requested measure, without its results."""
    what = one.described.what
    section = Section(what.name, what.title)
    if what.means:
        section.say(what.means[:1].upper() + what.means[1:] + ".")
    return section


def asked_sections(analysis: Analysis) -> list[Section]:
    """Sections on all requested measures."""
    sections = []
    for one in analysis.asked:
        section, what = asked_section(one), one.described.what
        section.parts.append(means_picture(analysis.data, one.described, what.name))
        if one.shares:
            section.parts.append(_share_pairs(what.name, one.shares, analysis.family))
        elif isinstance(one.model, str):
            section.say(f"No mixed model: {one.model}.", "note")
        else:
            section.parts.append(_pairs_table(what, one.differences, analysis.family))
            section.parts.append(_model_table(one.model, what.scale))
        _depend(section, one)
        if what.name == THROUGHPUT:
            throughput_errors(section, analysis)
        sections.append(section)
    return sections


def _depend(section: Section, one: MeasureModel) -> None:
    """Adds a table of simple effects and interactions for every other factor."""
    what = one.described.what
    show = {LOG: formats.change, SHARE: formats.points}.get(what.scale, formats.number)
    for other in dict.fromkeys(d.other.name for d in one.dependences):
        mine = [d for d in one.dependences if d.other.name == other]
        rows = [
            [
                d.title,
                d.kind,
                show(d.estimate.value),
                formats.interval(show(d.estimate.low), show(d.estimate.high)),
            ]
            for d in mine
        ]
        scale = {LOG: "Change", SHARE: "Points"}.get(what.scale, "Difference")
        section.parts.append(
            Table(
                f"{what.title}: {mine[0].pair.factor.name} by {other}",
                ["Levels", "Kind", scale, "95 % interval"],
                rows,
                f"Exploratory. Simple effect: the difference at one level of {other}. Interaction: "
                "the difference between two simple effects; 0 if the first difference does not "
                f"depend on {other}.",
            )
        )


def _pairs_table(what: Quantity, some: Sequence[Difference], family: Family) -> Table:
    show = formats.change if what.scale == LOG else formats.number
    rows = [
        [
            title,
            show(d.estimate.value),
            formats.interval(show(d.estimate.low), show(d.estimate.high)),
            *effect_cells(d),
            *p_cells(family, what.name, d.pair),
        ]
        for title, d in zip(titles_of(some), some, strict=True)
    ]
    return Table(
        "Differences, by the mixed model",
        [
            *("Levels", "Difference", "95 % interval"),
            *("SD, log" if what.scale == LOG else "SD", "dz", "p", "p, Holm"),
        ],
        rows,
        f"{_compared_by(what)} {EFFECT_NOTE} {test_note(family, what.name)}",
    )


def _compared_by(what: Quantity) -> str:
    """A sentence on the scale on which a measure is compared."""
    if what.scale == LOG:
        return "Compared by ratios, from logarithms."
    unit = f" in {what.unit}" if what.unit else ""
    why = ", as not all values are above 0" if what.unit in RATIO_UNITS else ""
    return f"Compared by differences{unit}{why}."


def effect_cells(d: Difference) -> list[str]:
    """Cells with the standard deviation of a difference over people, and its standardised size."""
    return [formats.number(d.spread), formats.number(d.size)]


def p_cells(family: Family, outcome: str, pair: Pair) -> list[str]:
    """Cells with the p value and the adjusted p value; dashes if the comparison is exploratory."""
    return [formats.p_value(p) for p in family.p_values(outcome, pair)]


def test_note(family: Family, outcome: str) -> str:
    """A sentence that says whether an outcome is tested, and with what."""
    if family.role(outcome) == EXPLORATORY:
        return "Exploratory: estimates with intervals, not tested."
    return (
        f"p, Holm is adjusted for all {formats.count(family.adjusted_for, 'test')} of the study"
        + (" that can be computed" if family.adjusted_for < len(family.tests) else "")
        + "; intervals are not adjusted."
    )


def means_picture(data: StudyData, one: MeasureSummary, name: str) -> Picture:
    """Plot of means by condition: levels of the first factor in colours, the others in rows."""
    what = one.what
    factors = [f for f in data.factors if len(f.levels) > 1]
    rows, series, places = [""], ["all"], {}
    if factors:
        series = list(factors[0].levels)
        seen = data.used.drop_duplicates("cell").to_dict("records")
        of = {r["condition"]: [r[f.column] for f in factors] for r in seen}
        rank = [{x: i for i, x in enumerate(f.levels)} for f in factors]
        ordered = sorted(
            (levels[1:] for levels in of.values()),
            key=lambda rest: [at.get(x, 0) for at, x in zip(rank[1:], rest, strict=True)],
        )
        rows = list(dict.fromkeys(map(BETWEEN_NAMES.join, ordered)))
        places = {c: (BETWEEN_NAMES.join(rest), first) for c, (first, *rest) in of.items()}
    scale = 100.0 if what.scale == SHARE else 1.0

    def scaled(estimate: Estimate) -> Estimate:
        return estimate.mapped(lambda value: scale * value)

    values = {
        places.get(s.name, ("", "all")): plots.Dot(
            scale * s.mean.value, scaled(s.mean), scaled(s.within)
        )
        for s in one.conditions
    }
    label = f"{what.title} (% of trials)" if what.scale == SHARE else what.label
    limits = (-2.0, 102.0) if what.scale == SHARE else None
    svg = plots.dots(
        f"{name}-means",
        f"{what.title} by condition",
        label,
        rows,
        series,
        values,
        what.scale == LOG,
        limits,
    )
    return Picture(
        svg,
        f"{what.title} by condition. {HOW_TO_READ}",
        means_table(data, one, f"{what.title} by condition and by level"),
    )


def means_table(data: StudyData, one: MeasureSummary, caption: str) -> Table:
    """Table of means with intervals."""
    what = one.what
    show = formats.percent if what.scale == SHARE else formats.number
    timed = what.name == "time_s"
    rows = []
    for i, s in enumerate(one.conditions):
        extra = []
        if timed:
            middle = median_with_unseen(data, i)
            extra = ["not known" if middle == float("inf") else formats.number(middle)]
        rows.append([s.name, *_mean_cells(s, show), *extra])
    for factor, some in one.levels.items():
        if len(one.levels) > 1:
            rows += [
                [f"{factor}: {s.name}", *_mean_cells(s, show), *([""] if timed else [])]
                for s in some
            ]
    unit = f", {what.unit}" if what.unit and what.scale != SHARE else ""
    head = ["Condition", "People", "Trials", f"Mean{unit}", "95 % interval", "for comparing"]
    note = (
        "Median: over all trials, where trials without success count as longer than all others; "
        "not known if half of the trials or more had no success."
    )
    more = [f"Median{unit}"] if timed else []
    return Table(caption, [*head, *more], rows, note if timed else "")


def _mean_cells(s: Summary, show: object) -> list[str]:
    assert callable(show)
    return [
        str(s.people),
        str(s.trials),
        show(s.mean.value),
        formats.interval(show(s.mean.low), show(s.mean.high)),
        formats.interval(show(s.within.low), show(s.within.high)),
    ]


def throughput_errors(section: Section, analysis: Analysis) -> None:
    """Says how uncertain the throughput of one person and condition is."""
    used = analysis.data.used.drop_duplicates(["ppid", "cell"])
    if not {"throughput_se_bit_s", "throughput_bias_bit_s"} <= set(used.columns):
        return
    value, error, bias = (
        to_numbers(used[name])
        for name in ("throughput_bit_s", "throughput_se_bit_s", "throughput_bias_bit_s")
    )
    if not (error / value).notna().any():
        return
    section.say(
        f"The throughput of one person in one condition has a standard error of "
        f"{formats.percent((error / value).median())} (median), and is expected to be "
        f"{formats.percent((bias / value).median())} too high, since it is from few movements. "
        "Both are smaller with more repetitions.",
        "note",
    )
