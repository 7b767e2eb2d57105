"""`sandbox devices leap`: a fake Leap service (leapd), simulated recordings, a list of formats."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from cyclopts import Parameter
from rich.console import Console
from rich.table import Table
from rich.text import Text

from encoders.capture import load_capture
from encoders.paalm.simulated.air import AirTake, simulate_air, takes_of_capture
from encoders.paalm.simulated.air import turned as turned_take
from encoders.paalm.simulated.forward import leap_take
from models.arithmetic import Array
from models.errors import InputError
from models.rotations import exp
from sandbox.cli.common.command_line import application
from sandbox.cli.common.json_out import refuse_replacing
from sandbox.devices.files import show_report
from sandbox.devices.leap.leap_fake import DEFAULT_PORT, FakeLeapd
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.leap.leap_write import write_take


def fake(
    file: Path,
    *,
    bind: Annotated[str, Parameter(metavar="ADDRESS")] = "127.0.0.1",
    port: int = DEFAULT_PORT,
    rate: float = 100.0,
    loop: bool = False,
    seconds: float = math.inf,
) -> int:
    """Plays a recording over a WebSocket like leapd, the Leap's service; Ctrl-C stops.

    The first line on stdout is JSON: {"event": "listening", "address"}. Then, in another terminal:

        sandbox paalm show --device leap

    Args:
        file: A Leap recording; `sandbox devices leap formats` lists the formats.
        bind: Address to listen on. 127.0.0.1: reachable from this machine only.
        port: TCP port; 0 takes a free one.
        rate: Frames per second; a Leap sends 290 at most.
        loop: Begin again at the end.
        seconds: Stop after this many seconds.
    """
    if not 0.0 < rate <= 10_000.0:
        raise InputError(
            "the rate is out of range",
            where="--rate",
            got=rate,
            expected="above 0, at most 10000 Hz",
        )
    if not 0 <= port <= 65535:
        raise InputError(
            "the port is out of range", where="--port", got=port, expected="0 to 65535"
        )
    recording = read_leap(file)
    show_report(recording.report, str(file))
    server = FakeLeapd(recording.messages, bind=bind, port=port, rate=rate, loop=loop)
    try:
        print(json.dumps({"event": "listening", "address": server.address}), flush=True)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            time.sleep(min(0.2, max(0.0, end - time.monotonic())))
    except KeyboardInterrupt:
        return 0  # the usual way to end
    finally:
        server.close()
    return 0


def simulate(
    *,
    out: Annotated[Path, Parameter(metavar="FILE|FOLDER")],
    seed: int = 0,
    takes: int = 1,
    hand: Literal["right", "left"] = "right",
    dialect: Literal["v1", "v3"] = "v1",
    drop_outs: Annotated[bool, Parameter(negative="--no-drop-outs")] = True,
    turned: Annotated[
        str, Parameter(metavar="ROLL,PITCH,YAW", allow_leading_hyphen=True)
    ] = "0,0,0",
    capture: Annotated[Path | None, Parameter(metavar="FILE")] = None,
) -> int:
    """Makes SIMULATED recordings of a hand over a Leap.

    v1 is the first software of the Leap: fingers have no order, their lengths shrink as they bend,
    and they sometimes vanish. The file has the true pose of every frame, for `sandbox evaluate
    --paalm FOLDER`. Device and hands have a frozen configuration (docs/paalm.md).

    Args:
        out: File for the recording, or a folder for several takes.
        seed: Seed of person, motion and device; take i has seed + i.
        takes: Number of recordings.
        hand: Side of the hand.
        dialect: Software of the Leap: v1 (2013), or v3, with joints and labelled fingers.
        drop_outs: With --no-drop-outs, the device sees every finger at all times.
        turned: Rotation of the whole hand in degrees, also while it is held open. ROLL is about the
            axis away from the person, PITCH about the axis to the right, YAW about the upward axis.
        capture: Capture whose poses give the motion of the hand. Each take in it becomes a
            recording, up to --takes.
    """
    if seed < 0 or takes < 1:
        raise InputError("out of range", where="--seed, --takes", expected="0 or more, 1 or more")
    refuse_replacing(out, {"--capture": capture})
    rotation = _rotation(turned)
    motions: list[AirTake]
    if capture is not None:
        motions = list(takes_of_capture(load_capture(capture)))[:takes]
    else:
        motions = [simulate_air(seed + i, hand) for i in range(takes)]
    many = takes > 1
    try:
        (out if many else out.absolute().parent).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"the folder cannot be created: {error}",
            where=f"--out {out}",
            remedy="Name another folder",
        ) from error
    for i, motion in enumerate(motions):
        take = leap_take(turned_take(motion, rotation), seed + i, dialect, drop_outs)
        path = out / f"take-{seed + i:04d}.json" if many else out
        made_from = {"seed": seed + i, "capture": str(capture) if capture else None}
        write_take(take, path, made_from)
    count = "1 simulated recording" if len(motions) == 1 else f"{len(motions)} simulated recordings"
    Console(stderr=True).print(Text(f"{count} ({dialect}): {out}"))
    return 0


def _rotation(turned: str) -> Array:
    """Rotation (3, 3) of `ROLL,PITCH,YAW` in degrees."""
    try:
        roll, pitch, yaw = np.deg2rad([float(part) for part in turned.split(",")])
        if not np.isfinite([roll, pitch, yaw]).all():
            raise ValueError(turned)
    except ValueError:
        raise InputError(
            "not three angles", where="--turned", got=turned, expected="ROLL,PITCH,YAW in degrees"
        ) from None
    axes = ([0.0, 0.0, yaw], [pitch, 0.0, 0.0], [0.0, roll, 0.0])
    return np.asarray(exp(axes[0]) @ exp(axes[1]) @ exp(axes[2]))


def formats() -> int:
    """Lists the Leap services and file formats that this program reads."""
    table = Table("what", "how", "understood")
    table.add_row("leapd, Orion, Ultraleap bridge", "--device leap", "ws://127.0.0.1:6437/v6.json")
    table.add_row("v1 (2013)", "service, FILE", "directions and lengths, no names, no bones")
    table.add_row("v2 (2014)", "service, FILE", "joints; PIP and DIP bend alike by construction")
    table.add_row("v3 (Orion), bridge", "service, FILE", "joints, PIP and DIP apart")
    table.add_row(r"\[frame, ...]", "FILE", "JSON as the first software dumped it")
    table.add_row("{metadata, frames}", "FILE", "LeapJS recording, plain or packed")
    table.add_row("{frames: 87, data: ...}", "FILE", "a list of frames under another key")
    table.add_row(".json.lz", "FILE", "the same formats, LZString base64")
    table.add_row("one message a line", "FILE", "JSON lines; read up to the first damage")
    Console().print(table)
    print("Files are recognised by their content, not by their suffix.")
    return 0


app = application(
    "leap",
    "Replaces a Leap Motion device: a fake service, simulated recordings, formats.",
    fake,
    simulate,
    formats,
)
