"""Takes of two hands on one surface, and how often their contacts get the right hand.

Two takes of the simulated subject, one of them mirrored into a left hand, are played at once on one
surface, at random moments and places; the middles of the two hands stay a given distance apart when
both are down at first. Every contact of either counts once: right, wrong, or without a hand.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.labels.hand_split import HandSplitter
from encoders.regression.trained import builtin_capture
from models.arithmetic import Array
from models.frames import Contact, TouchFrame
from models.scene import CONTROL_PERIOD
from models.surface import METRES_PER_INCH

SURFACE = np.array((18.9, 10.6)) * METRES_PER_INCH
"""m, of a 22 inch touch screen."""

APART = (0.10, 0.14, 0.18, 0.22, 0.30)
"""m, between the middles of both hands' fingers."""

LATER = 1.0
"""s, most by which the second take begins after the first."""


@dataclass(frozen=True)
class Take:
    """One take of a capture, about its own middle.

    Attributes:
        time: (T,) s from its first contact.
        ids: (T, 5) contact ids, or -1.
        xy: (T, 5, 2) m from the middle of its contacts.
    """

    time: Array
    ids: NDArray[np.int64]
    xy: Array

    @property
    def ends(self) -> float:
        """s."""
        return float(self.time[-1])

    def at(self, now: float) -> dict[int, Array]:
        """Places of the contacts that are down, by id."""
        if not 0.0 <= now <= self.ends:
            return {}
        row = int(np.searchsorted(self.time, now, side="right")) - 1
        down = self.ids[row] >= 0
        return dict(zip(self.ids[row][down].tolist(), self.xy[row][down], strict=True))


@dataclass(frozen=True)
class Count:
    """Contacts that got the right hand, the wrong one, or none."""

    right: int = 0
    wrong: int = 0
    none: int = 0

    def __add__(self, other: Count) -> Count:
        return Count(self.right + other.right, self.wrong + other.wrong, self.none + other.none)

    @property
    def all(self) -> int:
        """Contacts in all."""
        return self.right + self.wrong + self.none


def takes_of(capture: Capture) -> list[Take]:
    """Its takes with at least one contact."""
    found = []
    for trial in np.unique(capture.trial):
        rows = (capture.trial == trial) & (capture.ids >= 0).any(axis=1)
        if rows.sum() > 1:
            time, xy = capture.time[rows], capture.xy[rows].astype(float)
            found.append(Take(time - time[0], capture.ids[rows], xy - np.nanmean(xy, axis=(0, 1))))
    return found


def play(right: Take, left: Take, apart: float, rng: np.random.Generator) -> Count:
    """Two takes at once; the second one is mirrored and to the left of the first.

    Args:
        right: Take of the right hand.
        left: Another take of a right hand, mirrored here.
        apart: m between the middles of both.
        rng: Random numbers for place and time.
    """
    middle = SURFACE / 2 + rng.uniform(-0.03, 0.03, 2)
    way = np.array((apart / 2, rng.uniform(-0.03, 0.03)))
    starts = rng.permutation([0.0, rng.uniform(0.0, LATER)])
    homes = SURFACE * [[0.75, 0.5], [0.25, 0.5]]
    splitter = HandSplitter(homes)
    found: dict[int, bool] = {}
    ended: set[int] = set()
    now = 0.0
    while now <= max(starts[0] + right.ends, starts[1] + left.ends):
        contacts = []
        for hand, (take, mirror, side) in enumerate(((right, 1.0, 1.0), (left, -1.0, -1.0))):
            for i, xy in take.at(now - starts[hand]).items():
                place = middle + side * way + xy * (mirror, 1.0)
                contacts.append(Contact(2 * i + hand, float(place[0]), float(place[1])))
        splitter.step(TouchFrame(now, tuple(contacts)))
        for contact in contacts:
            ended.add(contact.id)
            hand_given = splitter.hand(contact.id)
            if hand_given is not None:
                found[contact.id] = hand_given == contact.id % 2
        now += CONTROL_PERIOD
    right_ones = sum(found.values())
    return Count(right_ones, len(found) - right_ones, len(ended) - len(found))


def measure(pairs: int, seed: int = 0) -> dict[float, tuple[Count, int]]:
    """For each distance: contacts, and pairs of takes without a wrong one."""
    takes = takes_of(builtin_capture())
    result = {}
    for apart in APART:
        rng = np.random.default_rng([seed, round(1000 * apart)])
        total, clean = Count(), 0
        for _ in range(pairs):
            one, two = rng.choice(len(takes), 2)
            count = play(takes[one], takes[two], apart, rng)
            total, clean = total + count, clean + (count.wrong == 0)
        result[apart] = total, clean
    return result
