"""Files of simulated Leap recordings, which contain the true angles and fingers.

In addition to the fields of a service, every frame has a key `truth`: `angles` (5 x 4 degrees, see
`encoders.paalm.angles`), `fingers` (id -> 0 to 4) and `open` (true while the hand is held open for
calibration). Playback ignores it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from encoders.paalm.simulated.forward import LeapTake
from models.errors import RecordingError
from sandbox.devices.leap.leap_file import LeapRecording
from sandbox.devices.leap.leap_write import leap_message

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
        raise RecordingError(f"it cannot be written: {error}", where=str(path)) from error


def take_with_truth(recording: LeapRecording, where: str) -> LeapTake | None:
    """The take of a simulated recording; None for a recording without the truth.

    Raises:
        RecordingError: The truth is damaged.
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
        raise RecordingError(f"its truth is damaged: {error}", where=where) from error
    return LeapTake(recording.frames, fingers, angles, is_open, side, dialect)
