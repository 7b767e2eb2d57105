"""Required fields of the records of journals, by kind.

A record may have more fields. Kinds that are not listed here are read without a check.
"""

from __future__ import annotations

from typing import Any

from msgspec import Struct


class RecordHead(Struct):
    """Fields of every record: its number from 0, and its kind."""

    n: int
    kind: str


class _Step(Struct):
    """A step of a session."""

    step: str


class _Attempt(_Step):
    """An attempt of a trial."""

    trial: int
    attempt: int


class _TrialEnd(_Attempt):
    result: dict[str, Any]


class _Skip(_Step):
    reason: str | None


class _Repeat(_Skip):
    trial: int


class _Exclude(Struct):
    """A trial is excluded; without a trial number, the participant."""

    reason: str | None
    trial: int | None = None


class _Draft(_Step):
    """An answer in a form that is not finished."""

    item: str
    answer: Any


class _Answers(_Step):
    form: str
    answers: dict[str, Any]


class _Consent(_Step):
    agreed: bool


class _Participant(Struct):
    ppid: str
    number: int


class _Released(Struct):
    ppid: str


class _SessionEnd(Struct):
    complete: bool


FORMS: dict[str, type[Struct]] = {
    "trial_start": _Attempt,
    "trial_end": _TrialEnd,
    "trial_broken": _Attempt,
    "repeat": _Repeat,
    "skip": _Skip,
    "exclude": _Exclude,
    "draft": _Draft,
    "answers": _Answers,
    "step_done": _Step,
    "consent": _Consent,
    "calibration": _Step,
    "session_end": _SessionEnd,
    "participant": _Participant,
    "released": _Released,
}
