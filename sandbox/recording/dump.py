"""The last moments of a simulation that diverged, as a recording that replays to the same end.

Everything that came in since the trial began is kept in memory, a few hundred bytes per touch
frame, and of the states the last hundred. Touches alone would not do: where the numbers lose their
meaning has to be seen state by state. States alone would not do either: who is which finger, and
what the filters remember, is known only from all touches since the beginning.
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
"""Control states in a dump: 1.6 s."""
MOST_DUMPS = 1000
"""Of one trial in one folder."""


class DivergenceRecorder(RecordingLines):
    """Remembers a session, and passes everything on to a recording where there is one.

    Args:
        header: Of the recording.
        recording: Written all along; None writes nothing unless the simulation diverges.
    """

    def __init__(self, header: dict[str, Any], recording: RecordingWriter | None = None) -> None:
        super().__init__()
        self._header, self._recording = header, recording
        self._lines: list[Line | DeferredLine] = []
        # The last control states, one to a row, round and round, and which they are.
        self._last = np.empty((0, 0))
        self._told: list[tuple[int, str]] = []

    def state(
        self,
        step: int,
        state: NDArray[np.float64],
        state_hash: str,
        qpos: NDArray[np.float64],
        solid: Sequence[frozenset[int]],
    ) -> None:
        """The simulation at the beginning of a control period."""
        super().state(step, state, state_hash, qpos, solid)
        if not self._told:
            self._last = np.empty((LAST, len(state)))
        self._last[len(self._told) % LAST] = state
        self._told.append((step, state_hash))

    def dump(self, path: Path, step: int, result: dict[str, Any]) -> Path:
        """Writes what led to a divergence.

        Args:
            path: Of the file; where there is one already, a number is added to the name.
            step: Physics step at which the trial ended.
            result: Of the trial.

        Returns:
            Where it was written.

        Raises:
            RecordingError: It cannot be written, or not wholly.
        """
        self._put_track()
        told = list(enumerate(self._told))[-LAST:]
        writer = _new(path, {**self._header, "dump": {"states": len(told)}})
        dense = {s for _, (s, _) in told}
        # In this order the file tells the same story twice: what came in, then how it ended.
        for kept in self._lines:
            line = kept.line() if isinstance(kept, DeferredLine) else kept
            if not (line["kind"] == "keyframe" and line["step"] in dense) and line["kind"] != "end":
                writer.put(line)
        for i, (s, state_hash) in told:
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
    """Where a dump goes: beside the recording, else into the folder; None where there is neither.

    Args:
        folder: For dumps.
        record: The trial's recording.
        task: Name of the task.
        seed: Of the trial.
    """
    if record is not None:
        return record.with_stem(f"{record.stem}-diverged")
    return None if folder is None else folder / f"diverged-{task}-{seed}.jsonl"


def _new(path: Path, header: dict[str, Any]) -> RecordingWriter:
    """A file that did not exist, of this name or with a number."""
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
