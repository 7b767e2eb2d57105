"""Contact forces, grips and label probability of hands, for a page; read in its session."""

from __future__ import annotations

from dataclasses import dataclass

from models.frames import FINGERS
from sandbox.session.session import Session

NOTHING = (0.0,) * len(FINGERS)


@dataclass(frozen=True)
class HandFeedback:
    """Contact forces, grip and label probability of one hand.

    Attributes:
        forces: N, force of each finger's links on objects, thumb first.
        probability: Probability of the labels, 0 to 1.
        stored: N, force that the grip stores in each finger (`FingerLoad.stored`).
        full: Labels of the fingers that touch objects while a servo of their own or of the palm
            gives all the force that it may.
    """

    forces: tuple[float, ...] = NOTHING
    probability: float = 1.0
    stored: tuple[float, ...] = NOTHING
    full: frozenset[int] = frozenset()


def hand_feedback(session: Session) -> list[HandFeedback]:
    """Current contact forces, grips and label probabilities of all hands of a session."""
    return [
        HandFeedback(
            tuple(finger.force for finger in load.fingers),
            reconstruction.probability,
            tuple(finger.stored for finger in load.fingers),
            load.full,
        )
        for load, reconstruction in zip(session.loads(), session.reconstructions, strict=True)
    ]
