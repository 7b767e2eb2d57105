"""Settings of hands in the air: over a Leap, before a camera or in a headset."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from models.errors import InputError
from sandbox.devices.device import Sees
from sandbox.devices.hand_input import HandInput
from sandbox.devices.registry import LIVE_HEADSET, is_in_air, kind_of, seen_hand
from sandbox.options.leap_calibration import chosen_calibration
from sandbox.recording.recording import Recording
from sandbox.trial.settings import Settings, recorded_settings

_TOGETHER = {
    Sees.LEAP: "over one Leap",
    Sees.CAMERA: "before one camera",
    Sees.HEADSET: "in one headset",
}
"""What a device sees -> where two hands are that it sees both."""


def share_device_in_air(options: Any) -> bool:
    """True if two hands, should there be two, are in the air and seen by the same device."""
    kind = kind_of(options.device)
    if not kind.in_air or options.second_device not in (None, options.device):
        return False
    # A simulated headset sees one hand.
    return kind.sees is not Sees.HEADSET or kind.live


def with_hands_in_air(
    settings: Settings, options: Any, second_recording: Recording | None
) -> Settings:
    """Returns settings in which hands in the air are seen by their devices.

    Args:
        settings: Settings with all hands.
        options: `SceneOptions`.
        second_recording: Recording that the second hand's device plays; None otherwise.

    Raises:
        InputError: A position, a camera or a calibration is unusable, both hands over one device
            are of one side, or only the second one is in a headset.
    """
    first, *others = settings.hands
    other = options.second_device or options.device
    if others and other == LIVE_HEADSET and options.device != LIVE_HEADSET:
        raise InputError(
            "a headset shows the scene on its own page, so its hand comes first",
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
    if share_device_in_air(options) and first.side == second.side:
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


def _seen(options: Any, device: str, side: str) -> HandInput:
    """How a device sees a hand in the air."""
    given = {each.name: getattr(options, each.name) for each in fields(options)}
    if kind_of(device).sees is Sees.LEAP:
        given["calibration"] = chosen_calibration(options)
    return seen_hand(device, given, side)
