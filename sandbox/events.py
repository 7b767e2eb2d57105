"""Events of a session as JSON lines: ordered, never lost, for scripts that drive a session."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from models.errors import InputError


class EventLog:
    """Writes one line per event, at once; without a path it writes nothing.

    Args:
        path: Of the file, appended to; a named pipe works too.

    Raises:
        InputError: The file cannot be opened.
    """

    def __init__(self, path: Path | None) -> None:
        try:
            self._file = path.open("ab", buffering=0) if path else None
        except OSError as error:
            raise InputError(
                "the file cannot be written", where=f"--events {path}", got=error.strerror
            ) from None

    def tell(self, kind: str, **data: Any) -> None:
        """Writes an event: `listening`, `trial_start`, `trial_end` or `warning`."""
        if self._file:
            self._file.write(json.dumps({"event": kind, **data}).encode() + b"\n")

    def close(self) -> None:
        """Closes the file."""
        if self._file:
            self._file.close()
