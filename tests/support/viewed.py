"""Helpers for tests of views: a real session's snapshots, seen through a real surface."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.scene import Scene
from models.surface import Surface
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.session.messages import ContactView, Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings


@dataclass(frozen=True)
class Viewed:
    """A session's scene and surface, and moments of it.

    Attributes:
        ghost: The hand hovers over the place of two fingers.
        solid: The hand is down, with two fingers beside the box.
    """

    scene: Scene
    surface: Surface
    ghost: Snapshot
    solid: Snapshot


def mouse_session(seed: int = 3) -> tuple[Session, MouseDevice, Surface]:
    """A session that is driven by mouse gestures."""
    devices: list[MouseDevice] = []

    def open_mouse(_task: object, surface: Surface) -> MouseDevice:
        devices.append(MouseDevice(surface))
        return devices[0]

    session = build(Settings(seed=seed), (open_mouse,))
    return session, devices[0], session.rigs[0].reconstructor.surface


def advance(session: Session, seconds: float) -> Snapshot:
    """Goes on for a while of simulated time; gives the last snapshot."""
    end = session.time + seconds
    snapshot = session.advance()
    while session.time < end and not session.over:
        snapshot = session.advance()
    return snapshot


@cache
def viewed() -> Viewed:
    """Made once: nothing that looks at it may change it, which is tested."""
    session, mouse, surface = mouse_session()
    advance(session, 0.1)
    mouse.hand(2, surface.to_surface(session.task.objects[0].position))
    mouse.wheel(4)
    ghost = advance(session, 0.4)
    solid = advance(session, 1.5)
    assert not ghost.hands[0].solid and solid.hands[0].solid
    return Viewed(session.scene, surface, ghost, solid)


def with_contacts(snapshot: Snapshot, *contacts: ContactView) -> Snapshot:
    """The same moment with other contacts, and a hand that is not in their way."""
    hand = replace(snapshot.hands[0], contacts=contacts, solid=frozenset())
    return snapshot.with_hands(hand)


def model_bytes(model: mujoco.MjModel) -> bytes:
    """All of a model."""
    buffer: NDArray[np.uint8] = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return buffer.tobytes()
