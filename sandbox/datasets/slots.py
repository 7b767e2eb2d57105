"""Recorded touches as actions: every touch keeps one slot, that of its finger where it can."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from models.arithmetic import Array
from models.frames import FINGERS, Contact

SLOTS = len(FINGERS)


@dataclass
class Touch:
    """One touch from its beginning to its end.

    Attributes:
        number: Its place in the list of all touches of a hand.
        first: Control period in which it begins.
        places: (x, y) m on the surface, period by period.
        finger: Its finger, if the device said it or once it is found out; None otherwise.
    """

    number: int
    first: int
    places: list[tuple[float, float]] = field(default_factory=list)
    finger: int | None = None

    @property
    def end(self) -> int:
        """The control period after its last one."""
        return self.first + len(self.places)


def touches_of(frames: Sequence[Sequence[Contact]]) -> list[Touch]:
    """All touches of a hand, in the order in which they begin.

    A slot is empty for one period at least between two touches, or they would be one. With more
    than five at a time, a touch begins as soon as there is a slot for it, or is left out.

    Args:
        frames: The contacts of every control period.
    """
    touches: list[Touch] = []
    here: dict[int, Touch] = {}
    for period, contacts in enumerate(frames):
        known = {contact.id: contact for contact in contacts}
        # Slots that have just become empty are not free yet.
        busy = len(here)
        here = {id: touch for id, touch in here.items() if id in known}
        for id, contact in known.items():
            if id not in here:
                if busy >= SLOTS:
                    continue
                busy += 1
                here[id] = Touch(len(touches), period, finger=contact.label)
                touches.append(here[id])
            here[id].places.append((contact.x, contact.y))
    return touches


def slots_of(touches: Sequence[Touch]) -> list[int]:
    """A slot for every touch: that of its finger if it is free, and another one otherwise."""
    free_from = [0] * SLOTS
    slots = []
    for touch in touches:
        free = [slot for slot in range(SLOTS) if free_from[slot] <= touch.first]
        slot = touch.finger if touch.finger in free else _last_choice(free, touches, touch)
        # Empty for one period in between.
        free_from[slot] = touch.end + 1
        slots.append(slot)
    return slots


def _last_choice(free: Sequence[int], touches: Sequence[Touch], touch: Touch) -> int:
    """A free slot, of a finger that no touch of the same time has if there is one."""
    beside = {t.finger for t in touches if t.first < touch.end and touch.first <= t.end}
    return next((slot for slot in free if slot not in beside), free[0])


def actions_of(
    touches: Sequence[Touch], slots: Sequence[int], lifts: Sequence[float] | None, periods: int
) -> Array:
    """Actions (periods, 15) of `TouchHands`, or (periods, 16) with a lift control.

    Args:
        touches: The touches of a hand.
        slots: The slot of each.
        lifts: Position of the lift control in every period; None where there is none.
        periods: Number of control periods.
    """
    actions = np.zeros((periods, 3 * SLOTS + (lifts is not None)))
    for touch, slot in zip(touches, slots, strict=True):
        places = touch.places[: max(0, periods - touch.first)]
        if places:
            rows = slice(touch.first, touch.first + len(places))
            actions[rows, 3 * slot] = 1.0
            actions[rows, 3 * slot + 1 : 3 * slot + 3] = places
    if lifts is not None:
        actions[:, -1] = lifts[:periods]
    return actions


def labelled(touches: Sequence[Touch], found: Mapping[int, int]) -> list[Touch]:
    """The touches with the fingers that were found, by the touch's number."""
    return [Touch(t.number, t.first, t.places, found.get(t.number, t.finger)) for t in touches]
