"""The folder of one session: its journal, its recordings and its tables."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from models.errors import OtherPlanError, StudyError
from sandbox.devices.device import Closeable
from sandbox.lsl import tell
from sandbox.recording.recording import stored
from sandbox.recording.versions import versions
from sandbox.study.design.plan import Step, TrialStep, session_plan, trials_of
from sandbox.study.record.chain import DIGEST, Record
from sandbox.study.record.file_digests import (
    PACKED,
    file_digests,
    recording_digests,
    tables_of,
)
from sandbox.study.record.files import locked, make_folder, remove_unfinished, study_error
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import SCHEMA, Journal, SyncThread, read_journal
from sandbox.study.record.leftovers import (
    LOG,
    lost_records,
    unknown_recordings,
    whole_leftovers,
)
from sandbox.study.record.pack import pack
from sandbox.study.record.recorded_result import finished_result
from sandbox.study.record.session_clock import RUNS
from sandbox.study.record.state import Attempt, SessionState
from sandbox.study.record.stored_sessions import (
    JOURNAL,
    StoredSession,
    session_path,
    sessions_of,
)
from sandbox.system.files import sync_file, sync_folder
from sandbox.trial.result import KeptIn, TrialResult

SENT = ("n", "step", "trial", "attempt", "practice", "form", "block", "levels")
"""Fields of a record that are sent over LSL to other instruments. Its digest is not: whoever knows
all else of a record could try out what was answered."""
BEGUN, SEALED, LOST = "begun", "sealed", "lost"
"""Kinds of records in the journal of the study: a session has begun; its journal when it was
closed; its journal when somebody accepted that records after that were lost."""


class SessionFolder(Closeable):
    """A session of a participant, opened for writing by this program only.

    Opening it repairs the effects of a kill or a power cut: a half-written last line is cut off, a
    trial with a complete recording is added, and an interrupted trial is marked.

    Args:
        study: The study.
        person: The participant.
        number: Session number of this participant, from 1.

        recovering: True opens a session whose journal has lost records; see
            `sandbox.study.run.recover`.

    Attributes:
        path: Path of the folder.
        steps: All steps of the plan.
        state: State of the session according to the journal.
        resumed: True if the session had begun before.

    Raises:
        StudyError: Another program has the session open, it belongs to another study, an earlier
            session is not complete, or its journal has lost records.
    """

    def __init__(
        self,
        study: StudyFolder,
        person: Participant,
        number: int = 1,
        recovering: bool = False,
    ) -> None:
        self.study, self.person, self.number = study, person, number
        self.steps: list[Step] = session_plan(study.design, person.number, number)
        self._check_turn()
        self.path = session_path(study.path, person.ppid, number)
        for folder in (
            self.path,
            self.path / "trials",
            self.path / "trackers",
            self.path / "session_info",
        ):
            make_folder(folder)
        self._recording: Path | None = None
        self._sealed = ""
        self._syncing: SyncThread | None = None
        self._closing = ExitStack()
        try:
            self._open(recovering)
        except BaseException:
            self._closing.close()
            raise

    def _open(self, recovering: bool) -> None:
        what = f"participant {self.person.ppid}"
        self._closing.enter_context(locked(self.path / ".lock", wait=False, what=what))
        for name in ("", "trials", "trackers", "session_info"):
            remove_unfinished(self.path / name)
        if not recovering:
            self._check_losses()
        self.journal = Journal(self.path / JOURNAL)
        self._closing.callback(self.journal.close)
        self.state = SessionState.of(self.journal.records)
        if self.state.start:
            self._check()
            if not self.state.complete:
                self._check_plan()
        self.resumed = bool(self.state.start)
        self._tell_study()
        # Who opens what is complete resumes it only if something is left to be written down.
        self._is_opened = False
        if not self.state.complete:
            self._write_opening()
        # After the record above, whose clock is that of this start of the machine.
        self._recover()
        self._note_leftovers()
        self._syncing = SyncThread(self._sync)
        self._closing.callback(self._syncing.close)

    def _write_opening(self) -> None:
        """Records that the session begins or is resumed, and by which program and machine."""
        self.write(
            "session_resume" if self.resumed else "session_start",
            durable=True,
            schema=SCHEMA,
            study=self.study.id,
            experiment=self.study.design.name,
            mode=self.study.mode,
            design=self.study.design.digest,
            session=self.number,
            versions=versions(),
            build=self.study.build,
            boot=boot_id(),
            **vars(self.person),
        )
        self._is_opened = True

    def write(self, kind: str, durable: bool = False, **values: Any) -> Record:
        """Writes a record and updates the state.

        Raises:
            StudyError: The record cannot be written; the state is unchanged.
        """
        if durable and self._syncing is not None:
            try:
                self._syncing.check()
            except OSError as error:
                raise study_error(
                    error, self.path, "earlier data could not be written to the disk"
                ) from None
        if not self._is_opened and kind not in RUNS:
            self._write_opening()
        before = len(self.journal.records)
        record = self.journal.append(kind, durable, **values)
        for new in self.journal.records[before:]:
            self.state.take(new)
        # Other instruments get the events, but no answers and no texts of the experimenter.
        tell(f"journal_{kind}", {name: record[name] for name in SENT if name in record})
        return record

    def begin(self, trial: TrialStep) -> Path:
        """Records the start of an attempt.

        Returns:
            Path of its recording, which does not exist yet.
        """
        file = self._new_file(trial.number, len(self.state.attempts.get(trial.number, [])) + 1)
        self._start(trial, file)
        self._recording = self.path / file
        return self._recording

    def take_in(self, trial: TrialStep, file: str, result: TrialResult) -> None:
        """Records an attempt whose records were lost; its times are not known.

        Args:
            trial: The trial of the plan.
            file: Its recording, without `.gz`.
            result: The result at the end of the recording.

        Raises:
            StudyError: The record cannot be written.
        """
        self._start(trial, file, taken_in=True)
        self._commit(self.state.attempts[trial.number][-1], result, taken_in=True)

    def set_aside(self, file: str, reason: str) -> None:
        """Records that a recording without records does not count; the file stays."""
        trackers = self.path / "trackers"
        self.write(
            "set_aside",
            durable=True,
            file=file,
            reason=reason,
            recording=self._digests(file),
            files=file_digests(tables_of(trackers, Path(file).stem)),
        )

    def accept_loss(self, lost: int, reason: str) -> None:
        """Records that records were lost, here and in the journal of the study."""
        kept = self.journal.found
        self.study.note(
            LOST,
            ppid=self.person.ppid,
            session=self.number,
            records=kept,
            digest_of_last=self.journal.records[kept - 1][DIGEST] if kept else "",
        )
        self.write(LOST, durable=True, records=lost, reason=reason)

    def _start(self, trial: TrialStep, file: str, **more: Any) -> None:
        self.write(
            "trial_start",
            step=trial.id,
            trial=trial.number,
            attempt=len(self.state.attempts.get(trial.number, [])) + 1,
            file=file,
            block=trial.block,
            in_block=trial.in_block,
            repetition=trial.repetition,
            practice=trial.practice,
            levels=trial.levels,
            values=trial.values,
            seed=trial.seed,
            **more,
        )

    def finish(self, trial: TrialStep, result: TrialResult) -> None:
        """Records the end of an attempt, after its recording has been flushed to the disk.

        Raises:
            StudyError: The record cannot be written.
        """
        attempt = self.state.attempts[trial.number][-1]
        self._commit(attempt, result)

    def break_off(self, trial: TrialStep, why: str) -> None:
        """Records that an attempt was broken off."""
        start = self.state.attempts[trial.number][-1].start
        self._recording = None
        self.write(
            "trial_broken",
            step=trial.id,
            trial=trial.number,
            attempt=start["attempt"],
            file=start["file"],
            recording=self._digests(start["file"]),
            why=why,
        )

    def pack(self, file: str) -> None:
        """Compresses the recording of a finished trial, unless that has been done.

        Raises:
            StudyError: It cannot be written; the recording is unchanged.
        """
        path = self.path / file
        if not path.exists():
            return
        pack(path)
        if not (self.state.recordings.get(file) or {}).get(PACKED):
            self.write("packed", file=file, recording=self._digests(file))

    def note_tables(self, attempt: Attempt) -> None:
        """Records the digests of the tables that were derived from a recording.

        Raises:
            StudyError: A table cannot be read, or the record cannot be written.
        """
        start = attempt.start
        trackers, stem = self.path / "trackers", Path(start["file"]).stem
        try:
            files = file_digests(tables_of(trackers, stem))
        except OSError as error:
            raise study_error(error, trackers, "a table cannot be read") from None
        if files != self.state.tables.get(start["file"]):
            self.write(
                "tables",
                step=start["step"],
                trial=start["trial"],
                attempt=start["attempt"],
                file=start["file"],
                files=files,
            )

    def seal(self) -> str:
        """Records in the journal of the study how long this journal is, and its last digest.

        Returns:
            That digest.

        Raises:
            StudyError: The record cannot be written.
        """
        self.journal.sync()
        head, count = self.journal.head, len(self.journal.records)
        if head != self._sealed:
            self.study.note(
                SEALED,
                ppid=self.person.ppid,
                session=self.number,
                records=count,
                digest_of_last=head,
            )
            self._sealed = head
            # What another machine records of this is a witness of the whole journal.
            tell(SEALED, {"session": self.number, "records": count, DIGEST: head})
        return head

    def close(self) -> None:
        """Closes the session, so that other programs can open it."""
        self._closing.close()

    def _new_file(self, trial: int, attempt: int) -> str:
        """Name of a recording that does not exist yet.

        A recording may exist without a record of its attempt, which a power cut has lost.
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

    def _commit(self, attempt: Attempt, result: TrialResult, **more: Any) -> None:
        start = attempt.start
        # If it cannot be compressed now, the next opening does it.
        with suppress(StudyError):
            pack(self.path / start["file"])
        path = stored(self.path / start["file"])
        try:
            sync_file(path)
            sync_folder(path.parent)
        except OSError as error:
            raise study_error(error, path, "the recording cannot be flushed to the disk") from None
        self._recording = None
        self.write(
            "trial_end",
            durable=True,
            step=start["step"],
            trial=start["trial"],
            attempt=start["attempt"],
            file=start["file"],
            recording=self._digests(start["file"]),
            result=result.kept_in(KeptIn.JOURNAL),
            **more,
        )

    def _check_turn(self) -> None:
        """Raises an error if the design lacks this session, or an earlier session is unfinished."""
        planned = self.study.design.sessions
        if not 1 <= self.number <= planned:
            raise StudyError(
                "the design has no session of this number",
                where="--session",
                got=self.number,
                expected="1" if planned == 1 else f"1 to {planned}",
                remedy="`sessions` in the design sets their number",
            )
        if self.number == 1:
            return
        earlier = [s for s in sessions_of(self.study, self.person) if s.number < self.number]
        done = {s.number for s in earlier if s.state.complete}
        missing = next((n for n in range(1, self.number) if n not in done), None)
        if missing is not None:
            raise StudyError(
                f"session {missing} comes first, and is not finished",
                where=f"participant {self.person.ppid}",
                got=f"session {self.number}",
                remedy=f"Continue with --session {missing}; the key s skips steps that will not be "
                "done",
            )
        self._check_group(earlier)

    def _check_group(self, earlier: Sequence[StoredSession]) -> None:
        """Raises an error if this session would put its person into another group."""
        planned = trials_of(self.steps)
        for factor in self.study.design.factors:
            had = {
                attempt.start["levels"].get(factor.name)
                for session in earlier
                for attempts in session.state.attempts.values()
                for attempt in attempts
            } - {None}
            now = {trial.levels[factor.name] for trial in planned if factor.name in trial.levels}
            if factor.order == "between" and len(had) == 1 and had != now:
                raise OtherPlanError(
                    "this participant was in another group before the design changed",
                    where=f"participant {self.person.ppid}, session {self.number}",
                    got=f"{factor.name} {', '.join(sorted(now))}",
                    expected=", ".join(sorted(had)),
                    remedy="Go on with the design of before, or leave the participant as they are",
                )

    def _check(self) -> None:
        """Raises an error for a folder of another study, such as one copied from a pilot."""
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
                "this folder belongs to another study, participant or session",
                where=str(self.path),
                got=", ".join(f"{n} {start.get(n)}" for n in wrong),
                expected=", ".join(f"{n} {mine[n]}" for n in wrong),
                remedy="Move it back to its own study",
            )

    def _check_plan(self) -> None:
        """Raises an error if existing trials were run by another plan.

        This happens if the design was changed with --force-upgrade.
        """
        planned = {t.number: t for t in trials_of(self.steps)}
        chosen = {
            name
            for design in (self.study.design, self.study.design_of(self.state.design))
            for factor in design.factors
            for level in factor.levels
            for name in level.settings
        }
        for trial, attempts in self.state.attempts.items():
            start, plan = attempts[-1].start, planned.get(trial)
            got = ""
            if plan is None or (plan.seed, plan.levels) != (start["seed"], start["levels"]):
                got = "another trial"
            elif "values" in start:
                # The same name of a level must mean the same to the end of a session.
                new = json.loads(json.dumps(plan.values))
                other = sorted(n for n in chosen if new.get(n) != start["values"].get(n))
                got = ", ".join(f"{n} {start['values'].get(n)}, now {new.get(n)}" for n in other)
            if got:
                raise OtherPlanError(
                    "this session began with another plan, since the design has changed",
                    where=f"{self.path}, trial {trial}",
                    got=got,
                    remedy="Finish it with its original design, which earlier_designs has, or "
                    "leave it as it is and add a new participant",
                )

    def _check_losses(self) -> None:
        """Raises an error if the journal has lost records: nothing may go on without a decision."""
        journal = self.path / JOURNAL
        records = read_journal(journal) if journal.exists() else []
        whole = whole_leftovers(self.path, SessionState.of(records))
        lost = lost_records(self.path, len(records))
        if not whole and not lost:
            return
        names = ", ".join(Path(file).stem for file in whole)
        found = [
            *([f"whole recordings without a record: {names}"] if whole else []),
            *([f"{lost} records fewer than {LOG} has"] if lost else []),
        ]
        raise StudyError(
            "the journal of this session has lost records",
            where=str(self.path),
            got="; ".join(found),
            remedy=f"`sandbox study recover {self.study.path}` shows what is there, takes it in or "
            "sets it aside; nothing was changed",
        )

    def _note_leftovers(self) -> None:
        """Records what is left of attempts whose records a power cut has taken."""
        whole = whole_leftovers(self.path, self.state)
        for file in unknown_recordings(self.path, self.state):
            if file not in whole:
                self.write("leftover", file=file, recording=self._digests(file))

    def _recover(self) -> None:
        """Adds the attempt that ran when the program was killed, or marks it as interrupted."""
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
                recording=self._digests(start["file"]),
                why="the program ended",
            )

    def _tell_study(self) -> None:
        """Records in the journal of the study that this session has begun, unless it is known."""
        mine = [
            r
            for r in self.study.records()
            if r.get("ppid") == self.person.ppid and r.get("session") == self.number
        ]
        if not any(r["kind"] == BEGUN for r in mine):
            self.study.note(BEGUN, ppid=self.person.ppid, session=self.number)
        self._sealed = next(
            (r["digest_of_last"] for r in reversed(mine) if r["kind"] == SEALED), ""
        )

    def _digests(self, file: str) -> dict[str, Any] | None:
        path = self.path / file
        try:
            return recording_digests(path)
        except OSError as error:
            raise study_error(error, path, "the recording cannot be read") from None

    def _sync(self) -> None:
        self.journal.sync()
        # Read once: the session's thread may end the trial and compress its recording meanwhile.
        recording = self._recording
        if recording is not None:
            with suppress(FileNotFoundError):
                sync_file(recording)


def boot_id() -> str:
    """Id of this start of the machine, by which clocks can be compared; empty if unknown."""
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text().strip()
    except OSError:
        return ""
