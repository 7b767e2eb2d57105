"""`participants.csv`: one row for every participant."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.study.design.design import Design
from sandbox.study.record.state import SessionState
from sandbox.study.tables.column import Column, Row
from sandbox.study.tables.exclusions import PERSON
from sandbox.study.tables.trial_table import SESSION, UXF

_NAMED = {column.name: column for column in (*UXF, *SESSION)}

PEOPLE = (
    _NAMED["ppid"],
    Column("number", "", "order of arrival, from 0; it decides the order of levels"),
    _NAMED["hand"],
    _NAMED["hand_size"],
    Column("language", "", "language of the texts"),
    _NAMED["mode"],
    Column("simulated", "0/1", "1: a simulated user, not a person"),
    Column("consent", "0/1", "1: the participant agreed; empty: they were not asked"),
    Column("sessions_done", "", "sessions that reached their planned end"),
    Column("trials_done", "", "trials with an attempt that counts, practice included"),
    Column("trials_planned", "", "trials of all sessions, practice included"),
    Column("complete", "0/1", "1: all sessions reached their planned end"),
    Column("excluded", "0/1", "1: all trials are left out by a rule or by the experimenter"),
    Column("exclusion_reason", "", "`rule NAME`, or the experimenter's words"),
)


def person_columns(design: Design) -> list[Column]:
    """Columns of `participants.csv`."""
    language = design.languages[0]
    return [*PEOPLE, *(Column(x.name, "", x.ask[language]) for x in design.demographics)]


def person_row(
    design: Design,
    states: Sequence[SessionState],
    planned: int,
    rows: Sequence[Row],
    sessions: int = 1,
) -> Row:
    """A participant's row in `participants.csv`, or in the one of a single session.

    Args:
        design: Design of the study.
        states: States of the sessions that were begun, at least one.
        planned: Trials of all sessions.
        rows: Rows of `trial_results.csv` of these sessions.
        sessions: Number of sessions that are planned.
    """
    start = states[0].start
    reasons = [r["exclusion_reason"] for r in rows if r["exclusion_reason"].startswith(PERSON)]
    # Where nothing was finished there are no rows.
    reasons += [s.excluded_participant for s in states if s.excluded_participant]
    reason = reasons[0].removeprefix(PERSON) if reasons else ""
    asked = [r for s in states for r in s.answers.values() if r["form"] == "demographics"]
    ended = sum(state.complete for state in states)
    return {
        **{
            name: start[name]
            for name in ("ppid", "number", "hand", "hand_size", "language", "mode")
        },
        "simulated": start["user"] is not None,
        "consent": next((s.consent for s in states if s.consent is not None), None),
        "sessions_done": ended,
        "trials_done": sum(s.counted(t) is not None for s in states for t in s.attempts),
        "trials_planned": planned,
        "complete": ended == sessions,
        "excluded": bool(reason),
        "exclusion_reason": reason,
        **(asked[-1]["answers"] if asked else {}),
    }
