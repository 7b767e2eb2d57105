"""Removes identifying data from the records of a journal and the lines of a recording.

Only the listed fields of each kind of record are kept, so that new kinds of later versions are
removed until they are listed.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import PureWindowsPath
from typing import Any

from msgspec import Struct

from models.errors import StudyError
from models.json_input import checked, decoded_record
from sandbox.study.record.chain import Record
from sandbox.study.record.folder import ANEW
from sandbox.study.record.session_clock import RUNS, SessionClock

EPOCH = datetime(2000, 1, 1, tzinfo=UTC)
"""Start time of every anonymous session: dates and times of day are removed, durations are kept."""
WITHHELD = "(words are left out)"
"""Replaces texts typed by the experimenter."""

HAND_SIZE = "hand_size"
"""Field with the length of a hand relative to the trained one."""
COPY = "anonymous copy"
"""In the place of the id of the machine's start."""

_ATTEMPT = ("step", "trial", "attempt", "file")
KEPT: dict[str, tuple[str, ...]] = {
    "session_start": (
        "schema",
        "experiment",
        "mode",
        "design",
        "session",
        "versions",
        "build",
        "boot",
        "number",
        "hand",
        "hand_size",
        "language",
        "user",
    ),
    "session_end": ("complete",),
    "consent": ("step", "agreed", "version", "language", "text"),
    "step_done": ("step",),
    "calibration": ("step",),
    "answers": ("step", "form", "block", "levels", "seconds"),
    "trial_start": (
        *_ATTEMPT,
        "taken_in",
        "block",
        "in_block",
        "repetition",
        "practice",
        "levels",
        "values",
        "seed",
    ),
    "trial_end": (*_ATTEMPT, "result", "adopted", "taken_in", "recording"),
    "trial_broken": (*_ATTEMPT, "recording"),
    "tables": (*_ATTEMPT, "files"),
    "clock_step": ("seconds",),
    "repeat": ("step", "trial"),
    "skip": ("step", "trial"),
    "exclude": ("trial",),
    "note": ("trial",),
    "recovered": ("lost_bytes",),
    "lost": ("records",),
    "participant": ("number", "hand", "hand_size", "language", "user"),
    ANEW: ("changed", "before", "after"),
    "upgrade": ("changed", "before", "after"),
    "libraries": ("changed", "before", "after"),
    "released": (),
    "pause": (),
    "go_on": (),
}
_USER_OPTIONS = ("user", "drop_outs")
"""Options of devices that are about a simulated user."""
LEARNED = "learned"
"""Field of results with the layouts of a person's fingers; touches in recordings tell the same, and
copies without recordings must not."""
DUMP = "dump"
"""Field of results with the file of a divergence, whose folders have the pseudonym in them."""
DUMP_ERROR = "dump_error"
"""Field of results with why that file could not be written: words around such a path."""
KEPT["session_resume"] = KEPT["session_start"]
WORDS = {
    "lost": "reason",
    "trial_broken": "why",
    "repeat": "reason",
    "skip": "reason",
    "exclude": "reason",
    "note": "text",
    "upgrade": "reason",
    "released": "reason",
}
"""Field with text typed by the experimenter, by kind of record."""
LEFT_OUT = "left_out"
"""Kind of the records that replace drafts of forms and records of unlisted kinds."""
NAMED = ("session_start", "session_resume", "participant", "released")
"""Kinds of records that contain the pseudonym."""


@dataclass(frozen=True)
class PersonMasking:
    """Settings for making one participant's data anonymous.

    Attributes:
        ppid: The new pseudonym.
        study: The new id of the study.
        answer: Function of form, item and answer that returns the kept part of the answer, or
            None to leave it out.
        words: True keeps texts typed by the experimenter.
        hand_size: Returns the size of the hand that the copy tells.
    """

    ppid: str
    study: str
    answer: Callable[[str, str, Any], Any] = field(default=lambda form, item, value: value)
    words: bool = False
    hand_size: Callable[[float], float] = field(default=lambda size: size)


def anonymous_records(records: Iterable[Record], masking: PersonMasking) -> list[Record]:
    """Masks the journal of a session; number and order of records are unchanged."""
    masked: list[Record] = []
    clock = SessionClock()
    for record in records:
        clock.take(record)
        masked.append(_masked_record(record, clock.of.get(record["n"], 0.0), masking))
    return masked


def without_folders(value: Any) -> Any:
    """A JSON value without the folders of paths, whose names may be names of people."""
    if isinstance(value, Mapping):
        return {key: without_folders(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [without_folders(inner) for inner in value]
    if isinstance(value, str) and _is_path(value):
        return PureWindowsPath(value).name
    return value


class RecordingEnd(Struct):
    """The field that the last line of a recording must have."""

    result: dict[str, Any]


def anonymous_line(line: bytes, masking: PersonMasking, where: str = "recording") -> bytes:
    """Masks a line of a recording; the data needed for replay are unchanged.

    Args:
        line: The line as JSON.
        masking: Settings.
        where: Name of the file, for the error.

    Raises:
        StudyError: The line is damaged.
    """
    what = "the recording is damaged, so it cannot be made anonymous"
    values = decoded_record(line, StudyError, what=what, where=where)
    if values.get("kind") == "header":
        values = _masked_header(values, masking)
    elif values.get("kind") == "end":
        checked(values, RecordingEnd, StudyError, what=what, where=where)
        values["result"] = _masked_header(values["result"], masking)
    elif values.get("kind") == "event" and values.get("event") not in ("contact", "respawn"):
        values = {key: values[key] for key in ("kind", "step", "event") if key in values}
    else:
        return line
    return json.dumps(values, separators=(",", ":"), ensure_ascii=False).encode()


def _masked_record(record: Record, seconds: float, masking: PersonMasking) -> Record:
    """Masks a record that was written so long after the session's start, s."""
    kind = record["kind"] if record["kind"] in KEPT else LEFT_OUT
    masked: Record = {
        "n": record["n"],
        "time": (EPOCH + timedelta(seconds=seconds)).isoformat(timespec="milliseconds"),
        "clock": seconds,
        "kind": kind,
    }
    masked |= {k: without_folders(record[k]) for k in KEPT.get(kind, ()) if k in record}
    if kind in NAMED:
        masked["ppid"] = masking.ppid
    if masked.get(HAND_SIZE) is not None:
        masked[HAND_SIZE] = masking.hand_size(masked[HAND_SIZE])
    if kind in RUNS:
        # All clocks in the copy begin with the session.
        masked |= {"study": masking.study, "boot": COPY}
    if "result" in masked:
        masked["result"] = _without_marks(masked["result"])
    if kind == "answers":
        masked["answers"] = {
            item: masking.answer(record["form"], item, value)
            for item, value in record["answers"].items()
        }
    if kind in WORDS:
        key = WORDS[kind]
        masked[key] = record.get(key, "") if masking.words else WITHHELD
    return masked


def _masked_header(header: dict[str, Any], masking: PersonMasking) -> dict[str, Any]:
    """Masks the header of a recording, or its result, which repeats fields of the header."""
    masked = _without_marks(without_folders(header))
    if isinstance(masked.get("study"), dict):
        masked["study"]["ppid"] = masking.ppid
    for name in ("device", "second_device"):
        device = masked.get("settings", {}).get(name)
        if isinstance(device, dict):
            # Addresses of a laboratory's devices are nobody else's.
            options = device.get("options", {})
            masked["settings"][name] = {
                **device,
                "options": {k: v for k, v in options.items() if k in _USER_OPTIONS},
            }
    if "broken_off" in masked and not masking.words:
        masked["broken_off"] = WITHHELD
        if masked.get("reason"):
            masked["reason"] = WITHHELD
    return masked


def _without_marks(result: Mapping[str, Any]) -> dict[str, Any]:
    """A result without the fields that lead back to the person or to their folder."""
    kept = {key: value for key, value in result.items() if key not in (LEARNED, DUMP_ERROR)}
    if kept.get(DUMP):
        # Its folders need not look like a path's: that of a study may be `studies/NAME/...`.
        kept[DUMP] = PureWindowsPath(kept[DUMP]).name
    return kept


def _is_path(text: str) -> bool:
    looks = text.startswith(("/", "~", "../", "..\\", "\\\\")) or text[1:3] in (":\\", ":/")
    return looks and "\n" not in text
