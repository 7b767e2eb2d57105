"""Options of commands that run a scene with one hand."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from sandbox.options.headings import (
    COMMON,
    OUTPUT,
    PERSON,
    PHYSICS,
    RECONSTRUCTION,
    SIMULATED,
)
from sandbox.options.touch_devices import LiveTouchOptions
from sandbox.options.variations import KINDS, help_with_units
from sandbox.trial.settings import PhysicsSettings, PipelineSettings


@dataclass(frozen=True, kw_only=True)
class SourceOptions:
    """Task and device of one hand."""

    task: Annotated[str, Parameter(group=COMMON, metavar="TASK")] = field(
        default="box-to-goal", kw_only=False
    )
    """Name of a task (`sandbox` lists them), or FILE.py with a task of your own."""

    device: Annotated[str, Parameter(group=COMMON, metavar="DEVICE")] = "simulated"
    """Source of the input. simulated: a simulated user. tuio: a TUIO sender. evdev: a touch screen
    of this Linux machine. leap: a hand in the air over a Leap. webcam: a hand before a camera, by a
    page that opens in your browser (docs/webcam.md). leap-simulated: a simulated person
    over a Leap (leap-simulated:v1: over the first Leap; leap-simulated:v1,noise=2,lose=1: with
    twice the noise, and the hand is lost for 1 s while it carries something). webxr-simulated: a
    simulated person in a headset (docs/headset.md). FILE: a recording of this program, a file by
    `touches record`, a capture of TUIO packets, a Leap recording (.json, .json.lz), or landmarks by
    `devices webcam record`. Or a device of your own: FILE.py:CLASS[:ARGUMENT],
    MODULE:CLASS[:ARGUMENT], or its name in an installed package (docs/write-a-device.md)."""


@dataclass(frozen=True, kw_only=True)
class TrialOptions(PipelineSettings, PhysicsSettings):
    """Hand, pipeline and physics, which also hold for every trial of `sandbox regress`."""

    given: Annotated[frozenset[str], Parameter(parse=False)] = frozenset()
    """Names of the options on the command line; of options that were made in Python, those that
    differ from the defaults count (`given_options`)."""

    bare: Annotated[bool, Parameter(group=RECONSTRUCTION)] = False
    """Use the paper's labels, and no correction or smoothing, with any encoder."""

    impulse: Annotated[str, Parameter(group=PHYSICS, metavar="paper|safe|N")] = "paper"  # type: ignore[assignment]
    """Limit of every servo in N s per 1/60 s: paper is 100, safe is 0.5. At 0.5 and below, a
    lowered hand moves more slowly and its fingers are heavier."""

    hand: Annotated[Literal["right", "left"] | None, Parameter(group=COMMON)] = None
    """Which hand. Default: that of the recording or profile, else right."""

    hand_size: Annotated[float | None, Parameter(group=PERSON, metavar="RATIO")] = None
    """Length of the hand relative to the trained hand, 0.6 to 1.6; `sandbox hand measure` measures
    it."""

    turn: Annotated[Literal[0, 90, 180, 270] | None, Parameter(group=PERSON)] = None
    """Edge of the screen at which the person sits: 0 lower, 90 right, 180 upper, 270 left."""

    profile: Annotated[str | None, Parameter(group=COMMON, metavar="default|none|FILE")] = None
    """Profile of a person by `sandbox hand measure`: side and size of the hand, and seat. default:
    this user's own profile, which `sandbox play` with a touch device uses even without this
    option. Over a Leap: a calibration by `sandbox paalm calibrate`; default is this user's own
    measured hand."""

    rest: Annotated[Path | None, Parameter(group=RECONSTRUCTION, metavar="FILE")] = None
    """Rest posture: a few looks at the person's hand while it touches, or a capture of it. With
    --encoder population it removes what the hand does differently all the time
    (docs/strangers.md). Default: that of the profile."""

    surface: Annotated[str | None, Parameter(group=COMMON, metavar="SIZE")] = None
    """Size of the touch surface: 7.76x5.82in, 197x148mm, or a preset such as ipad2."""

    fingers: Annotated[int, Parameter(group=SIMULATED)] = 3
    """Number of fingers that the simulated user touches with, 2 to 5."""

    user: Annotated[Literal["skilled", "idle", "random"], Parameter(group=SIMULATED)] = "skilled"
    """Simulated user. idle and random are control conditions, which should not succeed."""

    drop_outs: Annotated[float, Parameter(group=SIMULATED)] = 0.0
    """Times per second that the simulated user's screen loses each touch. A lost touch returns
    after 0.1 s with another id."""

    def __post_init__(self) -> None:
        """Checks nothing: values are checked when they become settings."""


def given_options(options: TrialOptions) -> frozenset[str]:
    """Names of the options that were given."""
    kind = type(options)
    plain = kind()
    names = (each.name for each in fields(kind) if each.name != "given")
    return frozenset(
        name
        for name in names
        if name in options.given or getattr(options, name) != getattr(plain, name)
    )


# `--help` lists the options of the last base first.
@dataclass(frozen=True, kw_only=True)
class OneHandOptions(LiveTouchOptions, TrialOptions, SourceOptions):
    """Task, device, encoder, physics and recording options for one hand."""

    seed: Annotated[int | None, Parameter(group=COMMON, metavar="INT")] = None
    """Seed of start, goal and simulated user. Default: that of the recording, else 0."""

    vary: Annotated[
        str,
        Parameter(
            group=SIMULATED,
            metavar="NAME=VALUE,...",
            help="Change the trial or degrade the touches, such as size=0.8,latency=50. "
            + help_with_units(KINDS.values()),
        ),
    ] = ""

    record: Annotated[Path | None, Parameter(group=COMMON, metavar="FILE")] = None
    """Write a recording, which `sandbox replay` reproduces bit for bit."""

    dump: Annotated[Path, Parameter(group=OUTPUT, metavar="DIR")] = Path()
    """Folder for a recording of the last states, written if the simulation diverges. With --record,
    it is written beside the recording instead."""

    events: Annotated[Path | None, Parameter(group=OUTPUT, metavar="FILE")] = None
    """Append events to this file as JSON lines: listening, trial_start, trial_end, warning."""
