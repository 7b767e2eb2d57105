"""The report as one HTML file without scripts or external resources, in light or dark colours."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from models.message import counted
from sandbox.study.report import formats, plots
from sandbox.study.report.data import (
    Measure,
    ObservedFactor,
    StudyData,
    Values,
    item_values,
    number_in,
    score_values,
    to_numbers,
    trial_numbers,
    trial_values,
    words,
)
from sandbox.study.report.exclusions import endings, flow, gaps, unbalanced_states
from sandbox.study.report.numbers import (
    ALPHA,
    CONFIRMATORY,
    FEWEST,
    Compared,
    Estimate,
    Mean,
    Pair,
    Results,
    mean_of,
    paired_differences,
    welch,
)

if TYPE_CHECKING:
    from pandas import DataFrame

MODES = {
    "real": ("Study", "{}", ""),
    "pilot": ("Pilot", "Pilot of {}", "Data of a pilot. They are not part of the study."),
    "simulated": (
        "Simulated",
        "{}, simulated",
        "No person took part. Simulated users did these trials, which show that the study runs but "
        "nothing about people.",
    ),
    "unknown": (
        "Unknown kind",
        "{}, data of unknown kind",
        "These tables do not show whether people took part.",
    ),
}
"""Kinds of data: name, title and warning of their pages."""
ALONE = "There are no records in this folder, so changes of its tables by hand cannot be detected."
"""Warning of a page that was made from tables without the records of the study."""
LATE = 60.0
"""Latency (ms, 95th percentile) above which the page shows the latency of a session."""
MOST_CONDITIONS = 6
"""Largest number of conditions in the table of further measures. With more conditions, the table
has the levels of the first factor instead."""
MORE_TITLES = ("Screen size", "Resumed")
LIBRARIES = ("hand-sandbox", "pandas", "scipy", "numpy")
FILES = (
    ("results.csv", "every mean, difference, interval and p value of this page"),
    ("people.csv", "every person's mean by outcome and condition, from which results.csv follows"),
    ("codebook.csv", "the columns of these tables"),
    ("analysis.R", "mixed and other models in R; a report that is made later shows its results"),
)
"""Files next to the page, with their contents."""


@dataclass(frozen=True)
class Table:
    """A table of texts.

    Attributes:
        caption: Caption of the table.
        head: Headings of the columns.
        rows: Texts of the cells; the first cell of each row is its heading.
        note: Note below the table.
        words: True if the cells are texts, which are aligned to the left.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""
    words: bool = False
    kind: str = field(default="table", init=False)


@dataclass(frozen=True)
class Picture:
    """Pictures, and tables with their numbers.

    Attributes:
        pictures: (SVG, description) of each picture.
        tables: Tables with the numbers of the pictures.
    """

    pictures: tuple[tuple[str, str], ...]
    tables: tuple[Table, ...] = ()
    kind: str = field(default="picture", init=False)


@dataclass(frozen=True)
class Paragraph:
    """A paragraph.

    Attributes:
        text: Plain text.
        tone: Empty, `note` for a limitation of a result, or `quote` for a person's words.
    """

    text: str
    tone: str = ""
    kind: str = field(default="words", init=False)


@dataclass
class Section:
    """A section of the page.

    Attributes:
        id: Id of the anchor.
        title: Heading.
        parts: Parts in order.
    """

    id: str
    title: str
    parts: list[Table | Picture | Paragraph] = field(default_factory=list)

    def say(self, text: str, tone: str = "") -> None:
        """Adds a paragraph."""
        self.parts.append(Paragraph(text, tone))


def page(found: Results, lacking: str = "", in_r: Sequence[dict[str, str]] = ()) -> str:
    """Returns the HTML text of the report.

    Args:
        found: The results to show.
        lacking: Sentences on data that the tables do not have, for the top of the page.
        in_r: Rows of `results_R.csv`; empty if `analysis.R` has not run.
    """
    from jinja2 import Environment

    here = files("sandbox.study.report")
    template = Environment(autoescape=True).from_string(
        here.joinpath("page.html").read_text(encoding="utf-8")
    )
    css = here.joinpath("page.css").read_text(encoding="utf-8")
    top = head(found)
    alone = "" if found.data.has_records else ALONE
    top["warning"] = " ".join(filter(None, (alone, top["warning"], lacking)))
    return template.render(css=_Safe(css), sections=sections(found, in_r), **top)


class _Safe(str):
    """Text that is already HTML, so that it is not escaped."""

    def __html__(self) -> str:
        return str(self)


def head(found: Results) -> dict[str, Any]:
    """Values of the head of the page: title, warning, facts and findings."""
    data = found.data
    mode = data.mode if data.mode in MODES else "unknown"
    kind, title, warning = MODES[mode]
    upgraded = (
        "The study was changed after people had begun; the last section describes the changes and "
        "their reasons."
        if data.upgrades
        else ""
    )
    return {
        "mode": mode,
        "kind": kind,
        "title": title.format(data.title or data.name),
        "warning": " ".join(filter(None, (warning, data.rehearsed, upgraded))),
        "facts": _facts(data),
        "findings": [_finding(one, pair) for one in found.compared for pair in _tested(one)],
    }


def sections(found: Results, in_r: Sequence[dict[str, str]] = ()) -> list[Section]:
    """Sections of the page, in order; sections without content are left out."""
    data = found.data
    some = [
        _sessions(data),
        _progress(data),
        *(_outcome(data, one) for one in found.compared),
        _order(found),
        _words(data),
        _rest(found),
        _exclusions(data),
        _methods(found, in_r),
    ]
    return [section for section in some if section.parts]


def _facts(data: StudyData) -> list[tuple[str, str, str]]:
    steps = flow(data)
    began, used = steps[0], steps[-1]
    count = next(s for s in steps if s.what == "trials that count")
    gone = f"; {data.withdrawn} more withdrew" if data.withdrawn else ""
    facts = [
        ("Participants used", str(used.participants), f"of {began.participants} who began{gone}"),
        ("Trials used", str(used.trials), f"of {count.trials} that count"),
    ]
    if len(data.used):
        won = int(data.used["success"].sum())
        share = f"{formats.percent(won / len(data.used))} %"
        facts.append(("Success", share, f"{won} of {counted(len(data.used), 'trial')}"))
    return facts


def _tested(one: Compared) -> list[Pair]:
    return [pair for pair in one.pairs if one.role == CONFIRMATORY and isfinite(pair.p_holm)]


def _finding(one: Compared, pair: Pair) -> str:
    """A sentence on the result of a test."""
    word = "there may be no difference" if pair.p_holm >= ALPHA else "a difference"
    return (
        f"{one.what.title}, {pair.title}: {_difference_text(one.what, pair.estimate)}; p, Holm "
        f"{formats.p_value(pair.p_holm)}: {word}."
    )


def _sessions(data: StudyData) -> Section:
    """The section with a row for every session, and notes on unfinished sessions."""
    section = Section("sessions", "Sessions")
    trials = data.trials
    if not len(trials):
        section.say("No trial has been finished yet.")
        return section
    keys = ["ppid", "session_num"] if "session_num" in trials else ["ppid"]
    columns = [f.column for f in data.factors if f.name != "session"]
    rows = []
    for key, mine in trials.groupby(keys, sort=False):
        counts = mine[(mine["counted"] == 1)]
        main = counts[counts["practice"] != 1]
        order = [list(dict.fromkeys(x for x in main[c] if x)) for c in columns[:1]]
        session = f", {int(key[1])}" if len(keys) > 1 and data.by_session else ""
        late = _largest(counts, "latency_p95_ms")
        rows.append(
            [
                f"{key[0]}{session}",
                _cell(mine, "number"),
                ", ".join(order[0]) if order else "",
                _minutes(mine),
                str(len(main)),
                str(int((main["success"] == 1).sum())),
                str(int((main["excluded"] == 1).sum())),
                _seconds(counts, "away_s"),
                _seconds(counts, "lost_s"),
                f"{late:.0f} ms" if late > LATE else "",
                "guessed" if _cell(mine, "screen_measured") == "0" else "",
                _resumes(data, key),
            ]
        )
    titles = ("Participant", "Number", "Order", "Minutes", "Trials", "Successes", "Excluded")
    section.parts.append(
        _without_empty(
            Table(
                "Sessions so far; trials without practice",
                [*titles, "Page away", "Machine behind", "Late touches", *MORE_TITLES],
                rows,
            )
        )
    )
    for sentence in gaps(data):
        section.say(sentence, "note")
    return section


def _resumes(data: StudyData, key: Sequence[Any]) -> str:
    """Number of times that a session was resumed, as text; empty if it never was."""
    events = data.events
    if not {"ppid", "session_num", "event"} <= set(events.columns):
        return ""
    mine = events[(events["ppid"] == key[0]) & (events["event"] == "session_resume")]
    if len(key) > 1:
        mine = mine[to_numbers(mine["session_num"]) == key[1]]
    return str(len(mine)) if len(mine) else ""


def _without_empty(table: Table) -> Table:
    """A table without the columns in which all cells are empty or 0."""
    used = [i for i in range(len(table.head)) if any(row[i] not in ("", "0") for row in table.rows)]
    used = sorted({0, *used})
    rows = [[row[i] for i in used] for row in table.rows]
    return Table(table.caption, [table.head[i] for i in used], rows, table.note, table.words)


def _cell(rows: DataFrame, name: str) -> str:
    """The cell of a column in the first row; empty if there is no such column."""
    return str(rows[name].iloc[0]) if name in rows else ""


def _minutes(rows: DataFrame) -> str:
    if "end_time" not in rows:
        return ""
    last = to_numbers(rows["end_time"]).max()
    return formats.number(float(last) / 60.0, 2) if isfinite(last) else ""


def _seconds(rows: DataFrame, name: str) -> str:
    total = float(to_numbers(rows[name]).sum()) if name in rows else 0.0
    return f"{total:.1f} s" if total >= 0.05 else ""


def _largest(rows: DataFrame, name: str) -> float:
    return float(to_numbers(rows[name]).max()) if name in rows else -inf


def _progress(data: StudyData) -> Section:
    """The section on the orders in which people got the levels, and on the endings of trials."""
    section = Section("progress", "Orders and endings")
    if data.orders:
        people = counted(len(data.ppids), "participant")
        section.say(f"By the design, {data.orders}. Trials of {people} are used.")
    rows = []
    for factor in data.factors:
        if len(factor.levels) < 2 or not len(data.used):
            continue
        seen = data.used[["ppid", factor.column]].drop_duplicates()
        orders = Counter(
            ", ".join(of) for of in seen.groupby("ppid", sort=False)[factor.column].agg(list)
        )
        rows += [[factor.name, order, str(n)] for order, n in sorted(orders.items())]
    if rows:
        section.parts.append(
            Table(
                "Orders in which people first got the levels", ["Factor", "Order", "People"], rows
            )
        )
    if states := unbalanced_states(data):
        section.say(states, "note")
    kinds = list(next(iter(endings(data).values()), {}))
    if kinds:
        section.parts.append(
            Table(
                "How the trials used ended",
                ["Condition", *kinds],
                [[c, *(str(n[k]) for k in kinds)] for c, n in endings(data).items()],
                "Every other ending than success counts as no success.",
            )
        )
    return section


def _outcome(data: StudyData, one: Compared) -> Section:
    """The section on an outcome that is compared: a picture of all people, means and pairs."""
    what = one.what
    section = Section(f"outcome-{_id(what.name)}", what.title)
    if what.means and what.name not in ("time_s", "success"):
        section.say(f"{what.means[:1].upper()}{what.means[1:]}.")
    if what.scale == "limit":
        section.say(
            "Seconds to success, or the time limit in a trial without success. The mean is the "
            "restricted mean time, in which failures count."
        )
    factors = [f for f in one.values.factors if f.name in one.levels]
    if not factors:
        section.parts.append(_means(one, one.cells, "All trials"))
        return section
    tables = [
        _means(one, [*one.levels[f.name], *map(_nothing, data.unused_levels(f))], f.name)
        for f in factors
    ]
    of_trials = one.values.names == data.conditions
    cells = [*one.cells, *map(_nothing, data.unused_conditions if of_trials else ())]
    if len(cells) > len(tables[0].rows):
        tables.append(_means(one, cells, "Conditions"))
    svg = _people(one, factors)
    caption = "A thin line or dot is a person; the thick one is the mean over people" + (
        ", with its 95 % interval." if _has_interval(one) else "."
    )
    if one.pairs:
        tables.insert(0, _pairs(one))
    pictures = [(svg, caption)]
    if what.scale == "limit":
        pictures.append(_solved(data, factors[0], what))
    if one.interactions and _has_interval(one):
        tables.append(_differences(one))
    section.parts.append(Picture(tuple(pictures), tuple(tables)))
    if why := _no_interaction(one, factors):
        section.say(why, "note")
    return section


def _no_interaction(one: Compared, factors: Sequence[ObservedFactor]) -> str:
    """Reason why there is no table of the interaction of the first two factors.

    Empty if there is a table, or if there is only one factor.
    """
    if len(factors) < 2 or (one.interactions and _has_interval(one)):
        return ""
    names = f"the interaction of {factors[0].name} and {factors[1].name}"
    if not one.interactions:
        return f"No table of {names}: no person has values under all conditions that it compares."
    return f"No table of {names}: fewer than {FEWEST} people, or no spread among them."


def _nothing(name: str) -> Mean:
    """The empty mean of a condition or level of the design without used trials."""
    return Mean(name, 0, 0, Estimate())


def _has_interval(one: Compared) -> bool:
    return any(m.mean.is_known for some in one.levels.values() for m in some)


def _people(one: Compared, factors: Sequence[ObservedFactor]) -> str:
    """The picture of the means of every person."""
    what, values = one.what, one.values
    scale = _drawn(what)
    tables = [values.by_level(factor) for factor in factors]
    shown = [np.exp(t) if what.scale == "log" else t * scale for t in tables]
    means = [[_scaled(m, scale) for m in one.levels[f.name]] for f in factors]
    return plots.lines_by_person(
        f"people-{_id(what.name)}",
        f"{what.title} of every person",
        what.label,
        [f.name for f in factors],
        [f.levels for f in factors],
        shown,
        means,
        what.scale == "log",
        (0.0, scale) if what.scale == "share" else None,
    )


def _scaled(mean: Mean, scale: float) -> Any:
    e = mean.mean
    return type(e)(e.value * scale, e.low * scale, e.high * scale)


def _drawn(what: Measure) -> float:
    return 100.0 if what.scale == "share" else 1.0


def _mean_text(what: Measure, mean: Estimate) -> str:
    """A mean with its interval."""
    if what.scale == "share":
        return formats.estimate(mean, formats.percent, "%")
    return formats.estimate(mean, formats.number, what.unit)


def _difference_text(what: Measure, difference: Estimate) -> str:
    """A difference with its interval; for a logarithmic outcome, a ratio."""
    if what.scale == "share":
        return formats.estimate(difference, formats.points, "points")
    if what.scale == "log":
        return f"x {formats.estimate(difference)}"
    return formats.estimate(difference, formats.number, what.unit)


def _means(one: Compared, means: Sequence[Mean], caption: str) -> Table:
    rows = [[m.name, str(m.people), str(m.trials), _mean_text(one.what, m.mean)] for m in means]
    heading = "Mean (95 % interval)" if any(m.mean.is_known for m in means) else "Mean"
    return Table(
        caption, ["", "People", "Answers" if one.what.scale == "score" else "Trials", heading], rows
    )


def _pairs(one: Compared) -> Table:
    tested = one.role == CONFIRMATORY
    # If no interval is known, only the differences are shown.
    known = any(pair.estimate.is_known for pair in one.pairs)
    rows, note = [], ""
    for pair in one.pairs:
        estimate = pair.why or _difference_text(one.what, pair.estimate)
        cells = [pair.title, str(pair.people), estimate]
        if known:
            cells.append(formats.number(pair.dz, 2))
        if known and tested:
            cells += [formats.p_value(pair.p), formats.p_value(pair.p_holm)]
        rows.append(cells)
    names = sorted({pair.test for pair in one.pairs if pair.test})
    if not known:
        note = (
            f"Fewer than {FEWEST} people, or no spread among them: no interval and no test, so "
            "that nothing follows for other people."
        )
    elif not tested:
        note = "Exploratory: not tested."
    elif names:
        note = f"Test: {', '.join(names)}. Holm: adjusted for all tests of the study."
    more = ["dz", *(["p", "p, Holm"] if tested else [])] if known else []
    return Table("Pairs of levels", ["", "People", "Difference", *more], rows, note)


def _differences(one: Compared) -> Table:
    rows = [[name, str(n), _difference_text(one.what, e)] for name, e, n in one.interactions]
    return Table(
        "Interaction: difference of differences",
        ["", "People", "Estimate"],
        rows,
        "Exploratory: not tested.",
    )


def _solved(data: StudyData, factor: ObservedFactor, what: Measure) -> tuple[str, str]:
    """(SVG, description) of the picture of the share of trials that are solved by each second."""
    used = data.used
    times = [
        np.where(
            used.loc[used[factor.column] == level, "censored"],
            inf,
            used.loc[used[factor.column] == level, "time_s"],
        )
        for level in factor.levels
    ]
    longest = max((t[np.isfinite(t)].max(initial=0.0) for t in times), default=0.0)
    limit = max(what.high if isfinite(what.high) else float(longest), 1e-3)
    svg = plots.solved(factor.levels, times, limit)
    return svg, "Share of all trials that had succeeded by each second: time and success."


def _order(found: Results) -> Section:
    """The section on practice, on the places of levels in their orders, and on carry-over."""
    section, data = Section("order", "Practice and order"), found.data
    one = found.of("time_s")
    if one is None or not len(data.used):
        return section
    used = data.used.assign(value=trial_numbers(data, one.what))
    used["value"] = used["value"].where(np.isfinite(used["value"]))
    # Differences between conditions are removed, so that they do not look like practice.
    used["value"] -= used.groupby("cell")["value"].transform("mean") - used["value"].mean()
    lines = [
        (mine["position"].to_numpy(float), mine["value"].to_numpy(float))
        for _, mine in used.dropna(subset=["value"]).groupby("ppid", sort=False)
    ]
    mean = used.groupby("position")["value"].mean().dropna()
    if lines and len(mean) > 1:
        by_trial = mean.index.to_numpy(float), mean.to_numpy(float)
        svg = plots.practice(one.what.label, lines, by_trial)
        caption = (
            "Thin lines are people; the thick line is their mean. Differences between conditions "
            "are removed."
        )
        within = [f for f in one.values.factors if f.within and len(f.levels) > 1]
        tables = [_places(used, factor) for factor in within]
        if carried := _carried_over(data, found.compared[0]):
            tables.append(carried)
        section.parts.append(Picture(((svg, caption),), tuple(tables)))
    return section


def _carried_over(data: StudyData, one: Compared) -> Table | None:
    """A table of the differences of an outcome between two levels, by the level that came first.

    None if no pair of levels came in both orders.
    """
    rows = []
    for pair in one.pairs:
        factor = next(f for f in one.values.factors if f.name == pair.factor)
        met = data.used.groupby(["ppid", factor.column])["position"].min().unstack()
        if not factor.within or not {pair.first, pair.second} <= set(met.columns):
            continue
        own = paired_differences(one.values, factor, pair.first, pair.second)
        came = met.reindex(data.ppids)
        first = (came[pair.first] < came[pair.second]).to_numpy()
        groups = [own[first & np.isfinite(own)], own[~first & np.isfinite(own)]]
        if not pair.why and all(len(group) for group in groups):
            cells = [
                f"{_difference_text(one.what, one.what.in_unit(Estimate(g.mean())))}, "
                f"{counted(len(g), 'person', 'people')}"
                for g in groups
            ]
            apart = Estimate(float(groups[1].mean() - groups[0].mean()))
            if min(map(len, groups)) >= FEWEST:
                apart = welch(*groups)[0]
            rows.append([pair.title, *cells, _difference_text(one.what, apart)])
    if not rows:
        return None
    return Table(
        f"{one.what.title}: differences by the level that came first",
        ["", "The first level first", "The second first", "Apart"],
        rows,
        "In a row `B against A`, A is the first level and B the second. The two differences are "
        "unequal if one level affects the next level.",
    )


def _places(used: DataFrame, factor: ObservedFactor) -> Table:
    """A table of the means of a factor's levels at each place in its orders, with counts."""
    numbers = sorted(set(used[factor.place]))
    rows = []
    for level in factor.levels:
        cells = [level]
        for place in numbers:
            mine = used[(used[factor.column] == level) & (used[factor.place] == place)]
            people = mine.groupby("ppid")["value"].mean().dropna()
            here = counted(len(people), "person", "people")
            cells.append(f"{formats.number(float(people.mean()))} s, {here}" if len(people) else "")
        rows.append(cells)
    even = len({cell.rpartition(", ")[2] for row in rows for cell in row[1:]}) == 1
    note = "" if even else "Not balanced: levels were not equally often at every place."
    return Table(
        f"Place of each level of {factor.name} in its order",
        ["", *(f"Place {int(n)}" for n in numbers)],
        rows,
        note,
    )


def _words(data: StudyData) -> Section:
    """The section with every free-text answer, choice and note, verbatim."""
    section = Section("words", "Answers in words, and notes")
    for one in words(data):
        asked = f"{one.form}, {one.item}" + (f": {one.ask}" if one.ask else "")
        if one.is_choice:
            counts: dict[str, Counter[str]] = {}
            for _, condition, answer in one.answers:
                counts.setdefault(condition, Counter())[answer] += 1
            told = "; ".join(
                (f"{condition}: " if condition else "")
                + ", ".join(f"{answer} {n}" for answer, n in sorted(of.items()))
                for condition, of in counts.items()
            )
            section.say(f"{asked} {told}")
            continue
        rows = [[ppid, condition, answer] for ppid, condition, answer in one.answers]
        section.parts.append(
            _without_empty(Table(asked, ["", "Condition", "Answer"], rows, words=True))
        )
    if len(data.events) and {"event", "text", "ppid"} <= set(data.events.columns):
        notes = data.events[(data.events["text"] != "") & (data.events["event"] != "session_end")]
        rows = [
            [r["ppid"], r["event"].replace("_", " "), r.get("trial_num", ""), r["text"]]
            for _, r in notes.iterrows()
        ]
        if rows:
            section.parts.append(
                _without_empty(
                    Table(
                        "What the experimenter noted",
                        ["", "Event", "Trial", "Words"],
                        rows,
                        words=True,
                    )
                )
            )
    return section


def _rest(found: Results) -> Section:
    """The section with the means of all measures, scales and questions that are not compared."""
    section, data = Section("measures", "Further measures"), found.data
    rest = list(further(found))
    if not rest:
        return section
    factor = next((f for f in data.factors if len(f.levels) > 1), None)
    by_level = len(data.conditions) > MOST_CONDITIONS and factor is not None
    names = list(factor.levels) if by_level and factor else list(data.conditions)
    blocks: dict[tuple[str, ...], list[tuple[Measure, Values]]] = {}
    for what, values in rest:
        own = tuple(names) if values.names == data.conditions else values.names
        blocks.setdefault(own, []).append((what, values))
    for own, some in blocks.items():
        rows = []
        for what, values in some:
            show = formats.percent if what.scale == "share" else formats.number
            cells = [what.label]
            for name in own:
                of = (
                    values.cells_of(factor, name)
                    if by_level and factor and values.names == data.conditions
                    else [values.names.index(name)]
                )
                cells.append(formats.estimate(mean_of(what, values, name, of).mean, show))
            rows.append(cells)
        caption = "Means over people" + (
            ", with 95 % intervals" if len(data.ppids) >= FEWEST else ""
        )
        section.parts.append(Table(caption, ["", *own], rows))
    section.say(
        "Described and not tested: among many measures, some differ by chance. `[analysis] "
        "primary` of the design names the outcomes to test; codebook.csv of the study defines "
        "every measure."
    )
    return section


def further(found: Results) -> list[tuple[Measure, Values]]:
    """Measures, scales and questions that are not compared, with their person means.

    Measures with the same value in all trials are left out.
    """
    data, done = found.data, {one.what.name for one in found.compared}
    some: list[tuple[Measure, Values]] = []
    for name in data.measures:
        if (
            name in done
            or name not in data.used.columns
            or to_numbers(data.used[name]).nunique() < 2
        ):
            continue
        what = data.measure(name)
        if what is not None:
            some.append((what, trial_values(data, what)))
    return [*some, *score_values(data, main=False), *item_values(data)]


def _exclusions(data: StudyData) -> Section:
    section = Section("exclusions", "From all data to the data used")
    rows = [
        [
            s.what,
            str(s.participants) if s.remains else _minus(s.participants),
            ("" if s.what == "began" else str(s.trials)) if s.remains else _minus(s.trials),
        ]
        for s in flow(data)
    ]
    note = "Excluded data are not deleted: tables/trials.csv has all trials."
    section.parts.append(Table("Steps", ["Step", "Participants", "Trials"], rows, note))
    if data.withdrawals:
        section.say(data.withdrawals)
    return section


def _minus(n: int) -> str:
    return f"−{n}" if n else "0"


def _methods(found: Results, in_r: Sequence[dict[str, str]]) -> Section:
    section, data = Section("methods", "How this was computed"), found.data
    section.say(
        "The unit of analysis is the person: each person's trials give one mean per condition. "
        "Levels of a factor are compared by the differences of these means within people. The "
        "intervals are Student's t intervals. The tests are Student's t test for times and other "
        "numbers, a permutation test that flips signs for shares and counts, and Wilcoxon's "
        "signed-rank test for scores. Lengths, speeds and times other than the time to success are "
        "compared as logarithms if all are above 0. Groups are compared by Welch's test, scores of "
        "groups by the Mann-Whitney test. In a trial without success, the time to success is the "
        "time limit (restricted mean); it is compared only between levels with equal limits. Below "
        f"{FEWEST} people there are no intervals and no tests. Intervals are cut at the limits of "
        "the outcome."
    )
    outcomes = [one.what.name for one in found.compared if one.role == CONFIRMATORY and one.pairs]
    named = (
        f"The design names {', '.join(data.primary)} as primary; only these are tested"
        if data.primary
        else f"The design names no primary outcome; tested are {', '.join(outcomes) or 'none'}"
    )
    missing = f" Without data to compare: {', '.join(found.missing)}." if found.missing else ""
    section.say(
        f"{named}: {counted(found.tests, 'test')}, adjusted together by Holm's method (1979). All "
        f"other results are exploratory.{missing}"
    )
    if in_r:
        section.parts.append(_in_r(found, in_r))
    for form, wording in data.wordings.items():
        section.say(f"{form}: {wording}.", "note")
    for sentence in data.upgrades:
        section.say(sentence, "note")
    for line in (*data.without_frames, *data.clock_steps):
        section.say(f"{line}.", "note")
    section.parts.append(
        Table("Beside this page", ["File", "Content"], [list(f) for f in FILES], words=True)
    )
    software = ", ".join(f"{name} {_version(name)}" for name in LIBRARIES)
    section.say(
        f"Computed from {counted(len(data.trials), 'row')} of trials.csv (SHA-256 "
        f"{data.digest[:16]}…) with {software}."
    )
    return section


def _in_r(found: Results, rows: Sequence[dict[str, str]]) -> Table:
    """A table of the results of `analysis.R` next to the results of this page."""
    cells = []
    for row in rows:
        one = found.of(row.get("outcome", ""))
        pairs = one.pairs if one is not None else ()
        pair = next(
            (
                p
                for p in pairs
                if (p.factor, p.first, p.second)
                == (row.get("factor"), row.get("first"), row.get("second"))
            ),
            None,
        )
        if one is None or pair is None:
            continue
        theirs = Estimate(*(number_in(row.get(name, "")) for name in ("estimate", "low", "high")))
        if pair.people < FEWEST:
            theirs = Estimate(theirs.value)
        if row.get("kind") == pair.kind:
            shown = _difference_text(one.what, theirs)
        else:
            shown = f"{row.get('kind', '')} {formats.estimate(theirs)}"
        ours = _difference_text(one.what, pair.estimate)
        cells.append([f"{one.what.title}, {pair.title}", ours, shown, row.get("model", "")])
    return Table("Beside the models of analysis.R", ["", "Here", "R", "Model"], cells)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "of this folder"


def _id(name: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in name)
