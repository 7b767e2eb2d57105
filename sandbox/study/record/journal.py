"""The journal of a session or study: append-only JSON lines, from which all else is derived.

Each record is one write. A written record survives the end of the program at once. It survives a
power cut after at most `SYNC` seconds; a durable record does so at once.
"""

from __future__ import annotations

import json
import os
import stat
import threading
import time
from collections.abc import Callable, Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from models.errors import StudyError
from models.json_input import checked, decoded_record
from sandbox.study.record.files import study_error, sync_folder
from sandbox.study.record.record_forms import FORMS, RecordHead

SYNC = 0.5
"""s between two flushes of written data to the disk."""

SCHEMA = 1
"""Version of the records."""

Record = dict[str, Any]


def now() -> str:
    """The current time, UTC, in the format of records."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


class Journal:
    """Appends records to a file; the caller must hold the lock of the session.

    Opening the journal cuts off a half-written last line of a killed program, and records the cut.

    Args:
        path: Path of the file, which is created if it does not exist.

    Attributes:
        records: All records, in order.

    Raises:
        StudyError: The file cannot be opened, or is not a journal.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self._fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o666)
        except OSError as error:
            raise study_error(error, path, "the journal cannot be opened") from None
        try:
            regular = stat.S_ISREG(os.fstat(self._fd).st_mode)
            data = path.read_bytes() if regular else b""
            self.records, sound = parse_records(data, path)
            if sound < len(data):
                os.ftruncate(self._fd, sound)
                self.append("recovered", lost_bytes=len(data) - sound)
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
            StudyError: The record cannot be written, and the journal is unchanged; or a durable
                record was written but may not be on the disk.
        """
        record = {
            "n": len(self.records),
            "time": now(),
            "clock": round(time.monotonic(), 6),
            "kind": kind,
            **values,
        }
        try:
            self._write(journal_bytes([record]))
            self.records.append(record)
            if durable:
                os.fsync(self._fd)
        except OSError as error:
            raise study_error(error, self.path, "the journal cannot be written") from None
        return record

    def sync(self) -> None:
        """Flushes the file to the disk."""
        os.fdatasync(self._fd)

    def close(self) -> None:
        """Closes the file."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1

    def _write(self, data: bytes) -> None:
        """Writes all bytes; if a full disk takes only a part of them, that part is removed."""
        written = 0
        try:
            while written < len(data):
                written += os.write(self._fd, data[written:])
        except OSError:
            if written:
                self._take_back(written)
            raise

    def _take_back(self, written: int) -> None:
        """Removes a half-written line. If that fails, the journal is closed, and the next opening
        removes the line."""
        try:
            os.ftruncate(self._fd, os.fstat(self._fd).st_size - written)
        except OSError:
            self.close()
            raise


def parse_records(data: bytes, path: Path) -> tuple[list[Record], int]:
    """Parses a journal.

    Returns:
        The records, and the number of valid bytes; the rest is a half-written last line.

    Raises:
        StudyError: A line before the last one is damaged, which no crash of the program causes.
    """
    records: list[Record] = []
    sound = 0
    lines = data.split(b"\n")
    for number, line in enumerate(lines[:-1], start=1):
        try:
            record = _record(line, len(records), f"{path}, line {number}")
        except StudyError:
            if number == len(lines) - 1:
                # A power cut may leave a last block of zeros that ends like a line.
                break
            raise
        records.append(record)
        sound += len(line) + 1
    return records, sound


def _record(line: bytes, n: int, where: str) -> Record:
    """Parses and checks the record number `n`, counted from 0.

    Raises:
        StudyError: The record is damaged, or has another number.
    """
    what, remedy = "the journal is damaged", "Restore it from a backup; nothing was changed"
    record = decoded_record(line, StudyError, what=what, where=where, remedy=remedy)
    head = checked(record, RecordHead, StudyError, what=what, where=where, remedy=remedy)
    if head.n != n:
        raise StudyError(
            f"{what}: its records are not in order",
            where=where,
            got=f"record {head.n}",
            expected=f"record {n}",
            remedy=remedy,
        )
    form = FORMS.get(head.kind, RecordHead)
    checked(record, form, StudyError, what=what, where=where, remedy=remedy)
    return record


def read_journal(path: Path) -> list[Record]:
    """Reads a journal, which another program may be writing; ignores a half-written last line.

    Raises:
        StudyError: The journal cannot be read, or is damaged.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise StudyError(
            "the journal cannot be read", where=str(path), got=error.strerror
        ) from None
    return parse_records(data, path)[0]


def journal_bytes(records: Iterable[Record]) -> bytes:
    """Lines of a journal."""
    return b"".join(
        json.dumps(record, separators=(",", ":"), ensure_ascii=False).encode() + b"\n"
        for record in records
    )


class SyncThread:
    """A thread that flushes files to the disk every `SYNC` seconds.

    The system reports lost data only once, and later flushes succeed. The first error is therefore
    kept, and raised by `check`.

    Args:
        sync: Flushes the files.
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
