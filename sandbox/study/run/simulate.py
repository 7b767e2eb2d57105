"""Simulated participants of different skill and hand size, who go through a whole study."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any, cast

import numpy as np

from models.errors import StudyError
from models.surface import Surface
from sandbox.devices.simulated.leap_user import SimulatedLeap
from sandbox.devices.simulated.simulated import NEXT_PERSON, SimulatedDevice
from sandbox.devices.wrappers.spoiled import SpoiledDevice
from sandbox.options.leap_devices import over_one
from sandbox.session.device import Device
from sandbox.study.design.design import Design
from sandbox.study.design.plan import TrialStep
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.run.controls import Controls
from sandbox.study.run.forms import SimulatedForms
from sandbox.study.run.players import HeadlessPlayer
from sandbox.study.run.runner import OpenDevices, SessionOutcome, SessionRunner
from sandbox.study.tables.tables import StudyTables
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from sandbox.trial.settings import RunSettings
from sandbox.trial.surfaces import home
from tasks.task import Task
from tasks.user import UserConfiguration

HAND_SPREAD = 0.07
"""Standard deviation of hand lengths over people against their mean: about that of adults of both
sexes together."""
LEFT = 0.1
"""Share of people whose left hand is the better one."""

_STREAM = 7_106
DAYS = 16
"""Bits of a seed below those that tell sessions apart."""


def simulated_person(design: Design, number: int) -> dict[str, Any]:
    """What a simulated participant is like: hand, its size, and a configuration of the user.

    Skill goes from 0 to 1; at 0.5 somebody is the simulated user that regression runs use.

    Args:
        design: Its seed decides.
        number: Of the participant.
    """
    rng = np.random.default_rng([design.seed, number, _STREAM])
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
    told = {**asdict(user), "reaction": list(user.reaction), "skill": round(skill, 4)}
    return {
        "hand": "left" if rng.uniform() < LEFT else "right",
        "hand_size": round(size, 4),
        "language": design.languages[number % len(design.languages)],
        "user": told,
    }


def simulated_devices(person: Participant) -> OpenDevices:
    """Opens the devices of a simulated participant, whose hands are of equal skill."""
    values = {k: v for k, v in (person.user or {}).items() if k != "skill"}
    user = UserConfiguration(**{**values, "reaction": tuple(values["reaction"])})

    def of_trial(trial: TrialStep, settings: RunSettings) -> DeviceMakers:
        # Another stream than the task's own: equal starts are met with other luck.
        # A later session is another day.
        seed = trial.seed ^ (person.number + 1) ^ ((trial.session - 1) << DAYS)
        makers = tuple(
            simulated_hand(user, settings, hand, seed) for hand in range(len(settings.hands))
        )
        both_in_air = len(makers) > 1 and settings.in_air
        return over_one(makers, makers[0], settings) if both_in_air else makers

    return of_trial


def simulated_hand(
    user: UserConfiguration, settings: RunSettings, hand: int, seed: int
) -> DeviceMaker:
    """Opens the device of one simulated hand.

    Args:
        user: Moves it.
        settings: Of the trial.
        hand: Index of the hand.
        seed: Of the user's chance, the same for all hands of a trial.
    """
    whose = settings.hands[hand]

    def make(task: Task, surface: Surface) -> Device:
        if whose.in_air is not None:
            leap = SimulatedLeap(task, user, seed, whose.in_air.at, person=whose.person, hand=hand)
            return cast(Device, leap)
        device = SimulatedDevice(
            task,
            user,
            surface,
            seed,
            settings.labels == "device",
            person=whose.person,
            hand=hand,
            home=home(hand, settings, surface),
        )
        if settings.variation.degrades_touches:
            return SpoiledDevice(device, settings.variation, surface, seed + hand * NEXT_PERSON)
        return device

    return make


def run_simulated(
    study: StudyFolder,
    number: int,
    say: Callable[[str], object],
    controls: Controls | None = None,
    tables: StudyTables | None = None,
) -> SessionOutcome:
    """All of a participant's sessions, or what is left of them, up to one that is not finished."""
    person = study.add(number, **simulated_person(study.design, number))
    outcome = SessionOutcome.COMPLETE
    for n in range(1, study.design.sessions + 1):
        with SessionFolder(study, person, n) as session:
            forms = SimulatedForms((study.design.seed % 2**31 + number) ^ ((n - 1) << DAYS))
            outcome = SessionRunner(
                session,
                HeadlessPlayer(),
                simulated_devices(person),
                forms,
                controls or Controls(say),
                say,
                tables=tables,
            ).run()
        if outcome is not SessionOutcome.COMPLETE:
            break
    return outcome


def simulate(
    study: StudyFolder, participants: int, resume: bool, say: Callable[[str], object]
) -> dict[str, int]:
    """Lets so many simulated participants go through a study, one after another.

    Returns:
        See `StudyTables.update`.

    Raises:
        StudyError: There are some already, and nobody said to go on with them.
    """
    if study.participants() and not resume:
        raise StudyError(
            "there are simulated participants already",
            where=str(study.path),
            remedy="--resume goes on with them; or use another --out",
        )
    tables = StudyTables(study, say)
    for number in range(participants):
        outcome = run_simulated(study, number, say, tables=tables)
        say(f"participant {number + 1} of {participants}: {outcome}")
    return tables.update()
