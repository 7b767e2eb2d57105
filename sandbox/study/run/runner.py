"""Runs the steps of a session, with a real or a simulated participant."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from hashlib import blake2b
from pathlib import Path
from typing import Any

from models.errors import InputError, StudyError
from models.message import counted
from sandbox.devices.registry import DeviceSettings
from sandbox.devices.simulated import SimulatedOptions
from sandbox.study.design.conditions import PARTNER, consent_text, run_settings
from sandbox.study.design.plan import (
    BreakStep,
    CalibrationStep,
    ConsentStep,
    FormStep,
    InstructionStep,
    Step,
    TrialStep,
)
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.run.answers import Draft, still_allowed
from sandbox.study.run.controls import Command, Controls
from sandbox.study.run.finished_trials import bring_up_to_date
from sandbox.study.run.forms import Forms, Poll
from sandbox.study.run.players import PlayedAttempt, TrialPlayer, TrialRequest
from sandbox.study.run.simulated_user import simulated_user
from sandbox.study.tables.tables import StudyTables, rebuild_session
from sandbox.trial.live_run import TICK
from sandbox.trial.open_devices import DeviceMakers
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings

OpenDevices = Callable[[TrialStep, Settings], DeviceMakers]
"""Returns functions that open the devices of a trial, one for every hand."""
FitSettings = Callable[[TrialStep, Settings, Poll], Settings]
"""Adapts the settings of a trial to the participant's device; may wait for the device."""
Calibrate = Callable[[Poll], dict[str, Any] | None]
"""Measures the participant's hand over a Leap; None uses an average hand."""


class SessionOutcome(StrEnum):
    """Result of running a session."""

    COMPLETE = "complete"
    STOPPED = "stopped"
    NO_CONSENT = "no consent"


class _StepLeft(Exception):  # noqa: N818 - not an error, but a signal that ends a form
    """Raised inside a form when the experimenter skips or stops it."""


@dataclass
class SessionRunner:
    """Runs a session.

    Attributes:
        session: The open session.
        player: Runs the trials.
        open_devices: See `OpenDevices`.
        forms: Shows texts and questions to the participant.
        controls: Commands of the experimenter.
        say: Prints a line for the experimenter.
        device: The device of the first hand, for recordings.
        fit: See `FitSettings`.
        calibrate: See `Calibrate`.
        tables: Tables of the study that have been read before; None reads all journals.
        second_device: The second hand's device, for recordings of trials with two hands.
        witness: File to which the digests of journals are appended at the end; None writes none.
    """

    session: SessionFolder
    player: TrialPlayer
    open_devices: OpenDevices
    forms: Forms
    controls: Controls
    say: Callable[[str], object]
    device: DeviceSettings = field(default_factory=DeviceSettings)
    fit: FitSettings = lambda trial, settings, poll: settings
    calibrate: Calibrate = lambda poll: None
    tables: StudyTables | None = None
    second_device: DeviceSettings = field(default_factory=DeviceSettings)
    witness: Path | None = None

    def __post_init__(self) -> None:
        self._leave_key = self._leave_reason = ""
        self._step: Step | None = None
        # A session that goes on after a crash may begin with a trial to exclude.
        self._last = self.session.state.last_finished(self.session.steps)
        self._study_tables = self.tables or StudyTables(self.session.study, self.say)

    def run(self) -> SessionOutcome:
        """Runs the session from the first unfinished step until its end, or until it is stopped.

        Raises:
            StudyError: The journal or a recording cannot be written; earlier data are safe.
        """
        self._update_tables()
        disk_is_writable = True
        try:
            return self._run_steps()
        except StudyError:
            # The tables are built again when the session is opened.
            disk_is_writable = False
            raise
        finally:
            if disk_is_writable:
                self._update_tables(seal=True)

    def _run_steps(self) -> SessionOutcome:
        """Runs the remaining steps of the plan."""
        session = self.session
        while (step := session.state.next_step(session.steps)) is not None:
            self._step, self._leave_key = step, ""
            self._take_commands()
            self._wait_while_paused()
            if self._leave_key == "s":
                session.write("skip", step=step.id, reason=self._leave_reason)
                self._say_left(step)
            elif not self._leave_key:
                self._run_step(step)
            if self._leave_key == "q":
                return SessionOutcome.STOPPED
            if session.state.consent is False:
                why = SessionOutcome.NO_CONSENT.value
                session.write("session_end", durable=True, complete=False, why=why)
                # The next participant gets the same orders.
                session.study.release(session.person.ppid, why)
                return SessionOutcome.NO_CONSENT
        if not session.state.complete:
            session.write("session_end", durable=True, complete=True)
        return SessionOutcome.COMPLETE

    def _run_step(self, step: Step) -> None:
        if isinstance(step, TrialStep):
            self._run_trial(step)
            return
        language, session = self.session.person.language, self.session
        design = session.study.design
        self._announce(step)
        try:
            match step:
                case ConsentStep():
                    text = consent_text(design, language)
                    agreed = self.forms.consent(text, self._poll_form)
                    read = blake2b(text.encode(), digest_size=16)
                    session.write(
                        "consent",
                        durable=True,
                        step=step.id,
                        agreed=agreed,
                        version=design.consent_version,
                        language=language,
                        text=read.hexdigest(),
                    )
                case InstructionStep():
                    self.forms.instruct(step.instruction.text[language], self._poll_form)
                    session.write("step_done", step=step.id)
                case CalibrationStep():
                    calibration = self.calibrate(self._poll_form)
                    session.write(
                        "calibration",
                        durable=True,
                        step=step.id,
                        hand=session.person.hand,
                        calibration=calibration,
                    )
                case FormStep():
                    began = time.monotonic()
                    draft = Draft(
                        still_allowed(step.form.items, session.state.drafts.get(step.id, {})),
                        lambda item, answer: session.write(
                            "draft", step=step.id, item=item, answer=answer
                        ),
                        step.id,
                    )
                    answers = self.forms.ask(step.form, language, self._poll_form, draft)
                    session.write(
                        "answers",
                        durable=True,
                        step=step.id,
                        form=step.form.name,
                        block=step.block,
                        levels=step.levels,
                        answers=answers,
                        seconds=round(time.monotonic() - began, 3),
                    )
                case BreakStep():
                    self.forms.rest(step.least, self._poll_form)
                    session.write("step_done", step=step.id)
        except _StepLeft:
            self._say_left(step)

    def _run_trial(self, trial: TrialStep) -> None:
        session, person = self.session, self.session.person
        settings = run_settings(
            trial.values, trial.seed, person.hand, person.hand_size, session.study.settings
        )
        settings = _calibrated(settings, person.hand, session.state.calibration)
        try:
            settings = self.fit(trial, settings, self._poll_form)
        except _StepLeft:
            self._say_left(trial)
            return
        learns = self._learning_hands(trial, settings)
        known = session.state.learned
        settings = settings.with_layouts({name: known[name] for name in learns if name in known})
        settings = self._with_devices(trial, settings)
        done, of = session.state.done(session.steps)
        levels = ", ".join(trial.levels.values())
        kind = "  practice" if trial.practice else ""
        self.say(f"{person.ppid}  trial {done + 1} of {of}  {levels}{kind}")
        record = session.begin(trial)
        start = session.state.attempts[trial.number][-1].start
        about = {
            "study": {
                "experiment": session.study.design.name,
                "mode": session.study.mode,
                "ppid": person.ppid,
                "session": session.number,
                "trial": trial.number,
                "attempt": start["attempt"],
                "practice": trial.practice,
                "levels": trial.levels,
            },
        }
        try:
            played = self.player.play(
                TrialRequest(
                    settings,
                    self.open_devices(trial, settings),
                    record,
                    about,
                    session.study.design.time_limit,
                    self._poll_trial,
                    lambda: self.controls.paused,
                    learns,
                )
            )
        except InputError as error:
            self._break_off(trial, str(error))
            raise
        except KeyboardInterrupt:
            self._break_off(trial, "interrupted")
            raise
        self._commit(trial, played)

    def _learning_hands(self, trial: TrialStep, settings: Settings) -> tuple[str, ...]:
        """Names of the participant's hands if the design lets a session learn their layouts."""
        if self.session.study.design.learning != "session":
            return ()
        if self._has_partner(trial):
            return settings.hand_names[:1]
        return settings.hand_names

    def _has_partner(self, trial: TrialStep) -> bool:
        """True if a simulated user moves the second hand."""
        asked = (trial.values.get("second_device"), self.second_device.name)
        return self.session.person.user is not None or PARTNER in asked

    def _with_devices(self, trial: TrialStep, settings: Settings) -> Settings:
        """The settings with the devices of the session, for the recording."""
        person = self.session.person
        device, second = self.device, self.second_device
        if person.user is not None:
            device = second = DeviceSettings(PARTNER, SimulatedOptions(simulated_user(person)))
        elif self._has_partner(trial):
            second = DeviceSettings()
        both = len(settings.hands) > 1
        return replace(settings, device=device, second_device=second if both else None)

    def _commit(self, trial: TrialStep, played: PlayedAttempt) -> None:
        session = self.session
        if played.broken:
            session.break_off(trial, played.broken)
            if self._leave_key == "s":
                session.write("skip", step=trial.id, trial=trial.number, reason=played.broken)
            self._say_left(trial, "" if self._leave_key else played.broken)
            return
        session.finish(trial, played.result)
        self._last = trial
        self.say(f"  {_trial_summary(played.result)}")
        file = session.state.attempts[trial.number][-1].start["file"]
        stem = file.removeprefix("trials/").removesuffix(".jsonl")
        try:
            for notice in played.table.write(session.path / "trackers", stem, played.result):
                self.say(f"  {notice}")
            session.note_tables(session.state.attempts[trial.number][-1])
            session.pack(file)
            rebuild_session(session, say=self.say)
        except StudyError as error:
            # Journal and recording contain the trial; the tables are built from them later.
            self.say(str(error))

    def _break_off(self, trial: TrialStep, why: str) -> None:
        """Records that an attempt was broken off; if that fails, the next opening does it."""
        try:
            self.session.break_off(trial, why)
        except StudyError as error:
            self.say(str(error))

    def _update_tables(self, seal: bool = False) -> None:
        """Builds the tables of the session and the study, and missing tables of trials.

        Args:
            seal: True records the journal's end in the journal of the study before.
        """
        bring_up_to_date(self.session, self._study_tables, self.say, seal, self.witness)

    def _announce(self, step: Step) -> None:
        """Says which step begins."""
        self.say(f"{self.session.person.ppid}  {_called(step)}")

    def _say_left(self, step: Step, why: str = "") -> None:
        """Says what became of a step that was left, and why if it was not the experimenter."""
        done = {"s": "skipped", "q": "left"}.get(self._leave_key, "begins again")
        self.say(f"  {_called(step)}: {done}" + (f", as {why}" if why else ""))

    def _poll_trial(self) -> str:
        """Implements `Watch` for players."""
        self._take_commands()
        return self._leave_reason if self._leave_key else ""

    def _poll_form(self) -> None:
        """Implements `Poll` for forms."""
        self._take_commands()
        if self._leave_key:
            if self._leave_key == "s" and self._step is not None:
                self.session.write("skip", step=self._step.id, reason=self._leave_reason)
            raise _StepLeft

    def _wait_while_paused(self) -> None:
        while self.controls.paused and not self._leave_key:
            time.sleep(TICK)
            self._take_commands()

    def _take_commands(self) -> None:
        for command in self.controls.take():
            self._execute(command)

    def _execute(self, command: Command) -> None:
        session, words = self.session, command.words
        running = self._step if isinstance(self._step, TrialStep) else None
        began = running is not None and running.number in session.state.attempts
        trial = running if began else self._last
        match command.key:
            case "p":
                self.controls.paused = not self.controls.paused
                session.write("pause" if self.controls.paused else "go_on")
                self.say("paused; p continues" if self.controls.paused else "continuing")
            case "i":
                self.say(self._progress_text())
            case "n":
                session.write("note", text=words, trial=trial.number if trial else None)
                self.say("noted")
            case "X":
                session.write("exclude", durable=True, trial=None, reason=words)
                session.study.release(session.person.ppid, words)
                self.say("the participant is excluded; nothing is deleted")
            case "x" if trial is not None:
                session.write("exclude", durable=True, trial=trial.number, reason=words)
                self.say(f"trial {trial.number} is excluded; nothing is deleted")
            case "r" if began and running is not None and self._under_way(running):
                self._leave_key, self._leave_reason = "r", words or "repeated"
            case "r" if self._last is not None:
                session.write(
                    "repeat",
                    durable=True,
                    step=self._last.id,
                    trial=self._last.number,
                    reason=words,
                )
                self._leave_key, self._leave_reason = "r", words or "repeated"
                self.say(f"trial {self._last.number} is repeated")
            case "s" if isinstance(self._step, ConsentStep):
                self.say("consent is not skipped: the participant agrees or does not; q stops")
            case "s" | "q":
                self._leave_key, self._leave_reason = (
                    command.key,
                    words or "the experimenter's wish",
                )
            case _:
                self.say("no trial has been run yet")

    def _progress_text(self) -> str:
        """Progress of the session."""
        done, of = self.session.state.done(self.session.steps)
        left = [s for s in self.session.steps if s.id not in self.session.state.finished]
        now = _called(self._step) if self._step else "the beginning"
        pause = ", paused" if self.controls.paused else ""
        return (
            f"{self.session.person.ppid}: {done} of {counted(of, 'trial')}, at {now}{pause}; "
            f"{counted(len(left), 'step')} left, including this one"
        )

    def _under_way(self, trial: TrialStep) -> bool:
        attempt = self.session.state.attempts[trial.number][-1]
        return attempt.end is None and self.session.journal.records[-1]["kind"] != "trial_broken"


def _calibrated(settings: Settings, side: str, calibration: dict[str, Any] | None) -> Settings:
    """Adds the calibration of the participant's hand to settings of a trial in the air."""
    if calibration is None:
        return settings
    hands = tuple(
        replace(hand, in_air=replace(hand.in_air, calibration=calibration))
        if hand.in_air is not None and hand.side == side
        else hand
        for hand in settings.hands
    )
    return replace(settings, hands=hands)


def _called(step: Step) -> str:
    """Name of a step for the experimenter."""
    match step:
        case TrialStep():
            return f"trial {step.number}"
        case FormStep():
            return f"form {step.form.name}"
        case BreakStep():
            return f"break of {step.least:g} s or longer"
        case InstructionStep():
            return "instructions"
        case CalibrationStep():
            return "measuring the hand"
        case _:
            return "consent"


def _trial_summary(result: TrialResult) -> str:
    """Result of a trial as a line for the experimenter."""
    away = (result.measures or {}).get("away_s")
    gone = f"; no connection to the page for {away:.1f} s" if away else ""
    return f"{result.status}, {result.time_s:.1f} s{gone}"
