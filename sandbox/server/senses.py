"""What a hand feels and how sure its labels are, for a page; read in the session's own thread."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from models.frames import FINGERS
from models.scene import Scene
from sandbox.session import Session

NOTHING = (0.0,) * len(FINGERS)


@dataclass(frozen=True)
class HandSense:
    """One hand.

    Attributes:
        forces: N, what each finger's last link presses things with, thumb first.
        probability: How sure the labels are, 0 to 1.
    """

    forces: tuple[float, ...] = NOTHING
    probability: float = 1.0


def senses(session: Session) -> list[HandSense]:
    """Of every hand of a session, now."""
    return [
        HandSense(tuple(forces), reconstruction.probability)
        for forces, reconstruction in zip(
            press(session.scene, session.data), session.reconstructions, strict=True
        )
    ]


def press(scene: Scene, data: mujoco.MjData) -> list[list[float]]:
    """N, what each finger of each hand presses things with, in a state that was just reached."""
    model = scene.model
    found = [[0.0] * len(FINGERS) for _ in scene.spec.hands]
    if not data.ncon:
        return found
    owner = {
        model.body(hand.element_name(bone.name)).id: (i, bone.finger)
        for i, hand in enumerate(scene.spec.hands)
        for bone in hand.skeleton.bones
    }
    wrench = np.zeros(6)
    for k, pair in enumerate(model.geom_bodyid[data.contact.geom].tolist()):
        for i, finger in (owner[body] for body in pair if body in owner):
            mujoco.mj_contactForce(model, data, k, wrench)
            found[i][finger] += float(np.linalg.norm(wrench[:3]))
    return found
