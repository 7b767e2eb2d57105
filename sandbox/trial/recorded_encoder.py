"""Finds the encoder that a recording was made with, built in or from elsewhere."""

from __future__ import annotations

from typing import Any

from encoders.regression.registry import find_encoder
from models.errors import InputError, RecordingError
from models.outside import how_to_get, place_of


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
