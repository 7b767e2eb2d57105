"""`sandbox capture simulate`: makes a SIMULATED session with both devices, and its ground truth."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.progress import Progress
from rich.text import Text

from encoders.capture import save_capture
from encoders.captures.overhead.simulated_camera import OverheadPictures, simulate_overhead
from encoders.captures.paired.simulated_pair import PairedSession, simulate_paired
from models.errors import InputError
from sandbox.cli.common.command_line import parse
from sandbox.devices.files.paired_capture import PairedCaptureWriter, check_new
from sandbox.devices.webcam.landmarks import header_record, message_of

TRUTH, DEVICES = "truth.npz", "truth.json"


def write_simulated(session: PairedSession, folder: Path, subject: str) -> None:
    """Writes a session and its ground truth."""
    about = {
        "side": session.side,
        "subject": subject,
        "simulated": True,
        "touches": "simulated tablet",
        "hands": f"simulated Leap, {session.leap.dialect}",
    }
    with PairedCaptureWriter(folder, session.surface, about) as writer:
        for frame, host in zip(session.touches, session.touch_arrived.tolist(), strict=True):
            writer.touch(frame, round(host, 6))
        for seen, host in zip(session.leap.frames, session.leap_arrived.tolist(), strict=True):
            writer.hand(seen, round(host, 6))
    truth = {
        "simulated": True,
        "offset_s": session.offset,
        "touch_delay_s": session.touch_delay,
        "device_axes": session.rotation.tolist(),
        "device_at_m": session.shift.tolist(),
    }
    save_capture(session.truth, folder / TRUTH)
    (folder / DEVICES).write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


def write_simulated_camera(
    session: PairedSession,
    pictures: OverheadPictures,
    folder: Path,
    subject: str,
    corners: bool = False,
) -> None:
    """Writes a session under a camera, and the ground truth of the session.

    Args:
        session: The simulated touches and hand.
        pictures: Landmarks as the camera's page sends them.
        folder: Folder to create.
        subject: Pseudonym.
        corners: True if the tablet's corners were marked.
    """
    camera = pictures.configuration.camera
    about: dict[str, Any] = {
        "side": session.side,
        "subject": subject,
        "simulated": True,
        "touches": "simulated tablet",
        "hands": "simulated camera",
        "fov": camera.view,
    }
    marked = pictures.corners.round(2).tolist()
    if corners:
        about["corners"] = marked
    with PairedCaptureWriter(folder, session.surface, about, header_record(camera)) as writer:
        for frame, host in zip(session.touches, session.touch_arrived.tolist(), strict=True):
            writer.touch(frame, round(host, 6))
        for seen, host in zip(pictures.frames, pictures.arrived.tolist(), strict=True):
            writer.picture(message_of(seen), round(host, 6))
    truth = {
        "simulated": True,
        "offset_s": pictures.configuration.latency - session.touch_delay,
        "touch_delay_s": session.touch_delay,
        "corners_px": marked,
        "fingers": {str(id_): finger for id_, finger in session.labels.items()},
    }
    save_capture(session.truth, folder / TRUTH)
    (folder / DEVICES).write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


@dataclass(frozen=True, kw_only=True)
class SimulateOptions:
    """Makes a SIMULATED session in the form of `sandbox capture record`. A hand touches a tablet
    and is seen by a Leap; each device has its own clock, latency and noise.

    The folder also has the ground truth: truth.npz, a capture of the same touches with the true
    fingers and poses, and truth.json, with the offset of the clocks and the position of the Leap.
    Every seed gives a different person, with different bones. Day 0 is the training script; later
    days are free play.

    Try:

        sandbox capture simulate --out monday
        sandbox capture --recorded monday --out mine.npz
    """

    out: Annotated[Path, Parameter(metavar="FOLDER")]
    """Folder to create; an existing session is never overwritten."""

    seed: int = 0
    """Number of the simulated person."""

    day: int = 0
    """Day: 0 is the training script, 1 and later are free play."""

    dialect: Literal["v3", "v1"] = "v3"
    """Software of the Leap: v3, with joints and labelled fingers; or v1, the first version."""

    hand: Literal["right", "left"] = "right"
    """Side of the hand; a left hand is the mirror image."""

    hands: Literal["leap", "webcam"] = "leap"
    """Device that sees the hand. leap: a Leap. webcam: a camera over the tablet, which gives
    landmarks with errors; truth.json then has the tablet's corners, not a position of the Leap."""

    corners: bool = False
    """With --hands webcam: write the tablet's corners into the session, as if they had been
    marked."""


def main(argv: list[str]) -> int:
    """Runs `sandbox capture simulate ...`."""
    options = parse(SimulateOptions, "sandbox capture simulate", argv)
    if options.seed < 0 or options.day < 0:
        raise InputError("out of range", where="--seed, --day", expected="0 or more")
    check_new(options.out)
    bars = Console(stderr=True)
    with Progress(console=bars, transient=True, disable=not bars.is_terminal) as progress:
        bar = progress.add_task("simulating the person", total=1.0)
        session = simulate_paired(
            options.seed,
            options.day,
            options.dialect,
            options.hand,
            progress=lambda share: progress.update(bar, completed=share),
        )
        progress.update(bar, description="writing")
        name = f"simulated {options.seed}"
        if options.hands == "webcam":
            pictures = simulate_overhead(session, options.seed + 1000 * options.day)
            write_simulated_camera(session, pictures, options.out, name, options.corners)
            what, frames = "camera", len(pictures.frames)
        else:
            write_simulated(session, options.out, name)
            what, frames = options.dialect, len(session.leap.frames)
    bars.print(
        Text(
            f"SIMULATED session ({what}, {session.leap_arrived[-1]:.0f} s, "
            f"{len(session.touches):,} touch frames, {frames:,} hand frames): "
            f"{options.out}"
        ),
        soft_wrap=True,
    )
    return 0
