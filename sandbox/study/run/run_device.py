"""Devices of people in a study, and how large their surfaces are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import cast

from models.errors import StudyError
from models.surface import Surface
from sandbox.devices.leap.leap import DEFAULT_ADDRESS
from sandbox.devices.wrappers.spoiled import SpoiledDevice
from sandbox.options.leap_devices import open_leap
from sandbox.options.touch_devices import (
    TouchOptions,
    guesses_size,
    is_evdev,
    live_maker,
    native_surface,
)
from sandbox.session.device import Device
from sandbox.study.design.plan import TrialStep
from sandbox.study.record.folder import Participant
from sandbox.study.run.page_player import page_device, page_settings
from sandbox.study.run.runner import OpenDevices
from sandbox.study.run.simulate import simulated_devices
from sandbox.study.run.study_page import StudyPage
from sandbox.trial.device_makers import DeviceMakers
from sandbox.trial.lift import with_lift
from sandbox.trial.settings import RunSettings
from tasks.task import Task

SLACK = 0.02
"""Share by which a design's surface may differ from the touch screen's own."""


def person_devices(
    options: TouchOptions,
    person: Participant,
    page: StudyPage | None = None,
    leap: str = DEFAULT_ADDRESS,
) -> OpenDevices:
    """How the devices of every trial are opened.

    Args:
        options: Device `mouse`, `web`, `tuio`, `evdev`, `evdev:NODE` or `simulated`.
        person: Who touches, or moves a hand over a Leap in trials whose design says so.
        page: Of `web`.
        leap: Address of the Leap service.
    """
    name = options.device
    if name == "simulated":
        return simulated_devices(person)

    def of_trial(trial: TrialStep, settings: RunSettings) -> DeviceMakers:
        def make(task: Task, surface: Surface) -> Device:
            device: Device
            if settings.in_air:
                # What the design says counts: this trial is played over a Leap, and begins with the
                # scene, not with a touch of the page.
                if page is not None:
                    page.device = None
                return cast(Device, open_leap(leap))
            if page is not None and name == "web":
                device = page_device(page, surface)
            elif name == "mouse":
                from sandbox.devices.mouse import MouseDevice

                device = MouseDevice(surface, settings.hands[0].person)
            else:
                maker = live_maker(options)
                assert maker is not None, name
                device = maker(surface)
            if settings.variation.spoils:
                return SpoiledDevice(device, settings.variation, surface, trial.seed)
            return device

        return with_lift((make,), keys=name == "mouse")

    return of_trial


def fitting(
    name: str, page: StudyPage | None = None
) -> Callable[[TrialStep, RunSettings, Callable[[], None]], RunSettings]:
    """How a trial's settings are fitted to what the participant touches.

    What is returned may wait for the page, and raises a StudyError where the design's surface is
    not the device's.
    """

    def fit(trial: TrialStep, settings: RunSettings, ready: Callable[[], None]) -> RunSettings:
        designed = "surface" in trial.values
        if settings.in_air:
            return settings
        if page is not None and name == "web":
            page.await_somebody(ready)
            return page_settings(page, settings, designed)
        if is_evdev(name) and (native := native_surface(name)) is not None:
            own = native.width_in, native.height_in
            pairs = zip(own, settings.surface_in, strict=True)
            if designed and any(abs(a / b - 1.0) > SLACK for a, b in pairs):
                raise StudyError(
                    "the touch device is not as large as the design's surface",
                    where="surface",
                    got=f"{own[0]:.2f} x {own[1]:.2f} in",
                    expected="{:g} x {:g} in".format(*settings.surface_in),
                    remedy="Write the device's own size into the design, or leave it out",
                )
            return replace(settings, surface_in=own)
        if guesses_size(name):
            # Nobody tells sizes: without the design's, inches are a guess, and recordings say so.
            return settings if designed else replace(settings, surface_calibrated=False)
        return settings

    return fit
