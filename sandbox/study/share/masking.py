"""Masks records, notes, recordings and frames of a participant, so that they can be published, and
counts the people with the same demographic values.

Only fields that are declared as shared are included. Fields of records and notes are declared in
`sandbox.study.record`, fields of recordings in `sandbox.recording` and `sandbox.trial`, and columns
of frames in `sandbox.study.tables.frame_table`. A field that a later version adds is left out until
it is declared as shared.

A person with a unique combination of age, handedness and other values can be recognised despite the
pseudonym. So numbers can be rounded down to bins, and the sizes of the groups of equal people are
counted: k-anonymity (Sweeney 2002).
"""

from __future__ import annotations

import csv
import gzip
import json
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import UTC, datetime, timedelta
from io import StringIO
from math import floor
from pathlib import PureWindowsPath
from typing import Any

from msgspec import Struct

from models.errors import StudyError
from models.json_input import checked, decoded_record
from sandbox.recording.recording import SHARED_FIELDS
from sandbox.recording.versions import SHARED_VERSIONS
from sandbox.study.record.build import SHARED_BUILD
from sandbox.study.record.journal import Record
from sandbox.study.record.notes import FORMS
from sandbox.study.record.records import COMMAND, FORM, RUNS, forms, shared_fields
from sandbox.study.record.state import SessionClock
from sandbox.study.tables.frame_table import declared_columns, frames_bytes
from sandbox.trial.result import ResultRecord, record_fields
from sandbox.trial.settings import declared
from tasks.user import UserConfiguration

EPOCH = datetime(2000, 1, 1, tzinfo=UTC)
"""Start time of every anonymous session. Dates and times of day are removed; durations stay."""
WITHHELD = "(words are left out)"
"""Text that replaces texts typed by the experimenter."""

HAND_SIZE = "hand_size"
"""Field with the length of a hand, relative to the hand on which the encoders were trained."""
COPY = "anonymous copy"
"""Text that replaces the id of the machine's boot."""

_WITHIN: dict[str, tuple[str, ...]] = {
    "build": SHARED_BUILD,
    "result": record_fields(ResultRecord.SHARED),
    "study": ("experiment", "mode", "session", "trial", "attempt", "practice", "levels"),
    "user": tuple(each.name for each in fields(UserConfiguration)),
    "versions": SHARED_VERSIONS,
}
"""Shared fields of the JSON objects in records, notes and recordings, by the object's name."""
_USER_OPTIONS = ("user", "drop_outs")
"""Options of devices that configure a simulated user. Other options, such as addresses of a
laboratory's devices, are private."""
HEADER, DUMP, BROKEN_OFF = "header", "dump", "broken_off"
"""`HEADER` is the kind of a recording's first line. The others are fields of a result: the file of
the states before a divergence, and the reason why an attempt was broken off."""
COMMANDS = ("pause", "go_on", "repeat", "begin_again", "skip", "exclude", "note")
"""Commands that stay in a copy."""
LEFT_OUT = "left_out"
"""Command of the records that replace drafts of forms and records of unknown kinds."""

SMALLEST = 5
"""Number of people who should share each combination of values. This is a usual choice, and no
guarantee."""
DIGITS = 9
"""Decimals of binned numbers."""
NARROWEST, WIDEST = 1e-6, 1e6
"""Smallest and largest width of a bin."""


@dataclass(frozen=True)
class PersonMasking:
    """Settings for making one participant's data anonymous.

    Attributes:
        ppid: The new pseudonym.
        answer: Function of form, item and answer that returns the part of the answer to be shared,
            or None to leave it out.
        words: True keeps texts typed by the experimenter.
        hand_size: Function from the size of the hand to the size in the copy.
    """

    ppid: str
    answer: Callable[[str, str, Any], Any] = field(default=lambda form, item, value: value)
    words: bool = False
    hand_size: Callable[[float], float] = field(default=lambda size: size)


def shared_records(records: Iterable[Record], masking: PersonMasking) -> list[Record]:
    """Masks the journal of a session. The number and the order of the records do not change."""
    masked: list[Record] = []
    clock = SessionClock()
    for record in records:
        clock.take(record)
        masked.append(_masked_record(record, clock.of.get(record["n"], 0.0), masking))
    return masked


def shared_note(note: Record, masking: PersonMasking) -> Record:
    """Masks a note, of a participant or of a study."""
    masked = _shared(note, shared_fields(FORMS[note["kind"]]), masking)
    return {"time": time_after(0.0), **masked}


def time_after(seconds: float) -> str:
    """Masked time of the wall clock, `seconds` after the start of a session."""
    return (EPOCH + timedelta(seconds=seconds)).isoformat(timespec="milliseconds")


def _masked_record(record: Record, seconds: float, masking: PersonMasking) -> Record:
    """Masks a record that was written `seconds` after the start of the session."""
    kind = record["kind"]
    names = shared_fields(forms()[kind]) if kind in forms() else {}
    if names.keys() <= {"n"} or record.get("command", "note") not in COMMANDS:
        # Two kinds of records are replaced: drafts of forms, and kinds of a later version.
        kind, names, record = COMMAND, {}, {"n": record["n"], "command": LEFT_OUT}
    masked: Record = {
        "n": record["n"],
        "time": time_after(seconds),
        "clock": seconds,
        "kind": kind,
        **({"command": LEFT_OUT} if not names else _shared(record, names, masking)),
    }
    if kind in RUNS:
        # All clocks in the copy begin with the session.
        masked |= {"ppid": masking.ppid, "boot": COPY}
    if kind == FORM:
        masked["answers"] = {
            item: masking.answer(record["form"], item, value)
            for item, value in record["answers"].items()
        }
    return masked


def _shared(record: Record, names: Mapping[str, bool], masking: PersonMasking) -> Record:
    """The shared fields of a record or note.

    Args:
        record: The record.
        names: Names of the shared fields; True for fields with words.
        masking: Settings.
    """
    kept: Record = {}
    for name, are_words in names.items():
        if name in record:
            value = record[name]
            kept[name] = WITHHELD if are_words and value and not masking.words else value
    if kept.get(HAND_SIZE) is not None:
        kept[HAND_SIZE] = masking.hand_size(kept[HAND_SIZE])
    return {name: _within(name, without_folders(value)) for name, value in kept.items()}


def _within(name: str, value: Any) -> Any:
    """The value of a field, without the parts of it that are not shared."""
    if name not in ("settings", *_WITHIN):
        return value
    if not isinstance(value, Mapping):
        return None
    if name == "settings":
        value = declared(value)
        for device in (value.get("device"), value.get("second_device")):
            options = device.get("options") if isinstance(device, dict) else None
            if isinstance(options, dict):
                device["options"] = {k: v for k, v in options.items() if k in _USER_OPTIONS}
        return value
    value = {k: _within(k, v) for k, v in value.items() if k in _WITHIN[name]}
    if isinstance(value.get(DUMP), str):
        # `without_folders` misses relative paths, such as `studies/NAME/...`.
        value[DUMP] = PureWindowsPath(value[DUMP]).name
    return value


def without_folders(value: Any) -> Any:
    """A JSON value in which every path is reduced to its file name.

    Names of folders may be names of people.
    """
    if isinstance(value, Mapping):
        return {without_folders(key): without_folders(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [without_folders(inner) for inner in value]
    if isinstance(value, str) and _is_path(value):
        return PureWindowsPath(value).name
    return value


class RecordingEnd(Struct):
    """The field that the last line of a recording must have."""

    result: dict[str, Any]


def shared_line(line: bytes, masking: PersonMasking, where: str = "recording") -> bytes:
    """Masks a line of a recording; the data needed for replay are unchanged.

    Args:
        line: The line as JSON.
        masking: Settings.
        where: Name of the file, for the error.

    Returns:
        The masked line; empty for a line of an unknown kind.

    Raises:
        StudyError: The line is damaged.
    """
    what = "the recording is damaged, so it cannot be shared"
    values = decoded_record(line, StudyError, what=what, where=where)
    kind = str(values.get("kind"))
    if kind == HEADER:
        masked = {"kind": kind, **_masked_result(values, masking)}
    elif kind in SHARED_FIELDS:
        masked = {name: v for name, v in values.items() if name in SHARED_FIELDS[kind]}
        if kind == "end":
            checked(values, RecordingEnd, StudyError, what=what, where=where)
            masked["result"] = _masked_result(values["result"], masking)
        if masked == values:
            return line
    else:
        return b""
    return json.dumps(masked, separators=(",", ":"), ensure_ascii=False).encode()


def _masked_result(result: Mapping[str, Any], masking: PersonMasking) -> dict[str, Any]:
    """Masks the result of a trial, or the header of its recording, which has the same fields."""
    masked: dict[str, Any] = _within("result", without_folders(result))
    if isinstance(masked.get("study"), dict):
        masked["study"]["ppid"] = masking.ppid
    if BROKEN_OFF in result:
        masked[BROKEN_OFF] = result[BROKEN_OFF] if masking.words else WITHHELD
        if masked.get("reason") and not masking.words:
            masked["reason"] = WITHHELD
    return masked


def shared_frames(data: bytes) -> bytes:
    """The file of a trial's frames, without columns that are not declared.

    Raises:
        StudyError: The file is damaged.
    """
    try:
        names, *rows = csv.reader(StringIO(gzip.decompress(data).decode(), newline=""))
    except (OSError, EOFError, zlib.error, ValueError, csv.Error) as error:
        raise StudyError(
            "frames of a trial are damaged",
            got=str(error),
            remedy="Delete the file; `sandbox study tables` makes it again",
        ) from None
    kept = [names.index(name) for name in declared_columns(names)]
    if len(kept) == len(names):
        return data
    return frames_bytes([names[i] for i in kept], ([row[i] for i in kept] for row in rows))


def _is_path(text: str) -> bool:
    looks = text.startswith(("/", "~", "../", "..\\", "\\\\")) or text[1:3] in (":\\", ":/")
    return looks and "\n" not in text


@dataclass(frozen=True)
class Groups:
    """Groups of people with equal values.

    Attributes:
        columns: The compared columns.
        smallest: k, the size of the smallest group; 0 without people.
        few: Combinations that fewer than `SMALLEST` people share, with the number of people.
    """

    columns: tuple[str, ...]
    smallest: int
    few: tuple[tuple[tuple[Any, ...], int], ...]

    @property
    def exposed(self) -> int:
        """Number of people in groups that are too small."""
        return sum(count for _, count in self.few)


def groups(people: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> Groups:
    """Groups people who have equal values in all given columns. Without columns, all people are one
    group."""
    counted = Counter(tuple(person.get(name) for name in columns) for person in people)
    few = tuple((what, n) for what, n in counted.items() if n < SMALLEST)
    return Groups(tuple(columns), min(counted.values(), default=0), few)


def binned(value: Any, width: float) -> Any:
    """A number rounded down to a multiple of a width; other values are returned unchanged."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    # Rounded before and after, since 0.7 / 0.1 is a little less than 7.
    low = round(floor(round(value / width, DIGITS)) * width, DIGITS)
    return int(low) if low == int(low) else low
