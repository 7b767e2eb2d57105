"""A hand turns solid outside of things only, and a person is told what keeps it a ghost."""

from __future__ import annotations

import pytest

from sandbox.session import Session
from sandbox.solidity import STUCK, STUCK_TIME
from tests.scripted import box_xy, pinch, run, scripted

INTO_THE_BOX, BESIDE_IT = 0.03, 0.09
"""m between thumb and fingers; the box is 50 mm wide."""


def grip(gap: float, contact: str = "hard", until: float = 99.0) -> Session:
    """A hand over the box, its fingers so far apart; beside it after `until` s."""
    empty = scripted(lambda now: (), seed=1)
    at = box_xy(empty)
    empty.close()
    touch = pinch(at, lambda now: gap if now < until else BESIDE_IT)
    return scripted(touch, seed=1, contact=contact)


def test_a_finger_that_stays_inside_a_thing_keeps_the_hand_a_ghost_and_the_person_is_told() -> None:
    session = grip(INTO_THE_BOX)
    run(session, STUCK_TIME / 2)
    assert not session.snapshot().notice
    run(session, STUCK_TIME + 0.5)
    now = session.snapshot()
    assert now.hands[0].phase == "down" and not now.hands[0].solid
    assert now.notice == STUCK


def test_who_opens_the_hand_has_a_solid_one_and_is_told_no_more() -> None:
    session = grip(INTO_THE_BOX, until=2.5)
    run(session, 2.4)
    assert session.snapshot().notice == STUCK
    run(session, 1.0)
    assert session.snapshot().hands[0].solid
    assert not session.snapshot().notice


@pytest.mark.parametrize(("gap", "contact"), [(BESIDE_IT, "hard"), (INTO_THE_BOX, "none")])
def test_a_hand_beside_things_or_one_that_wants_to_pass_through_is_told_nothing(
    gap: float, contact: str
) -> None:
    session = grip(gap, contact)
    for _ in range(5):
        run(session, 0.5)
        assert not session.snapshot().notice
