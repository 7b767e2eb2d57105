"""A new file of JSON lines, each of which is out of this program as soon as it is written."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from models.errors import RecordingError
from sandbox.session.closeable import Closeable


class LineFile(Closeable):
    """Takes lines from one thread; a program that dies loses at most the one it was writing.

    Args:
        path: Of the file; one that is there is not written over.

    Raises:
        RecordingError: It is there already, or cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self._file = path.open("x", encoding="utf-8")
        except FileExistsError:
            raise RecordingError(
                "this file is there already, and is not written over", where=str(path)
            ) from None
        except OSError as error:
            raise RecordingError("cannot be written", where=str(path), got=error.strerror) from None

    def write(self, values: Mapping[str, Any]) -> None:
        """Appends a line.

        Raises:
            RecordingError: It cannot be written; what came before it is.
        """
        try:
            print(json.dumps(values, separators=(",", ":")), file=self._file, flush=True)
        except OSError as error:
            raise RecordingError(
                "the recording cannot go on",
                where=str(self.path),
                got=error.strerror,
                remedy="Make room on the disk; what was recorded before is kept",
            ) from None

    def close(self) -> None:
        """Closes the file; may be called twice."""
        # What could not be written was told then.
        with suppress(OSError):
            self._file.close()
