"""Events of a session as JSON lines, in order and complete, for scripts that drive a session."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from models.errors import InputError
from sandbox.session.messages import Snapshot

MOST_WAITING = 10_000
"""Greatest number of events that wait for their reader."""
PATIENCE = 5.0
"""s for which `close` waits while the reader takes nothing."""


class EventLog:
    """Writes one line per event, at once; without a path it writes nothing.

    A thread of its own writes, so a reader who stands still holds no session up. A failed write
    does not end the session: `close` reports it.

    Args:
        path: File to append to, also a named pipe; None writes nothing.

    Raises:
        InputError: The file cannot be opened.
    """

    def __init__(self, path: Path | None) -> None:
        self._path, self._error, self._broken = path, "", False
        self._waiting: SimpleQueue[bytes] = SimpleQueue()
        self._written = 0
        self._lock = threading.Lock()
        try:
            self._file = path.open("ab", buffering=0) if path else None
        except OSError as error:
            raise InputError(
                "the file cannot be written", where=f"--events {path}", got=error.strerror
            ) from None
        self._thread = threading.Thread(target=self._write, name="events", daemon=True)
        if self._file is not None:
            self._thread.start()

    def tell(self, kind: str, **data: Any) -> None:
        """Writes an event: `listening`, `trial_start`, `trial_end` or `warning`."""
        if self._file is None or self._error:
            return
        line = json.dumps({"event": kind, **data}).encode() + b"\n"
        # The threads of session, page and window write events.
        with self._lock:
            if self._waiting.qsize() < MOST_WAITING:
                self._waiting.put(line)
            else:
                self._error = f"more than {MOST_WAITING:,} events waited for their reader"

    def close(self) -> None:
        """Writes what waits and closes the file; may be called twice.

        Raises:
            InputError: An event could not be written, or found no place to wait; that one and all
                later ones are lost.
        """
        if self._file is not None:
            self._waiting.put(b"")
            before = -1
            while self._thread.is_alive() and self._written != before:
                before = self._written
                self._thread.join(PATIENCE)
            if self._thread.is_alive():
                self._error = self._error or f"the reader took nothing for {PATIENCE:g} s"
            else:
                self._file.close()
            self._file = None
        error, self._error = self._error, ""
        if error:
            raise InputError(
                "events were lost",
                where=f"--events {self._path}",
                got=error,
                remedy="Only events are affected; make room, or read the pipe to its end",
            )

    def _write(self) -> None:
        """Writes events until an empty line comes; after a failed write it only counts them."""
        file = self._file
        assert file is not None
        while line := self._waiting.get():
            try:
                while line and not self._broken:
                    line = line[file.write(line) :]
            except OSError as error:
                self._error, self._broken = error.strerror or str(error), True
            self._written += 1


class NoticeEvents:
    """Writes every new notice of a session as one `warning` event.

    Args:
        events: Log of events.
        say: Receives the text of the notice as well, to show it to the person.
    """

    def __init__(self, events: EventLog, say: Callable[[str], object]) -> None:
        self._events, self._say = events, say
        self._last: frozenset[str] = frozenset()

    def show(self, snapshot: Snapshot) -> None:
        """Looks for new notices; must get every snapshot, or a short notice would be missed."""
        for notice in snapshot.notices:
            if notice not in self._last:
                self._events.tell("warning", what=notice, time_s=round(snapshot.time, 3))
                self._say(notice)
        self._last = frozenset(snapshot.notices)
