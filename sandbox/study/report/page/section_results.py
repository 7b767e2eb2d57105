"""Sections on completion time, success, and measures that were asked for."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp

from sandbox.study.report.models.analysis import Analysis, MeasureModel, MeasureSummary, adjusted
from sandbox.study.report.models.censored import Censored
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import BETWEEN_NAMES, StudyData
from sandbox.study.report.models.intervals import Estimate
from sandbox.study.report.models.mixed import Mixed, practice_effect
from sandbox.study.report.models.quantities import LOG, SHARE, Quantity
from sandbox.study.report.models.success import ShareDifference
from sandbox.study.report.models.summaries import Summary, median_with_unseen
from sandbox.study.report.page import formats, plots
from sandbox.study.report.page.parts import Picture, Section, Table

HOW_TO_READ = (
    "Points are means over people, each person counting once. Thin lines: 95 % intervals of these "
    "means. Thick lines: 95 % intervals for comparing conditions, without the differences between "
    "people (Cousineau and Morey)."
)


def time_section(found: Analysis) -> Section:
    """Completion times."""
    section = Section("time", "Completion time")
    if found.time is None:
        section.say("No trial succeeded, so there are no completion times.")
        return section
    data = found.data
    unseen = int(data.used["censored"].sum())
    section.say(
        f"Of {formats.count(len(data.used), 'trial')}, {len(data.used) - unseen} succeeded; their "
        "times are averaged as logarithms (geometric means)."
        + (
            f" {unseen} did not, and their completion times are only known to be longer than they "
            "lasted."
            if unseen
            else ""
        )
    )
    section.parts.append(means_picture(data, found.time.described, "time"))
    _compare_times(section, found, unseen)
    return section


def _compare_times(section: Section, found: Analysis, unseen: int) -> None:
    assert found.time is not None
    model, seen, leading = found.time.model, found.time.differences, found.leading
    ways: list[tuple[str, Sequence[Difference]]] = []
    if unseen and found.unseen:
        ways.append(("all trials", found.unseen))
    if seen:
        ways.append(("successes only", seen))
    if isinstance(model, str):
        section.say(f"No mixed model: {model}.", "note")
    if unseen and isinstance(found.censored, str):
        section.say(f"No model with trials that did not succeed: {found.censored}.", "note")
    if unseen and found.unseen:
        section.say(
            "Trials without success are mostly those that would have taken long. Leaving them out "
            "makes conditions with many of them look faster than they are, so the comparison that "
            "knows of them is to be read first; the mixed model of the trials that succeeded is "
            "beside it.",
            "note",
        )
    if not leading:
        return
    titles = [d.pair.title for d in leading]
    by_title = [{d.pair.title: d for d in some} for _, some in ways]
    rows = [
        [
            title,
            name,
            formats.change(d.estimate.value),
            formats.interval(formats.change(d.estimate.low), formats.change(d.estimate.high)),
            formats.p_value(d.p),
            formats.p_value(p),
        ]
        for title in titles
        for (name, some), known in zip(ways, by_title, strict=True)
        if title in known
        for d, p in zip(some, adjusted(some), strict=True)
        if d.pair.title == title
    ]
    nothing = Estimate(float("nan"), float("nan"), float("nan"))
    values = [
        [_factor(known[t].estimate) if t in known else nothing for t in titles]
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
            "averaged over the other factors, with 95 % intervals. All trials: those without "
            "success are taken as longer than they lasted.",
            Table(
                "Differences in completion time",
                ["Levels", "From", "Change", "95 % interval", "p", "p, Holm"],
                rows,
                "Successes only: by the mixed model. p Holm is adjusted for all "
                "pairs of levels of the same factor; intervals are each for itself.",
            ),
        )
    )
    if isinstance(model, Mixed):
        section.parts.append(_model_table(model, LOG))


def _model_table(model: Mixed, scale: str) -> Table:
    rows = [[f"{k} (standard deviation)", formats.number(v)] for k, v in model.spreads.items()]
    practice = practice_effect(model)
    if practice:
        value = formats.change(practice[0]) if scale == LOG else formats.number(practice[0])
        rows.append(["change with every doubling of trials done", value])
    trials = formats.count(model.trials, "trial")
    note = f"{trials} of {formats.count(model.people, 'person', 'people')}"
    if model.left_out:
        note += "; left out: " + "; ".join(model.left_out)
    if not model.converged:
        note += "; the optimiser did not settle, so read it with care"
    kind = " of the logarithm" if scale == LOG else ""
    return Table(f"The mixed model{kind}: what varies", ["Term", "Estimate"], rows, note + ".")


def success_section(found: Analysis) -> Section:
    """Success."""
    section = Section("success", "Success")
    if found.success is None:
        section.say("No trials are used.")
        return section
    section.parts.append(means_picture(found.data, found.success.described, "success"))
    if found.success.shares:
        section.parts.append(_share_pairs("success", found.success.shares))
    if isinstance(found.odds, str):
        section.say(f"Odds ratios: {found.odds}.", "note")
    elif found.odds:
        rows = [
            [
                d.pair.title,
                formats.number(exp(d.estimate.value)),
                formats.interval(
                    formats.number(exp(d.estimate.low)), formats.number(exp(d.estimate.high))
                ),
                formats.p_value(d.p),
                formats.p_value(p),
            ]
            for d, p in zip(found.odds, adjusted(found.odds), strict=True)
        ]
        section.parts.append(
            Table(
                "Odds ratios of success, by generalised estimating equations",
                ["Levels", "Odds ratio", "95 % interval", "p", "p, Holm"],
                rows,
                "Trials of one person are exchangeable; errors after Mancl and DeRouen.",
            )
        )
    return section


def _share_pairs(name: str, some: Sequence[ShareDifference]) -> Picture:
    titles = [d.pair.title for d in some]
    rows = [
        [
            d.pair.title,
            formats.percent(d.first.value),
            formats.percent(d.second.value),
            formats.points(d.estimate.value),
            formats.interval(formats.points(d.estimate.low), formats.points(d.estimate.high)),
            formats.p_value(d.p),
            formats.p_value(p),
        ]
        for d, p in zip(some, adjusted(some), strict=True)
    ]
    hundred = [
        Estimate(100 * d.estimate.value, 100 * d.estimate.low, 100 * d.estimate.high) for d in some
    ]
    return Picture(
        plots.forest(
            f"{name}-pairs",
            "Differences of shares with 95 % intervals",
            "percentage points (0: no difference)",
            titles,
            [hundred],
            ["shares"],
            0.0,
        ),
        "How much more often (right of the line) or less often (left) trials with the first-named "
        "level succeed, with 95 % intervals.",
        Table(
            "Differences in shares of trials",
            ["Levels", "second", "first", "Points", "95 % interval", "p", "p, Holm"],
            [[r[0], r[2], r[1], *r[3:]] for r in rows],
            "p is of a permutation test over people.",
        ),
    )


def asked_section(one: MeasureModel) -> Section:
    """A measure that was asked for."""
    what = one.described.what
    section = Section(what.name, what.title)
    if what.means:
        section.say(what.means[:1].upper() + what.means[1:] + ".")
    return section


def asked_sections(found: Analysis) -> list[Section]:
    """All measures that were asked for."""
    sections = []
    for one in found.asked:
        section, what = asked_section(one), one.described.what
        section.parts.append(means_picture(found.data, one.described, what.name))
        if one.shares:
            section.parts.append(_share_pairs(what.name, one.shares))
        elif isinstance(one.model, str):
            section.say(f"No mixed model: {one.model}.", "note")
        else:
            section.parts.append(_pairs_table(what, one.differences))
            section.parts.append(_model_table(one.model, what.scale))
        sections.append(section)
    return sections


def _pairs_table(what: Quantity, some: Sequence[Difference]) -> Table:
    show = formats.change if what.scale == LOG else formats.number
    rows = [
        [
            d.pair.title,
            show(d.estimate.value),
            formats.interval(show(d.estimate.low), show(d.estimate.high)),
            formats.p_value(d.p),
            formats.p_value(p),
        ]
        for d, p in zip(some, adjusted(some), strict=True)
    ]
    return Table(
        "Differences, by the mixed model",
        ["Levels", "Difference", "95 % interval", "p", "p, Holm"],
        rows,
    )


def means_picture(data: StudyData, one: MeasureSummary, name: str) -> Picture:
    """Means by condition: the first factor in colours, combinations of the others in rows."""
    what = one.what
    factors = [f for f in data.factors if len(f.levels) > 1]
    rows, series, places = [""], ["all"], {}
    if factors:
        series = list(factors[0].levels)
        rest = {c: c.split(BETWEEN_NAMES, 1) for c in data.conditions}
        rows = list(dict.fromkeys(r[1] if len(r) > 1 else "" for r in rest.values()))
        rank = {x: i for f in factors[1:] for i, x in enumerate(f.levels)}
        rows.sort(key=lambda r: [rank.get(x, 0) for x in r.split(BETWEEN_NAMES)])
        places = {c: (r[1] if len(r) > 1 else "", r[0]) for c, r in rest.items()}
    hundred = 100.0 if what.scale == SHARE else 1.0

    def scaled(e: Estimate) -> Estimate:
        return Estimate(hundred * e.value, hundred * e.low, hundred * e.high)

    values = {
        places.get(s.name, ("", "all")): plots.Dot(
            hundred * s.mean.value, scaled(s.mean), scaled(s.within)
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
    """Means with intervals, as texts."""
    what = one.what
    show = formats.percent if what.scale == SHARE else formats.number
    timed = what.name == "time_s"
    rows = []
    for i, s in enumerate(one.conditions):
        extra = []
        if timed:
            middle = median_with_unseen(data, i)
            extra = ["not seen" if middle == float("inf") else formats.number(middle)]
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
        "Median: of all trials, those without success counted as longer than any other; not seen "
        "where half of them or more had none."
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


def _factor(e: Estimate) -> Estimate:
    return Estimate(exp(e.value), exp(e.low), exp(e.high))


def unseen_model(found: Analysis) -> bool:
    """True if the main comparison includes trials without success."""
    return isinstance(found.censored, Censored) and found.censored.unseen > 0
