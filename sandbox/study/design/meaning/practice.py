"""Flaws of practice: none, too late, or of some levels only."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.balance import whole_cycle
from sandbox.study.design.design import Design
from sandbox.study.design.plan import session_plan, trials_of
from sandbox.study.design.told.flaw import Flaw

MOST_PEOPLE = 12
"""People whose sessions are looked through, of a longer cycle."""


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


def _unpractised(design: Design) -> tuple[str, str, int] | None:
    """Factor, level and session of a trial whose level was not practised; None if all are."""
    for person in range(min(design.participants, whole_cycle(design), MOST_PEOPLE)):
        practised = set()
        for session in range(1, design.sessions + 1):
            for trial in trials_of(session_plan(design, person, session)):
                for factor, level in trial.levels.items():
                    if trial.practice:
                        practised.add((factor, level))
                    elif (factor, level) not in practised:
                        return factor, level, session
    return None
