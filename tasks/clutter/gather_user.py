"""Simulated user who sweeps small things together with the fingers side by side."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, pi, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length, squared_lengths, total
from models.surface import Surface
from tasks.simulated_user.grasp import wrapped
from tasks.simulated_user.screen import beyond_border, stopped_at_border
from tasks.simulated_user.user import SkilledUser
from tasks.user import Sight, UserConfiguration

_SIDE_BY_SIDE = 0.0155
"""m from finger to finger: things of 12 mm do not slip through between fingers of 14 mm."""
_CUP = 0.004
"""m by which the outer fingers are ahead of the inner ones, so that things stay before the row."""
_TIP, _THING = 0.008, 0.0085
"""m, radius of a fingertip and of a thing, to its corner, as the user assumes them."""
_BEHIND = 0.024
"""m behind the last thing, where the fingers come down."""
_WITHIN = 0.006
"""m inside the ring, where the user wants the middle of the things."""
_OUT = 0.002
"""m from the border of the ring, within which the user takes a thing for outside."""
_OBLIQUE = (0.0, -0.5, 0.5, -1.0, 1.0)
"""rad from the way to the middle of the ring, in which a sweep may lead."""
_COMFORT = 0.6
"""Things that a sweep must catch more, to be worth turning the wrist by one rad."""
_CLOSE = 0.005
"""m, error of the row's place within which the user begins to sweep."""
_PATIENCE = 6
"""Looks at a hand before the sweep, after which the user lifts it."""


@dataclass(frozen=True)
class Sweep:
    """A straight sweep with a row of fingers.

    Attributes:
        places: (n, 2) m, where the fingers come down, thumb first.
        shift: (2,) m, by which they move.
    """

    places: Array
    shift: Array


class GatherUser(SkilledUser):
    """Sweeps things into the ring that the goals show, those first that lie together.

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
        """Puts the fingers down behind things that lie outside."""
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
        """Moves the fingers to where the sweep begins, as the drawn ones show, and sweeps."""
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
        """The sweep that brings most things into the ring, with the least turned wrist."""
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
        """What a sweep of a thing is worth, and the sweep."""
        way = middle - die
        direction = atan2(way[1], way[0]) + oblique
        ahead = np.array([cos(direction), sin(direction)])
        # The thumb is at the end of the row that suits the wrist.
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
        # To the point of the way that is nearest to the middle, or to the border of the ring.
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
