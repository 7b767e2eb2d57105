"""Playing a demonstration back: the same actions give the same states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from models.arithmetic import Array


def first_difference(env: Any, seed: int, actions: Array, hashes: Sequence[str]) -> int | None:
    """Plays an episode's actions and compares every state.

    Args:
        env: The data set's environment.
        seed: Seed of the episode.
        actions: (T, n) actions.
        hashes: (T + 1) hashes of the states.

    Returns:
        Number of steps before the first state that differs; None if all are equal.
    """
    _, info = env.reset(seed=seed)
    if info["state_hash"] != hashes[0]:
        return 0
    for step, (action, expected) in enumerate(zip(actions, hashes[1:], strict=True), start=1):
        *_, info = env.step(action)
        if info["state_hash"] != expected:
            return step
    return None
