"""Exclusion of trials by a rule or by the experimenter; excluded trials are never deleted."""

from __future__ import annotations

from collections.abc import Sequence

from models.arithmetic.products import total
from sandbox.study.design.design import Design
from sandbox.study.record.state import SessionState
from sandbox.study.tables.column import Row

PERSON = "participant: "
"""Prefix of the reason if all trials of a participant are excluded."""


def excluded_by_rule(design: Design, row: Row) -> str:
    """Reason why a rule on trials excludes this row; empty if no rule does."""
    for rule in design.exclusions:
        value = row.get(rule.measure)
        if rule.of == "trial" and value is not None and rule.holds(float(value)):
            return f"rule {rule.name}"
    return ""


def exclude_person(design: Design, states: Sequence[SessionState], rows: Sequence[Row]) -> None:
    """Marks all trials of a participant as excluded, if the experimenter excluded the participant
    in any session or a rule on participants applies. Rules apply once all sessions are complete.
    A second call changes nothing.

    Args:
        design: Design of the study.
        states: States of the participant's sessions.
        rows: Rows of `trial_results.csv` of these sessions.
    """
    reason = next((s.excluded_participant for s in states if s.excluded_participant), "")
    if not reason and len(states) >= design.sessions and all(s.complete for s in states):
        reason = _by_rule(design, rows)
    if reason:
        for row in rows:
            row |= {"excluded": True, "exclusion_reason": PERSON + reason}


def excluded_person(design: Design, states: Sequence[SessionState], rows: Sequence[Row]) -> str:
    """Reason why a participant is excluded, after `exclude_person`; empty for one who is not.

    An experimenter may begin the reason for a single trial with `participant: `, too: only a rule
    of the design that marks all trials is a rule on participants.
    """
    for state in states:
        if state.excluded_participant:
            return state.excluded_participant
    marks = {row["exclusion_reason"] for row in rows}
    rules = (f"rule {rule.name}" for rule in design.exclusions if rule.of == "participant")
    return next((reason for reason in rules if marks == {PERSON + reason}), "")


def _by_rule(design: Design, rows: Sequence[Row]) -> str:
    """Name of the first rule on participants that the mean over these trials meets, as a reason."""
    counted = [r for r in rows if r["counted"] and not r["practice"] and not r["excluded"]]
    for rule in design.exclusions:
        values = [float(r[rule.measure]) for r in counted if r.get(rule.measure) is not None]
        if rule.of == "participant" and values and rule.holds(total(values) / len(values)):
            return f"rule {rule.name}"
    return ""
