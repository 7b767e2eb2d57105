"""Required fields of the records of journals, by kind.

A record may have more fields. Kinds that are not listed here are read without a check.
"""

from __future__ import annotations

from datetime import datetime
from typing import Any

from msgspec import Struct


class RecordHead(Struct):
    """Fields of every record.

    Attributes:
        n: Number, from 0.
        time: Time of the wall clock, for people.
        clock: Time of the monotonic clock, s.
        kind: What happened.
        previous: Digest of the record before.
        digest: Its own digest.
    """

    n: int
    time: datetime
    clock: float
    kind: str
    previous: str
    digest: str


class _Step(Struct):
    """A step of a session."""

    step: str


class _Attempt(_Step):
    """An attempt of a trial."""

    trial: int
    attempt: int
    file: str = ""
    recording: dict[str, Any] | None = None


class _TrialEnd(_Attempt, kw_only=True):
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


class _Withdrawal(Struct):
    """Digests of the records that replaced others, by number."""

    replaced: dict[int, str]


class _Packed(Struct):
    """A recording was compressed after its record was written."""

    file: str
    recording: dict[str, Any] | None


class _SetAside(_Packed):
    """A whole recording whose records were lost, and that does not count."""

    reason: str
    files: dict[str, str]


class _Moved(Struct):
    """A merge has moved the session into another study."""

    study: str
    ppid: str
    recordings: dict[str, dict[str, Any] | None]


class _ClockStep(Struct):
    seconds: float


class _Sealed(_Released):
    """The journal of a session as it was when the session was closed."""

    session: int
    records: int
    digest_of_last: str


class _Files(_Attempt, kw_only=True):
    """Digests of the derived files of an attempt, by name."""

    files: dict[str, str]


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
    "withdrawal": _Withdrawal,
    "sealed": _Sealed,
    "tables": _Files,
    "packed": _Packed,
    "leftover": _Packed,
    "set_aside": _SetAside,
    "moved": _Moved,
    "clock_step": _ClockStep,
}
