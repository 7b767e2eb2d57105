"""Contract, settings and sights of simulated users."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from math import atan2, cos, radians
from typing import Any, Protocol

import numpy as np

from models.arithmetic import Array
from models.errors import InputError
from models.frames import TouchFrame
from models.objects import SceneObject
from models.surface import Surface
from tasks.task import Goal

KINDS = ("skilled", "demonstrating", "idle", "random")
"""Kinds of users. `skilled` plays the task. `demonstrating` plays it as its instructions say, with
the movements that a person should copy. The other kinds are baselines, which do nothing or touch at
random."""


@dataclass(frozen=True)
class UserConfiguration:
    """Settings of a simulated user.

    Attributes:
        kind: One of `KINDS`.
        fingers: Number of touching fingers, 2 to 5, in the order thumb, index, middle, ring,
            little. Fewer fingers touch an object whose faces are too small.
        reaction: Range (s) from which each trial's reaction delay is drawn.
        peak_speed: Highest speed (m/s) of a fingertip.
        movement_base: Base (s) of the duration of a movement. A movement over d metres takes
            base + slope log2(d / 2 mm), or longer because of the peak speed.
        movement_slope: Slope (s) of the duration of a movement.
        end_noise: Standard deviation of a movement's error, as a share of its length.
        tremor: Standard deviation (m per axis) of slow correlated noise of every finger.
        tremor_time: Correlation time (s) of the tremor.
        noise: Standard deviation (m per axis) of uncorrelated noise of every finger. With the
            default values, tremor and noise together have a standard deviation of 1 mm.
        aim_error: Standard deviation (m per axis) of the error of the first touch that is common to
            all fingers. The screen is not under the fingers, so the user does not see where the
            fingers will land.
        finger_error: Standard deviation (m per axis) of the additional error of each finger at the
            first touch.
        stagger: Time (s) within which the fingers land, and lift, in random order.
        hand_size: Length of the hand divided by that of an average adult. It scales the distances
            and openings of the fingers. A device sets it to the size of its person's hand.
        opening: Largest distance (m per side) by which the hand comes down wider than the object.
        easy_opening: Distance (m) from thumb to fingers up to which the hand opens easily. It opens
            wider only for an object that requires it.
        squeeze: Distance (m per side) by which the touches close inside the object's faces.
        natural_axis: Most comfortable direction (rad) from thumb to index finger.
        natural_axis_of_row: Most comfortable direction (rad) from the thumb to several fingers
            across an object.
        longest_span: Widest opening (m) of the hand, from thumb to fingers.
        attempts: Number of grasps before giving up.
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
    hand_size: float = 1.0
    opening: float = 0.009
    easy_opening: float = 0.085
    squeeze: float = 0.0035
    natural_axis: float = float(np.deg2rad(45.0))
    natural_axis_of_row: float = float(np.deg2rad(75.0))
    longest_span: float = 0.110
    attempts: int = 8

    def __post_init__(self) -> None:
        if self.kind not in KINDS or not 2 <= self.fingers <= 5:
            raise InputError(
                "no such simulated user",
                got=f"{self.kind}, {self.fingers} fingers",
                expected=f"{', '.join(KINDS)}; 2 to 5 fingers",
            )

    def as_json(self) -> dict[str, Any]:
        """Values for results and recordings."""
        return asdict(self)


@dataclass(frozen=True)
class SeenObject:
    """An object on the screen, as the user sees it.

    Attributes:
        shape: The object.
        position: (3,) m, centre of the object.
        rotation: (3, 3), world from object.
        mirrored: True if a left-handed user sees the mirror image of a shape whose left and right
            sides differ. A point (x, y, z) of the shape is then at (x, -y, z) in the frame of
            `rotation`.
    """

    shape: SceneObject
    position: Array
    rotation: Array
    mirrored: bool = False

    @property
    def yaw(self) -> float:
        """Yaw (rad) about the vertical."""
        return atan2(self.rotation[1, 0], self.rotation[0, 0])

    @property
    def upright(self) -> bool:
        """True if the object appears to stand on one of its faces."""
        return bool(np.max(np.abs(self.rotation[2])) > cos(radians(8.0)))


@dataclass(frozen=True)
class Sight:
    """Content of the screen at one moment.

    Attributes:
        time: Simulated time (s).
        tips: Positions (3,) m of the drawn fingertips of labelled fingers, by contact id.
        solid: True if the hand is drawn opaque.
        objects: The objects by name.
        goals: Goals to be reached.
        done: True if the screen shows that the task is done.
    """

    time: float
    tips: Mapping[int, Array]
    solid: bool
    objects: Mapping[str, SeenObject]
    goals: tuple[Goal, ...]
    done: bool


class LateSight(Sight):
    """A sight that is computed when it is first read. Users get sixty sights a second, and act on
    about four of them."""

    compute: Callable[[], Sight]

    @classmethod
    def of(cls, time: float, compute: Callable[[], Sight]) -> LateSight:
        """Creates a sight that is computed later.

        Args:
            time: Simulated time (s).
            compute: Function that returns the sight. It must not refer to anything that changes,
                nor to a user: a user that stores its sights would keep itself alive.
        """
        late = cls.__new__(cls)
        object.__setattr__(late, "time", time)
        object.__setattr__(late, "compute", compute)
        return late

    @cached_property
    def _known(self) -> Sight:
        return self.compute()

    @cached_property
    def tips(self) -> Mapping[int, Array]:
        return self._known.tips

    @cached_property
    def solid(self) -> bool:
        return self._known.solid

    @cached_property
    def objects(self) -> Mapping[str, SeenObject]:
        return self._known.objects

    @cached_property
    def goals(self) -> tuple[Goal, ...]:
        return self._known.goals

    @cached_property
    def done(self) -> bool:
        return self._known.done


class User(Protocol):
    """Contract of simulated users, who look at the screen and touch it."""

    def observe(self, sight: Sight) -> None: ...

    def touch(self, now: float) -> TouchFrame: ...


class FingersKnown(ABC):
    """Contract of simulated users whose true fingers are known.

    Labellers and evaluations read the true labels; the user does not.
    """

    @abstractmethod
    def finger_of(self, contact: int) -> int | None:
        """Finger, thumb 0 to little 4, of a contact id; None if the last touch had no such id."""


UserMaker = Callable[[UserConfiguration, Surface, int], User]
"""Creates a simulated user from settings, screen and seed."""
