"""The record of a session: append-only JSON lines, from which all other data are derived.

Each record is one write. A written record is safe at once if the program ends in any way. It is
safe from a power cut after at most `SYNC` seconds, or at once if it is durable.

The records are a hash chain: each line carries a hash of itself and of the line before. A line ends
with `"hash":"..."}`. The hash is the BLAKE2b digest (32 bytes, in hex) of two parts: first the hash
of the line before (empty for the first line), then the line's bytes without the field `hash`. So a
changed bit is found in its line, and a missing, new or moved line is found at the line after it.
The record of a trial's end has the digest of the trial's recording, so the last hash covers the
whole session.
"""

from __future__ import annotations

import json
import os
import stat
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from hashlib import blake2b
from pathlib import Path
from typing import Any

from models.errors import LaterLayoutError, StudyError
from models.json_input import checked, decoded_record
from sandbox.study.record.durable_files import study_error, write_atomically
from sandbox.study.record.records import (
    CLOCK_STEP,
    REPAIRED,
    RUNS,
    AnyRecord,
    number_from_one,
    refuse_later_layout,
)
from sandbox.system.files import OPEN, flush, sync_folder

Record = dict[str, Any]

SIZE = 32
"""Bytes of a hash."""
HASH = "hash"
"""Name of the field with the hash of a record."""
_TAIL = len(f',"{HASH}":""}}') + 2 * SIZE
"""Number of bytes at the end of a line, from the comma before the field `hash`."""

SYNC = 0.5
"""Time (s) between two flushes of written data to the disk."""

DAMAGED = "damaged-"
"""Prefix of the name of a copy of a damaged journal; its date follows."""

STEP = 0.5
"""Smallest change (s) of the difference between wall clock and monotonic clock, from one record to
the next, that counts as a step of the wall clock."""
SLEW = 1e-3
"""Allowance for the drift of the two clocks, as a share of the time between two records; it is
added to `STEP`. Clocks are corrected by up to 500 ppm (the limit of `adjtimex` and NTP), and their
own rates differ by less than that."""


def now() -> str:
    """The current time, UTC, in the format of records: ISO 8601 with milliseconds."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def digest_of(data: bytes) -> str:
    """Digest of bytes: BLAKE2b, hex."""
    return blake2b(data, digest_size=SIZE).hexdigest()


def chained(record: Mapping[str, Any], before: str) -> tuple[Record, bytes]:
    """Adds a record to a chain.

    Args:
        record: The record; a field `hash` in it is ignored.
        before: Hash of the record before; empty for the first record.

    Returns:
        The record with its hash, and its line.
    """
    body = {name: value for name, value in record.items() if name != HASH}
    text = json.dumps(body, separators=(",", ":"), ensure_ascii=False).encode()
    own = digest_of(before.encode() + text)
    return {**body, HASH: own}, text[:-1] + f',"{HASH}":"{own}"}}\n'.encode()


def follows(line: bytes, own: str, before: str) -> bool:
    """True if a line has the right hash for its content and its place in the chain.

    Args:
        line: The line, without its line break.
        own: The hash in the line.
        before: Hash of the line before; empty for the first line.
    """
    ends = line[-_TAIL:] == f',"{HASH}":"{own}"}}'.encode()
    return ends and digest_of(before.encode() + line[:-_TAIL] + b"}") == own


def chained_bytes(records: Iterable[Mapping[str, Any]]) -> bytes:
    """Lines of some records, as a new hash chain."""
    before, lines = "", []
    for record in records:
        linked, line = chained(record, before)
        before = linked[HASH]
        lines.append(line)
    return b"".join(lines)


class Journal:
    """Appends records to a file; the caller must hold the lock of the session.

    Opening the journal cuts off a half-written last line of a killed program, and records the cut.
    If the wall clock is set between two records, a record of this step is written before the second
    record.

    Args:
        path: Path of the file, which is created if it does not exist.

    Attributes:
        records: All records, in order.
        found: Number of records in the file when it was opened.

    Raises:
        StudyError: The file cannot be opened, or is not a journal.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._clocks: tuple[float, float] | None = None
        try:
            self._fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | OPEN, 0o666)
        except OSError as error:
            raise study_error(error, path, "the journal cannot be opened") from None
        try:
            regular = stat.S_ISREG(os.fstat(self._fd).st_mode)
            data = path.read_bytes() if regular else b""
            self.records, sound = parse_records(data, path)
            self.found = len(self.records)
            if sound < len(data):
                os.ftruncate(self._fd, sound)
                self.append(REPAIRED, lost_bytes=len(data) - sound)
            elif not data and regular:
                sync_folder(path.parent)
        except OSError as error:
            os.close(self._fd)
            raise study_error(error, path, "the journal cannot be repaired") from None
        except StudyError:
            os.close(self._fd)
            raise

    def append(self, kind: str, durable: bool = False, **values: Any) -> Record:
        """Writes a record.

        Args:
            kind: Kind of the record.
            durable: True ensures that it is on the disk when this returns.
            values: Fields of the record, as JSON values.

        Raises:
            StudyError: The record cannot be written, and is not in the journal; or a durable record
                was written, but may not be on the disk.
        """
        wall, clock = datetime.now(UTC), time.monotonic()
        try:
            step = self._step(wall.timestamp(), clock)
            if step:
                self._put(wall, clock, CLOCK_STEP, {"seconds": round(step, 3)})
            record = self._put(wall, clock, kind, values)
            if durable:
                os.fsync(self._fd)
        except OSError as error:
            raise study_error(error, self.path, "the journal cannot be written") from None
        return record

    @property
    def head(self) -> str:
        """Hash of the last record; empty without records."""
        return str(self.records[-1][HASH]) if self.records else ""

    def sync(self) -> None:
        """Flushes the file to the disk."""
        flush(self._fd)

    def close(self) -> None:
        """Closes the file."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1

    def _put(self, wall: datetime, clock: float, kind: str, values: dict[str, Any]) -> Record:
        """Writes a record with the given readings of both clocks."""
        head = {
            "n": len(self.records),
            "time": wall.isoformat(timespec="milliseconds"),
            "clock": round(clock, 6),
            "kind": kind,
        }
        try:
            record, line = chained({**head, **values}, self.head)
        except UnicodeEncodeError as error:
            text = error.object
            raise _letter_error(text, error.start, f"{self.path}, {kind}") from None
        if NUL_IN_JSON in line:
            check_texts(values, f"{self.path}, {kind}")
        self._write(line)
        self.records.append(record)
        return record

    def _step(self, wall: float, clock: float) -> float:
        """Step of the wall clock since the last call, s; 0 if there was none."""
        before, self._clocks = self._clocks, (wall, clock)
        if before is None:
            return 0.0
        passed = clock - before[1]
        step = wall - before[0] - passed
        return step if abs(step) > STEP + SLEW * passed else 0.0

    def _write(self, data: bytes) -> None:
        """Writes all bytes. If the disk is full after a part of them, this part is removed."""
        written = 0
        try:
            while written < len(data):
                written += os.write(self._fd, data[written:])
        except OSError:
            if written:
                self._take_back(written)
            raise

    def _take_back(self, written: int) -> None:
        """Removes a half-written line.

        If that fails, the journal is closed. The line is removed when the journal is next opened.
        """
        try:
            os.ftruncate(self._fd, os.fstat(self._fd).st_size - written)
        except OSError:
            self.close()
            raise


NUL_IN_JSON = b"\\u0000"
"""Escape of a NUL in a JSON line. A backslash that is followed by the text u0000 gives these bytes,
too."""


def plain_text(text: str, where: str) -> str:
    """Returns the text if JSON, CSV and their readers preserve it.

    Args:
        text: Any typed text.
        where: Place of the text, for the error message.

    Raises:
        StudyError: The text contains a NUL, at which some readers end a row, or a lone surrogate,
            which cannot be encoded in UTF-8.
    """
    for i, letter in enumerate(text):
        if letter == "\0" or "\ud800" <= letter <= "\udfff":
            raise _letter_error(text, i, where)
    return text


def _letter_error(text: str, at: int, where: str) -> StudyError:
    return StudyError(
        "this text holds a character that tables cannot store",
        where=where,
        got=f"U+{ord(text[at]):04X}, character {at + 1} of the text",
        remedy="Type the text without that character",
    )


def check_texts(value: Any, where: str) -> None:
    """Checks all texts in a JSON value.

    Raises:
        StudyError: See `plain_text`.
    """
    if isinstance(value, str):
        plain_text(value, where)
    elif isinstance(value, dict):
        for name, one in value.items():
            check_texts(name, where)
            check_texts(one, where)
    elif isinstance(value, list | tuple):
        for one in value:
            check_texts(one, where)


def parse_records(data: bytes, path: Path) -> tuple[list[Record], int]:
    """Parses a journal.

    Returns:
        The records, and the number of bytes of whole lines. Bytes after these are a half-written
        last line.

    Raises:
        StudyError: A line is damaged or changed. A crash of the program does not cause this.
    """
    records, sound, damage = sound_records(data, path)
    if damage is not None:
        raise damage
    return records, sound


def sound_records(data: bytes, path: Path) -> tuple[list[Record], int, StudyError | None]:
    """Parses a journal up to the first line that is damaged or changed.

    Returns:
        The records before that line, their number of bytes, and the error of the line. The error is
        None if no line is damaged; any bytes left are then a half-written last line.
    """
    records: list[Record] = []
    sound, head = 0, ""
    lines = data.split(b"\n")
    for number, line in enumerate(lines[:-1], start=1):
        if number == len(lines) - 1 and line.endswith(b"\0"):
            # After a power cut, the last line may be a block of zeros with a line break.
            break
        where = f"{path}, line {number}"
        try:
            record = _read_record(line, len(records), where)
        except LaterLayoutError:
            # The line is not damaged, and must not be discarded.
            raise
        except StudyError as error:
            return records, sound, _damage(error.what, path, number, error.got, error.expected)
        if not follows(line, record[HASH], head):
            what = f"{_DAMAGED}: this line, or the line before, was changed after it was written"
            return records, sound, _damage(what, path, number)
        head = record[HASH]
        records.append(record)
        sound += len(line) + 1
    return records, sound, None


def _damage(
    what: str, path: Path, line: int, got: object = None, expected: str | None = None
) -> StudyError:
    """The error for a damaged line; its remedy names both ways to continue."""
    person = path.absolute().parent.parent
    return StudyError(
        what,
        where=f"{path}, line {line}",
        got=got,
        expected=expected,
        remedy=f"Restore it from a backup; or `sandbox study note {person.parent} --participant "
        f'{person.name} --accept-loss "REASON"` continues with the lines before it. Nothing was '
        "changed. `sandbox replay STUDY --verify` names what differs",
    )


_DAMAGED = "the journal is damaged"


def _read_record(line: bytes, n: int, where: str) -> Record:
    """Parses and checks a record, whose number must be `n`, counted from 0.

    Raises:
        StudyError: The record is damaged, was written by a later version of the program, or has
            another number.
    """
    record = decoded_record(line, StudyError, what=_DAMAGED, where=where)
    refuse_later_layout(record, where)
    checked(record, AnyRecord, StudyError, what=_DAMAGED, where=where)
    if record["n"] != n:
        raise StudyError(
            f"{_DAMAGED}: its records are not in order",
            where=where,
            got=f"record {record['n']}",
            expected=f"record {n}",
        )
    if record["kind"] in RUNS:
        number_from_one(record)
    return record


def _content(path: Path) -> bytes:
    """Content of a journal; empty if the file does not exist.

    Raises:
        StudyError: The journal cannot be read.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return b""
    except OSError as error:
        raise study_error(error, path, "the journal cannot be read") from None


def read_journal(path: Path) -> list[Record]:
    """Reads a journal, to which another program may be writing; empty if the file does not exist.

    A half-written last line is ignored.

    Raises:
        StudyError: The journal cannot be read, or is damaged.
    """
    return parse_records(_content(path), path)[0]


def readable_records(path: Path) -> tuple[list[Record], int]:
    """Reads a journal up to its first damaged line.

    Returns:
        The records before that line, and the number of lines from that line to the end; 0 if no
        line is damaged.

    Raises:
        StudyError: The journal cannot be read.
    """
    data = _content(path)
    records, sound, damage = sound_records(data, path)
    return records, 0 if damage is None else len(data[sound:].splitlines())


def cut_damage(path: Path) -> Path | None:
    """Cuts off a journal from its first damaged line on, after copying it to a file next to it.

    Returns:
        Path of the copy; None if no line is damaged, and nothing was changed.

    Raises:
        StudyError: The journal cannot be read, or the copy or the journal cannot be written.
    """
    data = _content(path)
    _, sound, damage = sound_records(data, path)
    if damage is None:
        return None
    copy = path.with_name(f"{DAMAGED}{now().replace(':', '')}.jsonl")
    write_atomically(copy, data)
    write_atomically(path, data[:sound])
    return copy


def journal_bytes(records: Iterable[Record]) -> bytes:
    """The content of a journal with the given records, numbered anew, in a new hash chain."""
    return chained_bytes({**record, "n": n} for n, record in enumerate(records))


class SyncThread:
    """A thread that flushes files to the disk every `SYNC` seconds.

    The operating system reports lost data only once; later flushes succeed. So the thread stores
    the first error and ends, and `check` raises the error.

    Args:
        sync: Function that flushes the files.
    """

    def __init__(self, sync: Callable[[], None]) -> None:
        self._sync = sync
        self._error: OSError | None = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="sync", daemon=True)
        self._thread.start()

    def check(self) -> None:
        """Raises the error of an earlier flush, if there was one.

        Raises:
            OSError: A flush has failed since the thread was started.
        """
        if self._error is not None:
            raise self._error

    def close(self) -> None:
        """Ends the thread."""
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._stop.wait(SYNC):
            try:
                self._sync()
            except OSError as error:
                self._error = error
                return
