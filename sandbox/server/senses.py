"""What a hand feels and how sure its labels are, for a page; read in the session's own thread."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from models.frames import FINGERS
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
    model, data = session.scene.model, session.data
    found = [dict.fromkeys(range(len(FINGERS)), 0.0) for _ in session.rigs]
    if data.ncon:
        owner = {
            model.body(hand.element_name(bone.name)).id: (i, bone.finger)
            for i, hand in enumerate(session.scene.spec.hands)
            for bone in hand.skeleton.bones
        }
        wrench = np.zeros(6)
        pairs = model.geom_bodyid[data.contact.geom]
        for k, pair in enumerate(pairs.tolist()):
            for body in pair:
                if body in owner:
                    i, finger = owner[body]
                    mujoco.mj_contactForce(model, data, k, wrench)
                    found[i][finger] += float(np.linalg.norm(wrench[:3]))
    return [
        HandSense(tuple(forces.values()), reconstruction.probability)
        for forces, reconstruction in zip(found, session.reconstructions, strict=True)
    ]
