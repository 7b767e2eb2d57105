"""The folder of one session: its journal, its recordings, and what is derived from them."""

from __future__ import annotations

import os
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from msgspec import Struct

from models.errors import RecordingError, StudyError
from models.json_input import decoded
from sandbox.lsl.lsl_listening import tell
from sandbox.recording.recording import load_recording
from sandbox.recording.recording_file import stored
from sandbox.recording.versions import versions
from sandbox.session.closeable import Closeable
from sandbox.study.design.plan import Step, TrialStep, session_plan, trials_of
from sandbox.study.record.files import (
    locked,
    make_folder,
    remove_unfinished,
    study_error,
    sync_file,
    sync_folder,
)
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import SCHEMA, Journal, Record, SyncThread
from sandbox.study.record.state import Attempt, SessionState
from sandbox.study.record.stored_sessions import JOURNAL, session_path, sessions_of
from sandbox.trial.result import KeptIn, TrialResult

TOLD = ("n", "step", "trial", "attempt", "practice", "form", "block", "levels")
"""Fields of a record that are sent to other instruments."""


class SessionFolder(Closeable):
    """A participant's session, opened exclusively for writing.

    Opening repairs the effects of a kill or a power cut: a torn last line is cut off, a trial with
    a complete recording is added, an interrupted one is marked as such.

    Args:
        study: The study.
        person: The participant.
        number: Session number of this participant, from 1.

    Attributes:
        path: Path of the folder.
        steps: The whole plan.
        state: State that follows from the journal.

    Raises:
        StudyError: Another program has it open, it belongs to another study, or an earlier session
            is not complete.
    """

    def __init__(self, study: StudyFolder, person: Participant, number: int = 1) -> None:
        self.study, self.person, self.number = study, person, number
        self._check_turn()
        self.path = session_path(study.path, person.ppid, number)
        self.steps: list[Step] = session_plan(study.design, person.number, number)
        for folder in (
            self.path,
            self.path / "trials",
            self.path / "trackers",
            self.path / "session_info",
        ):
            make_folder(folder)
        self._recording: Path | None = None
        self._syncing: SyncThread | None = None
        self._closing = ExitStack()
        try:
            self._open()
        except BaseException:
            self._closing.close()
            raise

    def _open(self) -> None:
        what = f"participant {self.person.ppid}"
        self._closing.enter_context(locked(self.path / ".lock", wait=False, what=what))
        for name in ("", "trials", "trackers", "session_info"):
            remove_unfinished(self.path / name)
        self.journal = Journal(self.path / JOURNAL)
        self._closing.callback(self.journal.close)
        self.state = SessionState.of(self.journal.records)
        if self.state.start:
            self._check()
            self._check_plan()
        self._recover()
        self.resumed = bool(self.state.start)
        kind = "session_resume" if self.resumed else "session_start"
        self.write(
            kind,
            durable=True,
            schema=SCHEMA,
            study=self.study.id,
            experiment=self.study.design.name,
            mode=self.study.mode,
            design=self.study.design.digest,
            session=self.number,
            versions=versions(),
            build=self.study.build,
            **vars(self.person),
        )
        self._syncing = SyncThread(self._sync)
        self._closing.callback(self._syncing.close)

    def write(self, kind: str, durable: bool = False, **values: Any) -> Record:
        """Writes a record and takes it in.

        Raises:
            StudyError: It cannot be written, and is not taken in either.
        """
        if durable and self._syncing is not None:
            try:
                self._syncing.check()
            except OSError as error:
                raise study_error(
                    error, self.path, "the disk did not take what was written before"
                ) from None
        record = self.journal.append(kind, durable, **values)
        self.state.take(record)
        # Other instruments hear what happens, and nothing that anybody has said.
        tell(f"journal_{kind}", {name: record[name] for name in TOLD if name in record})
        return record

    def begin(self, trial: TrialStep) -> Path:
        """Writes that an attempt begins.

        Returns:
            Where its recording goes: a file that does not exist.
        """
        attempt = len(self.state.attempts.get(trial.number, [])) + 1
        file = self._free(trial.number, attempt)
        self.write(
            "trial_start",
            step=trial.id,
            trial=trial.number,
            attempt=attempt,
            file=file,
            block=trial.block,
            in_block=trial.in_block,
            repetition=trial.repetition,
            practice=trial.practice,
            levels=trial.levels,
            values=trial.values,
            seed=trial.seed,
        )
        self._recording = self.path / file
        return self._recording

    def finish(self, trial: TrialStep, result: TrialResult) -> None:
        """Commits an attempt: its recording is on the disk before the journal says so.

        Raises:
            StudyError: It cannot be written.
        """
        attempt = self.state.attempts[trial.number][-1]
        self._commit(attempt, result, adopted=False)

    def break_off(self, trial: TrialStep, why: str) -> None:
        """Writes that an attempt was broken off."""
        start = self.state.attempts[trial.number][-1].start
        self._recording = None
        self.write(
            "trial_broken",
            step=trial.id,
            trial=trial.number,
            attempt=start["attempt"],
            file=start["file"],
            why=why,
        )

    def close(self) -> None:
        """Lets others open it."""
        self._closing.close()

    def _free(self, trial: int, attempt: int) -> str:
        """A recording's name that nothing has yet.

        A power cut may have taken the record of an attempt, and left its recording.
        """
        name = (
            f"trials/T{trial:03d}.jsonl"
            if attempt == 1
            else f"trials/T{trial:03d}.a{attempt}.jsonl"
        )
        while stored(self.path / name).exists():
            attempt += 1
            name = f"trials/T{trial:03d}.a{attempt}.jsonl"
        return name

    def _commit(self, attempt: Attempt, result: TrialResult, adopted: bool) -> None:
        start = attempt.start
        path = stored(self.path / start["file"])
        try:
            sync_file(path)
            sync_folder(path.parent)
        except OSError as error:
            raise study_error(error, path, "the recording cannot be kept") from None
        self._recording = None
        more = {"adopted": True} if adopted else {}
        self.write(
            "trial_end",
            durable=True,
            step=start["step"],
            trial=start["trial"],
            attempt=start["attempt"],
            file=start["file"],
            result=result.kept_in(KeptIn.JOURNAL),
            **more,
        )

    def _check_turn(self) -> None:
        """Refuses a session that the design does not know, or whose forerunner is not finished."""
        planned = self.study.design.sessions
        if not 1 <= self.number <= planned:
            times = "once" if planned == 1 else f"{planned} times"
            raise StudyError(
                f"by the design everybody comes {times}",
                where="--session",
                got=self.number,
                remedy="`sessions` in the design says how often",
            )
        if self.number == 1:
            return
        done = {s.number for s in sessions_of(self.study, self.person) if s.state.complete}
        missing = next((n for n in range(1, self.number) if n not in done), None)
        if missing is not None:
            raise StudyError(
                f"session {missing} comes first, and is not finished",
                where=f"participant {self.person.ppid}",
                got=f"session {self.number}",
                remedy=f"Go on with --session {missing}; there the key s skips what "
                "will not be done",
            )

    def _check(self) -> None:
        """Refuses a folder that is another study's, such as one copied in from a pilot."""
        start = self.state.start
        mine = {
            "study": self.study.id,
            "mode": self.study.mode,
            "session": self.number,
            **vars(self.person),
        }
        wrong = [name for name, value in mine.items() if start.get(name) != value]
        if wrong:
            raise StudyError(
                "this session belongs to another study, participant or time",
                where=str(self.path),
                got=", ".join(f"{n} {start.get(n)}" for n in wrong),
                expected=", ".join(f"{n} {mine[n]}" for n in wrong),
                remedy="Put it back where it came from",
            )

    def _check_plan(self) -> None:
        """Raises an error if the plan differs from that of the existing trials.

        A design that was changed by force gives every participant another plan.
        """
        planned = {t.number: t for t in trials_of(self.steps)}
        for trial, attempts in self.state.attempts.items():
            start, plan = attempts[-1].start, planned.get(trial)
            if plan is None or (plan.seed, plan.levels) != (start["seed"], start["levels"]):
                raise StudyError(
                    "this session was begun by another plan, since the design changed",
                    where=f"{self.path}, trial {trial}",
                    remedy="Finish it with the design that it began with, or leave "
                    "it as it is and take a new participant",
                )

    def _recover(self) -> None:
        """Adds, or marks as interrupted, the attempt that was running when the program ended."""
        attempt = self.state.open_attempt()
        broken = {
            (r["trial"], r["attempt"]) for r in self.journal.records if r["kind"] == "trial_broken"
        }
        if attempt is None or (attempt.start["trial"], attempt.start["attempt"]) in broken:
            return
        start = attempt.start
        result = finished_result(self.path / start["file"])
        if result is not None:
            self._commit(attempt, result, adopted=True)
        else:
            self.write(
                "trial_broken",
                step=start["step"],
                trial=start["trial"],
                attempt=start["attempt"],
                file=start["file"],
                why="the program ended",
            )

    def _sync(self) -> None:
        self.journal.sync()
        # One read: the session's thread may end the trial meanwhile, and compress its recording.
        recording = self._recording
        if recording is not None:
            with suppress(FileNotFoundError):
                sync_file(recording)


def finished_result(path: Path) -> TrialResult | None:
    """The result at the end of a recording; None if it is incomplete or marked as not counting."""
    file = stored(path)
    if not file.exists() or (file == path and not _ends(path)):
        return None
    try:
        recording = load_recording(path)
    except RecordingError:
        # Killed before its first line was whole.
        return None
    if recording.damage or recording.end is None or recording.end["result"].get("broken_off"):
        return None
    return TrialResult.from_json(recording.end["result"], str(path))


class _LastLine(Struct):
    """Field that only the last line of a recording has."""

    kind: str = ""


def _ends(path: Path) -> bool:
    """True if the last line is complete and an end line; reads only the last bytes."""
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
        # It may be longer than what was looked at.
        return True
    return line.kind == "end"
