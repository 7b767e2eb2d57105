"""The journal: append-only JSON lines, one write per record, the only truth of a session.

A written record is safe from the program's end at once, and from a power cut within `SYNC` seconds,
or at once if it reports that something is finished.
"""

from __future__ import annotations

import json
import os
import stat
import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from models.errors import StudyError
from models.json_input import checked, decoded_record
from sandbox.study.record.files import study_error, sync_folder
from sandbox.study.record.record_forms import FORMS, RecordHead

SYNC = 0.5
"""s between two moments at which everything written so far is put on the disk."""

SCHEMA = 1
"""Version of the records."""

Record = dict[str, Any]


def now() -> str:
    """The time of day, UTC, in the format of records."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


class Journal:
    """Appends records to a file; the owner must hold the session's lock.

    A half written line of a killed program is cut off on opening, and the cut is recorded.

    Args:
        path: Path of the file, which is created if needed.

    Attributes:
        records: All records, in order.

    Raises:
        StudyError: It cannot be opened, or is not a journal.
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
            values: JSON values.

        Raises:
            StudyError: It cannot be written, and the journal is unchanged; or, for a durable
                record, it was written but may not be on the disk.
        """
        record = {
            "n": len(self.records),
            "time": now(),
            "clock": round(time.monotonic(), 6),
            "kind": kind,
            **values,
        }
        data = json.dumps(record, separators=(",", ":"), ensure_ascii=False).encode() + b"\n"
        try:
            self._write(data)
            self.records.append(record)
            if durable:
                os.fsync(self._fd)
        except OSError as error:
            raise study_error(error, self.path, "the journal cannot be written") from None
        return record

    def sync(self) -> None:
        """Puts everything on the disk."""
        os.fdatasync(self._fd)

    def close(self) -> None:
        """Closes the file."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1

    def _write(self, data: bytes) -> None:
        """One write; a full disk takes a part of it, and the next one says why."""
        written = 0
        try:
            while written < len(data):
                written += os.write(self._fd, data[written:])
        except OSError:
            if written:
                self._take_back(written)
            raise

    def _take_back(self, written: int) -> None:
        """Removes a half-written line; where that fails, nothing more is written, and the next
        opening removes it."""
        try:
            os.ftruncate(self._fd, os.fstat(self._fd).st_size - written)
        except OSError:
            self.close()
            raise


def parse_records(data: bytes, path: Path) -> tuple[list[Record], int]:
    """Records of a journal, and how many bytes of it are sound: the rest is a torn last line.

    Raises:
        StudyError: Something before the last line is damaged: no crash does that.
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
    """A record of which `n` come before it.

    Raises:
        StudyError: It is damaged, or another one should stand here.
    """
    what, remedy = "the journal is damaged", "Take it back from a backup; nothing was changed"
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
    """Reads the records of a journal that another program may be writing; skips a torn last line.

    Raises:
        StudyError: It cannot be read, or is damaged.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise StudyError(
            "the journal cannot be read", where=str(path), got=error.strerror
        ) from None
    return parse_records(data, path)[0]


class SyncThread:
    """Puts files on the disk every half second, from a thread of its own.

    Args:
        sync: Puts them there. Its errors must be reported at once: the system reports lost pages
            only once, and later calls succeed.
    """

    def __init__(self, sync: Callable[[], None]) -> None:
        self._sync = sync
        self._error: OSError | None = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="sync", daemon=True)
        self._thread.start()

    def check(self) -> None:
        """Says what could not be put on the disk.

        Raises:
            OSError: At some moment since the beginning, something could not.
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
