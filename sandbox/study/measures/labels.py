"""Measures of finger labels: how often they change, and how long they are wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

FingersByContact = Mapping[Any, int]
"""Fingers (thumb 0 .. little 4) by contact; by hand and contact where there may be two hands."""


def label_switches(named: Sequence[FingersByContact]) -> int:
    """How often a contact that had a finger got another one, at once or after having had none."""
    last: dict[Any, int] = {}
    switches = 0
    for now in named:
        switches += sum(last.get(contact, finger) != finger for contact, finger in now.items())
        last.update(now)
    return switches


def label_errors(
    named: Sequence[FingersByContact], true: Sequence[FingersByContact], period: float
) -> dict[str, Any]:
    """How labels compare with the truth.

    An error begins when a contact has a wrong finger, and ends when it has the right one. One that
    has no finger in between is still waiting for it; one whose contact ends before was never put
    right.

    Args:
        named: What was said, by moment.
        true: What is true; contacts that it does not know are passed over.
        period: s between two moments.

    Returns:
        `label_accuracy`, `label_errors`, `label_recovery_s` and `label_unrecovered`; nothing where
        nothing is known.
    """
    if not any(true):
        return {}
    looked_at = right = errors = 0
    since: dict[Any, int] = {}
    recoveries: list[float] = []
    for i, (now, truth) in enumerate(zip(named, true, strict=True)):
        for contact, finger in now.items():
            if contact not in truth:
                continue
            fits = finger == truth[contact]
            looked_at += 1
            right += fits
            if fits and contact in since:
                recoveries.append((i - since.pop(contact)) * period)
            elif not fits and contact not in since:
                errors += 1
                since[contact] = i
    return {
        "label_accuracy": right / looked_at if looked_at else None,
        "label_errors": errors,
        "label_recovery_s": sum(recoveries) / len(recoveries) if recoveries else None,
        "label_unrecovered": len(since),
    }
