"""Measures of handling and of finger labels: grasps, regrasps, drops; changes and errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import total
from models.scene import CONTROL_PERIOD
from sandbox.study.measures.arrays import NO_CONTACT, ObjectArrays, TrialArrays

RELEASE = 0.1
"""An object counts as released after this time (s) without any push of a hand."""
FORCE = 0.05
"""Force (N) at which a push begins. It ends when no digit pushes at all. With one threshold for
begin and end, a single light touch would count as many pushes."""
FALL = 0.010
"""An untouched object counts as dropped if it falls by more than this (m). If it is released a
little above its place, it is put down, not dropped."""
PALM = "p"

FingersByContact = Mapping[Any, int]
"""Finger label (thumb 0 .. little 4) by contact, or by (hand, contact) with several hands."""


def true_intervals(mask: ArrayLike) -> list[tuple[int, int]]:
    """First and last index of every run of true values in a mask (n,)."""
    edges = np.diff(np.concatenate([[0], np.asarray(mask, bool).astype(int), [0]]))
    return list(
        zip(
            np.flatnonzero(edges > 0).tolist(),
            (np.flatnonzero(edges < 0) - 1).tolist(),
            strict=True,
        )
    )


def push_intervals(digits: Sequence[str], grip: ArrayLike, period: float) -> list[tuple[int, int]]:
    """Intervals in which a hand pushes an object, by first and last index.

    An interval begins with a push of `FORCE` or more. Later pushes of any force belong to it, until
    there is no push for `RELEASE`.

    Args:
        digits: Letters of the pushing digits at each moment.
        grip: (n,) total normal force, N.
        period: Time between two moments, s.
    """
    strong = np.asarray(grip, float) >= FORCE
    joined: list[tuple[int, int]] = []
    for first, last in true_intervals([bool(d) for d in digits]):
        if joined and (first - joined[-1][1]) * period < RELEASE - 1e-9:
            joined[-1] = (joined[-1][0], last)
        elif (enough := strong[first : last + 1]).any():
            joined.append((first + int(np.argmax(enough)), last))
    return joined


def grasps(digits: Sequence[str], runs: Sequence[tuple[int, int]]) -> int:
    """Number of intervals that are grasps: two digits of one hand push at the same moment."""
    return sum(any(map(_grasped, digits[first : last + 1])) for first, last in runs)


def _grasped(digits: str) -> bool:
    """True if two digits of one hand push. Capital letters are digits of a second hand."""
    fingers = digits.lower().replace(PALM, "")
    second = sum(map(str.isupper, digits.replace(PALM.upper(), "")))
    return max(second, len(fingers) - second) >= 2


def drops(free: ArrayLike, height: ArrayLike) -> int:
    """Number of times that an object was dropped.

    Args:
        free: (n,) true while nothing pushes the object.
        height: (n,) height of the object, m.
    """
    heights = np.asarray(height, float)
    falls = [
        heights[max(first - 1, 0)] - heights[first : last + 2].min()
        for first, last in true_intervals(free)
    ]
    return sum(bool(fall > FALL) for fall in falls)


def _handled(item: ObjectArrays) -> list[tuple[int, int]]:
    return push_intervals(item.digits, np.nan_to_num(item.grip), CONTROL_PERIOD)


def first_push(trial: TrialArrays) -> int | None:
    """First frame in which a hand pushes an object; None if no hand does."""
    known = [item for item in trial.objects.values() if item.pushes_are_known]
    return min((first for item in known for first, _ in _handled(item)), default=None)


def handling(trial: TrialArrays) -> dict[str, Any]:
    """Pushes, grasps and drops; empty if contacts with objects are unknown."""
    known = [item for item in trial.objects.values() if item.pushes_are_known]
    if not known:
        return {}
    held = []
    dropped = 0
    for item in known:
        held.append(grasps(item.digits, _handled(item)))
        free = [not d and not by for d, by in zip(item.digits, item.pushed_by, strict=True)]
        dropped += drops(free, item.place[:, 2])
    first = trial.once(first_push)
    return {
        "first_push_s": None if first is None else float(trial.t[first]),
        "grasps": sum(held),  # any order: whole numbers
        "regrasps": sum(max(number - 1, 0) for number in held),  # any order: whole numbers
        "drops": dropped,
    }


def labels(trial: TrialArrays) -> dict[str, Any]:
    """Changes and errors of the labels."""
    assigned = fingers_by_contact(trial, true=False)
    true = fingers_by_contact(trial, true=True)
    return {
        "label_switches": label_switches(assigned),
        **label_errors(assigned, true, CONTROL_PERIOD),
    }


def fingers_by_contact(trial: TrialArrays, true: bool) -> list[FingersByContact]:
    """Finger by (hand, contact), for each frame: the true finger, or the label."""
    hands = [(hand.true if true else hand.labels).tolist() for hand in trial.hands]
    return [
        {
            (hand, contact): finger
            for hand, rows in enumerate(hands)
            for finger, contact in enumerate(rows[row])
            if contact != NO_CONTACT
        }
        for row in range(len(trial))
    ]


def label_switches(labels: Sequence[FingersByContact]) -> int:
    """Number of times that a labelled contact got another label, even after a time without one."""
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

    An error begins when a contact gets a wrong label, and ends when it gets the right label.
    Moments without a label in between do not end the error. If the contact ends first, the error
    was not corrected.

    Args:
        labels: Assigned labels at each moment.
        true: True fingers at each moment. Contacts without a true finger are ignored.
        period: Time between two moments, s.

    Returns:
        `label_accuracy`, `label_errors` and `label_recovery_s`; empty if no true finger is known.
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
    }
