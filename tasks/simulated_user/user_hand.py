"""The simulated user's hand: how far apart its fingers are, how they move, and where they fit.

The distances of neighbouring fingertips are the 10, 50 and 90 percent quantiles of 147 layouts of
five fingers that people put on a screen. The bends of the row of fingertips are estimated. With
them, the middle fingertip is 17 mm above the line from index to little finger; in 180 frames of
simulated people it was 19 mm above this line.

Fingers move smoothly and tremble. At the border of the screen a hand has to stop.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, exp, log2, sin, sqrt

import numpy as np

from models.arithmetic import Array, small_product, squared_lengths
from models.frames import Contact
from models.surface import METRES_PER_INCH, Surface
from tasks.user import UserConfiguration

NARROWEST = 0.012
"""Least distance (m) of two neighbouring touches: the width of a fingertip."""

_APART = ((0.025, 0.029, 0.034), (0.019, 0.023, 0.026), (0.025, 0.031, 0.036))
"""Distances (m) from index to middle, middle to ring and ring to little finger: the 10, 50 and 90
percent quantiles of the layouts."""
_TENTH = 1.2816
"""Number of standard deviations from the median to the 90 percent quantile."""
_UNUSUAL = 2.0
"""Number of standard deviations from the median beyond which no hand is drawn."""
_BENDS = ((40.0, 5.0), (28.0, 4.0))
"""Mean and standard deviation (degrees) of the row's bends at the middle and the ring finger."""
_FIRST = 20.0
"""Angle (degrees) by which the line from index to middle fingertip points outwards."""
_SMALLEST = 0.014
"""Least distance (m) of neighbouring fingertips in a drawn hand of any size."""
_BORDER = 0.002
"""Least distance (m) from the end of a face to the middle of the outermost finger."""


@dataclass(frozen=True)
class Hand:
    """Fingers of the person in one trial.

    Attributes:
        configuration: Settings of the simulated user.
        tips: Fingertips (4, 2) m of index, middle, ring and little finger on an arc, relative to
            the index fingertip. x is across the fingers and y along them; the middle finger reaches
            farthest and the little finger least.
    """

    configuration: UserConfiguration
    tips: tuple[tuple[float, float], ...]

    @classmethod
    def draw(cls, configuration: UserConfiguration, seed: int) -> Hand:
        """Draws the hand of a trial's person.

        Args:
            configuration: Settings of the simulated user, among them the hand's size.
            seed: Seed of the user's randomness.
        """
        rng = np.random.default_rng([seed, 7_009])
        apart = []
        for low, middle, high in _APART:
            off = float(np.clip(rng.normal(), -_UNUSUAL, _UNUSUAL)) / _TENTH
            drawn = middle + off * (high - middle if off > 0 else middle - low)
            apart.append(max(drawn * configuration.hand_size, _SMALLEST))
        x = y = 0.0
        way = float(np.deg2rad(_FIRST))
        tips = [(x, y)]
        far = np.clip(rng.normal(size=2), -_UNUSUAL, _UNUSUAL).tolist()
        bends = [
            np.deg2rad(mean + s * spread) for (mean, spread), s in zip(_BENDS, far, strict=True)
        ]
        for length, bend in zip(apart, [0.0, *bends], strict=True):
            way -= float(bend)
            x, y = x + length * cos(way), y + length * sin(way)
            tips.append((x, y))
        return cls(configuration, tuple(tips))

    def row(self, fingers: int) -> Array:
        """Fingertips (fingers - 1, 2) m of all touching fingers but the thumb, turned so that the
        first and the last of them are equally far out.

        Args:
            fingers: Number of touching fingers including the thumb, 2 to 5.

        Returns:
            Positions with the origin halfway between the first and the last finger. x points
            towards the last finger, y outwards; y is 0 for the first and the last finger.
        """
        tips = np.array(self.tips[: fingers - 1])
        end = tips[-1]
        far = sqrt(end[0] ** 2 + end[1] ** 2)
        if far == 0.0:
            return tips
        c, s = end / far
        x, y = c * tips[:, 0] + s * tips[:, 1], c * tips[:, 1] - s * tips[:, 0]
        return np.column_stack([x - far / 2, y])

    def length(self, fingers: int) -> float:
        """Distance (m) between the first and the last touching finger, the thumb not included."""
        x, y = self.tips[fingers - 2]
        return sqrt(x**2 + y**2)

    @property
    def natural_axis(self) -> float:
        """Most comfortable direction (rad) across an object from thumb to fingers.

        It differs between two fingers and more: a row of several fingers lies nearly crosswise in
        front of the person.
        """
        c = self.configuration
        return c.natural_axis if c.fingers == 2 else c.natural_axis_of_row

    def room(self, face: float, fingers: int) -> float:
        """Length (m) of a face that a row of fingers leaves free."""
        return max(face - 2 * _BORDER - self.length(fingers), 0.0)

    def fitting(self, face: float) -> int:
        """Number of fingers, including the thumb, for a face of a length (m): the configured number
        if there is room for it, and at least 2."""
        return self.within(face - 2 * _BORDER)

    def within(self, room: float) -> int:
        """Number of fingers, including the thumb, whose row is no longer than the room (m)."""
        fingers = self.configuration.fingers
        while fingers > 2 and self.length(fingers) > room:
            fingers -= 1
        return fingers


_PEAK = 1.875
"""Peak speed of a minimum-jerk movement, divided by its mean speed."""

_MARGIN = 0.001
"""Least distance (m) from the border of the screen at which a finger still touches the screen."""

_WIDTH = NARROWEST + 1e-9
"""Distance (m) between two fingers after one of them has pushed the other aside."""


def minimum_jerk(s: float) -> float:
    """Share of the way of a minimum-jerk movement after a share s of its time (Flash and Hogan
    1985)."""
    s = min(max(s, 0.0), 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s)


@dataclass
class _Movement:
    """A movement of all fingers between two sets of positions, rigid or independent."""

    start: Array
    end: Array
    begin: float
    duration: float
    turn: float = 0.0
    pivot: Array | None = None
    _over: Array | None = None

    def at(self, now: float) -> Array:
        """Positions of the fingers as a read-only array."""
        if now - self.begin < self.duration:
            return self._on_the_way(minimum_jerk((now - self.begin) / self.duration))
        if self._over is None:
            self._over = self._on_the_way(1.0)
        return self._over

    def _on_the_way(self, share: float) -> Array:
        if self.pivot is None:
            return self.start + share * (self.end - self.start)
        # A hand that drags and turns at once rotates about a moving point.
        angle = share * self.turn
        c, s = cos(angle), sin(angle)
        shift = share * (self.end - self.start)
        return (
            small_product(self.start - self.pivot, np.array([[c, s], [-s, c]])) + self.pivot + shift
        )


class Fingers:
    """Positions of the user's fingers in the world's horizontal plane (x right, y away), m.

    Args:
        configuration: Speeds and noises.
        rng: The user's source of randomness.
    """

    def __init__(self, configuration: UserConfiguration, rng: np.random.Generator) -> None:
        self._c, self._rng = configuration, rng
        n = configuration.fingers
        self._movement = _Movement(np.zeros((n, 2)), np.zeros((n, 2)), 0.0, 1e-9)
        # x and y of every finger in turn. Plain floats are quicker than arrays for few numbers.
        self._tremor: list[float] = rng.normal(0.0, configuration.tremor, 2 * n).tolist()
        self._down_at = np.full(n, np.inf)
        self._up_at = np.full(n, -np.inf)
        self._ids = np.full(n, -1)
        self._next_id = 0
        self._last = 0.0
        self._plan()

    def ids(self) -> list[int]:
        """Contact ids of the fingers that were last put down, thumb first."""
        return [int(i) for i in self._ids]

    def places(self, now: float) -> Array:
        """Intended positions (n, 2) m of the fingers."""
        return self._movement.at(now)

    def land(self, places: Array, now: float) -> None:
        """Puts fingers down at places (n, 2) m, thumb first, one shortly after another. n may be
        less than the configured number of fingers."""
        n = len(places)
        self._movement = _Movement(places, places, now, 1e-9)
        self._down_at = now + self._rng.permutation(np.linspace(0.0, self._c.stagger, n))
        self._up_at = np.full(n, np.inf)
        self._ids = np.arange(self._next_id, self._next_id + n)
        # The order of ids must not reveal which finger is which.
        self._rng.shuffle(self._ids)
        self._next_id += n
        self._plan()

    def lift(self, now: float) -> None:
        """Takes the fingers off, one shortly after another."""
        n = len(self._ids)
        self._up_at = now + self._rng.permutation(np.linspace(0.0, self._c.stagger, n))
        self._plan()

    def lift_some(self, fingers: Sequence[int], now: float) -> None:
        """Takes some fingers off, one shortly after another; the others stay.

        Args:
            fingers: Indices into the positions of the last landing.
            now: Current time (s).
        """
        stagger = self._rng.permutation(np.linspace(0.0, self._c.stagger, len(fingers)))
        self._up_at[list(fingers)] = now + stagger
        self._plan()

    def put_down(self, finger: int, place: Array, now: float) -> None:
        """Puts a lifted finger down again, while the others stay.

        Args:
            finger: Index into the positions of the last landing.
            place: (2,) m, position on the table's plane.
            now: Current time (s).
        """
        places = self.places(now).copy()
        places[finger] = place
        self._movement = _Movement(places, places, now, 1e-9)
        self._down_at[finger], self._up_at[finger] = now, np.inf
        self._ids[finger] = self._next_id
        self._next_id += 1
        self._plan()

    def _plan(self) -> None:
        """Plans the landing and lifting times of every contact."""
        fingers = range(len(self._ids))
        times = self._down_at.tolist(), self._up_at.tolist()
        self._spans = sorted(zip(self._ids.tolist(), fingers, *times, strict=True))

    def move(self, places: Array, now: float) -> float:
        """Moves the fingers independently; returns the time of arrival (s)."""
        start = self.places(now)
        return self._go(_Movement(start, self._missed(start, places), now, 0.0))

    def carry(self, shift: Array, turn: float, pivot: Array, now: float) -> float:
        """Moves the fingers as a rigid body, by a shift (2,) m and a turn (rad) about a pivot (2,)
        m; returns the time of arrival (s)."""
        start = self.places(now)
        end = start + self._missed(np.zeros((1, 2)), shift[None])[0]
        missed = turn * (1.0 + self._c.end_noise * self._rng.normal())
        return self._go(_Movement(start, end, now, 0.0, missed, pivot))

    def touches(self, now: float, surface: Surface) -> tuple[Contact, ...]:
        """Current touches on the screen."""
        # Tremor of the fingers, then white noise, in one draw.
        drawn, many = self._rng.standard_normal(4 * self._c.fingers).tolist(), 2 * self._c.fingers
        self._shake(now, drawn[:many])
        touching = [
            (contact, finger)
            for contact, finger, down, up in self._spans
            if down - 1e-9 <= now < up - 1e-9
        ]
        if not touching:
            return ()
        intended, size = self.places(now).ravel().tolist(), self._c.noise
        # Fewer fingers than configured touch if an object has no room for them.
        noise = list(zip(self._tremor, drawn[many:], strict=True))[: len(intended)]
        actual = [a + b + size * c for a, (b, c) in zip(intended, noise, strict=True)]
        left, top, height = surface.origin
        places = _side_by_side(list(zip(actual[::2], actual[1::2], strict=True)))
        if surface.aligned:
            # Same as `to_surface`, which handles any direction.
            xy = [[x - left, top - y] for x, y in places]
        else:
            xy = surface.to_surface([(x, y, height) for x, y in places]).tolist()
        right = surface.width_in * METRES_PER_INCH - _MARGIN
        bottom = surface.height_in * METRES_PER_INCH - _MARGIN
        # The whole hand stops when a finger reaches the border.
        inwards = [
            max(_MARGIN - min(values), 0.0) - max(max(values) - most, 0.0)
            for values, most in zip(zip(*xy, strict=True), (right, bottom), strict=True)
        ]
        contacts = []
        for contact, finger in touching:
            x, y = (a + b for a, b in zip(xy[finger], inwards, strict=True))
            x, y = min(max(x, _MARGIN), right), min(max(y, _MARGIN), bottom)
            contacts.append(Contact(contact, x, y))
        return tuple(contacts)

    def _go(self, movement: _Movement) -> float:
        arc = 0.0
        if movement.pivot is not None:
            arm = np.sqrt(squared_lengths(movement.start - movement.pivot)).max()
            arc = abs(movement.turn) * float(arm)
        way = float(np.sqrt(squared_lengths(movement.end - movement.start)).max()) + arc
        fitts = self._c.movement_base + self._c.movement_slope * log2(max(way, 0.002) / 0.002)
        movement.duration = max(float(fitts), _PEAK * way / self._c.peak_speed)
        self._movement = movement
        return movement.begin + movement.duration

    def _missed(self, start: Array, end: Array) -> Array:
        """Actual end of a movement. All fingers have the same random error; its standard deviation
        is a share of the movement's length."""
        length = float(np.sqrt(squared_lengths(end - start)).max())
        return end + self._rng.normal(0.0, self._c.end_noise * length, 2)

    def _shake(self, now: float, drawn: Sequence[float]) -> None:
        keep = exp(-(now - self._last) / self._c.tremor_time)
        self._last = now
        size, share = self._c.tremor, sqrt(1.0 - keep * keep)
        self._tremor = [
            keep * a + share * (size * b) for a, b in zip(self._tremor, drawn, strict=True)
        ]


def _side_by_side(tips: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Fingertips, thumb first. A tip nearer to its neighbour than the width of a finger is pushed
    aside."""
    apart = tips[:1]
    for x, y in tips[1:]:
        a, b = apart[-1]
        far = sqrt((x - a) ** 2 + (y - b) ** 2)
        if far < NARROWEST:
            # Two tips at the same place may be pushed apart in any direction.
            c, s = ((x - a) / far, (y - b) / far) if far else (1.0, 0.0)
            x, y = a + _WIDTH * c, b + _WIDTH * s
        apart.append((x, y))
    return apart


SCREEN_EDGE = 0.003
"""Least distance (m) of a finger from the border of the screen."""


def beyond_border(places: Array, surface: Surface) -> float:
    """Largest distance (m) by which fingers at positions (n, 2) m would be beyond the border."""
    xy = _on_surface(places, surface)
    return float(max(SCREEN_EDGE - min(xy.min(), (surface.size - xy).min()), 0.0))


def stopped_at_border(places: Array, surface: Surface) -> Array:
    """Positions (n, 2) m, shifted as a whole so that no finger is beyond the border."""
    xy = _on_surface(places, surface)
    inwards = np.maximum(SCREEN_EDGE - xy.min(axis=0), 0.0)
    inwards -= np.maximum(xy.max(axis=0) - (surface.size - SCREEN_EDGE), 0.0)
    return surface.to_world(xy + inwards)[:, :2] if inwards.any() else places


def _on_surface(places: Array, surface: Surface) -> Array:
    return surface.to_surface(np.column_stack([places, np.zeros(len(places))]))
