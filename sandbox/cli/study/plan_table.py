"""Table of `sandbox study plan`: each participant's orders as they will meet them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from rich.table import Table

from models.message import counted
from sandbox.study.design.balance import confounded, cycle_line, nearest_cycles
from sandbox.study.design.checks import parting_breaks
from sandbox.study.design.conditions import tasks_of
from sandbox.study.design.design import Design
from sandbox.study.design.plan import BreakStep, Step, session_plan, trials_of
from sandbox.study.design.toml_lines import TomlLines


def plan_table(design: Design) -> Table:
    """An empty table for `add_session`."""
    several = ("session",) if design.sessions > 1 else ()
    names = (factor.name for factor in design.factors)
    return Table("participant", *several, *names, "trials", "minutes")


def add_session(
    table: Table, design: Design, participant: int, session: int, steps: list[Step], minutes: float
) -> None:
    """Adds a session: a line for every combination of outer levels, with the inner order in it."""
    trials = trials_of(steps)
    several = (str(session),) if design.sessions > 1 else ()
    before = [str(participant + 1), *several]
    after = [str(len(trials)), f"{minutes:.0f}"]
    for line in order_lines(design, steps):
        table.add_row(*before, *line, *after)
        before, after = [""] * len(before), [""] * len(after)


def order_lines(design: Design, steps: list[Step]) -> list[list[str]]:
    """Levels of the outer factors, each named where it begins, and the inner order within them."""
    names = [factor.name for factor in design.factors]
    met = [[t.levels[name] for name in names] for t in trials_of(steps) if not t.practice]
    lines, last = [], [""] * (len(names) - 1)
    for outer, some in groupby(met, key=lambda levels: levels[:-1]):
        changed = next((i for i, (a, b) in enumerate(zip(outer, last, strict=True)) if a != b), 0)
        shown = [level if i >= changed else "" for i, level in enumerate(outer)]
        lines.append([*shown, _order([levels[-1] for levels in some])])
        last = outer
    return lines


def _order(levels: Sequence[str]) -> str:
    """Levels as they follow each other, without repeats; not more than a line holds."""
    runs = [level for level, _ in groupby(levels)]
    if len(runs) > 2 * len(set(levels)):
        return f"{', '.join(runs[: len(set(levels))])}, ... ({len(runs)} changes)"
    return ", ".join(runs)


def own_limits(design: Design) -> str:
    """Line on tasks that end before the time limit that the design asks for; empty without any."""
    if not TomlLines(design.text).has(("trials", "time_limit_s")):
        return ""
    limits = {name: task.time_limit for name, task in tasks_of(design).items()}
    short = [f"{name} {limit:g} s" for name, limit in limits.items() if limit < design.time_limit]
    if not short:
        return ""
    return (
        f"trials end sooner than time_limit_s = {design.time_limit:g}, by their task's own limit: "
        f"{', '.join(short)}"
    )


def break_lines(design: Design, people: int) -> list[str]:
    """Lines on breaks: after how many trials they come, and which of them part practice from its
    trials; none without breaks."""
    places: dict[str, None] = {}
    for session in range(1, design.sessions + 1):
        steps = session_plan(design, 0, session)
        breaks = [i for i, step in enumerate(steps) if isinstance(step, BreakStep)]
        measured = [sum(not t.practice for t in trials_of(steps[:i])) for i in breaks]
        if measured:
            places[" and ".join(map(str, measured))] = None
    if not places:
        return []
    lines = [
        f"a break of {design.break_time:g} s or longer comes after {', or '.join(places)} trials "
        "of a session, practice not counted"
    ]
    parting = parting_breaks(design, people)
    if parting:
        person, session, trial = parting[0]
        among = len({one for one, _, _ in parting})
        where = f" of session {session}" if design.sessions > 1 else ""
        lines.append(
            "breaks come between practice and its trials in the sessions of "
            f"{counted(among, 'participant')}, first after trial {trial}{where} of participant "
            f"{person}: write another number for breaks.every"
        )
    return lines


def cycle_lines(design: Design, people: int) -> list[str]:
    """Lines about participants: how many a full cycle takes, and what so many leave confounded."""
    lines = [cycle_line(design)]
    problems = confounded(design, people)
    if problems:
        lines.append(
            f"{people} participants are no full cycle (write {nearest_cycles(design, people)}); "
            "confounded is:"
        )
        lines += [f"  {line}" for line in problems]
    return lines
