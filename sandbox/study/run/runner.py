"""Runs the steps of a session, with a real or a simulated participant."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

from models.errors import InputError, StudyError
from models.message import counted
from sandbox.devices.registry import DeviceSettings
from sandbox.devices.simulated import SimulatedOptions
from sandbox.study.design.conditions import PARTNER, consent_text, run_settings
from sandbox.study.design.session_plan import (
    BreakStep,
    CalibrationStep,
    ConsentStep,
    FormStep,
    InstructionStep,
    Step,
    TrialStep,
    trials_of,
)
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.run.answers import Draft, still_allowed
from sandbox.study.run.controls import Command, Controls
from sandbox.study.run.forms import Forms, NewTask, Poll, texts_by_design
from sandbox.study.run.players import PlayedAttempt, TrialPlayer, TrialRequest
from sandbox.study.tables.frame_table import FrameWriter
from sandbox.study.tables.tables import bring_up_to_date
from sandbox.trial.assembly import DeviceMakers
from sandbox.trial.driver import TICK
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from sandbox.words import words_in

OpenDevices = Callable[[TrialStep, Settings], DeviceMakers]
"""Returns functions that open the devices of a trial, one for every hand."""
FitSettings = Callable[[TrialStep, Settings, Poll], Settings]
"""Adapts the settings of a trial to the participant's device; may wait for the device."""
Calibrate = Callable[[Poll], dict[str, Any] | None]
"""Measures the participant's hand over a Leap; returns None for an average hand."""


class SessionOutcome(StrEnum):
    """Result of running a session."""

    COMPLETE = "complete"
    STOPPED = "stopped"
    NO_CONSENT = "no consent"


SCREENS = Step("screens")
"""Measuring of the pages' screens by the experimenter, before a step of the plan. It can be skipped
like a step."""


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
        makes_tables: False if the caller makes the tables of the study.
        second_device: The device of the second hand, for recordings of trials with two hands.
        before_step: Called before every step, with a `Poll` that it must call while it waits.
        picture_of: Returns the picture of a task as a data URL; empty for none. It calls its `Poll`
            while it waits.
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
    makes_tables: bool = True
    second_device: DeviceSettings = field(default_factory=DeviceSettings)
    before_step: Callable[[Poll], None] = lambda poll: None
    picture_of: Callable[[str, Poll], str] = lambda task, poll: ""

    def __post_init__(self) -> None:
        self._leave_key = self._leave_reason = ""
        self._step: Step | None = None
        self._introduced = "", False
        # In a resumed session, the experimenter may exclude the last trial before the interruption.
        self._last = self.session.state.last_finished(self.session.steps)
        self._frames = FrameWriter()

    def run(self) -> SessionOutcome:
        """Runs the session from the first unfinished step until its end, or until it is stopped.

        Raises:
            StudyError: The journal or a recording cannot be written; earlier data are safe.
        """
        disk_is_writable = True
        try:
            return self._run_steps()
        except StudyError:
            # Files that are missing now are written when the session is opened again.
            disk_is_writable = False
            raise
        finally:
            for line in self._frames.finish():
                self.say(line)
            if disk_is_writable:
                bring_up_to_date(self.session, self.say, self.makes_tables)

    def _run_steps(self) -> SessionOutcome:
        """Runs the remaining steps of the plan."""
        session = self.session
        while (step := session.state.next_step(session.steps)) is not None:
            self._step, self._leave_key = SCREENS, ""
            try:
                self.before_step(self._poll_form)
            except _StepLeft:
                self._say_left(SCREENS)
            self._step, self._leave_key = step, self._leave_key.replace("s", "")
            self._take_commands()
            self._wait_while_paused()
            if self._leave_key == "s":
                session.command("skip", step=step.id, reason=self._leave_reason)
                self._say_left(step)
            elif not self._leave_key:
                self._run_step(step)
            if self._leave_key == "q":
                return SessionOutcome.STOPPED
            if session.state.consent is False:
                why = SessionOutcome.NO_CONSENT.value
                session.write("end", durable=True, complete=False, why=why)
                # The number is free again, so the next participant gets its orders.
                session.study.release(session.person.ppid, why)
                return SessionOutcome.NO_CONSENT
        if not session.state.complete:
            session.write("end", durable=True, complete=True)
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
                    session.write(
                        "consent",
                        durable=True,
                        step=step.id,
                        agreed=agreed,
                        version=design.consent_version,
                        language=language,
                        text=text,
                    )
                case InstructionStep():
                    self.forms.instruct(step.instruction.text[language], self._poll_form)
                    session.write("done", step=step.id)
                case CalibrationStep():
                    calibration = self.calibrate(self._poll_form)
                    session.write(
                        "done",
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
                            "answer", durable=True, step=step.id, item=item, answer=answer
                        ),
                        step.id,
                    )
                    answers = self.forms.ask(step.form, language, self._poll_form, draft)
                    session.write(
                        "form",
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
                    session.write("done", step=step.id)
        except _StepLeft:
            self._say_left(step)

    def _run_trial(self, trial: TrialStep) -> None:
        session, person = self.session, self.session.person
        settings = run_settings(
            trial.values, trial.seed, person.hand, person.hand_size, session.study.settings
        )
        settings = _calibrated(settings, person.hand, session.state.calibration)
        try:
            self._introduce(settings.task, trial.practice)
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
            }
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
                    self._is_first(trial),
                )
            )
        except InputError as error:
            self._break_off(trial, str(error))
            raise
        except KeyboardInterrupt:
            self._break_off(trial, "interrupted")
            raise
        self._commit(trial, played)

    def _is_first(self, trial: TrialStep) -> bool:
        """True if no other trial of the same task has begun in this session."""
        attempts = self.session.state.attempts
        return not any(
            other.number in attempts and other.values.get("task") == trial.values.get("task")
            for other in trials_of(self.session.steps)
            if other.number != trial.number
        )

    def _introduce(self, task: str, practice: bool) -> None:
        """Shows the goal if the task is new, or if practice of the task begins or ends."""
        if (task, practice) == self._introduced:
            return
        session = self.session
        page, language = session.study.design.page, session.person.language
        words = words_in(language, page.words.get(language))
        title, goal = texts_by_design(page, task, language, words)
        if title or goal:
            done, of = session.state.done(session.steps)
            picture = self.picture_of(task, self._poll_form)
            self.forms.introduce(
                NewTask(done + 1, of, title, goal, practice, picture), self._poll_form
            )
        self._introduced = task, practice

    def _learning_hands(self, trial: TrialStep, settings: Settings) -> tuple[str, ...]:
        """Names of the participant's hands whose layouts are learned; empty if the design does not
        let a session learn layouts."""
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
        """The settings with the session's devices, which the recording then names."""
        person = self.session.person
        device, second = self.device, self.second_device
        if person.user is not None:
            device = second = DeviceSettings(PARTNER, SimulatedOptions(person.simulated_user))
        elif self._has_partner(trial):
            second = DeviceSettings()
        both = len(settings.hands) > 1
        return replace(settings, device=device, second_device=second if both else None)

    def _commit(self, trial: TrialStep, played: PlayedAttempt) -> None:
        session = self.session
        if played.broken:
            session.break_off(trial, played.broken)
            if self._leave_key == "s":
                session.command("skip", step=trial.id, trial=trial.number, reason=played.broken)
            self._say_left(trial, "" if self._leave_key else played.broken)
            return
        session.finish(trial, played.result)
        self._last = trial
        # Whoever notes this hash on paper can prove later that no record up to here is missing.
        self.say(f"  {_trial_summary(played.result)}; hash {session.journal.head[:12]}")
        file = session.state.attempts[trial.number][-1].start["file"]
        # The frames are written in the background while the participant continues.
        self._frames.write(played.table, session.path / file)

    def _break_off(self, trial: TrialStep, why: str) -> None:
        """Records that an attempt was broken off.

        If the record cannot be written, it is written when the session is next opened.
        """
        try:
            self.session.break_off(trial, why)
        except StudyError as error:
            self.say(str(error))

    def _announce(self, step: Step) -> None:
        """Prints that a step begins."""
        self.say(f"{self.session.person.ppid}  {_called(step)}")

    def _say_left(self, step: Step, why: str = "") -> None:
        """Prints what happens to a step that was left, and the reason if it was not a command."""
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
                self.session.command("skip", step=self._step.id, reason=self._leave_reason)
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
                session.command("pause" if self.controls.paused else "go_on")
                self.say("paused; p continues" if self.controls.paused else "continuing")
            case "i":
                self.say(self._progress_text())
            case "n":
                session.command("note", text=words, trial=trial.number if trial else None)
                self.say("noted")
            case "X":
                session.command("exclude", durable=True, trial=None, reason=words)
                session.study.release(session.person.ppid, words)
                self.say("the participant is excluded; nothing is deleted")
            case "x" if trial is not None:
                session.command("exclude", durable=True, trial=trial.number, reason=words)
                self.say(f"trial {trial.number} is excluded; nothing is deleted")
            case "r" if began and running is not None and self._under_way(running):
                self._leave_key, self._leave_reason = "r", words or "repeated"
            case "r" if self._last is not None:
                session.command(
                    "repeat",
                    durable=True,
                    step=self._last.id,
                    trial=self._last.number,
                    reason=words,
                )
                self._leave_key, self._leave_reason = "r", words or "repeated"
                self.say(f"trial {self._last.number} is repeated")
            case "s" if isinstance(self._step, ConsentStep):
                self.say(
                    "consent is not skipped: the participant must agree or decline; q stops the "
                    "session"
                )
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
        return not self.session.state.attempts[trial.number][-1].over


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
        case _ if step is SCREENS:
            return "measuring the screen"
        case _:
            return "consent"


def _trial_summary(result: TrialResult) -> str:
    """Result of a trial as a line for the experimenter."""
    away = (result.measures or {}).get("away_s")
    gone = f"; no connection to the page for {away:.1f} s" if away else ""
    return f"{result.status}, {result.time_s:.1f} s{gone}"
