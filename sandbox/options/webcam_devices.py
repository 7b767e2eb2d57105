"""Options for hands before a webcam, and how a camera or a recording of one is opened."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import atan, degrees
from pathlib import Path
from typing import Annotated, Any, cast

import tyro

from encoders.webcam.camera import Camera
from models.errors import InputError
from models.surface import Surface
from sandbox.devices.registry import built_in
from sandbox.devices.webcam.installed import installed_engine
from sandbox.devices.webcam.landmark_file import (
    LandmarkFileDevice,
    is_landmark_file,
    read_landmarks,
)
from sandbox.devices.webcam.shared_camera import SharedCamera
from sandbox.devices.webcam.webcam import WebcamDevice
from sandbox.session.device import Device
from sandbox.trial.device_makers import DeviceMakers
from sandbox.trial.hand_input import HandInput
from sandbox.trial.settings import RunSettings
from tasks.task import Task

LIVE = "webcam"
_NUMBERS = {"fov": "view", "tilt": "tilt", "roll": "roll", "pan": "pan"}
"""Key of an option -> field of the camera."""
_WORDS = ("mirrored", "quiet")
_FORM = "fov=60 or sees=0.58/0.5,at=0/0.45/0.1,tilt=0,roll=0,pan=0,mirrored,quiet"


@dataclass(frozen=True)
class WebcamOptions:
    """Options for hands before a webcam."""

    webcam: Annotated[str, tyro.conf.arg(metavar="KEY=VALUE,...")] = ""
    """The camera of --device webcam, by any of: fov=DEGREES across its picture, which with your
    hand's size gives its distance (default 60), or sees=ACROSS/AWAY, how many m of a ruler it sees
    from edge to edge, and how far away the ruler is held; at=X/Y/Z, where the camera is, m from the
    centre of the table top: right, away, up (default 0/0.45/0.1, facing you); tilt=DEGREES down;
    pan=DEGREES and roll=DEGREES; mirrored, if its picture is a mirror's; quiet, to open no
    browser."""


@dataclass(frozen=True)
class WebcamChoice:
    """Value of `--webcam`.

    Attributes:
        camera: The camera.
        mirrored: Its picture is a mirror's.
        quiet: The page's link is told, and no browser opened.
    """

    camera: Camera
    mirrored: bool = False
    quiet: bool = False


def is_webcam(device: str) -> bool:
    """True if a device is a camera or a recording of landmarks."""
    if built_in(device) is not None:
        return device == LIVE
    path = Path(device)
    return path.is_file() and is_landmark_file(path)


def both_before_one_camera(options: Any) -> bool:
    """True if two hands, should there be two, are before the same camera."""
    return is_webcam(options.device) and options.second_device in (None, options.device)


def webcam_choice(text: str, camera: Camera | None = None) -> WebcamChoice:
    """Reads `--webcam`.

    Args:
        text: The option's value.
        camera: Camera whose values hold where the text says nothing; None is the default one.

    Raises:
        InputError: A part of it is unknown or impossible.
    """
    values: dict[str, Any] = {}
    words: dict[str, bool] = {}
    for part in filter(None, text.split(",")):
        key, equals, value = part.partition("=")
        if key in _WORDS and not equals:
            words[key] = True
            continue
        try:
            if key == "at":
                x, y, z = map(float, value.split("/"))
                values["at"] = (x, y, z)
            elif key == "sees":
                across, away = map(float, value.split("/"))
                values["view"] = degrees(2.0 * atan(0.5 * across / away))
            else:
                values[_NUMBERS[key]] = float(value)
        except (KeyError, ValueError, ZeroDivisionError):
            raise InputError(
                "not a setting of the camera", where="--webcam", got=part, expected=_FORM
            ) from None
    return WebcamChoice(replace(camera or Camera(), **values), **words)


def with_webcam_hands(settings: RunSettings, options: Any) -> RunSettings:
    """Returns settings with the camera of the hands that are before one.

    Args:
        settings: Settings with all hands.
        options: `WebcamOptions` with `device` and `second_device`.

    Raises:
        InputError: The camera is impossible, or both hands are of one side.
    """
    first, *others = settings.hands
    if is_webcam(options.device):
        if settings.variation.degrades_touches:
            raise InputError("touches can be degraded, hands in the air cannot", where="--vary")
        first = replace(first, in_air=_hand_input(options, options.device))
    if others:
        second, other = others[0], options.second_device or options.device
        if is_webcam(other):
            others = [replace(second, in_air=_hand_input(options, other))]
            settings = replace(settings, one_surface=False)
        if both_before_one_camera(options) and first.side == second.side:
            raise InputError(
                "two hands before one camera must be a right and a left hand",
                where="--hand",
                got=f"two {second.side} hands",
            )
    return replace(settings, hands=(first, *others))


def webcam_maker(
    options: Any, settings: RunSettings, hand: int
) -> Callable[[Task, Surface], Device]:
    """Returns a function that opens the camera, or a recording of one.

    Raises:
        InputError: The engine is not installed, or the file cannot be read.
    """
    if options.device != LIVE:
        recording = read_landmarks(Path(options.device))
        return lambda task, surface: cast(Device, LandmarkFileDevice(recording))
    engine = installed_engine()
    choice = webcam_choice(options.webcam)
    sides = [h.side for h in settings.hands]
    sides = sides if both_before_one_camera(options) else [sides[hand]]

    def make(task: Task, surface: Surface) -> Device:
        device = WebcamDevice(engine, sides, choice.mirrored)
        if not choice.quiet:
            webbrowser.open(device.address)
        return cast(Device, device)

    return make


def sharing_camera(make: Callable[[Task, Surface], Device]) -> DeviceMakers:
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


def _hand_input(options: Any, device: str) -> HandInput:
    recorded = None if device == LIVE else read_landmarks(Path(device)).camera
    return HandInput(camera=webcam_choice(options.webcam, recorded).camera)
