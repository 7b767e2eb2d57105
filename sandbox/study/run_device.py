"""Devices of people in a study."""

from __future__ import annotations

from models.surface import Surface
from sandbox.assembly import DeviceMaker
from sandbox.devices.device import Device
from sandbox.devices.lift_keys import with_lift
from sandbox.devices.spoiled import SpoiledDevice
from sandbox.devices.tuio import TuioDevice
from sandbox.settings import RunSettings
from sandbox.study.folder import Participant
from sandbox.study.plan import TrialStep
from sandbox.study.runner import MakeDevice
from sandbox.study.simulate import simulated_device
from tasks.task import Task


def person_device(name: str, person: Participant, bind: str, port: int) -> MakeDevice:
    """How the device of every trial is opened.

    Args:
        name: `mouse`, `tuio` or `simulated`.
        person: Who touches.
        bind, port: Where TUIO is expected.
    """
    if name == "simulated":
        return simulated_device(person)

    def of_trial(trial: TrialStep, settings: RunSettings) -> DeviceMaker:
        def make(task: Task, surface: Surface) -> Device:
            device: Device
            if name == "tuio":
                device = TuioDevice(surface, bind=bind, port=port)
            else:
                from sandbox.devices.mouse import MouseDevice

                device = MouseDevice(surface, settings.person)
            if settings.variation.spoils:
                return SpoiledDevice(device, settings.variation, surface, trial.seed)
            return device

        return with_lift(make, keys=name == "mouse")

    return of_trial
