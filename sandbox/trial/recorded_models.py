"""Finds the models that a recording was made with: built in, of an earlier release, or foreign."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from encoders.kept import PREFIX, kept_models
from encoders.regression.model_registry import MODELS
from encoders.regression.registry import find_encoder
from models.errors import InputError, RecordingError
from models.outside import how_to_get, place_of
from sandbox.trial.assembly import digests
from sandbox.trial.settings import RunSettings


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


def with_kept_models(settings: RunSettings, header: dict[str, Any]) -> RunSettings:
    """The settings with the models that a recording's header names by digest, as far as kept.

    Args:
        settings: Settings of the recording; models of other names, and files, are left alone.
        header: Header of the recording.

    Raises:
        EncoderError: The index of kept models is damaged.
    """
    there, kept = header.get("digests"), kept_models()
    if not isinstance(there, dict) or not kept:
        return settings
    here = digests(settings)
    encoder, labels = there.get("encoder"), there.get("labels")
    if settings.encoder in MODELS and encoder != here["encoder"] and encoder in kept:
        settings = replace(settings, encoder=f"{PREFIX}{encoder}")
    if labels != here["labels"] and labels in kept:
        settings = replace(settings, kept_names=str(labels))
    return settings
