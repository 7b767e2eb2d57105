"""A camera: a page in a browser on this machine finds hands in its pictures."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import atan, degrees
from pathlib import Path
from typing import Any

from encoders.air.camera import Camera
from models.errors import InputError
from sandbox.devices.device import (
    AnyDevice,
    DeviceEntry,
    DeviceKind,
    Place,
    PlayedOptions,
    Sees,
    Source,
    UnitOptions,
)
from sandbox.devices.hand_input import HandInput

_NUMBERS = {"fov": "view", "tilt": "tilt", "roll": "roll", "pan": "pan"}
"""Key of an option -> field of the camera."""
_WORDS = ("mirrored", "quiet")
_FORM = "fov=60 or sees=0.58/0.5,at=0/0.45/0.1,tilt=0,roll=0,pan=0,mirrored,quiet"


@dataclass(frozen=True)
class WebcamOptions:
    """How a camera's page is opened. The position of the camera is a setting of the hand."""

    mirrored: bool = False
    """The camera's picture is mirrored."""

    quiet: bool = False
    """Only print the page's address; open no browser."""


@dataclass(frozen=True, kw_only=True)
class BeforeCameraOptions:
    """Options of the camera, live or in a recording, that sees a hand."""

    webcam: str = field(default="", metadata={"metavar": "KEY=VALUE,..."})
    """Settings of the camera of --device webcam: fov=DEGREES, the horizontal field of view (default
    60), or sees=ACROSS/AWAY, the length of a ruler that fills the picture's width and its distance
    from the camera, in m. at=X/Y/Z: position of the camera in m from the centre of the table top:
    right, away, up (default 0/0.45/0.1, facing you). tilt=DEGREES down; pan=DEGREES; roll=DEGREES.
    mirrored: the camera's picture is mirrored. quiet: open no browser. The distance of the hand
    follows from the field of view and the hand's size."""

    @cached_property
    def _choice(self) -> WebcamChoice:
        return webcam_choice(self.webcam)

    @property
    def mirrored(self) -> bool:
        """True if the camera's picture is mirrored."""
        return self._choice.mirrored

    @property
    def quiet(self) -> bool:
        """True if no browser is opened."""
        return self._choice.quiet


@dataclass(frozen=True)
class WebcamChoice:
    """Value of `--webcam`.

    Attributes:
        camera: The camera.
        mirrored: True if the camera's picture is mirrored.
        quiet: True if the page's address is only printed, and no browser is opened.
    """

    camera: Camera
    mirrored: bool = False
    quiet: bool = False


def webcam_choice(text: str, camera: Camera | None = None) -> WebcamChoice:
    """Reads `--webcam`.

    Args:
        text: The option's value.
        camera: Camera with the values that the text does not set; None: the default camera.

    Raises:
        InputError: A part of the text is unknown or has an impossible value.
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


def before_camera(options: BeforeCameraOptions, argument: str, side: str) -> HandInput:
    """Returns the input settings of a hand in front of a live camera.

    Raises:
        InputError: A setting of the camera is impossible.
    """
    return HandInput(camera=webcam_choice(options.webcam).camera)


@dataclass(frozen=True, kw_only=True)
class PlayedCameraOptions(UnitOptions, BeforeCameraOptions):
    """Options of a recording of landmarks on the command line."""


def in_landmark_file(options: PlayedCameraOptions, file: str, side: str) -> HandInput:
    """Returns the input settings of a hand in a recording of landmarks.

    Raises:
        InputError: A setting of the camera is impossible, or the recording cannot be read.
    """
    from sandbox.devices.files import read_once
    from sandbox.devices.webcam.landmarks import read_landmarks

    recorded = read_once(read_landmarks, Path(file), options.unit).camera
    return HandInput(camera=webcam_choice(options.webcam, recorded).camera)


def _open(options: WebcamOptions, place: Place) -> AnyDevice:
    import webbrowser

    from sandbox.devices.webcam.engine import installed_engine
    from sandbox.devices.webcam.webcam import WebcamDevice

    device = WebcamDevice(installed_engine(), place.sides, options.mirrored)
    if not options.quiet:
        webbrowser.open(device.address)
    return device


def _open_file(options: PlayedOptions, place: Place) -> AnyDevice:
    from sandbox.devices.files import read_once, show_report
    from sandbox.devices.webcam.landmarks import LandmarkFileDevice, read_landmarks

    recording = read_once(read_landmarks, Path(place.argument), options.unit)
    show_report(recording.report)
    return LandmarkFileDevice(recording)


def _check(options: WebcamOptions, argument: str) -> None:
    from sandbox.devices.webcam.engine import installed_engine

    installed_engine()


def _check_file(options: PlayedOptions, argument: str) -> None:
    from sandbox.devices.files import read_once
    from sandbox.devices.webcam.landmarks import read_landmarks

    read_once(read_landmarks, Path(argument), options.unit)


DEVICE: DeviceEntry[Any] = DeviceEntry(
    "a hand in front of a camera, by a page that opens in a browser of this machine",
    _open,
    WebcamOptions,
    DeviceKind(Sees.CAMERA, labels=True, in_scene=True),
    check=_check,
    command_options=BeforeCameraOptions,
    hand_input=before_camera,
)

FILE: DeviceEntry[Any] = DeviceEntry(
    "a recording of landmarks in a camera's pictures",
    _open_file,
    PlayedOptions,
    DeviceKind(Sees.CAMERA, Source.FILE, labels=True, in_scene=True),
    check=_check_file,
    command_options=PlayedCameraOptions,
    hand_input=in_landmark_file,
)
