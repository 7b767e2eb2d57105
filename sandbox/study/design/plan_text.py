"""The plan of a study as text: who gets which levels in which order, and how long it takes.

For a preregistration, the text is Markdown, and also has the design, the number of people, the
exclusions and the tests. All of it is computed from the design. It does not contain the purpose of
the study, which the authors write themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby, product

from models.message import counted
from sandbox.study.design.balance import confounded, cycle_line, nearest_cycles, whole_cycle
from sandbox.study.design.design import Design, Exclusion
from sandbox.study.design.power import ALPHA, family_size, planned_tests, power_lines
from sandbox.study.design.session_plan import BreakStep, Step, duration, session_plan, trials_of
from sandbox.study.measures.measures import find_measure

MOST_ORDERS = 24
"""Largest number of participants whose orders a preregistration lists."""


def order_rows(design: Design, people: int) -> list[list[str]]:
    """Rows of a table of orders; the first row names the columns.

    Each session has a row for every combination of levels of the outer factors. The row has the
    order of the innermost factor's levels.

    Args:
        design: The design.
        people: Number of participants, from the first one.
    """
    names = [factor.name for factor in design.factors]
    several = design.sessions > 1
    rows = [["participant", *(["session"] * several), *names, "trials", "minutes"]]
    for number, session in product(range(1, people + 1), range(1, design.sessions + 1)):
        steps = session_plan(design, number, session)
        before = [str(number), *([str(session)] * several)]
        after = [str(len(trials_of(steps))), f"{duration(design, steps) / 60:.0f}"]
        for levels in _levels_in_order(design, steps):
            rows.append([*before, *levels, *after])
            before, after = [""] * len(before), [""] * len(after)
    return rows


def _levels_in_order(design: Design, steps: list[Step]) -> Iterator[list[str]]:
    """Yields the levels of the outer factors, and the order of the innermost factor within them.

    An outer level is named only in the row in which it begins.
    """
    names = [factor.name for factor in design.factors]
    met = [[t.levels[name] for name in names] for t in trials_of(steps) if not t.practice]
    last = [""] * (len(names) - 1)
    for outer, some in groupby(met, key=lambda levels: levels[:-1]):
        changed = next((i for i, (a, b) in enumerate(zip(outer, last, strict=True)) if a != b), 0)
        shown = [level if i >= changed else "" for i, level in enumerate(outer)]
        yield [*shown, _order([levels[-1] for levels in some])]
        last = outer


def _order(levels: Sequence[str]) -> str:
    """Levels in their sequence, without immediate repeats; a long sequence is cut."""
    runs = [level for level, _ in groupby(levels)]
    if len(runs) > 2 * len(set(levels)):
        return f"{', '.join(runs[: len(set(levels))])}, ... ({len(runs)} changes)"
    return ", ".join(runs)


def session_lines(design: Design, people: int) -> Iterator[str]:
    """Lines on the trials, durations and breaks of sessions, for so many participants."""
    total = 0.0
    breaks: dict[str, None] = {}
    for session in range(1, design.sessions + 1):
        steps = session_plan(design, 1, session)
        trials = trials_of(steps)
        practice = sum(trial.practice for trial in trials)
        total += duration(design, steps)
        yield (
            f"session {session} of {design.sessions}: {counted(len(trials) - practice, 'trial')} "
            f"after {practice} of practice, about {duration(design, steps) / 60:.0f} min"
        )
        before = [trials_of(steps[:i]) for i, s in enumerate(steps) if isinstance(s, BreakStep)]
        if before:
            places = (str(sum(not t.practice for t in some)) for some in before)
            breaks[" and ".join(places)] = None
    yield (
        f"{counted(people, 'participant')}: about {people * total / 3600:.1f} h in all, if a trial "
        f"takes {design.expected:g} s"
    )
    if breaks:
        yield (
            f"a break of {design.break_time:g} s or longer comes after {', or '.join(breaks)} "
            "trials of a session, practice not counted"
        )


def cycle_lines(design: Design, people: int) -> Iterator[str]:
    """Lines on orders: how many people a full cycle takes, and what is confounded with `people`."""
    yield cycle_line(design)
    missing = confounded(design, people)
    if missing:
        yield (
            f"{counted(people, 'participant')} do not complete a cycle (choose "
            f"{nearest_cycles(design, people)}); this is confounded:"
        )
        yield from (f"  {line}" for line in missing)


def plan_markdown(design: Design, people: int) -> str:
    """Design, sessions, orders, exclusions, tests and people as a text for a preregistration.

    Args:
        design: The design.
        people: Number of participants.
    """
    parts = (
        [
            f"# {design.title or design.name}",
            "",
            f"Study `{design.name}`, design with the digest `{design.digest}`, seed {design.seed}.",
        ],
        _factors(design),
        _sessions(design, people),
        _orders(design, people),
        _exclusions(design),
        _tests(design),
        ["## People", "", *(f"- {line}" for line in power_lines(design, people))],
    )
    return "\n".join(line for part in parts for line in (*part, ""))


def _factors(design: Design) -> Iterator[str]:
    yield from ("## Design", "")
    rows = [["factor", "order", "levels and what they set"]]
    for factor in design.factors:
        levels = ", ".join(f"{level.name} ({_set(level.settings)})" for level in factor.levels)
        inside = f", inside {factor.outer}" if factor.outer else ""
        session = ", one level a session" if factor.one_a_session else ""
        rows.append([factor.name, f"{factor.order}{inside}{session}", levels])
    yield from _table(rows)
    if design.settings:
        yield from ("", f"All trials: {_set(design.settings)}.")


def _set(settings: dict[str, object]) -> str:
    return ", ".join(f"{name} = {value}" for name, value in settings.items())


def _sessions(design: Design, people: int) -> Iterator[str]:
    yield from ("## Sessions and trials", "")
    yield from (f"- {line}." for line in session_lines(design, people))
    yield f"- {design.repetitions} repetitions of each combination of levels."
    yield f"- A trial ends after {design.time_limit:g} s, or after its task's own limit if shorter."
    for form in design.questionnaires:
        scores = ", ".join(scale.name for scale in form.scales)
        yield f"- Questionnaire {form.name}, at {form.at}" + (f": {scores}." if scores else ".")


def _orders(design: Design, people: int) -> Iterator[str]:
    yield from ("## Orders", "")
    yield from (f"- {line.strip()}" for line in cycle_lines(design, people))
    yield ""
    yield from _table(order_rows(design, min(people, whole_cycle(design), MOST_ORDERS)))


def _exclusions(design: Design) -> Iterator[str]:
    yield from ("## Exclusions", "")
    yield (
        "Practice trials and attempts that were broken off are left out. The experimenter may "
        "exclude a trial or a participant by hand, with a reason."
    )
    yield ""
    for rule in design.exclusions:
        yield f"- {rule.name}: a {rule.of} with {rule.measure} {_bounds(rule)}."
    if not design.exclusions:
        yield "No other rule excludes trials or participants."


def _bounds(rule: Exclusion) -> str:
    measure = find_measure(rule.measure)
    unit = f" {measure.unit}" if measure is not None and measure.unit else ""
    bounds = (("below", rule.below), ("above", rule.above))
    return " or ".join(f"{side} {value:g}{unit}" for side, value in bounds if value is not None)


def _tests(design: Design) -> Iterator[str]:
    tests = planned_tests(design)
    yield from ("## Tests", "")
    rows = [["outcome", "factor", "compared", "pairs of levels"]]
    for test in tests:
        compared = "groups" if test.between else "within people"
        rows.append([test.outcome, test.factor.name, compared, str(test.pairs)])
    yield from _table(rows)
    yield ""
    yield (
        "The unit of analysis is the person: each value is the mean over a person's trials under a "
        "condition. In means of times, a trial without success counts as the time limit. Pairs of "
        "levels within people are compared by Student's paired t test; shares and counts by a "
        "permutation test that flips signs; scores by Wilcoxon's signed-rank test. Groups are "
        "compared by Welch's t test; scores by the Mann-Whitney test. All tests are two-sided. The "
        f"p values of all {family_size(tests)} tests are adjusted together (Holm), so that a study "
        f"without differences has a finding with probability {ALPHA:g} at most. All other results "
        "are exploratory and not tested."
    )


def _table(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """A table in Markdown; its first row names the columns."""
    for i, row in enumerate(rows):
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |"
        if not i:
            yield f"|{' --- |' * len(row)}"
