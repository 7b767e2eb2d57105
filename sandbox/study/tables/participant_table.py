"""`participants.csv`: one row for every participant."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sandbox.study.design.design import Design
from sandbox.study.record.session_clock import CLOCK_STEPS
from sandbox.study.record.state import SessionState
from sandbox.study.tables.column import NO_EARLIER, Column, Earlier, Row, names_of
from sandbox.study.tables.exclusions import excluded_person
from sandbox.study.tables.trial_table import SESSION, UXF

_COMMON = {column.name: column for column in (*UXF, *SESSION)}

PARTICIPANT = (
    _COMMON["ppid"],
    Column("number", "", "order of arrival, from 0; it determines the order of levels"),
    _COMMON["hand"],
    _COMMON["hand_size"],
    Column("language", "", "language in which the participant takes part"),
    _COMMON["mode"],
    Column("simulated", "0/1", "1: a simulated user, not a person"),
    Column("consent", "0/1", "1: the participant consented; empty: consent was not asked for"),
    Column("sessions_done", "", "sessions that reached their planned end"),
    Column("trials_done", "", "trials with a counted attempt, practice included"),
    Column("trials_planned", "", "planned trials of all sessions, practice included"),
    Column("complete", "0/1", "1: all sessions reached their planned end"),
    Column(
        "excluded", "0/1", "1: a rule or the experimenter excluded all trials of the participant"
    ),
    Column("exclusion_reason", "", "`rule NAME`, or the experimenter's words"),
    Column(
        CLOCK_STEPS,
        "s",
        "steps of the wall clock during the sessions, separated by spaces; times of trials come "
        "from another clock; empty if there was none",
    ),
)


def participant_columns(design: Design, earlier: Earlier = NO_EARLIER) -> list[Column]:
    """Columns of `participants.csv`, and then those of the questions of earlier designs.

    A question of an older design that is named like one of `PARTICIPANT` has no column here; its
    answers are in `questionnaires.csv`.
    """
    language, filled = design.languages[0], names_of(PARTICIPANT)
    asked = [x for x in design.demographics if x.name not in filled]
    return [
        *PARTICIPANT,
        *(Column(x.name, "", x.ask[language]) for x in asked),
        *(
            Column(name, "", "answer to a question of an earlier design, empty since then")
            for name in earlier.questions
        ),
    ]


def earlier_questions(design: Design, rows: Iterable[Row]) -> Earlier:
    """Questions about the person that rows of `participants.csv` have and a design has not."""
    own = {*names_of(participant_columns(design))}
    return Earlier(questions=tuple(dict.fromkeys(n for row in rows for n in row if n not in own)))


def participant_row(
    design: Design,
    states: Sequence[SessionState],
    planned: int,
    rows: Sequence[Row],
    sessions: int = 1,
) -> Row:
    """Row of a participant in `participants.csv`, or in the table of a single session.

    Args:
        design: Design of the study.
        states: States of the sessions that have begun, at least one.
        planned: Planned number of trials, practice included.
        rows: Rows of `trial_results.csv` of these sessions.
        sessions: Planned number of sessions.
    """
    start = states[0].start
    reason = excluded_person(design, states, rows)
    asked = [s.about_person for s in states if s.about_person is not None]
    ended = sum(state.complete for state in states)  # any order: whole numbers
    return {
        # What the program knows is not for a question to change.
        **(asked[-1] if asked else {}),
        **{
            name: start[name]
            for name in ("ppid", "number", "hand", "hand_size", "language", "mode")
        },
        "simulated": start["user"] is not None,
        "consent": next((s.consent for s in states if s.consent is not None), None),
        "sessions_done": ended,
        "trials_done": sum(s.counted(t) is not None for s in states for t in s.attempts),
        "trials_planned": planned,
        "complete": ended >= sessions,
        "excluded": bool(reason),
        "exclusion_reason": reason,
        CLOCK_STEPS: " ".join(f"{step:+g}" for s in states for step in s.clock_steps),
    }
