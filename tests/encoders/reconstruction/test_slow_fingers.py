"""Fingers that come down slowly, one after another, on a hand that is down already."""

from __future__ import annotations

from itertools import permutations

import pytest

from encoders.reconstruction.hand_motion import Phase
from models.frames import Contact, TouchFrame
from tests.encoders.reconstruction.test_palms import DT, FINGERS, reconstructor

GAP = 0.6
"""s between two fingers; a hand is down within that time."""
ORDERS = [
    order for number, order in enumerate(permutations(range(len(FINGERS)))) if number % 7 == 0
]


@pytest.mark.parametrize("order", ORDERS)
def test_five_fingers_have_their_labels_in_whatever_order_they_came_down(
    order: tuple[int, ...],
) -> None:
    hand, phases = reconstructor(), set()
    for step in range(int((len(order) + 1) * GAP / DT)):
        time = step * DT
        down = order[: int(time / GAP)]
        contacts = tuple(Contact(finger, *FINGERS[finger]) for finger in down)
        found = hand.step(TouchFrame(time, contacts))
        if len(down) == 1:
            phases.add(found.phase)
    assert Phase.DOWN in phases
    assert {c.id: c.label for c in found.contacts} == {f: f for f in range(len(FINGERS))}
