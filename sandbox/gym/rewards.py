"""Rewards of an agent, step by step."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from models.arithmetic import Array
from sandbox.session.messages import Snapshot

REACH = 0.2
"""Share of an episode's reward that bringing fingertips to objects can earn."""
NEAR = 0.10
"""m, distance at which a fingertip has earned about a third of it."""
TIPS = 3
"""Number of fingertips that count, the nearest ones."""


class Reward:
    """Reward of one episode.

    Of every choice the sum is bounded: success gives 1, `progress` what the task's progress grew by
    (0 to 1), and `reach` besides that at most `REACH` for the way of the three nearest fingertips
    to the nearest object. Going back costs what coming gave.

    Args:
        kind: One of `sandbox.gym.options.REWARDS`.
        snapshot: The beginning of the episode.
        progress: The task's progress then.
    """

    def __init__(self, kind: str, snapshot: Snapshot, progress: float) -> None:
        self._kind, self._won = kind, snapshot.score.success
        self._last = self._earned(snapshot, progress)

    def step(self, snapshot: Snapshot) -> float:
        """Reward of the control period that ended with a snapshot."""
        earned = self._earned(snapshot, snapshot.score.progress)
        gained = earned - self._last
        self._last = earned
        won, self._won = snapshot.score.success and not self._won, snapshot.score.success
        return gained + float(won)

    def _earned(self, snapshot: Snapshot, progress: float) -> float:
        return _EARNED[self._kind](snapshot, progress)


def reached(snapshot: Snapshot) -> float:
    """How near the three nearest fingertips are to the nearest object, 0 to 1."""
    return max(
        (
            _near(hand.tips, thing.position)
            for hand in snapshot.hands
            for thing in snapshot.objects.values()
        ),
        default=0.0,
    )


def _near(tips: Array, thing: Array) -> float:
    off = np.sqrt(np.sum((tips - thing) ** 2, axis=1))
    return float(np.mean(np.exp(-np.sort(off)[:TIPS] / NEAR)))


_EARNED: dict[str, Callable[[Snapshot, float], float]] = {
    "reach": lambda snapshot, progress: progress + REACH * reached(snapshot),
    "progress": lambda snapshot, progress: progress,
    "sparse": lambda snapshot, progress: 0.0,
}
