"""Files of a SIMULATED session with both devices, and its ground truth."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from encoders.captures.overhead.simulated import OverheadPictures
from encoders.captures.paired.simulated import PairedSession
from encoders.store import save_capture
from sandbox.devices.files.paired_capture import PairedCaptureWriter
from sandbox.devices.webcam.landmarks import header_record, message_of

TRUTH, DEVICES = "truth.npz", "truth.json"


def write_simulated(session: PairedSession, folder: Path, subject: str) -> None:
    """Writes a session and its ground truth."""
    about = {
        "side": session.side,
        "subject": subject,
        "simulated": True,
        "touches": "simulated tablet",
        "hands": f"simulated Leap, {session.leap.dialect}",
    }
    with PairedCaptureWriter(folder, session.surface, about) as writer:
        for frame, host in zip(session.touches, session.touch_arrived.tolist(), strict=True):
            writer.touch(frame, round(host, 6))
        for seen, host in zip(session.leap.frames, session.leap_arrived.tolist(), strict=True):
            writer.hand(seen, round(host, 6))
    truth = {
        "simulated": True,
        "offset_s": session.offset,
        "touch_delay_s": session.touch_delay,
        "device_axes": session.rotation.tolist(),
        "device_at_m": session.shift.tolist(),
    }
    save_capture(session.truth, folder / TRUTH)
    (folder / DEVICES).write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


def write_simulated_camera(
    session: PairedSession,
    pictures: OverheadPictures,
    folder: Path,
    subject: str,
    corners: bool = False,
) -> None:
    """Writes a session under a camera and its ground truth.

    Args:
        session: The person.
        pictures: What the camera's page said.
        folder: Folder to create.
        subject: Pseudonym.
        corners: True if the tablet's corners were marked.
    """
    camera = pictures.configuration.camera
    about: dict[str, Any] = {
        "side": session.side,
        "subject": subject,
        "simulated": True,
        "touches": "simulated tablet",
        "hands": "simulated camera",
        "fov": camera.view,
    }
    marked = pictures.corners.round(2).tolist()
    if corners:
        about["corners"] = marked
    with PairedCaptureWriter(folder, session.surface, about, header_record(camera)) as writer:
        for frame, host in zip(session.touches, session.touch_arrived.tolist(), strict=True):
            writer.touch(frame, round(host, 6))
        for seen, host in zip(pictures.frames, pictures.arrived.tolist(), strict=True):
            writer.picture(message_of(seen), round(host, 6))
    truth = {
        "simulated": True,
        "offset_s": pictures.configuration.latency - session.touch_delay,
        "touch_delay_s": session.touch_delay,
        "corners_px": marked,
        "fingers": {str(id_): finger for id_, finger in session.labels.items()},
    }
    save_capture(session.truth, folder / TRUTH)
    (folder / DEVICES).write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
