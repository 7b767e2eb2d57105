"""Conversion of a `HandFrame` to a Leap JSON message, v1 or with joints (v3).

It is the inverse of `sandbox.devices.leap.leap_json`.
"""

from __future__ import annotations

from typing import Any

from models.frames import HandFrame, TrackedFinger, TrackedHand, Vector
from sandbox.devices.leap.leap_json import METRES_PER_MM, SECONDS_PER_US


def leap_message(frame: HandFrame, number: int) -> dict[str, Any]:
    """The message that a Leap service would send; v3 if the fingers have joints, else v1.

    Args:
        frame: The hand frame.
        number: Id of the frame.
    """
    return {
        "id": number,
        "timestamp": round(frame.time / SECONDS_PER_US),
        "hands": [_hand(h) for h in frame.hands],
        "pointables": [_pointable(h, f) for h in frame.hands for f in h.fingers],
    }


def _hand(hand: TrackedHand) -> dict[str, Any]:
    record: dict[str, Any] = {
        "id": hand.id,
        "palmPosition": _place(hand.palm),
        "palmNormal": _axes(hand.normal),
        "direction": _axes(hand.direction),
    }
    if hand.sphere_radius is not None:
        record["sphereRadius"] = hand.sphere_radius / METRES_PER_MM
    if hand.side is not None:
        record |= {"type": hand.side, "confidence": hand.confidence}
    if hand.wrist is not None:
        record["wrist"] = _place(hand.wrist)
    return record


def _pointable(hand: TrackedHand, finger: TrackedFinger) -> dict[str, Any]:
    record: dict[str, Any] = {
        "id": finger.id,
        "handId": hand.id,
        "tool": False,
        "tipPosition": _place(finger.tip),
        "direction": _axes(finger.direction),
        "length": finger.length / METRES_PER_MM,
    }
    if finger.joints is not None:
        mcp, pip, dip, _ = finger.joints
        record |= {"mcpPosition": _place(mcp), "pipPosition": _place(pip)}
        record |= {"dipPosition": _place(dip), "type": finger.finger}
    if finger.extended is not None:
        record["extended"] = finger.extended
    return record


def _axes(v: Vector) -> list[float]:
    return [v[0], v[2], -v[1]]


def _place(v: Vector) -> list[float]:
    return [c / METRES_PER_MM for c in _axes(v)]
