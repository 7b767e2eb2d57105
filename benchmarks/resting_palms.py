"""Simulated palms that rest beside grips, and flat thumbs and wide fingertips within them.

Layouts of fingers, and the place of the hand's heel below them, are those of people of the
simulated population. No person took part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, pi

import numpy as np

from encoders.capture import Capture
from encoders.captures.population import simulate_population
from models import rotations
from models.arithmetic.arrays import Array
from models.frames import Contact, TouchFrame

PALM, GROWING = (25.0, 90.0), (8.0, 20.0)
"""mm, diameters of palms in the end, and of the half of them that grow as they begin."""
WIDE, FLATTENING = (12.0, 28.0), (0.5, 0.8)
"""mm, diameters of wide fingertips in the end; share of it with which those that flatten begin."""
USUAL = (7.0, 14.0)
"""mm, diameters of the other fingertips."""
TAKES = (0.1, 0.4)
"""s for which contacts grow."""
ROUNDNESS = (1.0, 1.6)
"""Larger by smaller diameter of every contact; which of them is the width is drawn."""
NOISE = 0.15
"""Deviation of either reported diameter, as a share of it."""
OTHER_HAND = 0.15
"""Share of palms that are another hand's, anywhere around the grip."""
TREMBLE = 0.0003
"""m, of every touch in every control period."""
START = 0.7
"""s, when the fingers begin to land."""
STAGGER = 0.1
"""s within which they land."""
AFTER = 1.2
"""s after the last touch until a trial ends."""

WHENS = {"before": (-0.6, -0.2), "with": (-0.05, 0.15), "while down": (0.8, 1.3)}
"""s from the first finger to a palm, or to a wide finger that joins."""


def people(salt: str, each: int) -> tuple[Capture, ...]:
    """People of the population, so many of either generator; posed people grip nothing."""
    groups = {"train": {"first": each, "second": each}}
    return simulate_population(salt, groups).people


@dataclass(frozen=True)
class Size:
    """The true size of a contact over time, and the noise of its reports.

    Attributes:
        first: mm, diameter of the circle of equal area at first.
        last: mm, in the end.
        takes: s in between; 0 if it has the last size at once.
        bend: Exponent of the growth over time: below 1 it is fast at first.
        wide: Width by height.
        lasting: Share of the noise's variance that is the same in every report of this contact.
        off: The lasting deviations of width and height, in deviations of the noise.
    """

    first: float
    last: float
    takes: float
    bend: float
    wide: float
    lasting: float
    off: tuple[float, float]

    def diameter(self, time: float) -> float:
        """mm, some seconds after touch-down."""
        share = min(time / self.takes, 1.0) ** self.bend if self.takes else 1.0
        return self.first + share * (self.last - self.first)

    def report(self, time: float, rng: np.random.Generator) -> tuple[float, float]:
        """Width and height in m, as a device reports them."""
        noise = self.lasting**0.5 * np.array(self.off)
        noise += (1.0 - self.lasting) ** 0.5 * rng.standard_normal(2)
        width, height = np.maximum(1.0 + NOISE * noise, 0.3).tolist()
        diameter = 0.001 * self.diameter(time)
        return diameter * self.wide**0.5 * width, diameter / self.wide**0.5 * height


def _size(rng: np.random.Generator, first: float, last: float, grows: bool, lasting: float) -> Size:
    wide = float(rng.uniform(*ROUNDNESS)) ** float(rng.choice([-1.0, 1.0]))
    takes = float(rng.uniform(*TAKES)) if grows else 0.0
    off = rng.standard_normal(2).tolist()
    bend = exp(rng.uniform(-0.5, 0.5))
    return Size(first if grows else last, last, takes, bend, wide, lasting, (off[0], off[1]))


def palm_size(rng: np.random.Generator, lasting: float = 0.0) -> Size:
    """The size of a palm; half of them grow."""
    first, last = rng.uniform(*GROWING), rng.uniform(*PALM)
    return _size(rng, float(first), float(last), rng.random() < 0.5, lasting)


def wide_size(rng: np.random.Generator, lasting: float = 0.0) -> Size:
    """The size of a flat thumb or a wide fingertip; a third of them flatten."""
    last = float(rng.uniform(*WIDE))
    return _size(rng, last * float(rng.uniform(*FLATTENING)), last, rng.random() < 1 / 3, lasting)


def usual_size(rng: np.random.Generator, lasting: float = 0.0) -> Size:
    """The size of a fingertip that is neither wide nor flat."""
    last = float(rng.uniform(*USUAL))
    return _size(rng, last, last, False, lasting)


@dataclass(frozen=True)
class Touching:
    """One contact of a trial.

    Attributes:
        id: Its id.
        begins: s, touch-down.
        place: (2,) m on the surface, in the end.
        shift: (2,) m, how far from there it begins, while it grows.
        size: Its size.
    """

    id: int
    begins: float
    place: Array
    shift: Array
    size: Size

    def contact(self, now: float, rng: np.random.Generator, sized: bool) -> Contact:
        """The contact as a device reports it; without its size if it is not `sized`."""
        since = now - self.begins
        grown = self.size.diameter(since) / self.size.last
        at = self.place + (1.0 - grown) * self.shift + rng.normal(0.0, TREMBLE, 2)
        x, y = at.tolist()
        extent = self.size.report(since, rng)
        return Contact(self.id, x, y, extent=extent if sized else None)


@dataclass(frozen=True)
class Scene:
    """The contacts of a trial.

    Attributes:
        touches: The fingers of the grip and what is judged.
        judged: Id of the contact that is judged.
        when: One of `WHENS`.
        seed: Seed of the reports.
    """

    touches: tuple[Touching, ...]
    judged: int
    when: str
    seed: int

    @property
    def ends(self) -> float:
        """s, when the trial is over."""
        return max(t.begins for t in self.touches) + AFTER

    def frames(self, period: float, sized: bool = True) -> list[TouchFrame]:
        """The frames of every control period; without sizes if not `sized`."""
        rng = np.random.default_rng(self.seed)
        return [
            TouchFrame(
                now,
                tuple(t.contact(now, rng, sized) for t in self.touches if now >= t.begins - 1e-9),
            )
            for now in (period * i for i in range(round(self.ends / period)))
        ]


def palm_scene(
    everyone: Sequence[Capture], rng: np.random.Generator, middle: Array, lasting: float = 0.0
) -> Scene:
    """A palm beside a grip of two fingers or more, whose middle is at a place of the surface."""
    person, frame, fingers = grip(everyone, rng)
    xy = person.xy[frame, fingers]
    size = palm_size(rng, lasting)
    tips = [usual_size(rng, lasting) for _ in fingers]
    room = 0.0005 * np.array([size.last + tip.last for tip in tips])
    place = clear_of(xy, palm_place(person, frame, rng), room)
    centre = xy.mean(axis=0)
    when = str(rng.choice(list(WHENS)))
    shift = 0.00025 * (size.last - size.first) * _direction(rng)
    begins = START + float(rng.uniform(*WHENS[when]))
    touches = _landing(rng, xy, tips)
    palm = Touching(len(touches), begins, place, shift, size)
    return _moved((*touches, palm), middle - centre, palm.id, when, rng)


def finger_scene(
    everyone: Sequence[Capture], rng: np.random.Generator, middle: Array, lasting: float = 0.0
) -> Scene:
    """A flat thumb or a wide fingertip within a grip; in a third of them it joins a hand."""
    person, frame, fingers = grip(everyone, rng)
    xy = person.xy[frame, fingers]
    which = which_finger(fingers, rng)
    sizes = [
        wide_size(rng, lasting) if i == which else usual_size(rng, lasting)
        for i in range(len(fingers))
    ]
    touches = _landing(rng, xy, sizes)
    when = "while down" if rng.random() < 1 / 3 else "with"
    if when == "while down":
        wide = touches[which]
        begins = START + float(rng.uniform(*WHENS[when]))
        touches[which] = Touching(wide.id, begins, wide.place, wide.shift, wide.size)
    return _moved(tuple(touches), middle - xy.mean(axis=0), which, when, rng)


def palm_place(person: Capture, frame: int, rng: np.random.Generator) -> Array:
    """(2,) m on the surface, the middle of a palm: the hand's own heel, or another hand's."""
    if rng.random() < OTHER_HAND:
        tips = person.xy[frame, person.down[frame]]
        return np.asarray(tips.mean(axis=0) + rng.uniform(0.09, 0.16) * _direction(rng))
    kind = rng.random()
    if kind < 0.6:  # the edge below the little finger
        x, y = rng.uniform(0.0, 0.035), rng.uniform(0.005, 0.06)
    elif kind < 0.8:  # the ball of the thumb
        x, y = rng.uniform(-0.03, 0.0), rng.uniform(0.01, 0.045)
    else:
        x, y = rng.uniform(-0.015, 0.015), rng.uniform(0.0, 0.03)
    q = person.q[frame]
    on_hand = float(person.meta["size"]) * np.array([x, y, 0.0])
    right, up, _ = q[:3] + rotations.exp(q[3:6]) @ on_hand
    return np.array([right, -up])


def clear_of(xy: Array, place: Array, room: Array) -> Array:
    """A palm's place (2,) led away from the middle of touches (n, 2) until there is room (n,) m."""
    away = place - xy.mean(axis=0)
    away = away / max(float(np.linalg.norm(away)), 1e-6)
    while (np.linalg.norm(xy - place, axis=1) < room).any():
        place = place + 0.003 * away
    return place


def which_finger(fingers: Sequence[int], rng: np.random.Generator) -> int:
    """Number of the finger that is judged among those that touch: half of the time the thumb."""
    if 0 in fingers and rng.random() < 0.5:
        return fingers.index(0)
    return int(rng.integers(len(fingers)))


def grip(everyone: Sequence[Capture], rng: np.random.Generator) -> tuple[Capture, int, list[int]]:
    """A person, a frame of theirs, and the fingers that touch in it, two or more."""
    while True:
        person = everyone[int(rng.integers(len(everyone)))]
        frame = int(rng.integers(len(person)))
        fingers = np.flatnonzero(person.down[frame]).tolist()
        if len(fingers) >= 2:
            return person, frame, fingers


def _landing(rng: np.random.Generator, xy: Array, sizes: Sequence[Size]) -> list[Touching]:
    begins = START + rng.permutation(np.linspace(0.0, STAGGER, len(xy)))
    return [
        Touching(i, float(at), place, np.zeros(2), size)
        for i, (at, place, size) in enumerate(zip(begins, xy, sizes, strict=True))
    ]


def _direction(rng: np.random.Generator) -> Array:
    angle = rng.uniform(0.0, 2.0 * pi)
    return np.array([np.cos(angle), np.sin(angle)])


def _moved(
    touches: tuple[Touching, ...], by: Array, judged: int, when: str, rng: np.random.Generator
) -> Scene:
    moved = tuple(Touching(t.id, t.begins, t.place + by, t.shift, t.size) for t in touches)
    return Scene(moved, judged, when, int(rng.integers(2**31)))
