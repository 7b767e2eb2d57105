"""Options of commands that run a scene, and the settings and devices made from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.text import Text

from encoders.person.rest_posture import load_rest
from encoders.regression.trained import POPULATION
from models.errors import InputError
from models.surface import Surface, parse_surface
from sandbox.devices.registry import (
    DEVICES,
    OWN_DEVICE,
    built_in,
    find_device,
    offered_devices,
)
from sandbox.devices.simulated.simulated import NEXT_PERSON, SimulatedDevice
from sandbox.devices.wrappers.degraded import DegradedDevice
from sandbox.options.headset_devices import (
    both_in_one_headset,
    headset_makers,
    is_headset,
    simulated_maker,
    with_headset_hands,
)
from sandbox.options.impulse import impulse_limit
from sandbox.options.leap_calibration import uses_touch_profile
from sandbox.options.leap_devices import (
    LeapOptions,
    both_over_one_device,
    is_leap,
    leap_maker,
    split_by_side,
    with_leap_hands,
)
from sandbox.options.one_hand_options import OneHandOptions
from sandbox.options.profiles import find_profile
from sandbox.options.second_hand import SecondOptions, with_second_hand
from sandbox.options.touch_devices import has_unknown_size, live_maker, native_surface, open_file
from sandbox.options.variations import parse_variation
from sandbox.options.webcam_devices import (
    WebcamOptions,
    both_before_one_camera,
    is_webcam,
    sharing_camera,
    webcam_maker,
    with_webcam_hands,
)
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recorded_task import recorded_task, task_change
from sandbox.recording.recording import Recording, is_recording, load_recording
from sandbox.recording.states import other_states
from sandbox.server.web import WebDevice
from sandbox.session.device import Device
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers, merging, sharing
from sandbox.trial.recorded_settings import recorded_encoder, recorded_settings
from sandbox.trial.settings import RunSettings, bare
from sandbox.trial.surfaces import home
from tasks.task import Task
from tasks.user import UserConfiguration

_PARTS: dict[str, dict[str, Any]] = {
    "correction": {"correction": False},
    "smoothing": {"smoothing": False},
    "arrival": {"arrival": False},
    "ghost": {"ghost_until_clear": False},
    "distal": {"distal_only": False},
    "stitch": {"stitch": False},
    "encoder": {"encode": False},
}


Around = Callable[[DeviceMaker], DeviceMaker]
"""Function that puts something around the device that a maker opens."""

Adjust = Callable[[RunSettings], RunSettings]
"""Function that changes the settings of a run."""


# `--help` lists the options of the last base first: those that most people need.
@dataclass(frozen=True)
class SceneOptions(WebcamOptions, LeapOptions, SecondOptions, OneHandOptions):
    """Options of a scene with one or two hands."""


@dataclass(frozen=True)
class Plan:
    """Settings of a run and makers of its devices, resolved from options.

    Attributes:
        settings: Settings of the run.
        about: Device and simulated user, for the recording's header and the result.
        live: True if a person or another program drives the run, which is then in real time.
        makers: One function for each hand, which opens its device.
    """

    settings: RunSettings
    about: dict[str, Any]
    live: bool
    makers: DeviceMakers


def plan(
    options: SceneOptions, around: Around = lambda make: make, adjust: Adjust = lambda s: s
) -> Plan:
    """Resolves options into settings and makers of devices.

    Args:
        options: The options.
        around: Change of the maker of the first device, beneath all that degrades or shares it.
        adjust: Change of the settings before devices are made for them, as to another task.

    Raises:
        InputError: An option has an invalid value, or options contradict each other.
    """
    recording = _recording(options.device)
    settings = with_second_hand(_settings(options, recording), options, options.device, recording)
    if recording is None:
        played = _recording(options.second_device) if options.second_device else None
        settings = with_webcam_hands(with_leap_hands(settings, options, played), options)
        settings = with_headset_hands(settings, options)
    settings = adjust(settings)
    first = _plan(options, recording, settings, 0, around)
    if len(settings.hands) == 1:
        return first
    (make_first,) = first.makers
    other = options.second_device or ("simulated" if recording is None else options.device)
    more = replace(
        options,
        device=other,
        port=options.port and options.port + 1,
        websocket_port=options.websocket_port and options.websocket_port + 1,
    )
    if options.second_user:
        more = replace(more, user=options.second_user)
    if both_over_one_device(options):
        second = _plan(replace(more, device=options.device), None, settings, 1)
        two = (*first.makers, *second.makers) if "user" in second.about else None
        return replace(first, makers=split_by_side(two, make_first, settings))
    if both_in_one_headset(options):
        return replace(first, makers=headset_makers(len(settings.hands)))
    if both_before_one_camera(options):
        return replace(first, makers=sharing_camera(make_first))
    shared = settings.one_surface and recording is None
    if shared and options.device != "simulated":
        return replace(first, makers=sharing(make_first, settings))
    second = _plan(more, _recording(other), settings, 1)
    makers = (*first.makers, *second.makers)
    about = first.about | {"second": second.about}
    if shared:
        return replace(first, about=about, makers=sharing(merging(makers), settings))
    return replace(first, about=about, live=first.live or second.live, makers=makers)


def check_labels(options: SceneOptions) -> None:
    """Refuses labels by the population beside the paper's own.

    Commands ask this; a study may have a factor `labels` beside a level `paper`.

    Raises:
        InputError: Both are given.
    """
    what = "--bare" if options.bare else "--encoder paper" if options.encoder == "paper" else ""
    if what and options.labels == "population":
        raise InputError(
            "this has the paper's labels, so these cannot be chosen",
            where=what,
            got=f"--labels {options.labels}",
            remedy="Leave one of them out; `--without correction smoothing` keeps labels of ours",
        )


def _plan(
    options: SceneOptions,
    recording: Recording | None,
    settings: RunSettings,
    hand: int,
    around: Around = lambda make: make,
) -> Plan:
    """Resolves the options of one hand."""
    about: dict[str, Any] = {"device": options.device}
    entry = built_in(options.device)
    live = entry is not None and entry.live
    if is_leap(options.device):
        opens = leap_maker(options, settings, _user(options), hand)
    elif is_webcam(options.device):
        opens = webcam_maker(options, settings, hand)
    elif options.device in _OPENERS:
        opens = _OPENERS[options.device](options, settings, hand)
    elif (make := live_maker(options)) is not None:
        opens, live = _on_surface(make), entry is None or entry.live
    elif recording is not None:
        about["user"] = recording.header.get("user")
        opens = _recorded(recording, hand)
    else:
        path = Path(options.device)
        # Errors of the file are reported before anything is built.
        open_file(path, None).device.close()
        opens = _on_surface(lambda surface: open_file(path, surface).device)
    if entry is not None and entry.simulated:
        about["user"] = _user(options).as_json()
        if not entry.in_air:
            about["drop_outs"] = options.drop_outs
    # Only simulated users and 3-D devices have random numbers that differ between hands.
    differs = is_in_air(options.device) or options.device == "simulated"
    return _with_variation(settings, about, live, around(opens), hand if differs else 0)


def is_in_air(device: str) -> bool:
    """True if a device sees hands in the air: a Leap, a camera, a headset, or a file."""
    return is_leap(device) or is_webcam(device) or is_headset(device)


def _on_surface(make: Callable[[Surface], Device]) -> DeviceMaker:
    """Returns a maker of a device that does not depend on the task."""
    return lambda task, surface: make(surface)


def _recorded(recording: Recording, hand: int) -> DeviceMaker:
    """Returns a device that plays one hand of a recording, or its only hand."""
    recorded_hand = hand if hand in recording.inputs else 0
    return lambda task, surface: RecordedDevice(recording, recorded_hand)


def _simulated(options: SceneOptions, settings: RunSettings, hand: int) -> DeviceMaker:
    """Returns a maker of a simulated user's screen."""
    user = _user(options)
    return lambda task, surface: SimulatedDevice(
        task,
        user,
        surface,
        settings.seed,
        settings.labels == "device",
        options.drop_outs,
        settings.hands[hand].person,
        hand,
        home(hand, settings, surface),
    )


def _mouse(options: SceneOptions, settings: RunSettings, hand: int) -> DeviceMaker:
    """Returns a maker of the mouse in the window."""
    from sandbox.devices.mouse import MouseDevice

    return lambda task, surface: MouseDevice(surface, settings.hands[hand].person)


def _web(options: SceneOptions, settings: RunSettings, hand: int) -> DeviceMaker:
    """Returns a maker of the device for touches on the page."""
    return _on_surface(WebDevice)


def _webxr(options: SceneOptions, settings: RunSettings, hand: int) -> DeviceMaker:
    """Returns a maker of the device of a headset's hand."""
    (make,) = headset_makers(1)
    return make


def _webxr_simulated(options: SceneOptions, settings: RunSettings, hand: int) -> DeviceMaker:
    """Returns a maker of the device of a simulated headset."""
    return simulated_maker(settings, _user(options), hand)


_OPENERS: dict[str, Callable[[SceneOptions, RunSettings, int], DeviceMaker]] = {
    "simulated": _simulated,
    "mouse": _mouse,
    "web": _web,
    "webxr": _webxr,
    "webxr-simulated": _webxr_simulated,
}
"""Makers of built-in touch devices that depend on more of the scene than its surface."""


def _with_variation(
    settings: RunSettings, about: dict[str, Any], live: bool, make: DeviceMaker, hand: int = 0
) -> Plan:
    variation = settings.variation
    if not variation.neutral:
        about["variation"] = variation.as_json()

    def open_device(task: Task, surface: Surface) -> Device:
        device = make(task, surface)
        # Recorded touches were degraded when they were recorded.
        if variation.degrades_touches and not isinstance(device, RecordedDevice):
            return DegradedDevice(device, variation, surface, settings.seed + hand * NEXT_PERSON)
        return device

    return Plan(settings, about, live, (open_device,))


def _recording(device: str) -> Recording | None:
    path = Path(device)
    if built_in(device) is not None or is_in_air(device):
        return None
    if not path.exists() and find_device(device) is not None:
        return None
    if not path.exists():
        raise InputError(
            "no such device or file",
            where="--device",
            got=device,
            expected=", ".join([*DEVICES, *offered_devices(), OWN_DEVICE, "or a file"]),
            remedy="`sandbox touches formats` lists the files that play as devices",
        )
    return load_recording(path) if is_recording(path) else None


def _settings(options: SceneOptions, recording: Recording | None) -> RunSettings:
    variation, size = parse_variation(options.vary)
    if recording is not None and options.vary:
        raise InputError("a recording cannot be varied", where="--vary", got=str(recording.path))
    if recording is not None:
        # A recording has its own task, seed and surface; other options apply to its touches.
        header, where = recording.header, str(recording.path)
        base = recorded_settings(header)
        base = replace(
            base,
            task=recorded_task(header, where),
            encoder=recorded_encoder(header, where),
        )
        changed = task_change(header, base.task, base.seed, base.surface)
        for notice in filter(None, (other_states(header), changed)):
            line = Text(f"{where}: {notice}", style="yellow")
            Console(stderr=True).print(line, soft_wrap=True)
    else:
        base = RunSettings(task=options.task)
    base = replace(base, seed=base.seed if options.seed is None else options.seed)
    if recording is not None and _keeps_recorded_settings(options):
        return base
    values: dict[str, Any] = {
        "encoder": options.encoder,
        "servo": options.servo,
        "impulse": impulse_limit(options.impulse),
        "contact": options.contact,
        "robot": options.robot,
    }
    if options.solid is not None:
        values["solid"] = options.solid
    if options.labels is not None:
        values["labels"] = options.labels
    if options.encoder == "paper" or options.bare:
        values = bare(values)
    if options.labels == "device":
        values["labels"] = options.labels
    for part in options.without:
        # The command line knows the parts; a study's design may name any.
        if part not in _PARTS:
            raise InputError(
                "no such part of the pipeline",
                where="without",
                got=part,
                expected=", ".join(_PARTS),
            )
        values |= _PARTS[part]
    first, *others = base.hands
    if uses_touch_profile(options, is_in_air(options.device)):
        first = replace(find_profile(str(options.profile)).hand, in_air=first.in_air)
    first = first.on(options.hand or first.side)
    if values.get("labels", base.labels) != "population":
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
        first = replace(first, rest=load_rest(options.rest, first.side, first.size))
    elif options.encoder != POPULATION:
        # A model of one person knows nothing of others'.
        first = replace(first, rest=())
    values["hands"] = (first, *others)
    if options.surface:
        surface = parse_surface(options.surface)
        values["surface_in"] = (surface.width_in, surface.height_in)
    elif (native := native_surface(options.device)) is not None:
        values["surface_in"] = (native.width_in, native.height_in)
        values["surface_calibrated"] = native.calibrated
    elif has_unknown_size(options.device):
        # TUIO does not transmit a size: without --surface, inches are a guess, and views say so.
        values["surface_calibrated"] = False
    return replace(base, **values)


def _keeps_recorded_settings(options: SceneOptions) -> bool:
    """True if no option changes the run of a recording except its input."""
    plain = SceneOptions()
    pipeline = (
        "encoder",
        "bare",
        "labels",
        "without",
        "impulse",
        "contact",
        "servo",
        "robot",
        "solid",
        "surface",
    )
    person = ("hand", "hand_size", "turn", "profile", "rest")
    return all(getattr(options, k) == getattr(plain, k) for k in (*pipeline, *person))


def _user(options: SceneOptions) -> UserConfiguration:
    if not 2 <= options.fingers <= 5:
        raise InputError(
            "the simulated user touches with 2 to 5 fingers",
            where="--fingers",
            got=options.fingers,
            expected="2 to 5",
        )
    if not 0.0 <= options.drop_outs <= 10.0:
        raise InputError(
            "out of range",
            where="--drop-outs",
            got=options.drop_outs,
            expected="0 to 10 times per second",
        )
    return UserConfiguration(kind=options.user, fingers=options.fingers)
