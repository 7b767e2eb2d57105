"""Options of a trial on a command line, and the settings that follow from them.

`sandbox run` and `sandbox play` parse a command line into `TrialOptions`. A study's design and
`run_trial` create `TrialOptions`, too. `trial_settings` converts them to `Settings`.

An option is a field; the field's docstring is the option's help. Each option has a heading of
`--help`. Options that most people need come first. Options of a device are defined with the device
(`sandbox.devices`), and listed if the device is named. The option `--vary` names quantities of a
trial or a screen, with their units.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cache
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Group, Parameter
from rich.console import Console
from rich.text import Text

from encoders.regression.model_registry import check_model_name
from encoders.regression.trained import POPULATION
from models.errors import InputError, unknown_name
from models.hand import IMPULSE_PROFILES
from models.surface import parse_surface
from sandbox.devices.device import PlayedOptions, Sees
from sandbox.devices.registry import (
    LIVE_HEADSET,
    DeviceSettings,
    check_device_options,
    is_in_air,
    kind_of,
    named_device,
    seen_hand,
)
from sandbox.recording.recorded_task import recorded_task, task_change
from sandbox.recording.recording import Recording, is_recording, load_recording
from sandbox.recording.versions import states_difference
from sandbox.trial.settings import (
    PAPER_PIPELINE,
    PhysicsSettings,
    PipelineSettings,
    Settings,
    recorded_encoder,
    recorded_settings,
    recorded_users,
)
from tasks.registry import find_task, hands_of
from tasks.user import UserConfiguration
from tasks.variation import RANGES, Variation

if TYPE_CHECKING:
    from sandbox.devices.hand_input import HandInput


COMMON = Group.create_ordered("Common options")
OUTPUT = Group.create_ordered("Output")
PERSON = Group.create_ordered("Hand of the person")
RECONSTRUCTION = Group.create_ordered("Labels and reconstruction")
PHYSICS = Group.create_ordered("Physics and robots")
SIMULATED = Group.create_ordered("Simulated user, and harder trials")
SECOND = Group.create_ordered("Second hand")
PAGE = Group.create_ordered("Page")


@cache
def device_heading(device: str) -> Group:
    """The heading of the options of a device, by its name."""
    return Group.create_ordered(f"Device {device}")


OF_SETTINGS = {
    "PipelineSettings": RECONSTRUCTION,
    "PhysicsSettings": PHYSICS,
}
"""Class of settings -> heading of the options that its fields define."""
COMMON_SETTINGS = ("encoder",)
"""Fields of these classes that are listed under the common options instead."""


@dataclass(frozen=True)
class Kind:
    """A quantity that can be varied.

    Attributes:
        name: Name on the command line.
        about: Description, for tables and axes.
        neutral: Value without variation.
        unit: Unit of the values; empty for a factor.
        scale: One unit in SI units.
        down: Values below the neutral value, from near to far. `sandbox regress` tries them in this
            order until success drops.
        up: The same for values above the neutral value.
    """

    name: str
    about: str
    neutral: float
    unit: str = ""
    scale: float = 1.0
    down: tuple[float, ...] = ()
    up: tuple[float, ...] = ()

    @property
    def field(self) -> str:
        """Name of the attribute of `Variation`, or of the hand's settings."""
        return self.name.replace("-", "_")

    def text(self, value: float) -> str:
        """Returns a value with its unit."""
        return f"{value:g} {self.unit}".rstrip()


HAND_SIZE = "hand-size"
"""Name of the factor on the hand's size. The size is a setting of the hand, not of `Variation`."""

KINDS = {
    quantity.name: quantity
    for quantity in (
        Kind(
            "size",
            "edges of the objects",
            1.0,
            down=(0.8, 0.6, 0.5, 0.4, 0.3),
            up=(1.2, 1.4, 1.6, 1.8, 2.0),
        ),
        Kind(
            "mass",
            "mass of the objects",
            1.0,
            down=(0.5, 0.2, 0.1, 0.05),
            up=(2.0, 4.0, 8.0, 16.0, 32.0),
        ),
        Kind(
            "resistance",
            "springs and friction of joints",
            1.0,
            down=(0.5, 0.2, 0.1),
            up=(1.5, 2.0, 3.0, 5.0, 8.0),
        ),
        Kind(
            "friction",
            "friction of table, objects and hand",
            1.0,
            down=(0.7, 0.5, 0.35, 0.25, 0.15, 0.1),
            up=(1.5, 2.0, 3.0, 5.0),
        ),
        Kind(
            "start",
            "shift of the drawn start",
            0.0,
            "mm",
            1e-3,
            up=(10.0, 20.0, 30.0, 40.0),
        ),
        Kind(
            "room",
            "gaps between the objects",
            1.0,
            down=(0.95, 0.9, 0.85, 0.8, 0.5, 0.25),
            up=(1.05, 1.1, 1.2, 1.5, 2.0),
        ),
        Kind(
            HAND_SIZE,
            "length of the hand",
            1.0,
            down=(0.95, 0.9, 0.85, 0.8, 0.7),
            up=(1.05, 1.1, 1.15, 1.2, 1.3, 1.5),
        ),
        Kind("noise", "noise of touches", 0.0, "mm", 1e-3, up=(0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 12.0)),
        Kind(
            "dropped",
            "drop-outs of each touch",
            0.0,
            "per s",
            up=(0.25, 0.5, 1.0, 2.0, 4.0, 8.0),
        ),
        Kind("ghosts", "ghost touches", 0.0, "per s", up=(0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)),
        Kind(
            "latency",
            "latency of touches",
            0.0,
            "ms",
            1e-3,
            up=(50.0, 100.0, 150.0, 200.0, 300.0, 400.0, 600.0),
        ),
    )
}
"""Quantities by name."""


def help_with_units(kinds: Iterable[Kind]) -> str:
    """Text with all quantities, grouped by unit: `size, mass: factors. noise: mm.`"""
    by_unit: dict[str, list[str]] = {}
    for kind in kinds:
        by_unit.setdefault(kind.unit or "factors", []).append(kind.name)
    return " ".join(f"{', '.join(names)}: {unit}." for unit, names in by_unit.items())


def help_with_names(kinds: Iterable[Kind]) -> str:
    """Text with the names of all quantities: `size, mass or noise`."""
    *names, last = (kind.name for kind in kinds)
    return f"{', '.join(names)} or {last}" if names else last


def find_kind(name: str) -> Kind:
    """Returns the quantity of a name.

    Raises:
        InputError: The name is unknown.
    """
    if name not in KINDS:
        raise unknown_name("unknown quantity", name, KINDS, where="--vary")
    return KINDS[name]


def parse_value(quantity: Kind, text: str) -> float:
    """Parses a value of a quantity.

    Raises:
        InputError: The text is not a number or is out of range.
    """
    try:
        value = float(text)
        if not isfinite(value):
            raise ValueError
    except ValueError:
        raise InputError(
            "not a number",
            where=f"--vary {quantity.name}",
            got=text,
            expected=f"such as {quantity.name}={(quantity.up or quantity.down)[0]:g}",
            # `run` separates quantities by commas, since one trial has all of them.
            remedy="Separate quantities by spaces here, not by commas: each is varied by itself"
            if "=" in text
            else None,
        ) from None
    combined([(quantity, value)])
    return value


def parse_variation(text: str) -> tuple[Variation, float]:
    """Parses a text such as `size=0.8,latency=50`.

    Returns:
        The variation, and the factor on the hand's size.

    Raises:
        InputError: `text` is not NAME=VALUE,...
    """
    chosen: list[tuple[Kind, float]] = []
    for part in filter(None, (p.strip() for p in text.split(","))):
        name, equals, value = part.partition("=")
        quantity = find_kind(name.strip())
        if not equals:
            raise InputError(
                "the value is missing",
                where=f"--vary {text}",
                got=part,
                expected=f"such as {name}={(quantity.up or quantity.down)[0]:g}",
            )
        if quantity in (k for k, _ in chosen):
            raise InputError("given twice", where=f"--vary {text}", got=name)
        chosen.append((quantity, parse_value(quantity, value)))
    return combined(chosen)


def combined(chosen: Sequence[tuple[Kind, float]]) -> tuple[Variation, float]:
    """Combines values into a variation, and the factor on the hand's size.

    Args:
        chosen: Quantities with values in their own units.

    Raises:
        InputError: A value is out of range.
    """
    values = {quantity.field: value * quantity.scale for quantity, value in chosen}
    hand = values.pop(KINDS[HAND_SIZE].field, 1.0)
    if not 0.0 < hand < 10.0:
        raise InputError(
            "out of range",
            where=f"--vary {HAND_SIZE}",
            got=hand,
            expected="more than 0, less than 10",
        )
    for quantity, value in chosen:
        least, most = RANGES.get(quantity.field, (-inf, inf))
        if not least <= value * quantity.scale <= most:
            raise InputError(
                "out of range",
                where=f"--vary {quantity.name}",
                got=quantity.text(value),
                expected=f"{least / quantity.scale:g} to {quantity.text(most / quantity.scale)}",
            )
    return Variation(**values), hand


@dataclass(frozen=True, kw_only=True)
class SourceOptions:
    """Task and device of one hand."""

    task: Annotated[str, Parameter(group=COMMON, metavar="TASK")] = field(
        default="box-to-goal", kw_only=False
    )
    """Name of a task (`sandbox` lists them), or FILE.py with a task of your own."""

    device: Annotated[str, Parameter(group=COMMON, metavar="DEVICE")] = "simulated"
    """Source of the input. simulated: a simulated user. tuio: a TUIO sender. evdev: a touch screen
    of this Linux machine. leap: a hand in the air over a Leap. webcam: a hand in front of a camera,
    by a page that opens in your browser (docs/webcam.md). leap-simulated: a simulated person
    over a Leap (leap-simulated:v1: with the first Leap software, v1;
    leap-simulated:v1,noise=2,lose=1: with twice the noise, and the hand is lost for 1 s while it
    carries an object). webxr-simulated: a simulated person in a headset (docs/headset.md). FILE: a
    recording of this program, a file by `touches record`, a capture of TUIO packets, a Leap
    recording (.json, .json.lz), or landmarks by `devices webcam record`. Or a device of your own:
    FILE.py:CLASS[:ARGUMENT], MODULE:CLASS[:ARGUMENT], or its name in an installed package
    (docs/write-a-device.md)."""


@dataclass(frozen=True, kw_only=True)
class ConditionOptions(PipelineSettings, PhysicsSettings):
    """Options of hand, pipeline and physics. In `sandbox regress` they apply to every trial."""

    given: Annotated[frozenset[str], Parameter(parse=False)] = frozenset()
    """Names of the options on the command line. For options that were created in Python,
    `given_options` adds those that differ from the defaults."""

    bare: Annotated[bool, Parameter(group=RECONSTRUCTION)] = False
    """With any encoder, use the paper's labels, and no correction or smoothing."""

    impulse: Annotated[str, Parameter(group=PHYSICS, metavar="paper|safe|N")] = "paper"  # type: ignore[assignment]
    """Limit of every servo in N s per 1/60 s: paper is 100, safe is 0.5. At 0.5 and below, a
    lowered hand moves more slowly and its fingers are heavier."""

    hand: Annotated[Literal["right", "left"] | None, Parameter(group=COMMON)] = None
    """The hand. Default: the hand of the recording or profile, otherwise right."""

    hand_size: Annotated[float | None, Parameter(group=PERSON, metavar="RATIO")] = None
    """Length of the hand relative to the trained hand, 0.6 to 1.6; `sandbox hand measure` measures
    it."""

    turn: Annotated[Literal[0, 90, 180, 270] | None, Parameter(group=PERSON)] = None
    """Edge of the screen at which the person sits: 0 lower, 90 right, 180 upper, 270 left."""

    profile: Annotated[str | None, Parameter(group=COMMON, metavar="default|none|FILE")] = None
    """Profile of a person, written by `sandbox hand measure`: side and size of the hand, and seat.
    default: this user's own profile; `sandbox play` with a touch device uses it even without this
    option. Over a Leap, the profile is a calibration by `sandbox paalm calibrate`; default is
    then this user's own calibration."""

    rest: Annotated[Path | None, Parameter(group=RECONSTRUCTION, metavar="FILE")] = None
    """Rest posture: a file written by `sandbox hand rest`, or a capture of the touching hand.
    With --encoder population it removes the constant difference between this hand and the trained
    hands (docs/playing.md). Default: the rest posture of the profile."""

    surface: Annotated[str | None, Parameter(group=COMMON, metavar="SIZE")] = None
    """Size of the touch surface: 7.76x5.82in, 197x148mm, or a preset such as ipad2."""

    fingers: Annotated[int, Parameter(group=SIMULATED)] = 3
    """Number of fingers that the simulated user touches with, 2 to 5."""

    user: Annotated[Literal["skilled", "idle", "random"], Parameter(group=SIMULATED)] = "skilled"
    """Simulated user. idle and random are control conditions, which should not succeed."""

    drop_outs: Annotated[float, Parameter(group=SIMULATED)] = 0.0
    """Drop-outs per second of each touch on the simulated user's screen. A lost touch returns after
    0.1 s with another id."""

    def __post_init__(self) -> None:
        """Checks nothing: values are checked when they become settings."""


TWICE = ("--device", "--hand", "--hand-size", "--turn", "--user")
"""Options that may be given twice; the second occurrence is for the second hand."""


@dataclass(frozen=True, kw_only=True)
class SecondOptions:
    """Options of a second hand."""

    second_device: Annotated[str | None, Parameter(group=SECOND, metavar="DEVICE")] = None
    """Device of a second hand; web opens a separate page for this hand. A second --device, --hand,
    --hand-size, --turn or --user means the same as --second-device, --second-hand and so on. The
    first hand is at the right, unless it is a left hand and the second hand is a right hand. Tasks
    for two hands always have a second hand."""

    second_hand: Annotated[Literal["right", "left"] | None, Parameter(group=SECOND)] = None
    """Side of the second hand. Default: the opposite of the first hand."""

    second_hand_size: Annotated[float | None, Parameter(group=SECOND, metavar="RATIO")] = None
    """Length of the second hand, as --hand-size. Default: the length of the first hand."""

    second_turn: Annotated[Literal[0, 90, 180, 270] | None, Parameter(group=SECOND)] = None
    """Seat of the second hand's person, as --turn."""

    second_user: Annotated[Literal["skilled", "idle", "random"] | None, Parameter(group=SECOND)] = (
        None
    )
    """Simulated user of the second hand. Default: the same as for the first hand."""

    one_surface: Annotated[bool, Parameter(group=SECOND)] = False
    """Both hands touch one surface; its contacts are divided between them."""


# `--help` lists the options of the last base first.
@dataclass(frozen=True, kw_only=True)
class TrialOptions(SecondOptions, ConditionOptions, SourceOptions):
    """Options of a trial with one or two hands."""

    device_options: Annotated[Mapping[str, Any], Parameter(parse=False)] = field(
        default_factory=dict
    )
    """Given options of the named devices, by the option's name. On a command line each device has
    options of its own (`DeviceEntry.on_command_line`)."""

    seed: Annotated[int | None, Parameter(group=COMMON, metavar="INT")] = None
    """Seed of start, goal and simulated user. Default: the seed of the recording, otherwise 0."""

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


def given_options(options: ConditionOptions) -> frozenset[str]:
    """Names of the options that were given."""
    kind = type(options)
    plain = kind()
    names = (each.name for each in fields(kind) if each.name != "given")
    return frozenset(
        name
        for name in names
        if name in options.given or getattr(options, name) != getattr(plain, name)
    )


def recording_of(device: str) -> Recording | None:
    """The recording that `--device` names; None if it names another device or file.

    Raises:
        InputError: There is no such device and no such file, or the file cannot be read.
    """
    named, path = named_device(device), Path(device)
    if named.argument != device or named.entry.kind.in_air or not is_recording(path):
        return None
    from sandbox.devices.files import read_once

    return read_once(load_recording, path)


def trial_settings(options: TrialOptions, base: Settings | None = None) -> Settings:
    """Resolves options into settings.

    Args:
        options: The options.
        base: Settings that the options change; None starts from the defaults. If the device is a
            recording, its own settings are used instead.

    Raises:
        InputError: An option has an invalid value, or options contradict each other.
    """
    recording = recording_of(options.device)
    chosen = _settings(options, recording, base or Settings())
    settings = _with_second_hand(chosen, options, options.device, recording)
    if recording is None:
        played = recording_of(options.second_device) if options.second_device else None
        settings = _with_hands_in_air(settings, options, played)
    first = _device(options, recording)
    settings = replace(settings, device=first, second_device=_second(options, recording, settings))
    for device in filter(None, (first, settings.second_device)):
        device.check()
    _check_of_devices(options, settings)
    return settings


def _settings(options: TrialOptions, recording: Recording | None, base: Settings) -> Settings:
    variation, size = parse_variation(options.vary)
    if recording is not None and options.vary:
        raise InputError("a recording cannot be varied", where="--vary", got=str(recording.path))
    if recording is not None:
        # A recording has its own task, seed and surface. All other options apply to its touches.
        header, where = recording.header, str(recording.path)
        base = recorded_settings(header)
        base = base.changed(
            task=recorded_task(header, where), encoder=recorded_encoder(header, where)
        )
        changed = task_change(header, base.task, base.seed, base.surface.rectangle)
        for notice in filter(None, (states_difference(header), changed)):
            line = Text(f"{where}: {notice}", style="yellow")
            Console(stderr=True).print(line, soft_wrap=True)
    else:
        base = replace(base, task=options.task)
    base = replace(base, seed=base.seed if options.seed is None else options.seed)
    given = given_options(options)
    names = [each.name for kind in (PipelineSettings, PhysicsSettings) for each in fields(kind)]
    values: dict[str, Any] = {name: getattr(options, name) for name in names if name in given}
    if "impulse" in given:
        values["impulse"] = impulse_limit(options.impulse)
    if options.encoder == "paper" or options.bare:
        values |= PAPER_PIPELINE
    if options.labels == "device":
        values["labels"] = options.labels
    first, *others = base.hands
    if options.profile not in (None, "none"):
        # Measurements and comparisons have no profile.
        from sandbox.trial.profiles import find_profile, uses_touch_profile

        if uses_touch_profile(options):
            first = replace(find_profile(options.profile).hand, in_air=first.in_air)
    first = first.on(options.hand or first.side)
    if values.get("labels", base.pipeline.labels) != "population":
        first = replace(first, layouts=())
    asked: dict[str, Any] = {
        "size": options.hand_size,
        "turn": options.turn,
    }
    first = replace(first, **{name: value for name, value in asked.items() if value is not None})
    if recording is None:
        first = replace(first, size=size * first.size)
        values["variation"] = variation
    if options.rest is not None:
        from encoders.person.rest_posture import load_rest

        first = replace(first, rest=load_rest(options.rest, first.side, first.size))
    elif values.get("encoder", base.pipeline.encoder) != POPULATION:
        # Only the encoder `population` uses the rest posture.
        first = replace(first, rest=())
    values["hands"] = (first, *others)
    if options.surface:
        surface = parse_surface(options.surface)
        values["size_in"] = (surface.width_in, surface.height_in)
    elif (native := named_device(options.device).surface(options.device_options)) is not None:
        values["size_in"] = (native.width_in, native.height_in)
        values["calibrated"] = native.calibrated
    elif kind_of(options.device).guessed_size:
        # TUIO does not transmit a size. Without --surface the size is a guess, and views show this.
        values["calibrated"] = False
    return base.changed(**values)


def _user(options: TrialOptions) -> UserConfiguration:
    if not 2 <= options.fingers <= 5:
        raise InputError(
            "the simulated user touches with 2 to 5 fingers",
            where="--fingers",
            got=options.fingers,
            expected="2 to 5",
        )
    return UserConfiguration(kind=options.user, fingers=options.fingers)


def impulse_limit(text: str) -> float:
    """Returns the impulse limit in N s per 1/60 s.

    Raises:
        InputError: The text is neither a profile nor a positive number.
    """
    if text in IMPULSE_PROFILES:
        return IMPULSE_PROFILES[text]
    try:
        value = float(text)
        if not 0 < value < float("inf"):
            raise ValueError
    except ValueError:
        others = "a positive number of N s per 1/60 s"
        raise unknown_name(
            "not an impulse limit", text, IMPULSE_PROFILES, where="--impulse", others=others
        ) from None
    return value


def _with_second_hand(
    settings: Settings, options: SecondOptions, device: str, recording: Recording | None
) -> Settings:
    """Returns settings with a second hand if the task or the options need one.

    Args:
        settings: Settings with the first hand.
        options: Options of the second hand.
        device: Device of the first hand.
        recording: Recording that the first device plays; the recording may have a second hand of
            its own. None if the first device plays no recording.

    Raises:
        InputError: The options contradict each other.
    """
    asked = {
        "side": options.second_hand,
        "size": options.second_hand_size,
        "turn": options.second_turn,
    }
    given: dict[str, Any] = {name: v for name, v in asked.items() if v is not None}
    if recording is not None and len(settings.hands) > 1:
        return settings
    for_two = _for_two(settings.task)
    wanted = options.second_device is not None or options.one_surface
    if not (for_two or wanted):
        if given or options.second_user:
            raise InputError(
                "an option of a second hand is given, but there is only one hand",
                where="--hand, --hand-size, --turn or --user twice",
                remedy="Give --device twice, or --one-surface",
            )
        return settings
    simulated = (device, options.second_device or "simulated") == ("simulated",) * 2
    if options.one_surface and not simulated and options.second_device is not None:
        raise InputError(
            "with --one-surface, both hands touch one device",
            where="--one-surface",
            got=f"{device} and {options.second_device}",
            remedy="Leave out the second --device",
        )
    if options.one_surface and device == "mouse":
        raise InputError("this device takes only one hand", where="--one-surface", got=device)
    alone = options.second_device is None and not kind_of(device).one_hand
    first = settings.hands[0]
    return settings.changed(
        hands=(first, replace(first.opposite, **given)), shared=options.one_surface or alone
    )


def _for_two(task: str) -> bool:
    """True if a task is for two hands. An unknown task gives False; it is refused later, when it
    is drawn."""
    try:
        return hands_of(find_task(task)) > 1
    except InputError:
        return False


_TOGETHER = {
    Sees.LEAP: "over one Leap",
    Sees.CAMERA: "before one camera",
    Sees.HEADSET: "in one headset",
}
"""Kind of input of a device -> place of two hands that one such device sees."""


def _share_device_in_air(options: TrialOptions) -> bool:
    """True if one device would see both hands in the air, whether or not there is a second hand."""
    kind = kind_of(options.device)
    if not kind.in_air or options.second_device not in (None, options.device):
        return False
    # A simulated headset sees one hand.
    return kind.sees is not Sees.HEADSET or kind.live


def _with_hands_in_air(
    settings: Settings, options: TrialOptions, second_recording: Recording | None
) -> Settings:
    """Returns settings in which each hand in the air has the settings of its 3-D device.

    Args:
        settings: Settings with all hands.
        options: The options.
        second_recording: Recording that the second hand's device plays; None otherwise.

    Raises:
        InputError: A position, a camera or a calibration is unusable; two hands that one device
            sees are of the same side; or only the second hand is in a headset.
    """
    first, *others = settings.hands
    other = options.second_device or options.device
    if others and other == LIVE_HEADSET and options.device != LIVE_HEADSET:
        raise InputError(
            "a headset shows the scene on its own page, so it must be the first hand's device",
            where="--device",
            got=f"{options.device}, {other}",
            expected=f"--device {LIVE_HEADSET} first",
        )
    if is_in_air(options.device):
        if settings.variation.degrades_touches:
            raise InputError("touches can be degraded, hands in the air cannot", where="--vary")
        first = replace(first, in_air=_seen(options, options.device, first.side))
    if not others:
        return replace(settings, hands=(first,))
    second = others[0]
    if _share_device_in_air(options) and first.side == second.side:
        raise InputError(
            f"two hands {_TOGETHER[kind_of(options.device).sees]} must be a right and a left hand",
            where="--hand",
            got=f"two {second.side} hands",
        )
    if second_recording is not None:
        played = recorded_settings(second_recording.header, "hands")
        in_air = played.hands[1 if 1 in second_recording.inputs else 0].in_air
    elif is_in_air(other):
        in_air = _seen(options, other, second.side)
    else:
        return replace(settings, hands=(first, second))
    shared = settings.surface.shared and in_air is None
    return settings.changed(hands=(first, replace(second, in_air=in_air)), shared=shared)


def _seen(options: TrialOptions, device: str, side: str) -> HandInput:
    """Settings of a 3-D device for a hand in the air."""
    given = dict(options.device_options)
    if kind_of(device).sees is Sees.LEAP:
        from sandbox.trial.profiles import chosen_calibration

        given["calibration"] = chosen_calibration(options)
    return seen_hand(device, given, side)


def _device(
    options: TrialOptions, recording: Recording | None = None, hand: int = 0
) -> DeviceSettings:
    """The device that the options of one hand name."""
    if recording is not None:
        return DeviceSettings(
            options.device, PlayedOptions(user=recorded_users(recording.header)[hand])
        )
    given: dict[str, Any] = {**options.device_options, "drop_outs": options.drop_outs}
    given["user"] = _user(options) if kind_of(options.device).simulated else None
    return DeviceSettings.of(options.device, given)


def _second(
    options: TrialOptions, recording: Recording | None, settings: Settings
) -> DeviceSettings | None:
    """The device of the second hand; None if there is one hand, or one device for both hands."""
    if len(settings.hands) == 1:
        return None
    other = options.second_device or ("simulated" if recording is None else options.device)
    if _share_device_in_air(options):
        if not kind_of(options.device).simulated:
            return None
        other = options.device
    elif settings.surface.shared and recording is None and options.device != "simulated":
        return None
    more = replace(options, device=other, user=options.second_user or options.user)
    device = _device(more, recording_of(other), 1)
    return replace(device, options=named_device(other).entry.for_second(device.options))


def _check_of_devices(options: TrialOptions, settings: Settings) -> None:
    """Refuses options whose device the trial does not use.

    Raises:
        InputError: Such an option is given; the error names the devices that have the option.
    """
    devices = [each.name for each in (settings.device, settings.second_device) if each is not None]
    check_device_options(options.device_options, devices)
    if any(kind_of(device).simulated for device in devices):
        return
    for name in sorted({"fingers", "user", "drop_outs", "second_user"} & given_options(options)):
        raise InputError(
            "this option is for simulated users only",
            where="--" + name.replace("_", "-"),
            got=f"--device {' and '.join(devices)}",
            expected="--device simulated",
            remedy="Leave it out",
        )


def with_second_names(argv: Sequence[str]) -> list[str]:
    """Returns the command line with a repeated option of `TWICE` renamed, as to `--second-device`.

    Raises:
        InputError: An option is given three times.
    """
    seen: dict[str, int] = {}
    renamed = []
    for word in argv:
        name, equals, value = word.partition("=")
        if name in TWICE:
            seen[name] = seen.get(name, 0) + 1
            if seen[name] > 2:
                raise InputError(
                    "there are at most two hands",
                    where=name,
                    got="three times",
                    expected="once or twice",
                )
            if seen[name] == 2:
                name = "--second-" + name.removeprefix("--")
        renamed.append(name + equals + value)
    return renamed


def check_names(options: TrialOptions) -> None:
    """Checks the names of task, devices, encoder and robot.

    Raises:
        InputError: A name is unknown.
    """
    find_task(options.task)
    named_device(options.device)
    if options.second_device is not None:
        named_device(options.second_device, "--second-device")
    check_model_name(options.encoder)
    if options.robot:
        # This import reads the mappings of robot hands, which a human hand does not need.
        from models.robot.mapping import find_robot

        find_robot(options.robot)


def check_labels(options: TrialOptions) -> None:
    """Refuses `--labels population` together with `--encoder paper` or `--bare`.

    Only commands call this function. A study may combine a factor `labels` with the level `paper`
    of the factor `encoder`.

    Raises:
        InputError: Both are given.
    """
    what = "--bare" if options.bare else "--encoder paper" if options.encoder == "paper" else ""
    if what and options.labels == "population" and "labels" in given_options(options):
        raise InputError(
            "this option means the paper's labels, so --labels population cannot be used with it",
            where=what,
            got=f"--labels {options.labels}",
            remedy="Leave one of them out. To turn off only correction and smoothing, use "
            "`--no-correction --no-smoothing`",
        )
