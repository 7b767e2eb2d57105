"""Recent lift-offs: contacts that have just left help to label new ones.

When one finger leaves and another comes, two contacts that never touched together belong to one
posture: the new finger lands beside the place of the old one, which has not gone far. So the place
    of a lifted contact is remembered, and shifted with the contacts that stayed, until these have
    moved too far for it to be informative.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from models.arithmetic.arrays import Array

REACH = 0.02
"""m, root mean square movement of the contacts that stayed, after which a lifted one is forgotten.
An assumption: about the distance of two neighbouring fingertips. Time does not count, since
knowledge about a hand at rest stays valid."""

AT_ONCE = 0.05
"""Probability that a contact which comes in the same frame in which another leaves is the same
finger. An assumption: a finger cannot do so, but devices sometimes give a contact another id."""

LATER = 0.3
"""The same probability for a contact that comes later. An assumption: fingers tap, but they also
take turns."""


@dataclass(frozen=True)
class LiftOff:
    """A contact that was lifted recently.

    Attributes:
        place: (2,) m on the surface, its last place, shifted with the contacts that stayed.
        looked: (2,) m, its place when the layout was last evaluated.
        since: Positions (2,) m of the contacts that stayed, by id, at the time when it left.
        just: True if it has left since the last frame.
    """

    place: Array
    looked: Array
    since: Mapping[int, Array]
    just: bool = True

    def carried(self, shift: Array) -> LiftOff:
        """The lift-off, shifted with the others by (2,) m."""
        return replace(self, place=self.place + shift, just=False)

    def seen(self) -> LiftOff:
        """The lift-off after another evaluation of the layout."""
        return replace(self, looked=self.place)

    def remembered(self, now: Mapping[int, Array]) -> bool:
        """True if its place is still informative, given the contacts' current positions."""
        ways = [now[i] - place for i, place in self.since.items() if i in now]
        return bool(ways) and float(np.mean(np.square(ways).sum(axis=1))) <= REACH**2


def that_fit(lifted: Mapping[int, LiftOff], room: int) -> Mapping[int, LiftOff]:
    """Chooses the lift-offs that can all be other fingers than those that touch.

    Args:
        lifted: Recent lift-offs, under any keys.
        room: Number of fingers that do not touch.
    """
    if len(lifted) > room:
        lifted = {key: contact for key, contact in lifted.items() if contact.just}
    return lifted if len(lifted) <= room else {}
