"""Headings of `--help`: what most people need comes first, what one device needs if it is named."""

from __future__ import annotations

from cyclopts import Group

COMMON = Group.create_ordered("Common options")
OUTPUT = Group.create_ordered("Output")
PERSON = Group.create_ordered("Hand of the person")
RECONSTRUCTION = Group.create_ordered("Labels and reconstruction")
PHYSICS = Group.create_ordered("Physics and robots")
SIMULATED = Group.create_ordered("Simulated user, and harder trials")
SECOND = Group.create_ordered("Second hand")
PAGE = Group.create_ordered("Page")
TUIO = Group.create_ordered("Device tuio")
EVDEV = Group.create_ordered("Device evdev")
LEAP = Group.create_ordered("Device leap, and its recordings")
WEBCAM = Group.create_ordered("Device webcam")

OF_SETTINGS = {
    "PipelineSettings": RECONSTRUCTION,
    "PhysicsSettings": PHYSICS,
    "TuioOptions": TUIO,
    "EvdevOptions": EVDEV,
    "LeapOptions": LEAP,
    "OverLeapOptions": LEAP,
    "BeforeCameraOptions": WEBCAM,
}
"""Class of settings, or of a device's options -> heading of the options that its fields are."""
COMMON_SETTINGS = ("encoder",)
"""Fields of these classes that most people need."""

OF_DEVICES = {"tuio": TUIO, "evdev": EVDEV, "leap": LEAP, "webcam": WEBCAM}
"""Device -> heading of the options that only it needs. `--help` has them if the device is named."""
