"""Options of commands that run a scene, and the settings and devices made from them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

from rich.console import Console
from rich.text import Text

from encoders.regression.trained import POPULATION
from models.errors import InputError
from models.surface import parse_surface
from sandbox.devices.device import PlayedOptions
from sandbox.devices.leap import LeapCommandOptions
from sandbox.devices.registry import DeviceSettings, is_in_air, kind_of, named_device
from sandbox.devices.webcam import BeforeCameraOptions
from sandbox.options.hands_in_air import share_device_in_air, with_hands_in_air
from sandbox.options.impulse import impulse_limit
from sandbox.options.one_hand_options import OneHandOptions, given_options
from sandbox.options.second_hand import SecondOptions, with_second_hand
from sandbox.options.variations import parse_variation
from sandbox.recording.recorded_task import recorded_task, task_change
from sandbox.recording.recording import Recording
from sandbox.recording.versions import other_states
from sandbox.trial.open_devices import recording_of
from sandbox.trial.settings import (
    PAPER_PIPELINE,
    PhysicsSettings,
    PipelineSettings,
    Settings,
    recorded_encoder,
    recorded_settings,
    recorded_users,
)
from tasks.user import UserConfiguration


# `--help` lists the options of the last base first: those that most people need.
@dataclass(frozen=True, kw_only=True)
class SceneOptions(BeforeCameraOptions, LeapCommandOptions, SecondOptions, OneHandOptions):
    """Options of a scene with one or two hands."""


def scene_settings(options: SceneOptions, base: Settings | None = None) -> Settings:
    """Resolves options into settings.

    Args:
        options: The options.
        base: Settings that the options change; None has the defaults. A recording that is played
            has its own.

    Raises:
        InputError: An option has an invalid value, or options contradict each other.
    """
    recording = recording_of(options.device)
    chosen = _settings(options, recording, base or Settings())
    settings = with_second_hand(chosen, options, options.device, recording)
    if recording is None:
        played = recording_of(options.second_device) if options.second_device else None
        settings = with_hands_in_air(settings, options, played)
    first = _device(options, recording)
    settings = replace(settings, device=first, second_device=_second(options, recording, settings))
    for device in filter(None, (first, settings.second_device)):
        device.check()
    return settings


def _device(
    options: SceneOptions, recording: Recording | None = None, hand: int = 0
) -> DeviceSettings:
    """The device that the options of one hand name."""
    if recording is not None:
        return DeviceSettings(options.device, PlayedOptions(recorded_users(recording.header)[hand]))
    given = {each.name: getattr(options, each.name) for each in fields(SceneOptions)}
    given["user"] = _user(options) if kind_of(options.device).simulated else None
    return DeviceSettings.of(options.device, given)


def _second(
    options: SceneOptions, recording: Recording | None, settings: Settings
) -> DeviceSettings | None:
    """The device of the second hand; None where there is one hand, or one device for both."""
    if len(settings.hands) == 1:
        return None
    other = options.second_device or ("simulated" if recording is None else options.device)
    if share_device_in_air(options):
        if not kind_of(options.device).simulated:
            return None
        other = options.device
    elif settings.surface.shared and recording is None and options.device != "simulated":
        return None
    more = replace(
        options,
        device=other,
        # A second sender of TUIO comes to the next ports.
        port=options.port and options.port + 1,
        websocket_port=options.websocket_port and options.websocket_port + 1,
        user=options.second_user or options.user,
    )
    return _device(more, recording_of(other), 1)


def check_labels(options: SceneOptions) -> None:
    """Refuses labels by the population beside the paper's own.

    Commands ask this; a study may have a factor `labels` beside a level `paper`.

    Raises:
        InputError: Both are given.
    """
    what = "--bare" if options.bare else "--encoder paper" if options.encoder == "paper" else ""
    if what and options.labels == "population" and "labels" in given_options(options):
        raise InputError(
            "this has the paper's labels, so these cannot be chosen",
            where=what,
            got=f"--labels {options.labels}",
            remedy="Leave one of them out; `--no-correction --no-smoothing` keeps labels of ours",
        )


def _settings(options: SceneOptions, recording: Recording | None, base: Settings) -> Settings:
    variation, size = parse_variation(options.vary)
    if recording is not None and options.vary:
        raise InputError("a recording cannot be varied", where="--vary", got=str(recording.path))
    if recording is not None:
        # A recording has its own task, seed and surface; other options apply to its touches.
        header, where = recording.header, str(recording.path)
        base = recorded_settings(header)
        base = base.changed(
            task=recorded_task(header, where), encoder=recorded_encoder(header, where)
        )
        changed = task_change(header, base.task, base.seed, base.surface.rectangle)
        for notice in filter(None, (other_states(header), changed)):
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
        from sandbox.options.leap_calibration import uses_touch_profile
        from sandbox.options.profiles import find_profile

        if uses_touch_profile(options, is_in_air(options.device)):
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
        # A model of one person knows nothing of others'.
        first = replace(first, rest=())
    values["hands"] = (first, *others)
    if options.surface:
        surface = parse_surface(options.surface)
        values["size_in"] = (surface.width_in, surface.height_in)
    elif (native := named_device(options.device).surface()) is not None:
        values["size_in"] = (native.width_in, native.height_in)
        values["calibrated"] = native.calibrated
    elif kind_of(options.device).guessed_size:
        # TUIO does not transmit a size: without --surface, inches are a guess, and views say so.
        values["calibrated"] = False
    return base.changed(**values)


def _user(options: SceneOptions) -> UserConfiguration:
    if not 2 <= options.fingers <= 5:
        raise InputError(
            "the simulated user touches with 2 to 5 fingers",
            where="--fingers",
            got=options.fingers,
            expected="2 to 5",
        )
    return UserConfiguration(kind=options.user, fingers=options.fingers)
