"""Flaws of practice: none, too late, of some levels only, or with a break after it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from sandbox.study.design.balance import whole_cycle
from sandbox.study.design.design import Design
from sandbox.study.design.plan import BreakStep, TrialStep, session_plan, trials_of
from sandbox.study.design.told.flaw import Flaw

MOST_PEOPLE = 12
"""People whose sessions are looked through, of a longer cycle."""
FURTHEST = 12
"""Largest change of the number of trials between breaks that is tried for a remedy."""


def practice_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of practice."""
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
    elif unpractised := _unpractised(design):
        factor, level, session = unpractised
        late = session > 1 and bool(design.practice_sessions)
        where = f"in session {session}, " if design.sessions > 1 else ""
        yield Flaw(
            ("trials", "practice_sessions" if late else "practice"),
            f"{where}{level} of {factor} is measured before anybody has practised it, and other "
            "levels are practised",
            f"Add {session}, or remove the line"
            if late
            else f'Write practice_each = "{factor}", or more practice trials',
        )

    yield from _breaks_after_practice(design)


def _breaks_after_practice(design: Design) -> Iterator[Flaw]:
    """Breaks between practice and the trials that it is for."""
    people = _people(design)
    if not design.practice_each or not design.break_every or not parting_breaks(design, people):
        return
    nearest = sorted(range(1, design.break_every + FURTHEST), key=_distance(design.break_every))
    fits = next((n for n in nearest if _fits(design, n)), None)
    yield Flaw(
        ("breaks", "every"),
        f"a break comes between the practice of a level of {design.practice_each} and its trials, "
        "so that what was practised is measured after a rest",
        f"Write {fits}, for instance; `sandbox study plan` says where breaks come"
        if fits
        else "Write another number, or remove [breaks]",
    )


def _distance(number: int) -> Callable[[int], int]:
    return lambda other: abs(other - number)


def _fits(design: Design, every: int) -> bool:
    """True if breaks come after so many trials, and never right after practice."""
    other = replace(design, break_every=every)
    some = any(isinstance(step, BreakStep) for step in session_plan(other, 0))
    return some and not parting_breaks(other, _people(design))


def _people(design: Design) -> int:
    """Number of participants whose sessions are looked through."""
    return min(design.participants, whole_cycle(design), MOST_PEOPLE)


def parting_breaks(design: Design, people: int) -> list[tuple[int, int, int]]:
    """Breaks right after practice, in the sessions of the first so many participants: participant,
    session, and number of the trial before the break, each from 1."""
    found = []
    for person in range(people):
        for session in range(1, design.sessions + 1):
            last: TrialStep | None = None
            for step in session_plan(design, person, session):
                if isinstance(step, BreakStep) and last is not None and last.practice:
                    found.append((person + 1, session, last.number))
                if isinstance(step, TrialStep):
                    last = step
    return found


def _unpractised(design: Design) -> tuple[str, str, int] | None:
    """Factor, level and session of a trial whose level was not practised; None if all are."""
    for person in range(_people(design)):
        practised = set()
        for session in range(1, design.sessions + 1):
            for trial in trials_of(session_plan(design, person, session)):
                for factor, level in trial.levels.items():
                    if trial.practice:
                        practised.add((factor, level))
                    elif (factor, level) not in practised:
                        return factor, level, session
    return None
