"""A session whose touches a test chooses, and devices that do as they are told."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from models.frames import Contact, TouchFrame
from sandbox.devices.device import Device, HandDevice
from sandbox.session.session import Recorder, Session
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings

Touch = Callable[[float], Sequence[Contact]]


class Script(Device):
    """A device that touches as it is told: time -> contacts."""

    name = "script"
    finished = False

    def __init__(self, touch: Touch = lambda now: ()) -> None:
        self.touch = touch

    def poll(self, now: float) -> list[TouchFrame]:
        return [TouchFrame(now, tuple(self.touch(now)))]

    def close(self) -> None:
        pass


class Played(Device):
    """A device that gives frames, of touches or of hands, as their times come."""

    name = "played"

    def __init__(self, frames: Sequence[Any]) -> None:
        self._frames = list(frames)

    @property
    def finished(self) -> bool:
        return not self._frames

    def poll(self, now: float) -> list[Any]:
        due = [f for f in self._frames if f.time <= now]
        del self._frames[: len(due)]
        return due

    def close(self) -> None:
        self._frames = []


class PlayedHands(Played, HandDevice):
    """The same for a device that sees hands."""


def scripted(touch: Touch, recorder: Recorder | None = None, **settings: Any) -> Session:
    return build(Settings().changed(**settings), (lambda task, surface: Script(touch),), recorder)


def box_xy(session: Session) -> np.ndarray:
    """(2,) m, where on the surface the box is."""
    surface = session.rigs[0].reconstructor.surface
    return surface.to_surface(session.scene.object_pose(session.data, "box")[0])


def run(session: Session, seconds: float) -> None:
    for _ in range(round(seconds / 0.016)):
        session.advance()


def pinch(
    at: np.ndarray, gap: Callable[[float], float], yaw: float = 0.0, shift: float = 0.0
) -> Touch:
    """Thumb and index on either side of a place (2,), their touches `gap` metres apart."""
    along = np.array([np.cos(yaw), -np.sin(yaw)])

    def touch(now: float) -> list[Contact]:
        half = gap(now) / 2 * along
        left, right = at - half, at + half + shift
        return [
            Contact(1, float(left[0]), float(left[1]), label=0),
            Contact(2, float(right[0]), float(right[1]), label=1),
        ]

    return touch
