"""Trials that are left out, by a rule or by the experimenter; none is ever deleted."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.study.design.design import Design
from sandbox.study.record.state import SessionState
from sandbox.study.tables.column import Row

PERSON = "participant: "
"""Beginning of the reason where all of a participant's trials are left out."""


def excluded_by_rule(design: Design, row: Row) -> str:
    """The rule about trials that leaves this one out, as a reason; empty where none does."""
    for rule in design.exclusions:
        value = row.get(rule.measure)
        if rule.of == "trial" and value is not None and rule.holds(float(value)):
            return f"rule {rule.name}"
    return ""


def exclude_person(design: Design, states: Sequence[SessionState], rows: Sequence[Row]) -> None:
    """Leaves out all trials of a participant whom the experimenter excluded in any session, or to
    whom a rule applies once all sessions are complete. Doing it twice changes nothing.

    Args:
        design: Design of the study.
        states: States of the participant's sessions.
        rows: Rows of `trial_results.csv` of these sessions.
    """
    reason = next((s.excluded_participant for s in states if s.excluded_participant), "")
    if not reason and len(states) == design.sessions and all(s.complete for s in states):
        reason = _by_rule(design, rows)
    if reason:
        for row in rows:
            row |= {"excluded": True, "exclusion_reason": PERSON + reason}


def _by_rule(design: Design, rows: Sequence[Row]) -> str:
    """The first rule about participants that holds for the mean of somebody's trials."""
    counted = [r for r in rows if r["counted"] and not r["practice"] and not r["excluded"]]
    for rule in design.exclusions:
        values = [float(r[rule.measure]) for r in counted if r.get(rule.measure) is not None]
        if rule.of == "participant" and values and rule.holds(sum(values) / len(values)):
            return f"rule {rule.name}"
    return ""
