"""Counts of the server's refusals and losses, by reason; shown at the end of a session."""

from __future__ import annotations

import threading
from collections import Counter


class Counters:
    """Counts by reason; safe from all threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._counts: Counter[str] = Counter()

    def add(self, reason: str, n: int = 1) -> None:
        """Adds to the count of a reason."""
        with self._lock:
            self._counts[reason] += n

    def __getitem__(self, reason: str) -> int:
        with self._lock:
            return self._counts[reason]

    def as_dict(self) -> dict[str, int]:
        """A copy, most frequent first."""
        with self._lock:
            return dict(self._counts.most_common())
