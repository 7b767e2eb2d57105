"""The folder of one session: its record, its recordings and their frames."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from models.errors import DifferentPlanError, StudyError
from sandbox.devices.device import Closeable
from sandbox.lsl import send_event
from sandbox.recording.recording import stored
from sandbox.recording.versions import versions
from sandbox.study.design.session_plan import Step, TrialStep, session_plan, trials_of
from sandbox.study.record.copies import JOURNAL
from sandbox.study.record.durable_files import locked, make_folder, remove_unfinished, study_error
from sandbox.study.record.folder import FILES, Participant, StudyFolder, design_files
from sandbox.study.record.journal import HASH, Journal, Record, SyncThread, cut_damage, read_journal
from sandbox.study.record.notes import LOSS, SEALED, broken_seals, person_notes, seals_of
from sandbox.study.record.records import (
    COMMAND,
    REPAIRED,
    RESUME,
    RUNS,
    SCHEMA,
    SESSION,
    TRIAL,
    TRIAL_END,
)
from sandbox.study.record.state import Attempt, SessionState, decisions_on
from sandbox.study.record.stored_sessions import StoredSession, session_path, sessions_of
from sandbox.study.record.trial_files import (
    TRIALS,
    finished_result,
    recorded_seconds,
    recording_digest,
    unknown_recordings,
    whole_leftovers,
)
from sandbox.system.files import sync_file, sync_folder
from sandbox.trial.result import ResultRecord, TrialResult

SENT = ("n", "step", "trial", "attempt", "practice", "form", "block", "levels", "command")
"""Fields of a record that are sent over LSL to other instruments. The hash of the record is not
sent: whoever knows it and all other fields could find an answer by trying."""


class SessionFolder(Closeable):
    """A session of a participant, opened for writing by this program only.

    Opening it repairs the effects of a kill or a power cut: a half-written last line is cut off, a
    trial with a complete recording is added, and an interrupted trial is marked.

    Args:
        study: The study.
        person: The participant.
        number: Session number of this participant, from 1.
        recovering: True also opens a session whose journal has lost records; see
            `sandbox.study.run.decisions`.

    Attributes:
        path: Path of the folder.
        steps: All steps of the plan.
        state: State of the session according to the journal.
        resumed: True if the session had begun before.
        damaged: Copy of the journal with its damaged lines, if opening has cut them off; else None.
        away: Time from the session's last record to its opening, s, by the wall clock.

    Raises:
        StudyError: Another program has the session open, it belongs to another study, an earlier
            session is not complete, or its journal has lost records.
    """

    def __init__(
        self, study: StudyFolder, person: Participant, number: int = 1, recovering: bool = False
    ) -> None:
        self.study, self.person, self.number = study, person, number
        self.steps: list[Step] = session_plan(study.design, person.number, number)
        self._check_turn()
        self.path = session_path(study.path, person.ppid, number)
        make_folder(self.path / TRIALS)
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
        for folder in (self.path, self.path / TRIALS):
            remove_unfinished(folder)
        self.damaged = cut_damage(self.path / JOURNAL) if recovering else None
        if not recovering:
            self._check_losses()
        self.journal = Journal(self.path / JOURNAL)
        self._closing.callback(self.journal.close)
        notes = person_notes(self.study.path, self.person.ppid)
        decided = decisions_on(notes, self.number)
        self.state = SessionState.of(self.journal.records, decided)
        if self.state.start:
            self._check()
            if not self.state.complete:
                self._check_plan()
        self.resumed = bool(self.state.start)
        self.away = _since(self.journal.records)
        seals = seals_of(self.study.path, self.person.ppid, self.number)
        self._sealed = seals[-1].hash if seals else ""
        # A complete session is resumed only if records remain to be written.
        self._is_opened = False
        if not self.state.complete:
            self._write_opening()
        # Times of records belong to a boot of the machine, which the opening record names. So
        # records of repairs come after it.
        self._recover()
        self._note_leftovers()
        self._syncing = SyncThread(self._sync)
        self._closing.callback(self._syncing.close)

    def _write_opening(self) -> None:
        """Records that the session begins or is resumed, with the program and the machine."""
        design = self.study.design
        # The design's texts are recorded once, in the first opening with this design.
        texts = {} if self.state.design == design.digest else {FILES: design_files(design)}
        self.write(
            RESUME if self.resumed else SESSION,
            durable=True,
            schema=SCHEMA,
            experiment=design.name,
            mode=self.study.mode,
            design=design.digest,
            **texts,
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
        try:
            record = self.journal.append(kind, durable, **values)
        finally:
            # A record of a step of the clock may have been written before this record failed.
            for new in self.journal.records[before:]:
                self.state.take(new)
        # Other instruments get events, without answers and without texts of the experimenter.
        send_event(f"journal_{kind}", {name: record[name] for name in SENT if name in record})
        return record

    def command(self, name: str, /, durable: bool = False, **values: Any) -> Record:
        """Writes a command of the experimenter; see `write`."""
        return self.write(COMMAND, durable, command=name, **values)

    def begin_again(self, steps: Sequence[Step], reason: str) -> None:
        """Records that some steps are repeated. Earlier attempts at their trials no longer count.

        Raises:
            StudyError: The record cannot be written.
        """
        self.command("begin_again", durable=True, steps=[step.id for step in steps], reason=reason)

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
        """Records an attempt whose records were lost; the times of its events are not known.

        Args:
            trial: The trial of the plan.
            file: The recording of the attempt, without `.gz`.
            result: The result at the end of the recording.

        Raises:
            StudyError: The record cannot be written.
        """
        self._start(trial, file, taken_in=True)
        self._commit(self.state.attempts[trial.number][-1], result, taken_in=True)

    def set_aside(self, file: str, reason: str) -> None:
        """Records that a recording, which no record mentions, does not count; the file stays."""
        self.write(REPAIRED, durable=True, file=file, reason=reason, recording=self._digest(file))

    def accept_loss(self, lost: int, unlike: bool, reason: str) -> None:
        """Records a loss of records, in the journal and in the notes about the participant.

        Args:
            lost: Number of lost records.
            unlike: True if sealed records have changed.
            reason: Reason of the experimenter, for the journal and the notes.
        """
        kept = self.journal.found
        # If sealed records have changed, all seals of the session are void.
        most = -1 if unlike else kept
        seals = seals_of(self.study.path, self.person.ppid, self.number)
        self.study.note_about(
            self.person.ppid,
            LOSS,
            session=self.number,
            records=lost,
            voids=[seal.hash for seal in seals if seal.records > most],
            reason=reason,
        )
        self.write(REPAIRED, durable=True, records=lost, reason=reason)

    def _start(self, trial: TrialStep, file: str, **more: Any) -> None:
        self.write(
            TRIAL,
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
        self._commit(self.state.attempts[trial.number][-1], result)

    def break_off(self, trial: TrialStep, why: str) -> None:
        """Records that an attempt was broken off."""
        self._end(self.state.attempts[trial.number][-1], why=why)

    def seal(self) -> str:
        """Writes a note with the number of records of this session, and the hash of the last one.

        Returns:
            The hash.

        Raises:
            StudyError: The record cannot be written.
        """
        self.journal.sync()
        head, count = self.journal.head, len(self.journal.records)
        if head != self._sealed:
            self.study.note(
                SEALED, ppid=self.person.ppid, session=self.number, records=count, hash=head
            )
            self._sealed = head
            # This hash covers the whole journal. Another machine that records it can prove later
            # that the journal is unchanged.
            send_event(SEALED, {"session": self.number, "records": count, HASH: head})
        return head

    def close(self) -> None:
        """Closes the session, so that other programs can open it."""
        self._closing.close()

    def _new_file(self, trial: int, attempt: int) -> str:
        """Name of a new recording.

        A recording of this attempt may exist already, if a power cut has lost the attempt's record.
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
        path = stored(self.path / start["file"])
        try:
            sync_file(path)
            sync_folder(path.parent)
        except OSError as error:
            raise study_error(error, path, "the recording cannot be flushed to the disk") from None
        self._end(attempt, durable=True, result=result.values_for(ResultRecord.JOURNAL), **more)

    def _end(self, attempt: Attempt, durable: bool = False, **more: Any) -> None:
        """Records the end of an attempt, with the digest of its recording."""
        self._recording = None
        of = {name: attempt.start[name] for name in ("step", "trial", "attempt", "file")}
        digest = self._digest(attempt.start["file"])
        self.write(TRIAL_END, durable, **of, recording=digest, **more)

    def _check_turn(self) -> None:
        """Raises an error if the design has no such session, or an earlier one is unfinished."""
        planned = self.study.design.sessions
        if not 1 <= self.number <= planned:
            raise StudyError(
                "the design has no session of this number",
                where="--session",
                got=self.number,
                expected="1" if planned == 1 else f"1 to {planned}",
                remedy="`sessions` in the design sets the number of sessions",
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
                remedy=f"Continue with --session {missing}; its key s skips steps that will not be "
                "done",
            )
        self._check_group(earlier)

    def _check_group(self, earlier: Sequence[StoredSession]) -> None:
        """Raises an error if this session would move the participant to another group.

        A group has one level of a factor whose order is `between`.
        """
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
                raise DifferentPlanError(
                    "this participant was in another group before the design changed",
                    where=f"participant {self.person.ppid}, session {self.number}",
                    got=f"{factor.name} {', '.join(sorted(now))}",
                    expected=", ".join(sorted(had)),
                    remedy="Restore the earlier design, or leave out this session",
                )

    def _check(self) -> None:
        """Raises an error for a folder of another study, such as one copied from a pilot."""
        start = self.state.start
        mine = {
            "experiment": self.study.design.name,
            "mode": self.study.mode,
            "session": self.number,
            **vars(self.person),
        }
        if not self.state.attempts:
            # A participant who is included again before the first trial may have another number.
            del mine["number"]
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
        """Raises an error if trials of this session were run by another plan.

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
                # A level must keep its settings to the end of a session.
                new = json.loads(json.dumps(plan.values))
                other = sorted(n for n in chosen if new.get(n) != start["values"].get(n))
                got = ", ".join(f"{n} {start['values'].get(n)}, now {new.get(n)}" for n in other)
            if got:
                raise DifferentPlanError(
                    "this session began with another plan, since the design has changed",
                    where=f"{self.path}, trial {trial}",
                    got=got,
                    remedy="Finish it with its original design, which its journal contains, or "
                    "leave it as it is and add a new participant",
                )

    def _check_losses(self) -> None:
        """Raises an error if the journal has lost records: the experimenter must decide first."""
        records = read_journal(self.path / JOURNAL)
        self.state = SessionState.of(records)
        if self.state.start:
            # A folder of another study or session is refused first, whatever it has lost.
            self._check()
        whole = whole_leftovers(self.path, self.state)
        seals = seals_of(self.study.path, self.person.ppid, self.number)
        lacks, unlike = broken_seals(records, seals)
        if not whole and not lacks and not unlike:
            return
        names = ", ".join(Path(file).stem for file in whole)
        found = [
            *([f"whole recordings without a record: {names}"] if whole else []),
            *([f"{lacks} of the sealed records are missing"] if lacks else []),
            *(["sealed records have changed"] if unlike else []),
        ]
        raise StudyError(
            "records of this session are missing or changed",
            where=str(self.path),
            got="; ".join(found),
            remedy=f"Restore {JOURNAL} from a backup; or `sandbox study note {self.study.path} "
            f'--participant {self.person.ppid} --accept-loss "REASON"` accepts the loss. '
            "Nothing was changed",
        )

    def _note_leftovers(self) -> None:
        """Records incomplete recordings of attempts whose records were lost in a power cut."""
        whole = whole_leftovers(self.path, self.state)
        for file in unknown_recordings(self.path, self.state):
            if file not in whole:
                self.write(REPAIRED, file=file, recording=self._digest(file))

    def _recover(self) -> None:
        """Adds the attempt that ran when the program was killed, or marks it as interrupted."""
        attempt = self.state.open_attempt()
        if attempt is None:
            return
        start = attempt.start
        result = finished_result(self.path / start["file"])
        if result is not None:
            lasted = recorded_seconds(self.path / start["file"], result)
            self._commit(attempt, result, adopted=True, lasted=lasted)
        else:
            self._end(attempt, why="the program ended")

    def _digest(self, file: str) -> str | None:
        path = self.path / file
        try:
            return recording_digest(path)
        except OSError as error:
            raise study_error(error, path, "the recording cannot be read") from None

    def _sync(self) -> None:
        self.journal.sync()
        # A local copy: the session's thread may end the trial and compress its recording meanwhile.
        recording = self._recording
        if recording is not None:
            with suppress(FileNotFoundError):
                sync_file(recording)


def _since(lines: Sequence[Record]) -> float:
    """Time since the last record, s; 0 without records, or if the clock went back."""
    if not lines:
        return 0.0
    passed = datetime.now(UTC) - datetime.fromisoformat(lines[-1]["time"])
    return max(passed.total_seconds(), 0.0)


def boot_id() -> str:
    """Id of the present boot of the machine; empty if unknown.

    Times of the monotonic clock can be compared only within one boot.
    """
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text().strip()
    except OSError:
        return ""
