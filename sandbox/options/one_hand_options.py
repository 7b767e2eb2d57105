"""Options of commands that run a scene: what runs, and how, by one hand."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from sandbox.devices.tuio.tuio import DEFAULT_PORT, LOOPBACK, Transport
from sandbox.devices.tuio.tuio_streams import DEFAULT_WEBSOCKET_PORT

Part = Literal[
    "correction", "smoothing", "arrival", "ghost", "distal", "stitch", "encoder", "history"
]
"""Parts of the pipeline that can be taken away, to see what each is worth."""


@dataclass(frozen=True)
class OneHandOptions:
    """What runs, and how, by one hand."""

    task: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="TASK")] = "box-to-goal"
    """Task to do; `sandbox` lists them. Or FILE.py with one of your own."""

    device: Annotated[str, tyro.conf.arg(metavar="{simulated,tuio,mouse,evdev,leap,FILE}")] = (
        "simulated"
    )
    """Where touches come from: the simulated user, a TUIO sender, the mouse in the window, a touch
    screen of this Linux machine, a device of your own (docs/write-a-device.md), or a file: a
    recording of ours, what `touches record` wrote, or a capture of TUIO packets. Or a hand in the
    air, over a Leap: leap, a Leap recording (.json, .json.lz), or leap-simulated, a simulated
    person; leap-simulated:v1 is over the first Leap, and leap-simulated:v1,noise=2,lose=1 over one
    with twice the noise, which loses the hand for 1 s while it carries something."""

    encoder: Annotated[
        str, tyro.conf.arg(metavar="{paper,linear,quadratic,cubic,pca-ik,best,FILE}")
    ] = "best"
    """From touches to the hand. paper: least squares, the paper's labels, no correction, no
    smoothing. The others share labels, correction and smoothing of best. FILE is what `sandbox
    train` wrote, or FILE.py:CLASS (MODULE:CLASS), an encoder of your own
    (docs/write-an-encoder.md)."""

    bare: tyro.conf.FlagCreatePairsOff[bool] = False
    """Any encoder as bare as paper's: its labels, no correction, no smoothing."""

    without: tuple[Part, ...] = ()
    """Takes parts of the pipeline away, to see what they are worth."""

    seed: Annotated[int | None, tyro.conf.arg(metavar="INT")] = None
    """Start, goal and simulated user come from it; 0 unless a recording says otherwise."""

    impulse: Annotated[str, tyro.conf.arg(metavar="{paper,safe,N}")] = "paper"
    """Limit of every servo in N s per 1/60 s: paper is 100, safe is 0.5. From safe down a hand that
    is down is slower, and its fingers are heavier."""

    contact: Literal["hard", "soft", "none"] = "hard"
    """How the hand touches things: soft gives way and pushes with 3 N at most, none passes through
    everything. `c` changes it in the window."""

    servo: Literal["orientation", "position"] = "orientation"
    """One servo on the rotation of each ball joint, or three on its components."""

    hand: Literal["right", "left"] | None = None
    """Which hand touches; the right one unless a recording or a profile says otherwise."""

    hand_size: Annotated[float | None, tyro.conf.arg(metavar="RATIO")] = None
    """Length of the hand against the trained one, 0.6 to 1.6; `sandbox calibrate` measures it."""

    turn: Literal[0, 90, 180, 270] | None = None
    """Where the person sits: 0 at the screen's lower edge, 90 at its right one, 180 at its upper
    one, 270 at its left one."""

    profile: Annotated[str | None, tyro.conf.arg(metavar="{default,none,FILE}")] = None
    """Hand, size and seat as `sandbox calibrate` found them: default is this user's own profile.
    Without it, none is used, save by `sandbox play` with a touch device. Over a Leap, also what
    `sandbox paalm calibrate` wrote; default is then this user's own measured hand."""

    surface: Annotated[str | None, tyro.conf.arg(metavar="SIZE")] = None
    """Size of the touch surface: 7.76x5.82in, 197x148mm or a preset such as ipad2."""

    fingers: int = 3
    """Of the simulated user, 2 to 5."""

    user: Literal["skilled", "idle", "random"] = "skilled"
    """The simulated user; idle and random are control arms that must not succeed."""

    tell_labels: tyro.conf.FlagCreatePairsOff[bool] = False
    """The simulated user says which finger touches: an upper bound for labelling."""

    drop_outs: float = 0.0
    """Times per second that the simulated user's screen loses each touch, for 0.1 s; it comes back
    under another id."""

    vary: Annotated[str, tyro.conf.arg(metavar="NAME=VALUE,...")] = ""
    """Another trial than the task draws, or a worse screen, such as size=0.8,latency=50: factors
    size, mass, friction, hand-size; mm start, noise; a second dropped, ghosts; ms latency."""

    port: int = DEFAULT_PORT
    """UDP and TCP port for TUIO; 0 takes a free one."""

    bind: Annotated[str, tyro.conf.arg(metavar="ADDRESS")] = LOOPBACK
    """Address for TUIO; 127.0.0.1 is reached from this machine only, 0.0.0.0 from the network."""

    tuio_transport: Transport = "udp"
    """How TUIO comes: udp, tcp, websocket, or all three."""

    websocket_port: int = DEFAULT_WEBSOCKET_PORT
    """TCP port for TUIO over WebSockets; 0 takes a free one."""

    tuio_connect: Annotated[str, tyro.conf.arg(metavar="URL")] = ""
    """Calls a TUIO sender that waits for it, such as tcp://HOST:3333 or ws://HOST:8080."""

    grab: tyro.conf.FlagCreatePairsOff[bool] = False
    """evdev: keep the touches from the desktop, so that a trackpad's pointer stays where it is."""

    record: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Writes a recording that `sandbox replay` plays to the bit."""

    dump: Annotated[Path, tyro.conf.arg(metavar="DIR")] = Path()
    """Folder for a recording of the last states, should the simulation diverge; with --record it is
    written beside that."""

    events: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Appends events as JSON lines: listening, trial_start, trial_end, warning."""
