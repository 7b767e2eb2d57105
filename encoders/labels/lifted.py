"""Contacts that have just left: while the others stand still, they say where a finger is not.

When one finger leaves and another comes, two contacts that never touched together belong to one
posture: the new finger lands beside the place of the old one, which has not gone far. So a contact
that left is remembered where it was, carried along with the contacts that stayed, until these have
moved too far for that place to mean anything.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REACH = 0.02
"""m, root mean square way of the contacts that stayed, after which one that left is forgotten. An
assumption: about the distance of two neighbouring fingertips. No clock is asked, for what is known
of a hand at rest does not age."""

AT_ONCE = 0.05
"""Probability that a contact that comes in the very moment in which another leaves is the same
finger. An assumption: a finger cannot do so, but devices sometimes give a contact another id."""

LATER = 0.3
"""The same of one that comes later. An assumption: fingers tap, but they also take turns."""


@dataclass(frozen=True)
class Lifted:
    """A contact that has left.

    Attributes:
        place: (2,) m on the surface, where it would be had it moved with those that stayed.
        looked: (2,) m, where it was when the labels were last judged by the layout.
        since: Contact id -> (2,) m, where those that stayed were when it left.
        just: It has left since the last look at the surface.
    """

    place: Array
    looked: Array
    since: Mapping[int, Array]
    just: bool = True

    def carried(self, shift: Array) -> Lifted:
        """The contact after the others have moved by (2,) m."""
        return replace(self, place=self.place + shift, just=False)

    def seen(self) -> Lifted:
        """The contact after another look at the layout."""
        return replace(self, looked=self.place)

    def remembered(self, now: Mapping[int, Array]) -> bool:
        """Whether its place still means something, given contacts' places now."""
        ways = [now[i] - place for i, place in self.since.items() if i in now]
        return bool(ways) and float(np.mean(np.square(ways).sum(axis=1))) <= REACH**2


def that_fit(lifted: Mapping[int, Lifted], room: int) -> Mapping[int, Lifted]:
    """Lifted contacts that can all be other fingers than those that touch.

    Args:
        lifted: Contacts that have left, under any keys.
        room: How many fingers do not touch.
    """
    if len(lifted) > room:
        lifted = {key: contact for key, contact in lifted.items() if contact.just}
    return lifted if len(lifted) <= room else {}
