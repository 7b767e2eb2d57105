"""Events of a session as JSON lines: ordered, never lost, for scripts that drive a session."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from models.errors import InputError
from sandbox.session.messages import Snapshot


class EventLog:
    """Writes one line per event, at once; without a path it writes nothing.

    A session does not end because nobody hears it any more: that is told when the log is closed.

    Args:
        path: Of the file, appended to; a named pipe works too.

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
            InputError: An event could not be written, and none after it was.
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
                remedy="Nothing else was; make room, or read the pipe to its end",
            )


class NoticeEvents:
    """Tells every new notice of a session as one `warning`.

    Args:
        events: Where it is told.
        say: Says it to the person, too.
    """

    def __init__(self, events: EventLog, say: Callable[[str], object]) -> None:
        self._events, self._say = events, say
        self._last: frozenset[str] = frozenset()

    def show(self, snapshot: Snapshot) -> None:
        """Looks at a snapshot; all of them, or a short notice would be missed."""
        for notice in snapshot.notices:
            if notice not in self._last:
                self._events.tell("warning", what=notice, time_s=round(snapshot.time, 3))
                self._say(notice)
        self._last = frozenset(snapshot.notices)
