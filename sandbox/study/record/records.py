"""The thirteen kinds of records of a session.

They are one tagged union, and a line of a journal is checked by decoding it to this union. A record
may have fields that its kind does not declare, such as those of a later version.

The type of a field also decides whether `sandbox study share` includes it: `Shared` fields always,
`Words` fields on request, and all other fields never.
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
"""Type of a field with free text that a person wrote; shared only with `--keep-words`."""

SESSION, RESUME, END = "session", "resume", "end"
CONSENT, ANSWER, FORM, DONE = "consent", "answer", "form", "done"
TRIAL, TRIAL_END, COMMAND = "trial", "trial_end", "command"
SCREEN, CLOCK_STEP, REPAIRED = "screen", "clock_step", "repaired"
RUNS = (SESSION, RESUME)
"""Kinds of records that are written when the program begins or resumes a session."""

SCHEMA = 4
"""Version of the layout of records and notes. Before 4, participants were numbered from 0."""


def number_from_one(record: dict[str, Any]) -> None:
    """Converts the participant's number, if a record or note has one, to the current layout."""
    if record.get("number") is not None and record.get("schema", 0) < SCHEMA:
        record |= {"number": record["number"] + 1, "schema": SCHEMA}


def refuse_later_layout(record: dict[str, Any], where: str) -> None:
    """Checks that this version of the program supports the layout of a record or note.

    Raises:
        LaterLayoutError: A later version has written it. Its fields may have other meanings.
    """
    schema = record.get("schema")
    if isinstance(schema, int) and schema > SCHEMA:
        raise LaterLayoutError(
            "this was written by a later version of the program",
            where=where,
            got=f"layout {schema}",
            expected=f"layout {SCHEMA} or earlier",
            remedy="Use that version; nothing was changed",
        )


class _Line(Struct, tag_field="kind"):
    """Fields of every record.

    Attributes:
        n: Number of the record in its session, from 0.
        time: Time of the wall clock, for human readers.
        clock: Time of the monotonic clock, s.
        hash: Hash of this line and of the hash of the line before.
    """

    n: Shared[int]
    time: datetime
    clock: float
    hash: str


class Session(_Line, tag=SESSION):
    """A session begins: its participant, program and design.

    Attributes:
        files: Texts of the design's files by name; None if the design is that of the last run.
    """

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
    """A session is resumed; `files` has the texts of the design if the design has changed."""


class Screen(_Line, tag=SCREEN):
    """A page of the participant was opened, was lost, came back, or changed its size.

    Attributes:
        page: Name of the page.
        event: `open`, `gone`, `back` or `changed`.
        width_px, height_px: Size of the page, CSS pixels; None before the page has reported it.
        px_per_in: CSS pixels in an inch.
        calibrated: True if `px_per_in` was measured, False if it is a guess.
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
    """The participant agreed or did not agree to the consent form; `text` is what was shown."""

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
    """A finished form. The kinds of the questions decide which answers are shared."""

    step: Shared[str]
    form: Shared[str]
    answers: dict[str, Any]
    block: Shared[int] = 0
    levels: Shared[dict[str, str] | None] = None
    seconds: Shared[float | None] = None


class Done(_Line, tag=DONE):
    """An instruction, a break or a calibration is over.

    Attributes:
        hand: The hand that was measured.
        calibration: Measured values: of a hand, or the offset between LSL's clock and the clock of
            the records.
    """

    step: Shared[str]
    hand: str = ""
    calibration: dict[str, Any] | None = None


class Trial(_Line, tag=TRIAL):
    """An attempt at a trial begins.

    Attributes:
        file: The attempt's recording.
        in_block: Number of the trial in its block.
        values: Settings of the trial by name.
        taken_in: True if the attempt's records were lost, and it was added from its recording.
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
    """An attempt ends with a result, or is broken off.

    Attributes:
        recording: Digest of the recording.
        why: Reason why the attempt was broken off.
        adopted: True if the program was killed before it wrote this record, so that the result was
            taken from the recording.
        lasted: Duration of the attempt according to the recording, if `adopted`, s.
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
    """A command of the experimenter: to pause, go on, repeat, skip, exclude, write a remark, or
    begin a block again.

    Attributes:
        steps: Ids of the steps of the block, if it begins again.
    """

    command: Shared[str]
    step: Shared[str] = ""
    steps: Shared[list[str] | None] = None
    trial: Shared[int | None] = None
    reason: Words[str | None] = None
    text: Words[str | None] = None


class ClockStep(_Line, tag=CLOCK_STEP):
    """The wall clock was set; `seconds` is how far it moved."""

    seconds: Shared[float]


class Repaired(_Line, tag=REPAIRED):
    """A repair of a session after a kill or power cut, or after records were lost.

    Attributes:
        lost_bytes: Length of a half-written last line that was cut off.
        records: Number of lost lines; the experimenter accepted the loss, for `reason`.
        file, recording: A recording without a record of its attempt, and its digest. With `reason`,
            the recording is complete, and the experimenter decided that it does not count.
    """

    lost_bytes: Shared[int | None] = None
    records: Shared[int | None] = None
    file: Shared[str] = ""
    recording: Shared[str | None] = None
    reason: Words[str] = ""


class End(_Line, tag=END):
    """The session has ended.

    Attributes:
        complete: True if it reached its planned end.
        why: Reason if it did not: the participant did not agree to the consent form.
    """

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
"""The type to which each line of a journal is decoded."""


@cache
def shared_fields(kind: type[Struct]) -> dict[str, bool]:
    """Fields of a kind of record or note that can be shared, by name; True for `Words` fields."""
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
