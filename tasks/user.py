"""A simulated user: what kind of person it is, what it sees, and what it does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.frames import TouchFrame
from models.later import Later
from models.objects import Thing
from models.surface import Surface
from tasks.goals import Goal

Array = NDArray[np.float64]

KINDS = ("skilled", "idle", "random")
"""`skilled` plays the task; the control arms do nothing, or touch at random."""


@dataclass(frozen=True)
class UserConfiguration:
    """A simulated person.

    Attributes:
        kind: One of `KINDS`.
        fingers: How many fingers touch, 2 to 5: the thumb and then index, middle, ...
        reaction: s, range from which each trial's delay between seeing and acting is drawn.
        peak_speed: m/s, fastest a fingertip moves.
        movement_base, movement_slope: s; a movement of d metres takes base + slope log2(d / 2 mm),
            and longer where the peak speed asks for it.
        end_noise: Share of a movement's length by which it misses.
        tremor: m, slow correlated noise of every finger (standard deviation per axis).
        tremor_time: s, its correlation time.
        noise: m, uncorrelated noise of every finger; together with the tremor 1 mm.
        aim_error: m per axis, error of a first touch, common to all fingers of the hand: the screen
            is not under the fingers, so where they will land is not seen.
        finger_error: m per axis, error of a single finger's first touch against the others.
        stagger: s, within which the fingers land, and lift, in random order.
        opening: m per side, how much wider than the object the hand comes down.
        squeeze: m per side, how far inside the object's faces the touches close.
        pitch: m between neighbouring fingers on one face.
        natural_axis: rad, direction from thumb to fingers that is most comfortable.
        longest_span: m, farthest the thumb goes from any finger.
        attempts: Grasps before giving up.
    """

    kind: str = "skilled"
    fingers: int = 3
    reaction: tuple[float, float] = (0.15, 0.25)
    peak_speed: float = 0.6
    movement_base: float = 0.25
    movement_slope: float = 0.08
    end_noise: float = 0.04
    tremor: float = 0.00095
    tremor_time: float = 0.15
    noise: float = 0.0003
    aim_error: float = 0.015
    finger_error: float = 0.0015
    stagger: float = 0.033
    opening: float = 0.013
    squeeze: float = 0.0035
    pitch: float = 0.0145
    natural_axis: float = float(np.deg2rad(55.0))
    longest_span: float = 0.13
    attempts: int = 8

    def __post_init__(self) -> None:
        if self.kind not in KINDS or not 2 <= self.fingers <= 5:
            raise InputError(
                "no such simulated user",
                got=f"{self.kind}, {self.fingers} fingers",
                expected=f"{', '.join(KINDS)}; 2 to 5 fingers",
            )

    def as_json(self) -> dict[str, Any]:
        """For results and recordings."""
        return asdict(self)


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


class User(Protocol):
    """A simulated person: looks at the screen and touches it."""

    configuration: UserConfiguration

    def look(self, sight: Sight) -> None: ...

    def touch(self, now: float) -> TouchFrame: ...


UserMaker = Callable[[UserConfiguration, Surface, int], User]
"""Makes a simulated person from what kind of person it is, the screen, and a seed."""
