"""The thirteen kinds of records of a session: one tagged union, whose decoding is the check.

A record may have more fields than its kind declares, as those of a later version.

The declaration of a field also decides on its sharing: `sandbox study share` includes `Shared`
fields, `Words` fields only on request, and no others.
"""

from __future__ import annotations

from datetime import datetime
from functools import cache
from typing import Annotated, Any, TypeVar, get_args, get_type_hints

from msgspec import Meta, Struct

from models.errors import LaterLayoutError

_T = TypeVar("_T")
_SHARED, _WORDS = Meta(extra={"shared": True}), Meta(extra={"words": True})
Shared = Annotated[_T, _SHARED]
"""Type of a field that may be shared."""
Words = Annotated[_T, _WORDS]
"""Type of a field with a person's words, which are shared only with `--keep-words`."""

SESSION, RESUME, END = "session", "resume", "end"
CONSENT, ANSWER, FORM, DONE = "consent", "answer", "form", "done"
TRIAL, TRIAL_END, COMMAND = "trial", "trial_end", "command"
SCREEN, CLOCK_STEP, REPAIRED = "screen", "clock_step", "repaired"
RUNS = (SESSION, RESUME)
"""Kinds of the records with which a run of the program begins."""

SCHEMA = 4
"""Version of the layout of records and notes; before 4, numbers of participants counted from 0."""


def number_from_one(record: dict[str, Any]) -> None:
    """Converts the participant's number in a record or note, if there is one, to today's layout."""
    if record.get("number") is not None and record.get("schema", 0) < SCHEMA:
        record |= {"number": record["number"] + 1, "schema": SCHEMA}


def refuse_later_layout(record: dict[str, Any], where: str) -> None:
    """Checks that this version of the program supports the layout of a record or note.

    Raises:
        LaterLayoutError: It is of a later version, whose fields may have other meanings.
    """
    schema = record.get("schema")
    if isinstance(schema, int) and schema > SCHEMA:
        raise LaterLayoutError(
            "a later version of the program has written this",
            where=where,
            got=f"layout {schema}",
            expected=f"layout {SCHEMA} or earlier",
            remedy="Use that version; nothing was changed",
        )


class _Line(Struct, tag_field="kind"):
    """Fields of every record.

    Attributes:
        n: Number, from 0.
        time: Time of the wall clock, for people.
        clock: Time of the monotonic clock, s.
        hash: Hash of its line and of the line before.
    """

    n: Shared[int]
    time: datetime
    clock: float
    hash: str


class Session(_Line, tag=SESSION):
    """A session begins: its participant, program and design; `files` has the design's texts."""

    ppid: str
    number: Shared[int] = 1
    session: Shared[int] = 1
    experiment: Shared[str] = ""
    mode: Shared[str] = ""
    site: Shared[str] = ""
    design: Shared[str] = ""
    files: Shared[dict[str, str] | None] = None
    build: Shared[dict[str, Any] | None] = None
    boot: str = ""
    schema: Shared[int] = 0
    versions: Shared[dict[str, str] | None] = None
    hand: Shared[str] = ""
    hand_size: Shared[float] = 1.0
    language: Shared[str] = ""
    user: Shared[dict[str, Any] | None] = None


class Resume(Session, tag=RESUME):
    """A session is resumed; the texts of the design are included if the design has changed."""


class Screen(_Line, tag=SCREEN):
    """A page of the participant came, went, came back, or has another size.

    Attributes:
        page: Name of the page.
        event: `open`, `gone`, `back` or `changed`.
        width_px, height_px: Its size, CSS pixels; None before it has been reported.
        px_per_in: CSS pixels in an inch.
        calibrated: True if this was measured, False if it is a guess.
        browser: Name that the browser reports.
    """

    page: Shared[str]
    event: Shared[str]
    width_px: float | None = None
    height_px: float | None = None
    px_per_in: float | None = None
    calibrated: bool | None = None
    browser: str = ""


class Consent(_Line, tag=CONSENT):
    """The participant agreed or did not agree to a version of the text, which is included."""

    step: Shared[str]
    agreed: Shared[bool]
    version: Shared[str] = ""
    language: Shared[str] = ""
    text: Shared[str] = ""


class Answer(_Line, tag=ANSWER):
    """An answer in a form that is not finished."""

    step: str
    item: str
    answer: Any


class Form(_Line, tag=FORM):
    """A finished form; which of the answers are shared depends on the questions."""

    step: Shared[str]
    form: Shared[str]
    answers: dict[str, Any]
    block: Shared[int] = 0
    levels: Shared[dict[str, str] | None] = None
    seconds: Shared[float | None] = None


class Done(_Line, tag=DONE):
    """An instruction, a break or a calibration is over. A calibration has the measured values, such
    as a hand, or the offset of the clock of LSL from that of the records."""

    step: Shared[str]
    hand: str = ""
    calibration: dict[str, Any] | None = None


class Trial(_Line, tag=TRIAL):
    """An attempt begins; `file` is its recording.

    Attributes:
        in_block: Number of the trial in its block.
        values: Settings of the trial by name.
        taken_in: True if its records were lost, and it was added from its recording.
    """

    step: Shared[str]
    trial: Shared[int]
    attempt: Shared[int]
    file: Shared[str] = ""
    block: Shared[int] = 0
    in_block: Shared[int] = 0
    repetition: Shared[int] = 0
    practice: Shared[bool] = False
    levels: Shared[dict[str, str] | None] = None
    values: Shared[dict[str, Any] | None] = None
    seed: Shared[int] = 0
    taken_in: Shared[bool] = False


class TrialEnd(_Line, tag=TRIAL_END):
    """An attempt ends with a result, or was broken off; `recording` is the recording's digest.

    Attributes:
        adopted: True if a killed program had not written this, so that the result comes from the
            recording.
        lasted: Duration of such a recording, s.
    """

    step: Shared[str]
    trial: Shared[int]
    attempt: Shared[int]
    file: Shared[str] = ""
    recording: Shared[str | None] = None
    result: Shared[dict[str, Any] | None] = None
    why: Words[str] = ""
    adopted: Shared[bool] = False
    lasted: Shared[float | None] = None
    taken_in: Shared[bool] = False


class Command(_Line, tag=COMMAND):
    """The experimenter pauses, goes on, repeats, skips, excludes, notes, or begins the `steps` of
    a block again."""

    command: Shared[str]
    step: Shared[str] = ""
    steps: Shared[list[str] | None] = None
    trial: Shared[int | None] = None
    reason: Words[str | None] = None
    text: Words[str | None] = None


class ClockStep(_Line, tag=CLOCK_STEP):
    """The wall clock was set."""

    seconds: Shared[float]


class Repaired(_Line, tag=REPAIRED):
    """The effects of a kill, or of a loss that was accepted.

    Attributes:
        lost_bytes: Length of a half-written last line that was cut off.
        records: Number of lines whose loss was accepted, for `reason`.
        file, recording: A recording without a record, and its digest; with `reason`, a whole
            recording that was set aside.
    """

    lost_bytes: Shared[int | None] = None
    records: Shared[int | None] = None
    file: Shared[str] = ""
    recording: Shared[str | None] = None
    reason: Words[str] = ""


class End(_Line, tag=END):
    """The session reached its planned end, or the participant did not agree: `why`."""

    complete: Shared[bool]
    why: str = ""


AnyRecord: Any = (
    Session
    | Resume
    | Screen
    | Consent
    | Answer
    | Form
    | Done
    | Trial
    | TrialEnd
    | Command
    | ClockStep
    | Repaired
    | End
)
"""The type to which every line decodes."""


@cache
def shared_fields(kind: type[Struct]) -> dict[str, bool]:
    """Fields of a record or note that are shared, by name; True for words of people."""
    types = get_type_hints(kind, include_extras=True)
    found = {}
    for name in kind.__struct_fields__:
        metadata = getattr(types[name], "__metadata__", ())
        if _SHARED in metadata or _WORDS in metadata:
            found[name] = _WORDS in metadata
    return found


@cache
def forms() -> dict[str, type[Struct]]:
    """The type of each kind of record."""
    return {str(form.__struct_config__.tag): form for form in get_args(AnyRecord)}
