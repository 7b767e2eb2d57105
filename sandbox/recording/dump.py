"""Divergence dumps: recordings that replay to the divergence, with the last states in full.

All inputs since the beginning of the trial are kept in memory, a few hundred bytes per touch frame,
and the last hundred states. Inputs alone are not enough to see at which state the numbers go wrong.
States alone are not enough either, because labels and filters depend on all inputs since the
beginning.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import RecordingError
from sandbox.recording.recording import (
    DeferredLine,
    Line,
    RecordingLines,
    RecordingWriter,
    end_line,
    keyframe_line,
)

LAST = 100
"""Number of control states in a dump: 1.6 s."""
MOST_DUMPS = 1000
"""Largest number of dumps of one trial in one folder."""


class DivergenceRecorder(RecordingLines):
    """Keeps a session in memory for a dump, and passes everything on to a recording, if any.

    Args:
        header: Header of the recording.
        recording: Recording that is written during the trial; None writes only dumps.
    """

    def __init__(self, header: dict[str, Any], recording: RecordingWriter | None = None) -> None:
        super().__init__()
        self._header, self._recording = header, recording
        self._lines: list[Line | DeferredLine] = []
        # Ring buffer of the last control states, one per row; step and hash of all states.
        self._last = np.empty((0, 0))
        self._states_seen: list[tuple[int, str]] = []

    def state(
        self,
        step: int,
        state: NDArray[np.float64],
        state_hash: str,
        qpos: NDArray[np.float64],
        solid: Sequence[frozenset[int]],
    ) -> None:
        """Keeps the state at the beginning of a control period."""
        super().state(step, state, state_hash, qpos, solid)
        if not self._states_seen:
            self._last = np.empty((LAST, len(state)))
        self._last[len(self._states_seen) % LAST] = state
        self._states_seen.append((step, state_hash))

    def dump(self, path: Path, step: int, result: dict[str, Any]) -> Path:
        """Writes the dump of a divergence.

        Args:
            path: File of the dump; if it exists, a number is added to the name.
            step: Physics step at which the trial ended.
            result: Result of the trial, JSON values.

        Returns:
            The file that was written.

        Raises:
            RecordingError: The file cannot be written completely.
        """
        self._put_track()
        last = list(enumerate(self._states_seen))[-LAST:]
        writer = _new(path, {**self._header, "dump": {"states": len(last)}})
        dense = {s for _, (s, _) in last}
        # All inputs come first, then the last states.
        for kept in self._lines:
            line = kept.line() if isinstance(kept, DeferredLine) else kept
            if not (line["kind"] == "keyframe" and line["step"] in dense) and line["kind"] != "end":
                writer.put(line)
        for i, (s, state_hash) in last:
            writer.put(keyframe_line(s, self._last[i % LAST], state_hash))
        writer.put(end_line(step, result))
        path = writer.path
        writer.close()
        return path

    def _put(self, line: Line | DeferredLine) -> None:
        self._lines.append(line)
        if self._recording:
            self._recording.put(line)


def dump_path(folder: Path | None, record: Path | None, task: str, seed: int) -> Path | None:
    """Path of a dump: beside the recording, else in the folder; None without either.

    Args:
        folder: Folder for dumps.
        record: File of the trial's recording.
        task: Name of the task.
        seed: Seed of the trial.
    """
    if record is not None:
        return record.with_stem(f"{record.stem}-diverged")
    return None if folder is None else folder / f"diverged-{task}-{seed}.jsonl"


def _new(path: Path, header: dict[str, Any]) -> RecordingWriter:
    """A writer to a new file of this name, with a number added if it exists."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordingError(
            "the folder cannot be made", where=str(path.parent), got=error.strerror
        ) from None
    numbered = path
    for number in range(2, MOST_DUMPS):
        try:
            return RecordingWriter(numbered, header)
        except RecordingError:
            if not numbered.exists():
                raise
        numbered = path.with_stem(f"{path.stem}-{number}")
    return RecordingWriter(numbered, header)
