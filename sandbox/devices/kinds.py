"""What a device sees: touches, or hands in the air over a Leap, before a camera, in a headset."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path

from sandbox.devices.registry import built_in

LIVE_LEAP, LIVE_WEBCAM, LIVE_HEADSET = "leap", "webcam", "webxr"
"""Devices of persons whose hands are in the air."""
LEAP_SUFFIXES = (".json", ".lz")
"""Suffixes of Leap recordings, which no recording of touches has; others are recognised by
content."""


class DeviceKind(StrEnum):
    """What a device sees."""

    TOUCHES = "touches"
    LEAP = "leap"
    CAMERA = "camera"
    HEADSET = "headset"


def kind_of(device: str) -> DeviceKind:
    """What a device sees, by its name or by the content of its file."""
    entry = built_in(device)
    if entry is not None:
        if not entry.in_air:
            return DeviceKind.TOUCHES
        if entry.camera:
            return DeviceKind.CAMERA
        return DeviceKind.HEADSET if entry.headset else DeviceKind.LEAP
    path = Path(device)
    if not path.is_file():
        return DeviceKind.TOUCHES
    # Readers of files are not needed for devices.
    from sandbox.devices.leap.leap_file import is_leap_recording
    from sandbox.devices.webcam.landmark_file import is_landmark_file

    if is_landmark_file(path):
        return DeviceKind.CAMERA
    leap = path.suffix in LEAP_SUFFIXES or is_leap_recording(path)
    return DeviceKind.LEAP if leap else DeviceKind.TOUCHES


def is_leap(device: str) -> bool:
    """True if a device is a Leap: `leap`, `leap-simulated`, or a Leap recording."""
    return kind_of(device) is DeviceKind.LEAP


def is_webcam(device: str) -> bool:
    """True if a device is a camera or a recording of landmarks."""
    return kind_of(device) is DeviceKind.CAMERA


def is_headset(device: str) -> bool:
    """True if a device is a headset, or a simulated one."""
    return kind_of(device) is DeviceKind.HEADSET


def is_in_air(device: str) -> bool:
    """True if a device sees hands in the air: a Leap, a camera, a headset, or a file."""
    return kind_of(device) is not DeviceKind.TOUCHES
