"""Contact forces and label probability of hands, for a page; read in the session's thread."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.frames import FINGERS
from models.scene import Scene
from sandbox.session.session import Session

NOTHING = (0.0,) * len(FINGERS)


@dataclass(frozen=True)
class HandFeedback:
    """Contact forces and label probability of one hand.

    Attributes:
        forces: N, force of each finger's last link on objects, thumb first.
        probability: Probability of the labels, 0 to 1.
    """

    forces: tuple[float, ...] = NOTHING
    probability: float = 1.0


def hand_feedback(session: Session) -> list[HandFeedback]:
    """Current contact forces and label probabilities of all hands of a session."""
    return [
        HandFeedback(tuple(forces), reconstruction.probability)
        for forces, reconstruction in zip(
            contact_forces(session.scene, session.data), session.reconstructions, strict=True
        )
    ]


def contact_forces(scene: Scene, data: mujoco.MjData) -> list[list[float]]:
    """N, force of each finger of each hand on objects, in the current state."""
    model = scene.model
    forces = [[0.0] * len(FINGERS) for _ in scene.spec.hands]
    if not data.ncon:
        return forces
    owner = _owners(scene)
    wrench = np.zeros(6)
    for k, pair in enumerate(owner[data.contact.geom].tolist()):
        for i, finger in (divmod(part, len(FINGERS)) for part in pair if part >= 0):
            mujoco.mj_contactForce(model, data, k, wrench)
            forces[i][finger] += float(np.linalg.norm(wrench[:3]))
    return forces


_OWNERS: WeakKeyDictionary[Scene, NDArray[np.int64]] = WeakKeyDictionary()


def _owners(scene: Scene) -> NDArray[np.int64]:
    """(geoms,) owner of each geom, 5 times the hand plus the finger; -1 without an owner.

    Computed once per scene, as looking up names sixty times a second would be too slow.
    """
    if scene not in _OWNERS:
        bodies = np.full(scene.model.nbody, -1)
        for i, hand in enumerate(scene.spec.hands):
            for link in hand.links:
                bodies[scene.model.body(link.body).id] = len(FINGERS) * i + link.finger
        _OWNERS[scene] = bodies[scene.model.geom_bodyid]
    return _OWNERS[scene]
