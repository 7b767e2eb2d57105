"""Opens a webcam, or a recording of landmarks."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Any, cast

from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.kinds import LIVE_WEBCAM
from sandbox.devices.webcam.installed import installed_engine
from sandbox.devices.webcam.landmark_file import (
    LandmarkFileDevice,
    read_landmarks,
)
from sandbox.devices.webcam.shared_camera import SharedCamera
from sandbox.devices.webcam.webcam import WebcamDevice
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from sandbox.trial.settings import Settings
from tasks.task import Task


def webcam_maker(settings: Settings, hand: int) -> DeviceMaker:
    """Returns a function that opens the camera of one hand, or a recording of one.

    Args:
        settings: Settings of the run.
        hand: Index of the hand in `settings.hands`.

    Raises:
        InputError: The engine is not installed, or the file cannot be read.
    """
    chosen = settings.device_of(hand)
    if chosen.name != LIVE_WEBCAM:
        recording = read_landmarks(Path(chosen.name))
        return lambda task, surface: cast(Device, LandmarkFileDevice(recording))
    engine = installed_engine()
    sides = [h.side for h in settings.hands]
    sides = sides if settings.one_device else [sides[hand]]

    def make(task: Task, surface: Surface) -> Device:
        device = WebcamDevice(engine, sides, chosen.options.mirrored)
        if not chosen.options.quiet:
            webbrowser.open(device.address)
        return cast(Device, device)

    return make


def sharing_camera(make: DeviceMaker) -> DeviceMakers:
    """Returns makers of two devices that share one camera.

    Args:
        make: Opens the camera.
    """
    parts: list[Device] = []

    def first(task: Task, surface: Surface) -> Device:
        camera: Any = make(task, surface)
        parts[:] = [cast(Device, part) for part in SharedCamera(camera).parts]
        return parts[0]

    def second(task: Task, surface: Surface) -> Device:
        return parts[1]

    return first, second
