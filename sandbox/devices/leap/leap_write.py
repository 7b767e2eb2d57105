"""Writes hand frames as JSON messages of a Leap service, and files of simulated recordings.

Messages have the form of v1, v2 or v3; this is the inverse of `sandbox.devices.leap.leap_json`.
Every frame of a simulated recording also has a key `truth`: `angles` (5 x 4 degrees, see
`encoders.paalm.angles`), `fingers` (id -> 0 to 4) and `open` (true while the hand is held open for
calibration). Playback ignores this key.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from encoders.paalm.palm import vector_of
from encoders.paalm.simulated.forward import LeapTake
from models.errors import RecordingError
from models.frames import HandFrame, TrackedFinger, TrackedHand, Vector
from sandbox.devices.leap.leap_file import LeapRecording

METRES_PER_MM, SECONDS_PER_US = 1e-3, 1e-6


def leap_message(frame: HandFrame, number: int) -> dict[str, Any]:
    """Returns the message that a Leap service would send for a frame.

    Fingers with joints have the fields of v2, and of v3 if that is the frame's dialect. Fingers
    without joints have the fields of v1.

    Args:
        frame: The hand frame.
        number: Id of the frame.
    """
    return {
        "id": number,
        "timestamp": round(frame.time / SECONDS_PER_US),
        "hands": [_hand(h) for h in frame.hands],
        "pointables": [_pointable(h, f, frame.dialect) for h in frame.hands for f in h.fingers],
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


def _pointable(hand: TrackedHand, finger: TrackedFinger, dialect: str | None) -> dict[str, Any]:
    record: dict[str, Any] = {
        "id": finger.id,
        "handId": hand.id,
        "tool": False,
        "tipPosition": _place(finger.tip),
        "direction": _axes(finger.direction),
        "length": finger.length / METRES_PER_MM,
    }
    if finger.joints is not None:
        mcp, pip, dip, end = finger.joints
        record |= {"mcpPosition": _place(mcp), "pipPosition": _place(pip)}
        record |= {"dipPosition": _place(dip), "type": finger.finger}
        record["btipPosition"] = _place(end)
        if dialect == "v3":
            record |= {"bases": _bases(hand, finger.joints)}
            record |= {"stabilizedTipPosition": _place(finger.tip)}
            record |= {"touchDistance": 1.0, "touchZone": "none"}
    if finger.extended is not None:
        record["extended"] = finger.extended
    return record


def _bases(hand: TrackedHand, joints: Sequence[Vector]) -> list[list[list[float]]]:
    """Returns the axes of a finger's four bones, from the palm outwards.

    z points against the bone, y to the back of the hand. The bone in the palm has the palm's axes.
    A bone of length 0 has the axes of the previous bone.
    """
    dorsal, back = -np.array(hand.normal), -np.array(hand.direction)
    bases = []
    for bone in (None, *np.diff(joints, axis=0)):
        size = 0.0 if bone is None else float(np.linalg.norm(bone))
        z = back if bone is None or size < 1e-9 else -bone / size
        x = np.cross(dorsal, z)
        x /= max(float(np.linalg.norm(x)), 1e-9)
        dorsal, back = np.cross(z, x), z
        bases.append([[round(c, 6) for c in _axes(vector_of(axis))] for axis in (x, dorsal, z)])
    return bases


def _axes(v: Vector) -> list[float]:
    return [v[0], v[2], -v[1]]


def _place(v: Vector) -> list[float]:
    return [c / METRES_PER_MM for c in _axes(v)]


GENERATOR = "Hand Sandbox: SIMULATED, no device saw this hand"


def write_take(take: LeapTake, path: Path, made_from: dict[str, Any]) -> None:
    """Writes a take as a LeapJS recording.

    Raises:
        RecordingError: The file cannot be written.
    """
    frames = [
        leap_message(frame, number)
        | {
            "truth": {
                "angles": np.round(angles, 4).tolist(),
                "fingers": {str(i): f for i, f in fingers.items()},
                "open": bool(held),
            }
        }
        for number, (frame, fingers, angles, held) in enumerate(
            zip(take.frames, take.fingers, take.angles, take.open, strict=True), start=1
        )
    ]
    metadata = {
        "generatedBy": GENERATOR,
        "protocolVersion": 6,
        "frames": len(frames),
        "side": take.side,
        "dialect": take.dialect,
        **made_from,
    }
    try:
        with path.open("w", encoding="utf-8") as file:
            json.dump({"metadata": metadata, "frames": frames}, file, separators=(",", ":"))
    except OSError as error:
        raise RecordingError(
            f"the recording cannot be written: {error}", where=str(path)
        ) from error


def take_with_truth(recording: LeapRecording, where: str) -> LeapTake | None:
    """Returns the take of a simulated recording; None for a recording without ground truth.

    Raises:
        RecordingError: The ground truth is damaged.
    """
    if recording.metadata.get("generatedBy") != GENERATOR:
        return None
    try:
        truths = [m["truth"] for m in recording.messages]
        if len(truths) != len(recording.frames):
            raise ValueError("some of its frames cannot be used")
        angles = np.array([t["angles"] for t in truths], float)
        if angles.shape[1:] != (5, 4) or not np.isfinite(angles).all():
            raise ValueError("angles must be 5 x 4 finite numbers")
        fingers = tuple({int(i): int(f) for i, f in t["fingers"].items()} for t in truths)
        is_open = np.array([bool(t["open"]) for t in truths])
        side, dialect = recording.metadata["side"], recording.metadata["dialect"]
        if side not in ("right", "left") or dialect not in ("v1", "v3"):
            raise ValueError("side or dialect is unknown")
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise RecordingError(
            f"the ground truth of this recording is damaged: {error}",
            where=where,
            remedy="Make the recording again with `sandbox devices leap simulate`",
        ) from error
    return LeapTake(recording.frames, fingers, angles, is_open, side, dialect)
