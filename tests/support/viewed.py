"""Helpers for tests of views: a real session's snapshots, seen through a real surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.frames import FINGERS, Contact
from models.scene import Scene
from models.surface import Surface
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.session.messages import FingerLoad, HandLoad, Snapshot
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


def contact_at(
    surface: Surface,
    id: int,
    place: NDArray[np.float64],
    label: int | None = None,
    state: str = "active",
    probability: float = 1.0,
) -> Contact:
    """The contact under a place (3,) in the world."""
    x, y = surface.to_surface(place).tolist()
    return Contact(id, x, y, label=label, state=state, probability=probability)


def with_contacts(snapshot: Snapshot, *contacts: Contact) -> Snapshot:
    """The same moment with other contacts, and a hand that is not in their way."""
    hand = replace(snapshot.hands[0], contacts=contacts, solid=frozenset())
    return snapshot.with_hands(hand)


def with_load(
    snapshot: Snapshot,
    force: Sequence[float] = (0.0,) * len(FINGERS),
    stored: Sequence[float] = (0.0,) * len(FINGERS),
    used: Sequence[float] = (0.0,) * len(FINGERS),
) -> Snapshot:
    """The same moment of one hand, whose fingers, thumb first, press with forces in N.

    Args:
        snapshot: The moment.
        force: N, of all contacts of each finger.
        stored: N, the part of it that a grip stores.
        used: Share of the servos' limit.
    """
    fingers = [FingerLoad(f, f, 0.0, u, s) for f, s, u in zip(force, stored, used, strict=True)]
    return replace(snapshot, see_loads=lambda: (HandLoad(tuple(fingers), 0.0),))


def model_bytes(model: mujoco.MjModel) -> bytes:
    """All of a model."""
    buffer: NDArray[np.uint8] = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return buffer.tobytes()
