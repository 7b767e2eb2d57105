"""A new file of JSON lines, each flushed as soon as it is written."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from models.errors import RecordingError
from sandbox.devices.device import Closeable


class LineFile(Closeable):
    """Writes lines from one thread; a crash loses at most the line being written.

    Args:
        path: The file; an existing file is never overwritten.

    Attributes:
        lines: Number of lines written.

    Raises:
        RecordingError: The file exists or cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.lines = path, 0
        try:
            self._file = path.open("x", encoding="utf-8")
        except FileExistsError:
            raise RecordingError(
                "this file exists already, and is not overwritten", where=str(path)
            ) from None
        except OSError as error:
            raise RecordingError("cannot be written", where=str(path), got=error.strerror) from None

    def write(self, values: Mapping[str, Any]) -> None:
        """Appends a line.

        Raises:
            RecordingError: The line cannot be written; the lines before it are on disk.
        """
        try:
            print(json.dumps(values, separators=(",", ":")), file=self._file, flush=True)
        except OSError as error:
            raise RecordingError(
                "the recording cannot go on",
                where=str(self.path),
                got=error.strerror,
                remedy="Make room on the disk; the lines before this are kept",
            ) from None
        self.lines += 1

    def discard(self) -> None:
        """Closes the file and removes it, where nothing was to be written."""
        self.close()
        self.path.unlink(missing_ok=True)

    def close(self) -> None:
        """Closes the file; may be called twice."""
        # `write` has already reported a line that could not be written.
        with suppress(OSError):
            self._file.close()
