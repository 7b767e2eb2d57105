"""Sections on exclusions, people, practice and order, questionnaires, and further measures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import nan

import numpy as np

from sandbox.study.report.models.analysis import Analysis, MeasureModel
from sandbox.study.report.models.answers import ScaleAnswers
from sandbox.study.report.models.exclusions import endings, flow, gaps
from sandbox.study.report.models.family import Family
from sandbox.study.report.models.intervals import Estimate
from sandbox.study.report.models.joint_order import confounded_pairs, design_orders
from sandbox.study.report.models.mixed import Mixed, practice_effect
from sandbox.study.report.models.order import balanced, neighbours
from sandbox.study.report.models.quantities import LOG, SHARE
from sandbox.study.report.models.summaries import cells_of, person_means, row_means
from sandbox.study.report.page import formats, plots
from sandbox.study.report.page.parts import Picture, Section, Table
from sandbox.study.report.page.section_results import (
    EFFECT_NOTE,
    THROUGHPUT,
    effect_cells,
    means_picture,
    p_cells,
    test_note,
    throughput_errors,
)


def exclusions_section(analysis: Analysis) -> Section:
    """Section on excluded data, and on how trials ended."""
    section = Section("exclusions", "Excluded data")
    data = analysis.data
    rows = [
        [
            s.what,
            str(s.participants) if s.remains else _minus(s.participants),
            ("" if s.what == "began" else str(s.trials)) if s.remains else _minus(s.trials),
        ]
        for s in flow(data)
    ]
    section.parts.append(
        Table(
            "From all data to the data used here",
            ["Step", "Participants", "Trials"],
            rows,
            "Excluded data are not deleted: trial_results.csv has all trials.",
        )
    )
    for sentence in filter(None, (data.withdrawals, *gaps(data))):
        section.say(sentence, "note")
    kinds = list(next(iter(endings(data).values()), {}))
    if kinds:
        section.parts.append(
            Table(
                "How the trials used ended",
                ["Condition", *kinds],
                [[c, *(str(n[k]) for k in kinds)] for c, n in endings(data).items()],
                "timeout: the time limit was reached; failed: the task could no longer succeed; "
                "diverged and input_ended: the simulation or the device failed. All of these "
                "count as no success.",
            )
        )
    return section


def _minus(n: int) -> str:
    return f"−{n}" if n else "0"


def people_section(analysis: Analysis) -> Section:
    """Section with the means of every person."""
    section = Section("people", "Person by person")
    for one in (analysis.time, analysis.success):
        if one is not None:
            section.parts.append(_spaghetti(analysis, one))
    if not section.parts:
        section.say("No trials are used.")
    return section


def _spaghetti(analysis: Analysis, one: MeasureModel) -> Picture:
    data, what = analysis.data, one.described.what
    own = person_means(data, what)
    several = [f for f in data.factors if len(f.levels) > 1]
    levels, values, means = [], [], []
    scale = 100.0 if what.scale == SHARE else 1.0
    for factor in several:
        groups = cells_of(data, factor)
        table = np.column_stack([row_means(own[:, cells]) for _, cells in groups])
        values.append(np.vectorize(what.back)(table) * scale)
        levels.append([name for name, _ in groups])
        means.append(
            [s.within.mapped(lambda v: scale * v) for s in one.described.levels[factor.name]]
        )
    if not several:
        values, levels = [np.vectorize(what.back)(own) * scale], [["all"]]
        means = [[s.mean.mapped(lambda v: scale * v) for s in one.described.conditions]]
    panels = [f.name for f in several] or [""]
    label = f"{what.title} (% of trials)" if what.scale == SHARE else what.label
    svg = plots.lines_by_person(
        f"people-{what.name}",
        f"{what.title} of every person",
        label,
        panels,
        levels,
        values,
        means,
        what.scale == LOG,
    )
    show = formats.number
    rows = [
        [ppid, *(show(v) for part in values for v in part[i])] for i, ppid in enumerate(data.ppids)
    ]
    unit = "%" if what.scale == SHARE else what.unit
    return Picture(
        svg,
        f"{what.title}: thin lines are persons; the thick line is the mean, with 95 % intervals "
        "for comparing.",
        Table(
            f"{what.title} of every person ({unit})",
            ["Participant", *(x for some in levels for x in some)],
            rows,
        ),
    )


def practice_section(analysis: Analysis) -> Section:
    """Section on learning and effects of order."""
    section = Section("order", "Practice and order")
    if analysis.time is None:
        section.say("Effects of practice need completion times, and there are none.")
        return section
    model = analysis.time.model
    practice = practice_effect(model) if isinstance(model, Mixed) else None
    if practice:
        value, low, high = (formats.change(v) for v in practice)
        section.say(
            f"Each time the number of trials done doubles, completion time changes by {value} (95 "
            f"% interval {formats.interval(low, high)}). The models above include this effect."
        )
    if analysis.learning:
        section.parts.append(_learning(analysis))
    for factor in analysis.data.factors:
        if factor.name in analysis.places:
            _order(section, analysis, factor.name)
    _joint_order(section, analysis)
    return section


def _joint_order(section: Section, analysis: Analysis) -> None:
    """Says what a full cycle takes, and which interactions the orders leave confounded."""
    orders = design_orders(analysis.data)
    people = len(analysis.data.ppids)
    if orders:
        section.say(f"By the design, {orders}. Trials of {people} are used.")
    for outer, inner in confounded_pairs(analysis.data):
        section.say(
            f"In the trials used, the levels of {inner} were not equally often at every place "
            f"inside of each level of {outer} at each of its places. Which level of {inner} is "
            f"better with which one of {outer} is confounded with practice.",
            "note",
        )


FEWEST = 3
"""Smallest number of people for a drawn interval; that of two people would fill the plot."""


def _drawn(e: Estimate, people: int) -> Estimate:
    return e if people >= FEWEST else Estimate(e.value, nan, nan)


def _learning(analysis: Analysis) -> Picture:
    points = analysis.learning
    series = list(dict.fromkeys(p.level for p in points))
    at = [[(p.first + p.last) / 2 for p in points if p.level == s] for s in series]
    values = [[_drawn(p.mean, p.people) for p in points if p.level == s] for s in series]
    rows = [
        [
            p.level,
            str(p.first) if p.first == p.last else f"{p.first} to {p.last}",
            str(p.people),
            formats.number(p.mean.value),
            formats.interval(formats.number(p.mean.low), formats.number(p.mean.high)),
        ]
        for p in points
    ]
    svg = plots.curves(
        "learning",
        "Completion time from trial to trial",
        "Completion time (s)",
        "number of the trial with this level",
        series,
        at,
        values,
        True,
    )
    what = f" by {analysis.main.name}" if analysis.main else ""
    return Picture(
        svg,
        f"Completion time from trial to trial{what}, without the effects of other factors; 95 % "
        f"intervals over people, for {FEWEST} people or more.",
        Table("Learning curves", ["Level", "Trial", "People", "Mean, s", "95 % interval"], rows),
    )


def _order(section: Section, analysis: Analysis, name: str) -> None:
    factor = analysis.data.factor(name)
    some = analysis.places[name]
    even = balanced(some, factor)
    series = list(dict.fromkeys(p.level for p in some))
    at = [[float(p.place) for p in some if p.level == s] for s in series]
    values = [[_drawn(p.mean, p.times) for p in some if p.level == s] for s in series]
    rows = [
        [
            p.level,
            str(p.place),
            str(p.times),
            formats.number(p.mean.value),
            formats.interval(formats.number(p.mean.low), formats.number(p.mean.high)),
        ]
        for p in some
    ]
    after = neighbours(analysis.data, factor)
    sequences = ", ".join(f"{a} then {b}: {n}" for (a, b), n in sorted(after.items()))
    svg = plots.curves(
        f"order-{_id(name)}",
        f"Completion time by position of each level of {name}",
        "Completion time (s)",
        f"position of the level of {name} in the order",
        series,
        at,
        values,
        True,
    )
    section.parts.append(
        Picture(
            svg,
            f"Order of {name}: every level was {'' if even else 'not '}equally often at every "
            "position. Parallel lines mean that the comparison does not depend on the order.",
            Table(
                f"Completion time by position of {name}",
                ["Level", "Position", "Times", "Mean, s", "95 % interval"],
                rows,
                f"Direct sequences: {sequences}." if sequences else "",
            ),
        )
    )
    if not even:
        section.say(
            f"The order of {name} is not balanced in the trials used. The models include "
            "practice, but no other effect of order.",
            "note",
        )


def _id(name: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in name)


def questionnaire_section(analysis: Analysis) -> Section:
    """Section on scores and single questions of questionnaires."""
    section = Section("questionnaires", "Questionnaires")
    if not analysis.scales:
        section.say("No questionnaire has numerical answers.")
    for name, told in analysis.data.wordings.items():
        section.say(f"{name} has {told}.", "note")
    factors = {(s.questionnaire, s.factor) for s in analysis.scales}
    about = Counter(questionnaire for questionnaire, _ in factors)
    for i, some in enumerate(_together(analysis.scales)):
        first = some[0]
        # A design that was changed in the middle may ask the same about another factor.
        twice = about[first.questionnaire] > 1
        where = f", by {first.factor.name}" if twice and first.factor else ""
        section.parts.append(_scales(i, some, analysis.family, where))
    return section


def _together(scales: Sequence[ScaleAnswers]) -> list[list[ScaleAnswers]]:
    """Groups scales of one questionnaire about the same levels: scores first, then questions.

    A question that is also a score, such as a rating of the NASA-TLX, is not shown twice.
    """
    scored = {(s.questionnaire, s.scale) for s in scales if s.score}
    groups: dict[tuple[object, ...], list[ScaleAnswers]] = {}
    for name in dict.fromkeys(s.questionnaire for s in scales):
        for s in scales:
            if s.questionnaire == name and (s.score or (name, s.scale) not in scored):
                groups.setdefault((name, s.score, s.factor, s.levels), []).append(s)
    return list(groups.values())


def _scales(number: int, some: list[ScaleAnswers], family: Family, about: str = "") -> Picture:
    first, several = some[0], len(some) > 1
    title = (first.questionnaire if several else first.title) + about
    names = [s.scale if several else "" for s in some]
    values = {
        (name, level): plots.Dot(s.means[j].value, s.means[j], s.within[j])
        for name, s in zip(names, some, strict=True)
        for j, level in enumerate(s.levels)
    }
    label = "score" if first.score else "answer"
    svg = plots.dots(f"scale-{number}", title, f"{title}: {label}", names, first.levels, values)
    rows = [
        row for name, s in zip(names, some, strict=True) for row in _scale_rows(name, s, family)
    ]
    tested = any(s.main for s in some)
    kind = (
        ("scores" if several else "score")
        if first.score
        else ("single questions" if several else "a single question")
    )
    return Picture(
        svg,
        f"{title} ({kind}): means over people with 95 % intervals; thick lines: intervals for "
        "comparing.",
        Table(
            f"{title}, {kind}",
            [
                *("Level, or pair", "People", "Mean or difference", "95 % interval"),
                *("SD", "dz", "p", "p, Holm"),
            ],
            rows,
            f"{EFFECT_NOTE} {test_note(family, first.questionnaire if tested else '')}"
            if any(s.differences for s in some)
            else "",
        ),
    )


def _scale_rows(name: str, scale: ScaleAnswers, family: Family) -> list[list[str]]:
    def called(level: str) -> str:
        if not name:
            return level
        return name if scale.factor is None else f"{name}: {level}"

    rows = [
        [
            called(level),
            str(int(np.isfinite(scale.values[:, j]).sum())),
            formats.number(scale.means[j].value),
            formats.interval(
                formats.number(scale.means[j].low), formats.number(scale.means[j].high)
            ),
            *("", "", "", ""),
        ]
        for j, level in enumerate(scale.levels)
    ]
    rows += [
        [
            called(d.pair.title),
            "",
            formats.number(d.estimate.value),
            formats.interval(formats.number(d.estimate.low), formats.number(d.estimate.high)),
            *effect_cells(d),
            *p_cells(family, scale.questionnaire if scale.main else "", d.pair),
        ]
        for d in scale.differences
    ]
    return rows


def others_section(analysis: Analysis) -> Section:
    """Section on measures that are described but not compared."""
    section = Section("measures", "Further measures")
    if not analysis.rest:
        section.say("There are no further measures.")
        return section
    section.say(
        "These measures are described but not tested, since among many measures some differ by "
        "chance. `[analysis] primary` of the design names measures that are to be tested.",
        "note",
    )
    for one in analysis.rest:
        picture = means_picture(analysis.data, one, f"m-{one.what.name}")
        better = {"high": " Higher is better.", "low": " Lower is better."}.get(one.what.better, "")
        means = f" {one.what.means[:1].upper()}{one.what.means[1:]}." if one.what.means else ""
        caption = f"{one.what.title} ({one.what.name}).{means}{better}"
        section.parts.append(Picture(picture.svg, caption, picture.table))
        if one.what.name == THROUGHPUT:
            throughput_errors(section, analysis)
    return section
