"""Flaws of the course of sessions: durations, breaks, practice, and starts that come again."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.conditions import tasks_of
from sandbox.study.design.design import Design
from sandbox.study.design.meaning.flaw import Flaw
from sandbox.study.design.plan import BreakStep, Step, duration, session_plan

LONGEST_SESSION = 5400.0
"""s; a rule of thumb: after an hour and a half, weariness is measured."""
LONGEST_STRETCH = 1800.0
"""s without a break, also a rule of thumb."""
CUT = 0.8
"""Share of the time limit that a trial may be expected to take; of longer ones, many are cut."""


def session_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of all sessions."""
    yield from _times(design)
    plans = [session_plan(design, 0, n + 1) for n in range(design.sessions)]
    yield from _lengths(design, plans)
    if not design.practice:
        yield Flaw(
            ("trials", "practice"),
            "nobody practises, so that the first trials measure how the program is learnt",
            "Write practice = 2 or more; practice trials are left out of the results",
        )
    elif design.practice_sessions and 1 not in design.practice_sessions:
        yield Flaw(
            ("trials", "practice_sessions"),
            "nobody practises in the first session",
            "Add 1, or remove the line",
        )
    if design.sessions > 1 and design.seeds == "shared":
        yield Flaw(
            ("trials", "seeds"),
            "starts and goals of all sessions are the same, so that a later one measures what is "
            "remembered of them, too",
            'Write seeds = "own"',
        )


def _times(design: Design) -> Iterator[Flaw]:
    holds = {name: task.hold_time for name, task in tasks_of(design).items()}
    too_long = {task: hold for task, hold in holds.items() if hold >= design.time_limit}
    if too_long:
        names = ", ".join(f"{task} {hold:g} s" for task, hold in too_long.items())
        yield Flaw(
            ("trials", "time_limit_s"),
            f"no trial can succeed: the limit is {design.time_limit:g} s, and the goal must be "
            f"held for ({names})",
            f"Write more than {max(too_long.values()):g}",
            error=True,
        )
    elif design.expected > design.time_limit:
        yield Flaw(
            ("trials", "expected_s"),
            f"{design.expected:g} s is more than the time limit, {design.time_limit:g} s",
            "Write the expected duration of a trial, below time_limit_s",
        )
    elif design.expected > CUT * design.time_limit:
        yield Flaw(
            ("trials", "time_limit_s"),
            f"a trial is expected to take {design.expected:g} s and ends at {design.time_limit:g} "
            "s, so that many are cut off before they succeed",
            f"Write {design.expected / CUT:.3g} or more; twice as long as expected is usual",
        )


def _lengths(design: Design, plans: list[list[Step]]) -> Iterator[Flaw]:
    if design.break_every and not any(isinstance(s, BreakStep) for plan in plans for s in plan):
        yield Flaw(
            ("breaks", "every"),
            f"no break ever comes: no session has more than {design.break_every} trials without "
            "practice",
            "Write a smaller number, or remove [breaks]",
        )
    longest = max(duration(design, plan) for plan in plans)
    if longest > LONGEST_SESSION:
        yield Flaw(
            ("trials", "repetitions"),
            f"a session takes {longest / 60:.0f} min, so that weariness is measured, too",
            "Write fewer repetitions, or several sessions",
        )
    stretch = max(_stretch(design, plan) for plan in plans)
    if stretch > LONGEST_STRETCH:
        yield Flaw(
            ("breaks", "every"),
            f"{stretch / 60:.0f} min come without a break",
            "Write [breaks] with every = a number of trials of a quarter of an hour",
        )


def _stretch(design: Design, steps: list[Step]) -> float:
    """Longest expected time without a break, s."""
    longest, since = 0.0, 0
    for i, step in enumerate(steps):
        if isinstance(step, BreakStep):
            longest, since = max(longest, duration(design, steps[since:i])), i + 1
    return max(longest, duration(design, steps[since:]))
