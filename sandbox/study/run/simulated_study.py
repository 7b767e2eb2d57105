"""Runs whole studies with simulated participants of different skill and hand size."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any, cast

import numpy as np

from models.errors import DifferentPlanError, StudyError
from models.surface import Surface
from sandbox.devices.device import Device, Sees
from sandbox.devices.simulated import NEXT_PERSON
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.devices.wrappers.degraded import DegradedDevice
from sandbox.study.design.conditions import uses_camera
from sandbox.study.design.design import Design
from sandbox.study.design.session_plan import TrialStep
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import has_finished
from sandbox.study.run.controls import Controls
from sandbox.study.run.forms import SimulatedForms
from sandbox.study.run.players import HeadlessPlayer
from sandbox.study.run.runner import OpenDevices, SessionOutcome, SessionRunner
from sandbox.study.tables.tables import bring_up_to_date, make_tables
from sandbox.trial.assembly import DeviceMaker, DeviceMakers, home, shared_by_users
from sandbox.trial.settings import Settings
from tasks.task import Task
from tasks.user import UserConfiguration

HAND_SPREAD = 0.07
"""Standard deviation of hand lengths over people, relative to the mean; about the value for adults
of both sexes together."""
LEFT = 0.1
"""Share of left-handed people."""

_STREAM = 7_106
DAYS = 16
"""Number of bits by which the session's number, from 0, is shifted before XOR with a seed."""


def simulated_person(design: Design, number: int) -> dict[str, Any]:
    """Draws a simulated participant: side and size of the hand, language, and the configuration of
    the simulated user.

    Skill is from 0 to 1. A person of skill 0.5 has the reaction, speed and noise of the simulated
    user of regression runs.

    Args:
        design: Design of the study, whose seed is used.
        number: Number of the participant, from 1.
    """
    rng = np.random.default_rng([design.seed, number - 1, _STREAM])
    skill = float(rng.beta(3.0, 3.0))
    size = float(np.clip(rng.normal(1.0, HAND_SPREAD), 0.8, 1.2))
    plain = UserConfiguration()
    slow = 2.0 ** (1.0 - 2.0 * skill)
    user = replace(
        plain,
        fingers=int(rng.integers(2, 4)),
        reaction=(round(plain.reaction[0] * slow, 4), round(plain.reaction[1] * slow, 4)),
        peak_speed=round(plain.peak_speed / slow, 4),
        movement_base=round(plain.movement_base * slow, 4),
        movement_slope=round(plain.movement_slope * slow, 4),
        end_noise=round(plain.end_noise * slow, 4),
        aim_error=round(plain.aim_error * slow**0.5, 5),
    )
    configuration = {**asdict(user), "reaction": list(user.reaction), "skill": round(skill, 4)}
    return {
        "hand": "left" if rng.uniform() < LEFT else "right",
        "hand_size": round(size, 4),
        "language": design.languages[(number - 1) % len(design.languages)],
        "user": configuration,
    }


def simulated_devices(person: Participant) -> OpenDevices:
    """Returns a function that opens the devices of a simulated participant."""
    user = person.simulated_user

    def of_trial(trial: TrialStep, settings: Settings) -> DeviceMakers:
        # The seed differs from that of the task, between participants, and between sessions.
        seed = trial.seed ^ person.number ^ ((trial.session - 1) << DAYS)
        makers = tuple(
            simulated_hand(user, settings, hand, seed) for hand in range(len(settings.hands))
        )
        both_in_air = len(makers) > 1 and settings.in_air
        return shared_by_users(makers, settings, Sees.LEAP) if both_in_air else makers

    return of_trial


def simulated_hand(
    user: UserConfiguration, settings: Settings, hand: int, seed: int
) -> DeviceMaker:
    """Returns a function that opens the device of one simulated hand.

    Args:
        user: Configuration of the simulated user.
        settings: Settings of the trial.
        hand: Index of the hand.
        seed: Seed of the user, the same for all hands of a trial.
    """
    whose = settings.hands[hand]

    def make(task: Task, surface: Surface) -> Device:
        if whose.in_air is not None:
            # Imported here, since it imports some 35 modules and most studies do not need it.
            from sandbox.devices.simulated.in_air import SimulatedLeap

            leap = SimulatedLeap(task, user, seed, whose.in_air.at, person=whose.person, hand=hand)
            return cast(Device, leap)
        device = SimulatedDevice(
            task,
            user,
            surface,
            seed,
            settings.pipeline.labels == "device",
            person=whose.person,
            hand=hand,
            home=home(hand, settings, surface),
        )
        if settings.variation.degrades_touches:
            return DegradedDevice(device, settings.variation, surface, seed + hand * NEXT_PERSON)
        return device

    return make


def run_simulated(
    study: StudyFolder,
    number: int,
    say: Callable[[str], object],
    controls: Controls | None = None,
    tables: bool = True,
) -> SessionOutcome:
    """Runs the remaining sessions of a participant, until one is not completed.

    Args:
        study: The study.
        number: Number of the participant, from 1.
        say: Prints a line.
        controls: Commands of the experimenter; None for no commands.
        tables: False if the caller makes the tables.
    """
    person = study.add(number, **simulated_person(study.design, number))
    outcome = SessionOutcome.COMPLETE
    for n in range(1, study.design.sessions + 1):
        with SessionFolder(study, person, n) as session:
            if session.state.complete:
                # It stays complete, even if the design has changed and now has more steps.
                bring_up_to_date(session, say, tables)
                continue
            seed = study.design.seed % 2**31 + number - 1
            forms = SimulatedForms(seed ^ ((n - 1) << DAYS))
            outcome = SessionRunner(
                session,
                HeadlessPlayer(),
                simulated_devices(person),
                forms,
                controls or Controls(say),
                say,
                makes_tables=tables,
            ).run()
        if outcome is not SessionOutcome.COMPLETE:
            break
    return outcome


def simulate(
    study: StudyFolder, participants: int, resume: bool, say: Callable[[str], object]
) -> dict[str, int]:
    """Runs a study with a number of simulated participants, one after another.

    Args:
        study: The study.
        participants: Number of participants.
        resume: True continues with the participants who have begun.
        say: Prints a line.

    Returns:
        See `make_tables`.

    Raises:
        StudyError: The study has participants already, and `resume` is False; or the design has
            trials with a webcam.
    """
    if study.participants() and not resume:
        raise StudyError(
            "the study already has simulated participants",
            where=str(study.path),
            remedy="Continue with them by --resume, or choose another folder with --out",
        )
    if uses_camera(study.design):
        raise StudyError(
            "simulated participants have no camera",
            where='device = "webcam"',
            got=study.design.name,
            remedy='Simulate a copy of the design with device = "leap" or "touch"',
        )
    people = study.participants()
    finished = {p.number for p in people if has_finished(study, p)}
    everybody = range(1, participants + 1)
    for number in everybody:
        try:
            outcome: str = run_simulated(study, number, say, tables=False)
        except DifferentPlanError as error:
            outcome = f"left as it is: {error}"
        already = " already" if number in finished else ""
        say(f"participant {number} of {participants}: {outcome}{already}")
    if finished >= set(everybody):
        say(
            "all participants had finished before, so nothing was played. For the results: "
            f"{shlex.join(['sandbox', 'study', 'report', str(study.path)])}. "
            f"For more participants: --participants {len(finished) + 1} or more"
        )
    return make_tables(study, say)
