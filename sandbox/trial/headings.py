"""Headings of `--help`: what most people need comes first, what one device needs if it is named."""

from __future__ import annotations

from functools import cache

from cyclopts import Group

COMMON = Group.create_ordered("Common options")
OUTPUT = Group.create_ordered("Output")
PERSON = Group.create_ordered("Hand of the person")
RECONSTRUCTION = Group.create_ordered("Labels and reconstruction")
PHYSICS = Group.create_ordered("Physics and robots")
SIMULATED = Group.create_ordered("Simulated user, and harder trials")
SECOND = Group.create_ordered("Second hand")
PAGE = Group.create_ordered("Page")


@cache
def device_heading(device: str) -> Group:
    """The heading of the options of a device, by its name."""
    return Group.create_ordered(f"Device {device}")


OF_SETTINGS = {
    "PipelineSettings": RECONSTRUCTION,
    "PhysicsSettings": PHYSICS,
}
"""Class of settings -> heading of the options that its fields are."""
COMMON_SETTINGS = ("encoder",)
"""Fields of these classes that most people need."""
