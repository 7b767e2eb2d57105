"""Rate limits."""

from __future__ import annotations


class Allowance:
    """A token bucket.

    Args:
        rate: Long-term limit, per second.
        burst: Number allowed at once.
        now: s, time at the start.
    """

    def __init__(self, rate: float, burst: float, now: float) -> None:
        self._rate, self._burst = rate, burst
        self._left, self._at = burst, now

    def take(self, now: float) -> bool:
        """True if one more is allowed at a time in seconds."""
        self._left = min(self._burst, self._left + (now - self._at) * self._rate)
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
