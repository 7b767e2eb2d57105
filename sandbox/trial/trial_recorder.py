"""The recorder of a trial: its recording if requested, and a dump if the simulation diverges."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from msgspec.structs import replace

from models.errors import RecordingError
from sandbox.lsl.lsl_listening import ForwardingRecorder, with_listeners
from sandbox.recording.dump import DivergenceRecorder, dump_path
from sandbox.recording.recording import RecordingWriter
from sandbox.session.session import Recorder, Session
from sandbox.trial.result import SCHEMA, TrialResult


class TrialRecorder:
    """Records one trial and makes its result.

    Args:
        header: Header of the recording (see `sandbox.trial.driver.trial_header`).
        record: File of the recording; None writes none.
        dump: Folder for the last states of a diverging simulation; beside a recording they are
            always written.

    Attributes:
        recorder: The recorder that the session needs.

    Raises:
        RecordingError: The recording's file exists or cannot be made.
    """

    def __init__(
        self, header: dict[str, Any], record: Path | None = None, dump: Path | None = None
    ) -> None:
        self._header, self._record, self._dump = header, record, dump
        self._writer = RecordingWriter(record, header) if record else None
        self._box = DivergenceRecorder(header, self._writer)
        self.recorder: Recorder = with_listeners(self._box, header)

    def end(self, session: Session, **more: Any) -> TrialResult:
        """Writes the trial's end and returns the result.

        After a divergence `dump` of the result is the file with the last states. If that file
        cannot be written, `dump` is empty and `dump_error` says why.

        Args:
            session: The session at its end.
            more: Further fields of the result by name, JSON values.
        """
        encoder = self._header["settings"]["pipeline"]["encoder"]
        fields = {"encoder": encoder, **self._header, **more, "schema": SCHEMA}
        result = TrialResult.of(session, fields)
        path = dump_path(self._dump, self._record, session.task.name, session.task.seed)
        if session.diverged and path is not None:
            try:
                dump = str(self._box.dump(path, session.step, result.as_json()))
                result = replace(result, dump=dump)
            except RecordingError as error:
                result = replace(result, dump="", dump_error=str(error))
        if isinstance(self.recorder, ForwardingRecorder):
            self.recorder.end(result.as_json())
        self._box.end(session.step, result.as_json())
        return result

    def check(self) -> None:
        """Does nothing while all could be written so far; never waits.

        Raises:
            RecordingError: Something could not be written; what came before it is safe.
        """
        if self._writer:
            self._writer.check()

    def withdraw(self) -> None:
        """Removes the recording of a trial that never began, once it is closed: the same command
        may be given again."""
        if self._record is not None:
            self._record.unlink(missing_ok=True)

    def close(self) -> None:
        """Waits until everything is on disk.

        Raises:
            RecordingError: Something could not be written; what came before it is safe.
        """
        if self._writer:
            self._writer.close()
