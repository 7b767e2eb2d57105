"""Hands that a headset sees: their settings, and how the device is opened."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from models.errors import InputError
from sandbox.devices.kinds import LIVE_HEADSET as LIVE
from sandbox.devices.kinds import is_headset
from sandbox.trial.hand_input import HandInput
from sandbox.trial.settings import Settings


def both_in_one_headset(options: Any) -> bool:
    """True if two hands, should there be two, are seen by the same headset."""
    return options.device == LIVE and options.second_device in (None, LIVE)


def with_headset_hands(settings: Settings, options: Any) -> Settings:
    """Returns settings whose hands are solved from joints where a headset sees them.

    Args:
        settings: Settings with all hands.
        options: Options with `device` and `second_device`.

    Raises:
        InputError: Both hands are of one side, or only the second one is in a headset.
    """
    first, *others = settings.hands
    other = options.second_device or options.device
    if others and other == LIVE and options.device != LIVE:
        raise InputError(
            "a headset shows the scene on its own page, so its hand comes first",
            where="--device",
            got=f"{options.device}, {other}",
            expected=f"--device {LIVE} first",
        )
    seen = HandInput(at=(0.0, 0.0, 0.0), joints=True)
    if is_headset(options.device):
        if settings.variation.degrades_touches:
            raise InputError("touches can be degraded, hands in the air cannot", where="--vary")
        first = replace(first, in_air=seen)
    if others and is_headset(other):
        if both_in_one_headset(options) and first.side == others[0].side:
            raise InputError(
                "two hands in one headset must be a right and a left hand",
                where="--hand",
                got=f"two {first.side} hands",
            )
        others = [replace(others[0], in_air=seen)]
        settings = settings.changed(shared=False)
    return replace(settings, hands=(first, *others))
