"""Conversion of frames of all kinds to JSON values and back, exact to the bit."""

from __future__ import annotations

from typing import Any

from models.frames import (
    Contact,
    Frame,
    HandFrame,
    LandmarkFrame,
    SeenHand,
    TouchFrame,
    TrackedFinger,
    TrackedHand,
    Vector,
)


def frame_to_json(frame: Frame) -> dict[str, Any]:
    """Converts a frame to JSON values; Python writes floats so that they are read back exactly."""
    if isinstance(frame, HandFrame):
        line: dict[str, Any] = {"time": frame.time, "hands": [_hand(h) for h in frame.hands]}
        told = {"source": frame.source, "dialect": frame.dialect}
        return line | {name: value for name, value in told.items() if value}
    if isinstance(frame, LandmarkFrame):
        return {
            "time": frame.time,
            "taken": frame.taken,
            "size": frame.size,
            "seen": [[h.side, h.score, h.image, h.world] for h in frame.hands],
            **({"source": frame.source} if frame.source else {}),
        }
    contacts = [[c.id, c.x, c.y, c.size, c.label, *(c.extent or ())] for c in frame.contacts]
    line = {"time": frame.time, "contacts": contacts}
    if frame.lift is not None:
        line["lift"] = frame.lift
    if frame.cancelled:
        line["cancelled"] = sorted(frame.cancelled)
    return line


def frame_from_json(line: dict[str, Any]) -> Frame:
    """Reads a frame from JSON values.

    Raises:
        FrameError: Its numbers are not valid for a frame.
        KeyError, TypeError, ValueError: The values are damaged.
    """
    if "hands" in line:
        hands = tuple(map(_read_hand, line["hands"]))
        dialect = line.get("dialect")
        return HandFrame(
            float(line["time"]),
            hands,
            str(line.get("source", "")),
            None if dialect is None else str(dialect),
        )
    if "seen" in line:
        width, height = line["size"]
        return LandmarkFrame(
            float(line["time"]),
            tuple(_read_seen(*hand) for hand in line["seen"]),
            (int(width), int(height)),
            float(line["taken"]),
            str(line.get("source", "")),
        )
    contacts = tuple(
        Contact(int(i), x, y, size, label, _extent(extent))
        for i, x, y, size, label, *extent in line["contacts"]
    )
    return TouchFrame(
        float(line["time"]), contacts, line.get("lift"), frozenset(line.get("cancelled", ()))
    )


def _extent(values: list[Any]) -> tuple[float, float] | None:
    """Width and height of a contact; contacts without them end with the label."""
    if not values:
        return None
    width, height = values
    return float(width), float(height)


def _hand(hand: TrackedHand) -> dict[str, Any]:
    values: dict[str, Any] = {
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
        values["confidence"] = hand.confidence
    for name in ("side", "sphere_radius", "wrist"):
        if getattr(hand, name) is not None:
            values[name] = getattr(hand, name)
    return values


def _read_hand(values: dict[str, Any]) -> TrackedHand:
    fingers = []
    for id_, tip, direction, length, finger, joints, extended in values["fingers"]:
        if joints is not None:
            mcp, pip, dip, end = map(_vector, joints)
            joints = (mcp, pip, dip, end)
        fingers.append(
            TrackedFinger(
                int(id_), _vector(tip), _vector(direction), float(length), finger, joints, extended
            )
        )
    wrist, radius = values.get("wrist"), values.get("sphere_radius")
    return TrackedHand(
        int(values["id"]),
        _vector(values["palm"]),
        _vector(values["normal"]),
        _vector(values["direction"]),
        tuple(fingers),
        values.get("side"),
        float(values.get("confidence", 1.0)),
        None if radius is None else float(radius),
        None if wrist is None else _vector(wrist),
    )


def _read_seen(side: Any, score: Any, image: Any, world: Any) -> SeenHand:
    points = tuple((float(x), float(y)) for x, y in image)
    return SeenHand(str(side), float(score), points, tuple(map(_vector, world)))


def _vector(values: Any) -> Vector:
    x, y, z = values
    return float(x), float(y), float(z)
