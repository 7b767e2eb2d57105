"""How far touches are from where they were a moment ago."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from math import inf

from models.arithmetic.products import distance

_EARLY = 1e-9
"""s, by which a control step may be early: times are sums of periods."""

Places = Mapping[int, tuple[float, float]]
"""(x, y) m on the surface by contact."""


class RecentPlaces:
    """Remembers where contacts were, a moment long.

    Args:
        span: s, the moment.
    """

    def __init__(self, span: float) -> None:
        self._span = span
        self._before: deque[tuple[float, Places]] = deque()

    def reset(self) -> None:
        """Forgets."""
        self._before.clear()

    def step(self, time: float, places: Places) -> float:
        """Farthest, m, that a contact is from where it was a moment ago; infinite where none is
        known that long.

        Args:
            time: s, which never runs backwards.
            places: Where the contacts are now.
        """
        before = self._before
        before.append((time, places))
        while len(before) > 1 and before[1][0] <= time - self._span + _EARLY:
            before.popleft()
        then, first = before[0]
        known = places.keys() & first.keys()
        if then > time - self._span + _EARLY or not known:
            return inf
        return max(distance(first[i], places[i]) for i in known)
