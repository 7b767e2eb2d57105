"""Settings of a recording, and the encoder that it was made with, built in or from elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import msgspec

from encoders.regression.registry import find_encoder
from models.errors import InputError, RecordingError
from models.plugins import how_to_get, place_of
from sandbox.devices.registry import device_options
from sandbox.recording.states import STATES, states_of
from sandbox.trial.settings import (
    GROUPS,
    HandSettings,
    Settings,
    decoded,
    encoded,
    group_of,
    is_allowed,
)
from tasks.user import UserConfiguration


def recorded_settings(header: Mapping[str, Any], *names: str) -> Settings:
    """The settings of a recording.

    Of a recording with other `STATES`, settings and values that this program lacks are left out,
    and those that it did not name have their defaults; whoever calls this reports `other_states`.

    Args:
        header: Header of the recording.
        names: Fields and groups of `Settings` that are needed; none stands for all. Of a recording
            with other `STATES`, the rest have their defaults.

    Raises:
        RecordingError: A setting is missing, unknown or of the wrong type.
        InputError: A value is not allowed.
    """
    values = header["settings"]
    if isinstance(values, Mapping) and not values.keys() & GROUPS.keys():
        values = _grouped(values, header)
    if states_of(header) != STATES and isinstance(values, Mapping):
        needed = names or values.keys()
        known = {name: value for name, value in values.items() if name in needed}
        for group in GROUPS.keys() & known.keys():
            known[group] = {k: v for k, v in known[group].items() if is_allowed(group, k, v)}
        values = _laid_over(encoded(Settings()), known)
    return decoded(values)


def recorded_users(header: Mapping[str, Any]) -> tuple[UserConfiguration | None, ...]:
    """The simulated users who drove the devices of a recording, by hand; None for a person."""
    made = recorded_settings(header, "hands", "device", "second_device")
    return made.device.user, made.device_of(1).user


def _grouped(flat: Mapping[str, Any], header: Mapping[str, Any]) -> dict[str, Any]:
    """Settings in groups, of a header whose settings stand beside each other.

    What such a header leaves out has its default; what this program lacks stays, to be refused. The
    devices stand beside the settings there.
    """
    values = encoded(Settings())
    second = header.get("second")
    values["device"] = _device(header)
    values["second_device"] = _device(second) if isinstance(second, Mapping) else None
    for name, value in flat.items():
        new = _RENAMED.get(name, name)
        try:
            group = group_of(new)
        except InputError:
            values[name] = value
            continue
        if group:
            values[group][new] = value
        elif new == "hands" and isinstance(value, list):
            values[new] = [_laid_over(_HAND, hand, all_of_it=True) for hand in value]
        else:
            values[new] = value
    return values


def _device(beside: Mapping[str, Any]) -> dict[str, Any]:
    """The device of a header without groups, with the options that it has."""
    name = str(beside.get("device", "simulated"))
    options: dict[str, Any] = {}
    for each in fields(device_options(name)):
        value = beside.get(each.name)
        if each.name == "user" and isinstance(value, Mapping):
            known = {field.name for field in fields(UserConfiguration)}
            options["user"] = {k: v for k, v in value.items() if k in known}
        elif value is not None:
            options[each.name] = value
    return {"name": name, "options": options}


_RENAMED = {
    "surface_in": "size_in",
    "surface_calibrated": "calibrated",
    "surface_scale": "scale",
    "one_surface": "shared",
}
"""Names of settings in headers without groups -> their names now."""

_HAND = msgspec.to_builtins(HandSettings())


def _laid_over(
    base: Mapping[str, Any], over: Mapping[str, Any], all_of_it: bool = False
) -> dict[str, Any]:
    """Values with others laid over them, of which unknown ones are left out.

    Args:
        base: The values.
        over: The others.
        all_of_it: Unknown ones are taken, too.
    """
    values = dict(base)
    for name, value in over.items():
        if name not in base and not all_of_it:
            continue
        inner = values.get(name)
        if name == "hands" and isinstance(value, list):
            values[name] = [_laid_over(_HAND, hand) for hand in value]
        elif isinstance(inner, Mapping) and isinstance(value, Mapping) and name != "options":
            values[name] = _laid_over(inner, value)
        else:
            values[name] = value
    return values


def recorded_encoder(header: Mapping[str, Any], where: str) -> str:
    """The name under which a recording's encoder can be loaded on this machine.

    Args:
        header: Header of the recording.
        where: The recording, for error messages.

    Raises:
        RecordingError: The encoder is not on this machine; the error names what to install.
    """
    name = recorded_settings(header, "pipeline").pipeline.encoder
    source = header.get("encoder_from")
    if not isinstance(source, dict):
        return name
    place = place_of(source)
    try:
        find_encoder(place)
    except InputError as error:
        raise RecordingError(
            "its encoder is not on this machine",
            where=where,
            got=str(error),
            expected=f"{name} from {place}",
            remedy=how_to_get(source),
        ) from error
    return place
