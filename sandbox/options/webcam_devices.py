"""Options for hands before a webcam, and how a camera or a recording of one is opened."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan, degrees
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from encoders.webcam.camera import Camera
from models.errors import InputError
from sandbox.devices.kinds import LIVE_WEBCAM as LIVE
from sandbox.devices.webcam.landmark_file import read_landmarks
from sandbox.options.headings import WEBCAM
from sandbox.trial.hand_input import HandInput

_NUMBERS = {"fov": "view", "tilt": "tilt", "roll": "roll", "pan": "pan"}
"""Key of an option -> field of the camera."""
_WORDS = ("mirrored", "quiet")
_FORM = "fov=60 or sees=0.58/0.5,at=0/0.45/0.1,tilt=0,roll=0,pan=0,mirrored,quiet"


@dataclass(frozen=True, kw_only=True)
class WebcamOptions:
    """Options for hands before a webcam."""

    webcam: Annotated[str, Parameter(group=WEBCAM, metavar="KEY=VALUE,...")] = ""
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


def hand_before_camera(options: WebcamOptions, device: str) -> HandInput:
    """Returns how a camera, or a recording of one, sees a hand.

    Raises:
        InputError: The camera is impossible.
    """
    recorded = None if device == LIVE else read_landmarks(Path(device)).camera
    return HandInput(camera=webcam_choice(options.webcam, recorded).camera)
