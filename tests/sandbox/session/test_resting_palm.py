"""A palm beside a grip pushes nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.frames import Contact
from sandbox.session.session import Session
from tests.support.scripted import scripted

GRIP = ((0.060, 0.090), (0.090, 0.055), (0.110, 0.055))
PALM = (0.12, 0.135)


def touched(now: float, sized: bool = True, palm: bool = True) -> list[Contact]:
    """A grip, and a palm that grows beside it once the hand is down; noisy sizes."""
    rng = np.random.default_rng(round(1e6 * now))
    contacts = [Contact(i, x, y, extent=(0.011, 0.009)) for i, (x, y) in enumerate(GRIP)]
    if palm and now > 1.0:
        size = 0.012 + 0.033 * min((now - 1.0) / 0.3, 1.0)
        width, height = (size * rng.normal(1.0, 0.1, 2)).tolist()
        contacts.append(Contact(9, *PALM, extent=(width, height)))
    return contacts if sized else [replace(c, extent=None) for c in contacts]


def played(session: Session, seconds: float = 2.0) -> str:
    while session.time < seconds:
        session.advance()
    return session.state_hash


def test_a_palm_changes_nothing_of_what_its_hand_does() -> None:
    with_palm, without = (
        scripted(touched, seed=3),
        scripted(lambda t: touched(t, palm=False), seed=3),
    )
    assert played(with_palm) == played(without)
    states = {c.id: c.state for c in with_palm.snapshot().hands[0].contacts}
    assert states == {0: "active", 1: "active", 2: "active", 9: "palm"}
    unsized = scripted(lambda t: touched(t, sized=False), seed=3)
    assert played(unsized) != with_palm.state_hash, "without sizes it is a finger"
