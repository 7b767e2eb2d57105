"""The simulated user's eye: the screen, seen with a reaction delay."""

from __future__ import annotations

from collections import deque

from tasks.user import Sight


class Eye:
    """Returns the screen's content of a reaction time ago.

    Args:
        delay: s between the appearance on the screen and the user's reaction.
    """

    def __init__(self, delay: float) -> None:
        self.delay = delay
        self._seen: deque[Sight] = deque()

    def look(self, sight: Sight) -> None:
        """Stores the current content of the screen."""
        self._seen.append(sight)

    def at(self, now: float) -> Sight | None:
        """The newest sight old enough for a reaction; None before the first."""
        while len(self._seen) > 1 and self._seen[1].time <= now - self.delay + 1e-9:
            self._seen.popleft()
        if self._seen and self._seen[0].time <= now - self.delay + 1e-9:
            return self._seen[0]
        return None
