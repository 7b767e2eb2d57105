"""Devices that tests register by a name: one of touches and one of hands in the air."""

from __future__ import annotations

from collections.abc import Sequence

from models.frames import Contact, HandFrame, TouchFrame
from models.surface import Surface
from sandbox.devices.device import (
    DeviceEntry,
    DeviceKind,
    HandDevice,
    NoOptions,
    Sees,
    Source,
    TouchDevice,
)
from sandbox.devices.hand_input import HandInput


class Pad(TouchDevice):
    """A pad with a finger on its middle, which is read for 0.2 s. Tests have it."""

    def poll(self, now: float) -> Sequence[TouchFrame]:
        self.finished = now > 0.2
        x, y = (0.5 * self.surface.size).tolist()
        return [TouchFrame(now, tuple(Contact(i, x, y) for i in range(int(self.argument or 1))))]


class Camera(HandDevice):
    """A camera that sees no hand for 0.2 s."""

    finished = False

    def __init__(self, surface: Surface, argument: str) -> None:
        self.argument = argument

    def poll(self, now: float) -> Sequence[HandFrame]:
        self.finished = now > 0.2
        return [HandFrame(now)]


PAD = DeviceEntry(
    "a pad with a finger on its middle, which is read for 0.2 s",
    lambda options, place: Pad(place.surface, place.argument),
    NoOptions,
    DeviceKind(source=Source.FILE),
    argument="FINGERS",
)

CAMERA = DeviceEntry(
    "a camera that sees no hand for 0.2 s",
    lambda options, place: Camera(place.surface, place.argument),
    NoOptions,
    DeviceKind(Sees.LEAP, Source.FILE, in_scene=True),
    argument="SIDE",
    hand_input=lambda options, argument, side: HandInput(),
)
