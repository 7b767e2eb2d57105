"""What a person sees of a session. A simulated user gets this, some time late, and nothing else."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.later import Later
from models.objects import Thing
from tasks.task import Goal

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SeenObject:
    """An object on the screen: its shape, position (3,) m and rotation (3, 3)."""

    shape: Thing
    position: Array
    rotation: Array

    @property
    def yaw(self) -> float:
        """rad about the vertical."""
        return float(np.arctan2(self.rotation[1, 0], self.rotation[0, 0]))

    @property
    def upright(self) -> bool:
        """Whether it stands on one of its faces, as far as one sees."""
        return bool(np.max(np.abs(self.rotation[2])) > np.cos(np.deg2rad(8.0)))


@dataclass(frozen=True)
class Sight(Later):
    """One moment on the screen.

    Attributes:
        time: s.
        tips: Places (3,) m of the drawn fingertips that carry a finger's name, by contact id.
        solid: The hand is drawn opaque.
        objects: By name.
        goals: What is to be reached.
        done: The screen says that the task is done.
    """

    time: float
    tips: Mapping[int, Array]
    solid: bool
    objects: Mapping[str, SeenObject]
    goals: tuple[Goal, ...]
    done: bool


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
