"""What is on the screen, seen some time late."""

from __future__ import annotations

from collections import deque

from tasks.user import Sight


class Eye:
    """Shows what was on the screen a while ago.

    Args:
        delay: s between a thing's being on the screen and an action because of it.
    """

    def __init__(self, delay: float) -> None:
        self.delay = delay
        self._seen: deque[Sight] = deque()

    def look(self, sight: Sight) -> None:
        """Takes in what is on the screen now."""
        self._seen.append(sight)

    def at(self, now: float) -> Sight | None:
        """The newest thing seen that has had time to be acted upon; None before the first."""
        while len(self._seen) > 1 and self._seen[1].time <= now - self.delay + 1e-9:
            self._seen.popleft()
        if self._seen and self._seen[0].time <= now - self.delay + 1e-9:
            return self._seen[0]
        return None
