"""Finds the encoder of a recording again, which may be somebody else's."""

from __future__ import annotations

from typing import Any

from encoders.regression.registry import find_encoder
from models.errors import InputError, RecordingError
from models.outside import how_to_get, place_of


def recorded_encoder(header: dict[str, Any], where: str) -> str:
    """The name of a recording's encoder here: its own, or the place that the header tells.

    Args:
        header: Of the recording.
        where: The recording, for messages.

    Raises:
        RecordingError: The encoder is not on this machine; says what to install.
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
