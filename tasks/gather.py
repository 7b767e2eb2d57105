"""Sweep twelve dice into a ring.

The simulated user sweeps the dice together with the fingers side by side.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, cos, pi, sin
from typing import ClassVar

import numpy as np

from models.arithmetic import Array, length, squared_lengths, total
from models.errors import InputError, SurfaceTooSmallError
from models.message import Message
from models.objects import Box
from models.scene import PaintedRing
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.simulated_user.grasp import wrapped
from tasks.simulated_user.user import SkilledUser
from tasks.simulated_user.user_hand import beyond_border, stopped_at_border
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import Sight, UserConfiguration, UserMaker

_SIDE_BY_SIDE = 0.0155
"""Distance (m) between the middles of neighbouring fingers. Fingers are 14 mm wide, so dice of 12
mm do not slip through between them."""
_CUP = 0.004
"""Distance (m) by which the outer fingers are ahead of the inner fingers, so that dice stay in
front of the row."""
_TIP, _THING = 0.008, 0.0085
"""Radii (m) that the user assumes for a fingertip, and for a die (its half diagonal)."""
_BEHIND = 0.024
"""Distance (m) behind the last die at which the fingers come down."""
_WITHIN = 0.006
"""Distance (m) inside the ring's border to which the user sweeps the middles of the dice."""
_OUT = 0.002
"""The user counts a die as outside if its middle is less than this distance (m) inside the ring's
border."""
_OBLIQUE = (0.0, -0.5, 0.5, -1.0, 1.0)
"""Angles (rad) between a sweep and the direct way to the middle of the ring."""
_COMFORT = 0.6
"""Number of additional dice that a sweep must catch to be worth a wrist turn of 1 rad."""
_CLOSE = 0.005
"""Largest error (m) of the row's position at which the user begins to sweep."""
_PATIENCE = 6
"""Largest number of looks at the hand before a sweep. After them, the user lifts the hand."""


@dataclass(frozen=True)
class Sweep:
    """A straight sweep with a row of fingers.

    Attributes:
        places: (n, 2) m, positions at which the fingers come down, thumb first.
        shift: (2,) m, movement of the fingers.
    """

    places: Array
    shift: Array


class GatherUser(SkilledUser):
    """Sweeps dice into the ring of the goals, beginning with dice that lie together.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._sweep: Sweep | None = None
        self._looks = 0
        self._swept = False

    def _act(self, sight: Sight, now: float) -> None:
        if self._sweep is None:
            self._plan(sight, now)
        elif self._swept:
            self._fingers.lift(now)
            self._sweep = None
            self._wait(self._eye.delay + 0.4, now)
        else:
            self._begin(sight, self._sweep, now)

    def _plan(self, sight: Sight, now: float) -> None:
        """Puts the fingers down behind dice that lie outside the ring."""
        self._sweep = None if sight.done else self._best(sight)
        if self._sweep is None:
            self._wait(0.1, now)
            return
        c = self.configuration
        error = self._rng.normal(0.0, c.aim_error, 2)
        each = self._rng.normal(0.0, c.finger_error, self._sweep.places.shape)
        self._fingers.land(self._sweep.places + error + each, now)
        self._looks, self._swept = 0, False
        self._wait(self._eye.delay + 0.45, now)

    def _begin(self, sight: Sight, sweep: Sweep, now: float) -> None:
        """Moves the fingers until the drawn fingers are at the start of the sweep, then sweeps."""
        self._looks += 1
        wanted = stopped_at_border(sweep.places + self._drawn_offset(sight), self.surface)
        off = float(np.sqrt(squared_lengths(wanted - self._fingers.places(now))).max())
        if off > _CLOSE and self._looks <= _PATIENCE:
            self._watch(self._fingers.move(wanted, now))
        elif sight.solid:
            self._swept = True
            self._watch(self._fingers.carry(sweep.shift, 0.0, self._middle(now), now))
        elif self._looks > _PATIENCE:
            self._swept = True
        else:
            self._wait(0.1, now)

    def _best(self, sight: Sight) -> Sweep | None:
        """The sweep with the best compromise between catching many dice and turning the wrist
        little; None if no die is outside the ring."""
        dice = np.array([seen.position[:2] for seen in sight.objects.values()])
        goals = np.array([goal.position[:2] for goal in sight.goals])
        middle = np.array([_mean(goals[:, 0]), _mean(goals[:, 1])])
        radius = float(np.sqrt(squared_lengths(goals - middle)).max()) + _THING
        outside = dice[np.sqrt(squared_lengths(dice - middle)) > radius - _OUT]
        options = [
            (*self._judged(die, middle, radius, angle, outside, dice), number)
            for number, die in enumerate(outside)
            for angle in _OBLIQUE
        ]
        return max(options, key=lambda o: (o[0], o[2]))[1] if options else None

    def _judged(
        self,
        die: Array,
        middle: Array,
        radius: float,
        oblique: float,
        outside: Array,
        dice: Array,
    ) -> tuple[float, Sweep]:
        """A sweep that starts behind a die, and its value."""
        way = middle - die
        direction = atan2(way[1], way[0]) + oblique
        ahead = np.array([cos(direction), sin(direction)])
        # The thumb is at that end of the row which requires less rotation of the wrist.
        natural = self._hand.natural_axis
        axis = min(
            (direction + pi / 2, direction - pi / 2), key=lambda a: abs(wrapped(a - natural))
        )
        across = np.array([cos(axis), sin(axis)])
        n = self.configuration.fingers
        along = (np.arange(n) - (n - 1) / 2) * _SIDE_BY_SIDE
        outer = max((n - 1) / 2 * _SIDE_BY_SIDE, _SIDE_BY_SIDE)
        cup = _CUP * (along / outer) ** 2
        row = along[:, None] * across + cup[:, None] * ahead
        start = die - _BEHIND * ahead
        # The sweep ends at the point of its line nearest to the ring's middle, or at the border.
        nearest = float((way * ahead).sum())  # any order: two numbers
        side = float(np.sqrt(max(length(way) ** 2 - nearest**2, 0.0)))
        inner = max(radius - _WITHIN, side)
        end = nearest - float(np.sqrt(inner**2 - side**2)) - (_TIP + _THING)
        shift = (_BEHIND + max(end, 0.0)) * ahead
        places = start + row
        off = outside - start
        forward = off[:, 0] * ahead[0] + off[:, 1] * ahead[1]
        sideways = off[:, 0] * across[0] + off[:, 1] * across[1]
        caught = (np.abs(sideways) < outer + 0.5 * _TIP) & (forward > 0.0)
        gaps = [float(np.sqrt(squared_lengths(dice - tip)).min()) for tip in places]
        worth = float(np.count_nonzero(caught))
        worth -= _COMFORT * abs(wrapped(axis - natural))
        worth -= 400.0 * beyond_border(places, self.surface)
        worth -= 200.0 * max(_TIP + _THING - min(gaps), 0.0)
        worth -= 2.0 * abs(oblique) + 10.0 * (side > radius - _THING)
        return worth, Sweep(places, shift)


def _mean(values: Array) -> float:
    return total(values.tolist()) / len(values)


COUNT = 12
EDGE = 0.012
"""Edge (m) of a die. Dice are sold with edges of 12 mm and 16 mm."""
MASS = 0.0021
"""Mass (kg) of a die of 12 mm and acrylic glass (1.19 g/cm3)."""
RADIUS = 0.040
"""Radius (m) of the ring. Dice fill a third of it, so they need not be packed."""
BORDER = 0.028
"""Least distance (m) of a die from the surface's border, so that fingertips have room behind it."""
RING_BORDER = 0.055
"""Least distance (m) of the ring's middle from the surface's border."""
APART, OUTSIDE = 0.018, 0.012
"""Least distances (m) between two dice, and of a die from the ring, at the start. No dice touch,
and all dice have to be moved."""
SPEED_TOLERANCE = 0.010
"""Largest speed (m/s) of a die that counts as still."""
IVORY = (0.93, 0.90, 0.82)

_TRIES, _PLACES = 100, 200
"""Number of drawn rings after which a surface is reported as too small, and number of positions
drawn around each ring."""


@dataclass(frozen=True)
class Gather(TaskDefaults):
    """Sweep twelve dice into a ring on the table, several at a time.

    Scene: twelve dice of 12 mm, 2.1 g each, lie on the table around a painted ring of 4 cm radius.
    The friction coefficient against the table is 0.5.
    Goal: all dice in the ring, at any places in it.
    Success: the middle of every die is within the ring, every die is slower than 1 cm/s, and no
    hand touches a die, all for 0.5 s without a break, within 90 s.
    Start: the ring's middle is uniform, at least 55 mm from the surface's border. The middles of
    the dice are uniform, at least 28 mm from the border, more than 18 mm from each other and more
    than 12 mm outside of the ring. Yaws are uniform.
    History: version 1.
    """

    name: ClassVar[str] = "gather"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 90.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.003
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    user: ClassVar[UserMaker | None] = GatherUser

    seed: int
    objects: tuple[Box, ...]
    goals: tuple[Goal, ...]
    ring: PaintedRing

    @property
    def painted(self) -> tuple[PaintedRing, ...]:
        """The ring."""
        return (self.ring,)

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Gather:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for the ring and the dice around it.
        """
        rng = np.random.default_rng([seed, cls.version, 23])
        size = surface.size
        if np.any(size < 2 * RING_BORDER):
            raise _too_small(surface)
        for _ in range(_TRIES):
            middle = rng.uniform(np.full(2, RING_BORDER), size - RING_BORDER)
            dice = _scattered(rng, middle, size)
            if len(dice) == COUNT:
                break
        else:
            raise _too_small(surface)
        yaws = rng.uniform(-pi / 4, pi / 4, COUNT).tolist()
        centre = surface.to_world(middle[None])[0, :2].tolist()
        half = EDGE / 2
        objects = tuple(
            Box(f"die{i + 1}", (half,) * 3, MASS, (*place, half), yaw, IVORY)
            for i, (place, yaw) in enumerate(
                zip(surface.to_world(np.stack(dice))[:, :2].tolist(), yaws, strict=True)
            )
        )
        ring = PaintedRing("ring", (centre[0], centre[1]), RADIUS)
        return cls(seed, objects, _dice_goals(ring), ring)

    def shifted(self) -> tuple[str, ...]:
        """Always raises, since the dice already start anywhere around the ring.

        Raises:
            InputError: Always, with the reason.
        """
        raise InputError(
            "shifted starts cannot make this task harder: dice already start anywhere on the table",
            where=f"{self.name}, --vary start",
            remedy="Vary something else, such as room",
        )

    def with_room(self, factor: float) -> Gather:
        """The same trial with the ring's radius multiplied by a factor."""
        ring = replace(self.ring, radius=factor * self.ring.radius)
        return replace(self, ring=ring, goals=_dice_goals(ring))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether all dice are in the ring now."""
        ring = self.ring
        dice = [sensing.object(die.name) for die in self.objects]
        off = np.array([die.position[:2] for die in dice]) - ring.middle
        outside = int(np.sum(squared_lengths(off) > ring.radius**2))
        reason: str = ""
        if outside:
            reason = Message(
                "dice_outside", "{count} of the dice are not in the ring", count=f"{outside}"
            )
        elif any(die.held for die in dice):
            reason = Message("dice_touched", "a hand still touches a die")
        elif max(die.speed for die in dice) > SPEED_TOLERANCE:
            reason = Message("dice_move", "a die is still moving")
        progress = 1.0 if not reason else min(1.0 - outside / len(dice), 0.99)
        return Measure(not reason, progress, reason)


def _scattered(rng: np.random.Generator, middle: Array, size: Array) -> list[Array]:
    """Positions (2,) m of dice around a ring; fewer than twelve if there is no room for all.

    Args:
        rng: Source of randomness.
        middle: (2,) m, middle of the ring on the surface.
        size: (2,) m, size of the surface.
    """
    dice: list[Array] = []
    for place in rng.uniform(np.full(2, BORDER), size - BORDER, (_PLACES, 2)):
        apart = [length(place - other) for other in dice]
        if length(place - middle) > RADIUS + OUTSIDE and min(apart, default=1.0) > APART:
            dice.append(place)
    return dice[:COUNT]


def _dice_goals(ring: PaintedRing) -> tuple[Goal, ...]:
    """Goals of the dice, not drawn: an outer circle of nine and an inner circle of three."""
    goals = []
    for i in range(COUNT):
        share, angle = (0.78, 2 * pi * i / 9) if i < 9 else (0.28, 2 * pi * i / 3)
        x, y = ring.middle
        out = share * ring.radius
        place = x + out * cos(angle), y + out * sin(angle), EDGE / 2
        goals.append(Goal(f"die{i + 1}", place, angle, ghost=False))
    return tuple(goals)


def _too_small(surface: Surface) -> SurfaceTooSmallError:
    size = surface.width_in, surface.height_in
    return SurfaceTooSmallError(Gather.name, size, "a ring and twelve dice around it", (7.8, 5.9))
