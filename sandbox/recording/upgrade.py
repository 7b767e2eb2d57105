"""Upgrade of headers that earlier versions wrote to the form of this version."""

from __future__ import annotations

from typing import Any

Values = dict[str, Any]

_EARLIER: Values = {"contact": "hard", "hand": "right", "hand_size": 1.0, "turn": 0}
"""Values of settings that earlier versions did not have."""

_OF_A_HAND = {"hand": "side", "hand_size": "size", "turn": "turn", "in_air": "in_air"}
"""Current names of the settings of one hand, by their earlier names."""


def upgraded(header: Values) -> Values:
    """The header of a recording, with its settings in the form of this version.

    Until version 0.1 a run's settings were those of its first hand (`hand`, `hand_size`, `turn`,
    `in_air`), with another hand under `second`, whose `shared` was true if both touched one
    surface.

    Args:
        header: The header as it was read; one of this version is returned unchanged.
    """
    settings = header["settings"]
    if not isinstance(settings, dict) or "hands" in settings:
        return header
    settings = _EARLIER | settings
    second = settings.pop("second", None)
    hands = [_hand({name: settings.pop(name) for name in _OF_A_HAND if name in settings})]
    one_surface = False
    if isinstance(second, dict):
        one_surface = bool(second.get("shared"))
        hands.append(_hand({name: value for name, value in second.items() if name != "shared"}))
    return {**header, "settings": {**settings, "hands": hands, "one_surface": one_surface}}


def _hand(earlier: Values) -> Values:
    """The entry of one hand in the current form."""
    return {_OF_A_HAND.get(k, k): v for k, v in earlier.items() if v is not None}
