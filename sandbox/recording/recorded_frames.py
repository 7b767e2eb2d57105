"""Frames as JSON values and back, exact to the bit: touches, and 3-D hands."""

from __future__ import annotations

from typing import Any

from models.frames import Contact, Frame, HandFrame, TouchFrame, TrackedFinger, TrackedHand, Vector


def frame_to_json(frame: Frame) -> dict[str, Any]:
    """A frame as JSON values; Python writes floats so that they are read back as they were."""
    if isinstance(frame, HandFrame):
        line: dict[str, Any] = {"time": frame.time, "hands": [_hand(h) for h in frame.hands]}
        return line | ({"source": frame.source} if frame.source else {})
    contacts = [[c.id, c.x, c.y, c.size, c.label] for c in frame.contacts]
    line = {"time": frame.time, "contacts": contacts}
    if frame.lift is not None:
        line["lift"] = frame.lift
    if frame.cancelled:
        line["cancelled"] = sorted(frame.cancelled)
    return line


def frame_from_json(line: dict[str, Any]) -> Frame:
    """A frame read back.

    Raises:
        FrameError: Its numbers are those of no frame.
        KeyError, TypeError, ValueError: It is damaged.
    """
    if "hands" in line:
        hands = tuple(map(_read_hand, line["hands"]))
        return HandFrame(float(line["time"]), hands, str(line.get("source", "")))
    contacts = tuple(
        Contact(int(i), x, y, size, label) for i, x, y, size, label in line["contacts"]
    )
    return TouchFrame(
        float(line["time"]), contacts, line.get("lift"), frozenset(line.get("cancelled", ()))
    )


def _hand(hand: TrackedHand) -> dict[str, Any]:
    found: dict[str, Any] = {
        "id": hand.id,
        "palm": hand.palm,
        "normal": hand.normal,
        "direction": hand.direction,
        "fingers": [
            [f.id, f.tip, f.direction, f.length, f.finger, f.joints, f.extended]
            for f in hand.fingers
        ],
    }
    if hand.confidence != 1.0:
        found["confidence"] = hand.confidence
    for name in ("side", "sphere_radius", "wrist"):
        if getattr(hand, name) is not None:
            found[name] = getattr(hand, name)
    return found


def _read_hand(found: dict[str, Any]) -> TrackedHand:
    fingers = []
    for id_, tip, direction, length, finger, joints, extended in found["fingers"]:
        if joints is not None:
            mcp, pip, dip, end = map(_vector, joints)
            joints = (mcp, pip, dip, end)
        fingers.append(
            TrackedFinger(
                int(id_), _vector(tip), _vector(direction), float(length), finger, joints, extended
            )
        )
    wrist, radius = found.get("wrist"), found.get("sphere_radius")
    return TrackedHand(
        int(found["id"]),
        _vector(found["palm"]),
        _vector(found["normal"]),
        _vector(found["direction"]),
        tuple(fingers),
        found.get("side"),
        float(found.get("confidence", 1.0)),
        None if radius is None else float(radius),
        None if wrist is None else _vector(wrist),
    )


def _vector(values: Any) -> Vector:
    x, y, z = values
    return float(x), float(y), float(z)
