"""Contact forces and label probability of hands, for a page; read in the session's thread."""

from __future__ import annotations

from dataclasses import dataclass

from models.frames import FINGERS
from sandbox.session.session import Session

NOTHING = (0.0,) * len(FINGERS)


@dataclass(frozen=True)
class HandFeedback:
    """Contact forces and label probability of one hand.

    Attributes:
        forces: N, force of each finger's links on objects, thumb first.
        probability: Probability of the labels, 0 to 1.
    """

    forces: tuple[float, ...] = NOTHING
    probability: float = 1.0


def hand_feedback(session: Session) -> list[HandFeedback]:
    """Current contact forces and label probabilities of all hands of a session."""
    return [
        HandFeedback(tuple(finger.force for finger in load.fingers), reconstruction.probability)
        for load, reconstruction in zip(session.loads(), session.reconstructions, strict=True)
    ]
