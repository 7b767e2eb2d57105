"""Sections on exclusions, people, practice and order, questionnaires, and further measures."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan

import numpy as np

from sandbox.study.report.models.analysis import Analysis, MeasureModel
from sandbox.study.report.models.answers import ScaleAnswers, adjusted
from sandbox.study.report.models.exclusions import endings, flow, unfinished
from sandbox.study.report.models.intervals import Estimate
from sandbox.study.report.models.mixed import Mixed, practice_effect
from sandbox.study.report.models.order import balanced, neighbours
from sandbox.study.report.models.quantities import LOG, SHARE
from sandbox.study.report.models.summaries import cells_of, person_means
from sandbox.study.report.page import formats, plots
from sandbox.study.report.page.parts import Picture, Section, Table
from sandbox.study.report.page.section_results import means_picture


def exclusions_section(found: Analysis) -> Section:
    """Section on left out data, and on how trials ended."""
    section = Section("exclusions", "What was left out")
    data = found.data
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
            "From everything to what is used here",
            ["Step", "Participants", "Trials"],
            rows,
            "Nothing is ever deleted; trial_results.csv has all.",
        )
    )
    missing = unfinished(data)
    if missing:
        section.say(
            f"Not finished yet: {', '.join(missing)}. Their trials so far are used.", "note"
        )
    kinds = list(next(iter(endings(data).values()), {}))
    if kinds:
        section.parts.append(
            Table(
                "How the trials used ended",
                ["Condition", *kinds],
                [[c, *(str(n[k]) for k in kinds)] for c, n in endings(data).items()],
                "timeout: the time was up; failed: something was lost or broken for good; diverged "
                "and input_ended: the simulation or the device failed. All but successes count as "
                "no success.",
            )
        )
    return section


def _minus(n: int) -> str:
    return f"−{n}" if n else "0"


def people_section(found: Analysis) -> Section:
    """Everybody's own means."""
    section = Section("people", "Person by person")
    for one in (found.time, found.success):
        if one is not None:
            section.parts.append(_spaghetti(found, one))
    if not section.parts:
        section.say("No trials are used.")
    return section


def _spaghetti(found: Analysis, one: MeasureModel) -> Picture:
    data, what = found.data, one.described.what
    own = person_means(data, what)
    several = [f for f in data.factors if len(f.levels) > 1]
    levels, values, means = [], [], []
    scale = 100.0 if what.scale == SHARE else 1.0
    for factor in several:
        groups = cells_of(data, factor)
        table = np.column_stack([_row_means(own[:, cells]) for _, cells in groups])
        values.append(np.vectorize(what.back)(table) * scale)
        levels.append([name for name, _ in groups])
        means.append([_scaled(s.within, scale) for s in one.described.levels[factor.name]])
    if not several:
        values, levels = [np.vectorize(what.back)(own) * scale], [["all"]]
        means = [[_scaled(s.mean, scale) for s in one.described.conditions]]
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
        f"{what.title}: a thin line is a person; the thick one is the mean, with "
        "95 % intervals for comparing.",
        Table(
            f"{what.title} of every person ({unit})",
            ["Participant", *(x for some in levels for x in some)],
            rows,
        ),
    )


def _row_means(values: np.ndarray) -> np.ndarray:
    known = np.isfinite(values)
    n = known.sum(axis=1)
    return np.divide(
        np.where(known, values, 0.0).sum(axis=1), n, out=np.full(len(n), np.nan), where=n > 0
    )


def _scaled(e: Estimate, by: float) -> Estimate:
    return Estimate(by * e.value, by * e.low, by * e.high)


def practice_section(found: Analysis) -> Section:
    """Learning, and whether order mattered."""
    section = Section("order", "Practice and order")
    if found.time is None:
        section.say("Without completion times there is nothing to tell about practice.")
        return section
    model = found.time.model
    practice = practice_effect(model) if isinstance(model, Mixed) else None
    if practice:
        value, low, high = (formats.change(v) for v in practice)
        section.say(
            f"With every doubling of trials done, completion time changes by {value} (95 % "
            f"interval {formats.interval(low, high)}); the models above take this into account."
        )
    if found.learning:
        section.parts.append(_learning(found))
    for factor in found.data.factors:
        if factor.name in found.places:
            _order(section, found, factor.name)
    return section


FEWEST = 3
"""People of whom an interval is drawn: that of two is so wide that nothing else would be seen."""


def _drawn(e: Estimate, people: int) -> Estimate:
    return e if people >= FEWEST else Estimate(e.value, nan, nan)


def _learning(found: Analysis) -> Picture:
    points = found.learning
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
        "trial with this level",
        series,
        at,
        values,
        True,
    )
    what = f" by {found.main.name}" if found.main else ""
    return Picture(
        svg,
        f"Completion time from trial to trial{what}, what other factors make of it "
        f"taken out; 95 % intervals over people, where they are {FEWEST} or more.",
        Table("Learning curves", ["Level", "Trial", "People", "Mean, s", "95 % interval"], rows),
    )


def _order(section: Section, found: Analysis, name: str) -> None:
    factor = found.data.factor(name)
    some = found.places[name]
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
    after = neighbours(found.data, factor)
    told = ", ".join(f"{a} then {b}: {n}" for (a, b), n in sorted(after.items()))
    svg = plots.curves(
        f"order-{_id(name)}",
        f"Completion time by place of each level of {name}",
        "Completion time (s)",
        f"place of the level of {name}",
        series,
        at,
        values,
        True,
    )
    section.parts.append(
        Picture(
            svg,
            f"Order of {name}: every level was {'' if even else 'not '}equally often at every "
            "place. Lines that run side by side mean that the comparison does not depend on the "
            "order.",
            Table(
                f"Completion time by place of {name}",
                ["Level", "Place", "Times", "Mean, s", "95 % interval"],
                rows,
                f"Right after each other: {told}." if told else "",
            ),
        )
    )
    if not even:
        section.say(
            f"The order of {name} is not balanced among the trials used. The models take practice "
            "into account, and nothing else that order may do.",
            "note",
        )


def _id(name: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in name)


def questionnaire_section(found: Analysis) -> Section:
    """Scores and scales."""
    section = Section("questionnaires", "Questionnaires")
    if not found.scales:
        section.say("No questionnaire has answers that are numbers.")
    for i, some in enumerate(_together(found.scales)):
        section.parts.append(_scales(i, some))
    return section


def _together(scales: Sequence[ScaleAnswers]) -> list[list[ScaleAnswers]]:
    """Scales of one questionnaire that were asked about the same levels: scores, then questions.

    A question that is a score by itself, as a rating of the NASA-TLX, is not shown twice.
    """
    scored = {(s.questionnaire, s.scale) for s in scales if s.score}
    groups: dict[tuple[str, bool, tuple[str, ...]], list[ScaleAnswers]] = {}
    for name in dict.fromkeys(s.questionnaire for s in scales):
        for s in scales:
            if s.questionnaire == name and (s.score or (name, s.scale) not in scored):
                groups.setdefault((name, s.score, s.levels), []).append(s)
    return list(groups.values())


def _scales(number: int, some: list[ScaleAnswers]) -> Picture:
    first, several = some[0], len(some) > 1
    title = first.questionnaire if several else first.title
    names = [s.scale if several else "" for s in some]
    values = {
        (name, level): plots.Dot(s.means[j].value, s.means[j], s.within[j])
        for name, s in zip(names, some, strict=True)
        for j, level in enumerate(s.levels)
    }
    label = "score" if first.score else "answer"
    svg = plots.dots(f"scale-{number}", title, f"{title}: {label}", names, first.levels, values)
    rows = [row for name, s in zip(names, some, strict=True) for row in _scale_rows(name, s)]
    kind = (
        ("scores" if several else "score")
        if first.score
        else ("single questions" if several else "a single question")
    )
    return Picture(
        svg,
        f"{title} ({kind}): means over people with 95 % intervals; thick lines are for comparing.",
        Table(
            f"{title}, {kind}",
            ["Level, or pair", "People", "Mean or difference", "95 % interval", "p", "p, Holm"],
            rows,
        ),
    )


def _scale_rows(name: str, scale: ScaleAnswers) -> list[list[str]]:
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
            "",
            "",
        ]
        for j, level in enumerate(scale.levels)
    ]
    rows += [
        [
            called(d.pair.title),
            "",
            formats.number(d.estimate.value),
            formats.interval(formats.number(d.estimate.low), formats.number(d.estimate.high)),
            formats.p_value(d.p),
            formats.p_value(p),
        ]
        for d, p in zip(scale.differences, adjusted(scale), strict=True)
    ]
    return rows


def others_section(found: Analysis) -> Section:
    """Measures that nobody asked to be compared."""
    section = Section("measures", "Further measures")
    if not found.rest:
        section.say("There are no further measures.")
        return section
    section.say(
        "These are described and not tested: who looks at many measures finds differences "
        "by chance. `--measure NAME` adds the comparison of one that was chosen "
        "beforehand.",
        "note",
    )
    for one in found.rest:
        picture = means_picture(found.data, one, f"m-{one.what.name}")
        better = {"high": " More is better.", "low": " Less is better."}.get(one.what.better, "")
        means = f" {one.what.means[:1].upper()}{one.what.means[1:]}." if one.what.means else ""
        caption = f"{one.what.title} ({one.what.name}).{means}{better}"
        section.parts.append(Picture(picture.svg, caption, picture.table))
    return section
