"""Measures of finger labels: number of changes, errors, and time to recovery."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from models.arithmetic.products import total

FingersByContact = Mapping[Any, int]
"""Finger label (thumb 0 .. little 4) by contact; with two hands, by hand and contact."""


def label_switches(labels: Sequence[FingersByContact]) -> int:
    """Number of times that a labelled contact got another label, at once or later."""
    last: dict[Any, int] = {}
    switches = 0
    for now in labels:
        switches += sum(last.get(contact, finger) != finger for contact, finger in now.items())
        last.update(now)
    return switches


def label_errors(
    labels: Sequence[FingersByContact], true: Sequence[FingersByContact], period: float
) -> dict[str, Any]:
    """Compares labels with the true fingers.

    An error begins when a contact gets a wrong label, and ends when it gets the right one. Moments
    without a label in between do not end it. If the contact ends first, the error was never
    corrected.

    Args:
        labels: Assigned labels at each moment.
        true: True fingers at each moment; contacts that are missing here are ignored.
        period: Time between two moments, s.

    Returns:
        `label_accuracy`, `label_errors`, `label_recovery_s` and `label_unrecovered`; empty if no
        true finger is known.
    """
    if not any(true):
        return {}
    compared = right = errors = 0
    since: dict[Any, int] = {}
    recoveries: list[float] = []
    for i, (now, truth) in enumerate(zip(labels, true, strict=True)):
        for contact, finger in now.items():
            if contact not in truth:
                continue
            fits = finger == truth[contact]
            compared += 1
            right += fits
            if fits and contact in since:
                recoveries.append((i - since.pop(contact)) * period)
            elif not fits and contact not in since:
                errors += 1
                since[contact] = i
    return {
        "label_accuracy": right / compared if compared else None,
        "label_errors": errors,
        "label_recovery_s": total(recoveries) / len(recoveries) if recoveries else None,
        "label_unrecovered": len(since),
    }
