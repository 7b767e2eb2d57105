"""The result at the end of a recording, by which a finished attempt is told from others."""

from __future__ import annotations

import os
from pathlib import Path

from msgspec import Struct

from models.errors import RecordingError
from models.json_input import decoded
from sandbox.recording.recording import load_recording, stored
from sandbox.trial.result import TrialResult


def finished_result(path: Path) -> TrialResult | None:
    """Result at the end of a recording; None if it is incomplete or was broken off."""
    file = stored(path)
    if not file.exists() or (file == path and not _may_be_complete(path)):
        return None
    try:
        recording = load_recording(path)
    except RecordingError:
        # The program was killed before the first line was complete.
        return None
    if recording.damage or recording.end is None or recording.end["result"].get("broken_off"):
        return None
    return TrialResult.from_json(recording.end["result"], str(path))


class _LastLine(Struct):
    """Field that only the last line of a recording has."""

    kind: str = ""


def _may_be_complete(path: Path) -> bool:
    """Returns False if the last line is half written or not an end line; reads 64 KiB at most."""
    with path.open("rb") as file:
        file.seek(max(0, os.fstat(file.fileno()).st_size - 65_536))
        tail = file.read()
    if not tail.endswith(b"\n"):
        return False
    try:
        line = decoded(
            tail.split(b"\n")[-2],
            _LastLine,
            RecordingError,
            what="the last line is damaged",
            where=str(path),
        )
    except RecordingError:
        # The last line may be longer than the part that was read.
        return True
    return line.kind == "end"
