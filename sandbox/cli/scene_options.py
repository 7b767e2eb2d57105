"""Options that all commands share which run a scene, and what they mean."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from models.errors import InputError
from models.surface import Surface, parse_surface
from sandbox.assembly import DeviceMaker
from sandbox.cli.impulse import impulse_limit
from sandbox.cli.leap_devices import (
    LeapOptions,
    from_one,
    is_leap,
    leap_maker,
    over_one,
    with_leaps,
)
from sandbox.cli.own_hand import of_touches
from sandbox.cli.second_hand import SecondOptions, with_second
from sandbox.cli.touch_devices import is_evdev, live_maker, native_surface, open_file
from sandbox.devices.device import Device
from sandbox.devices.discovery import find_device
from sandbox.devices.recorded import RecordedDevice
from sandbox.devices.simulated import NEXT_PERSON, SimulatedDevice
from sandbox.devices.spoiled import SpoiledDevice
from sandbox.devices.tuio import DEFAULT_PORT, LOOPBACK, Transport
from sandbox.devices.tuio_streams import DEFAULT_WEBSOCKET_PORT
from sandbox.devices.web import WebDevice
from sandbox.profiles import find_profile
from sandbox.recorded_task import recorded_task
from sandbox.recording import Recording, is_recording, load_recording
from sandbox.settings import RunSettings, bare
from sandbox.two_hands import PerHand, home, merging, sharing
from sandbox.variations import parse_variation
from tasks.simulated_user.configuration import UserConfiguration
from tasks.task import Task

Part = Literal[
    "correction", "smoothing", "arrival", "ghost", "distal", "stitch", "encoder", "history"
]
"""Parts of the pipeline that can be taken away, to see what each is worth."""

_PARTS: dict[str, dict[str, Any]] = {
    "correction": {"correction": False},
    "smoothing": {"smoothing": False},
    "arrival": {"arrival": False},
    "ghost": {"ghost_until_clear": False},
    "distal": {"distal_only": False},
    "stitch": {"stitch": False},
    "encoder": {"encode": False},
    "history": {"labels": "paper"},
}


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
    smoothing. The others share labels, correction and smoothing of best."""

    bare: tyro.conf.FlagCreatePairsOff[bool] = False
    """Any encoder as bare as paper's: its labels, no correction, no smoothing."""

    without: tuple[Part, ...] = ()
    """Takes parts of the pipeline away, to see what they are worth."""

    seed: Annotated[int | None, tyro.conf.arg(metavar="INT")] = None
    """Start, goal and simulated user come from it; 0 unless a recording says otherwise."""

    impulse: Annotated[str, tyro.conf.arg(metavar="{paper,safe,N}")] = "paper"
    """Limit of every servo in N s per 1/60 s: paper is 100, safe is 0.5."""

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


# Bases from the last to the first are the order of `--help`: what most people need comes first.
@dataclass(frozen=True)
class SceneOptions(LeapOptions, SecondOptions, OneHandOptions):
    """What runs, and how."""


@dataclass(frozen=True)
class Plan:
    """Options made definite.

    Attributes:
        settings: Of the run.
        about: For header and result: device and simulated user.
        live: A person or another program drives it, so that it runs at real time.
        make_device: Opens the device.
        opened: The device, once opened.
    """

    settings: RunSettings
    about: dict[str, Any]
    live: bool
    make_device: DeviceMaker
    opened: list[Device] = field(default_factory=list)


def plan(options: SceneOptions) -> Plan:
    """What the options mean.

    Raises:
        InputError: An option's value is none of those it has.
    """
    recording = _recording(options.device)
    settings = with_second(_settings(options, recording), options, options.device, recording)
    if recording is None:
        played = _recording(options.second_device) if options.second_device else None
        settings = with_leaps(settings, options, played)
    first = _plan(options, recording, settings, 0)
    second = settings.second
    if second is None:
        return first
    other = options.second_device or ("simulated" if recording is None else options.device)
    more = replace(options, device=other, port=options.port and options.port + 1)
    if options.second_user:
        more = replace(more, user=options.second_user)
    if from_one(options):
        next_ = _plan(replace(more, device=options.device), None, settings, 1)
        two = (first.make_device, next_.make_device) if "user" in next_.about else None
        return replace(first, make_device=over_one(two, first.make_device, settings))
    alone = second.shared and recording is None and options.device != "simulated"
    if alone:
        return replace(first, make_device=sharing(first.make_device, settings, first.opened))
    next_ = _plan(more, _recording(other), settings, 1)
    makers = PerHand((first.make_device, next_.make_device))
    about = first.about | {"second": next_.about}
    if second.shared and recording is None:
        return replace(
            first, about=about, make_device=sharing(merging(makers), settings, first.opened)
        )
    return replace(first, about=about, live=first.live or next_.live, make_device=makers)


def _plan(
    options: SceneOptions, recording: Recording | None, settings: RunSettings, hand: int
) -> Plan:
    """What the options mean for one hand."""
    about: dict[str, Any] = {"device": options.device}
    if options.device == "simulated":
        user = _user(options)
        about["user"] = user.as_json()
        about["drop_outs"] = options.drop_outs

        def simulated(task: Task, surface: Surface) -> Device:
            return SimulatedDevice(
                task,
                user,
                surface,
                settings.seed,
                options.tell_labels,
                options.drop_outs,
                settings.persons[hand],
                hand,
                home(hand, settings, surface),
            )

        return _keeping(settings, about, False, simulated, hand)
    if is_leap(options.device):
        user = _user(options)
        opens = leap_maker(options, settings, user, hand)
        if options.device.startswith("leap-simulated"):
            about["user"] = user.as_json()
        return _keeping(settings, about, options.device == "leap", opens, hand)
    maker = live_maker(options)
    if maker is not None:
        live = maker
        return _keeping(settings, about, True, lambda task, surface: live(surface))
    if options.device == "web":
        return _keeping(settings, about, True, lambda task, surface: WebDevice(surface))
    if options.device == "mouse":
        from sandbox.devices.mouse import MouseDevice

        return _keeping(
            settings,
            about,
            True,
            lambda task, surface: MouseDevice(surface, settings.persons[hand]),
        )
    if recording is not None:
        played = recording
        about["user"] = recording.header.get("user")
        whose = hand if hand in recording.inputs else 0
        return _keeping(settings, about, False, lambda task, surface: RecordedDevice(played, whose))
    path = Path(options.device)
    open_file(path, None).device.close()  # what is wrong with it is said before anything is built
    return _keeping(settings, about, False, lambda task, surface: open_file(path, surface).device)


def _keeping(
    settings: RunSettings, about: dict[str, Any], live: bool, make: DeviceMaker, hand: int = 0
) -> Plan:
    opened: list[Device] = []
    variation = settings.variation
    if not variation.neutral:
        about["variation"] = variation.as_json()

    def open_device(task: Task, surface: Surface) -> Device:
        device = make(task, surface)
        # What was recorded was spoiled then.
        if variation.spoils and not isinstance(device, RecordedDevice):
            spoiled = SpoiledDevice(device, variation, surface, settings.seed + hand * NEXT_PERSON)
            # Whoever shows snapshots has to do so through it; a window drives the device itself.
            opened.append(spoiled if hasattr(device, "show") else device)
            return spoiled
        opened.append(device)
        return device

    return Plan(settings, about, live, open_device, opened)


def _recording(device: str) -> Recording | None:
    path = Path(device)
    if device in ("simulated", "tuio", "mouse", "web") or is_leap(device):
        return None
    if not path.exists() and _live(device):
        return None
    if not path.exists():
        raise InputError(
            "there is no such device or file",
            where="--device",
            got=device,
            expected="simulated, tuio, mouse, web, evdev, leap, leap-simulated or a file",
            remedy="`sandbox touches formats` lists the files that play as devices",
        )
    return load_recording(path) if is_recording(path) else None


def _live(device: str) -> bool:
    return is_evdev(device) or find_device(device) is not None


def _settings(options: SceneOptions, recording: Recording | None) -> RunSettings:
    variation, hand = parse_variation(options.vary)
    if recording is not None and options.vary:
        raise InputError(
            "what is recorded cannot be varied", where="--vary", got=str(recording.path)
        )
    if recording is not None:
        # A recording brings its own task, seed and surface; what is asked for otherwise is tried on
        # the recorded touches.
        base = RunSettings.from_json(recording.header["settings"])
        base = replace(base, task=recorded_task(recording.header, str(recording.path)))
    else:
        base = RunSettings(task=options.task)
    base = replace(base, seed=base.seed if options.seed is None else options.seed)
    if recording is not None and _defaults_apart_from_input(options):
        return base
    values: dict[str, Any] = {
        "encoder": options.encoder,
        "servo": options.servo,
        "impulse": impulse_limit(options.impulse),
        "contact": options.contact,
    }
    if options.encoder == "paper" or options.bare:
        values = bare(values)
    for part in options.without:
        values |= _PARTS[part]
    if options.tell_labels:
        values["labels"] = "device"
    if of_touches(options, is_leap(options.device)):
        values |= asdict(find_profile(str(options.profile)).person)
    asked = {"hand": options.hand, "hand_size": options.hand_size, "turn": options.turn}
    values |= {name: value for name, value in asked.items() if value is not None}
    if recording is None:
        values["hand_size"] = hand * values.get("hand_size", base.hand_size)
        values["variation"] = variation
    if options.surface:
        surface = parse_surface(options.surface)
        values["surface_in"] = (surface.width_in, surface.height_in)
    elif (native := native_surface(options.device)) is not None:
        values["surface_in"] = (native.width_in, native.height_in)
    elif options.device == "tuio" or is_evdev(options.device):
        # TUIO tells no sizes: without one, inches are a guess, and views say so.
        values["surface_calibrated"] = False
    return replace(base, **values)


def _defaults_apart_from_input(options: SceneOptions) -> bool:
    """Whether a recording is to be run just as it was."""
    plain = SceneOptions()
    pipeline = (
        "encoder",
        "bare",
        "without",
        "impulse",
        "contact",
        "servo",
        "surface",
        "tell_labels",
    )
    person = ("hand", "hand_size", "turn", "profile")
    return all(getattr(options, k) == getattr(plain, k) for k in (*pipeline, *person))


def _user(options: SceneOptions) -> UserConfiguration:
    if not 2 <= options.fingers <= 5:
        raise InputError(
            "the simulated user cannot do this", where="--fingers", got=options.fingers,
            expected="2 to 5",
        )  # fmt: skip
    if not 0.0 <= options.drop_outs <= 10.0:
        raise InputError(
            "no screen loses touches like this", where="--drop-outs", got=options.drop_outs,
            expected="0 to 10 times per second",
        )  # fmt: skip
    return UserConfiguration(kind=options.user, fingers=options.fingers)
