"""Events of a session as JSON lines, in order and complete, for scripts that drive a session."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from models.errors import InputError
from sandbox.session.messages import Snapshot


class EventLog:
    """Writes one line per event without buffering; without a path it writes nothing.

    A failed write does not end the session: `close` reports it.

    Args:
        path: File to append to, also a named pipe; None writes nothing.

    Raises:
        InputError: The file cannot be opened.
    """

    def __init__(self, path: Path | None) -> None:
        self._path, self._error = path, ""
        try:
            self._file = path.open("ab", buffering=0) if path else None
        except OSError as error:
            raise InputError(
                "the file cannot be written", where=f"--events {path}", got=error.strerror
            ) from None

    def tell(self, kind: str, **data: Any) -> None:
        """Writes an event: `listening`, `trial_start`, `trial_end` or `warning`."""
        if self._file is None or self._error:
            return
        line = json.dumps({"event": kind, **data}).encode() + b"\n"
        try:
            while line:
                line = line[self._file.write(line) :]
        except OSError as error:
            self._error = error.strerror or str(error)

    def close(self) -> None:
        """Closes the file; may be called twice.

        Raises:
            InputError: An event could not be written; that one and all later ones are lost.
        """
        if self._file is not None:
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
