"""Settings of a recording, and the encoder that it was made with, built in or from elsewhere."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from encoders.regression.registry import find_encoder
from models.errors import InputError, RecordingError
from models.plugins import how_to_get, place_of
from sandbox.recording.states import STATES, states_of
from sandbox.trial.settings import RunSettings


def recorded_settings(header: dict[str, Any], *names: str) -> RunSettings:
    """The settings of a recording, to read it or to play its touches as a device.

    Of a recording with other `STATES`, settings that this program lacks are left out, and those
    that it did not name have their defaults; whoever calls this reports `other_states`.

    Args:
        header: Header of the recording.
        names: Settings that are needed; none stands for all. Others have their defaults.

    Raises:
        RecordingError: A setting is missing, unknown or of the wrong type.
        InputError: A value is not allowed.
    """
    values = header["settings"]
    if states_of(header) != STATES and isinstance(values, dict):
        wanted = names or [field.name for field in fields(RunSettings)]
        known = {name: values[name] for name in wanted if name in values}
        values = RunSettings().as_json() | known
    return RunSettings.from_json(values)


def recorded_encoder(header: dict[str, Any], where: str) -> str:
    """The name under which a recording's encoder can be loaded on this machine.

    Args:
        header: Header of the recording.
        where: The recording, for error messages.

    Raises:
        RecordingError: The encoder is not on this machine; the error names what to install.
    """
    name = str(header["settings"]["encoder"])
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
