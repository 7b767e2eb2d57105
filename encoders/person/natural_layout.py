"""The natural layout of five fingertips, which gives labels and yaw of four or five touches.

The five fingertips of a hand form an arc with the thumb aside. Four or five touches, rotated and
scaled for the best fit to that arc, give the fingers' labels and the hand's yaw without prior
knowledge of either, for a hand of any size from any side. (Labellers, which also label two or three
fingers, need prior knowledge of the usual yaw of hands.)

Layouts are complex numbers here, x + iy with y up the screen: a product then turns and scales.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterable, Sequence
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.capture import Capture
from encoders.labels.labelling import hypotheses
from models.arithmetic.arrays import Array
from models.errors import CaptureError

Complex = NDArray[np.complex128]

LEAST = 4
"""Least number of touches that determine labels and yaw; three fit in several ways."""

_ROUNDS = 20
"""Rounds of rotating layouts onto their mean; it converges long before."""


class Match(NamedTuple):
    """Fit of touches to the natural layout."""

    labels: NDArray[np.int64]
    """Finger (k,) of every touch."""
    turn: float
    """Yaw in rad, counterclockwise from the natural layout of a hand straight in front of its
    owner."""
    likeness: float
    """Correlation of the two layouts' coordinates, 0 to 1; 1 is the same shape."""


class NaturalLayout:
    """The mean shape of five touching fingertips.

    Args:
        layouts: (n, 5, 2) m, touches by label on the surface, x right and y down.

    Attributes:
        places: (5,) complex, m, positions relative to their middle.
        turns: (n,) rad, yaw of every given layout.

    Raises:
        CaptureError: No layout is given.
    """

    def __init__(self, layouts: ArrayLike) -> None:
        z = _complex(layouts)
        if not len(z):
            raise CaptureError("no frame has five fingers down", expected="at least one")
        z = z - z.mean(axis=1, keepdims=True)
        mean = z.mean(axis=0)
        for _ in range(_ROUNDS):
            way = z @ mean.conj()
            mean = (z * np.exp(-1j * np.angle(way))[:, None]).mean(axis=0)
        # The shape does not define straight ahead: it is the hands' average yaw.
        ahead = np.angle(np.mean(np.exp(1j * np.angle(z @ mean.conj()))))
        self.places: Complex = mean * np.exp(1j * ahead)
        self.turns: Array = np.angle(z @ self.places.conj())
        self._place_of: list[complex] = self.places.tolist()
        self._laid: dict[int, tuple[Complex, Array]] = {}

    def match(self, xy: ArrayLike) -> Match:
        """Finds the fingers of touches, for a right hand of any size and yaw.

        Args:
            xy: (k, 2) m, 2 to 5 touches; below `LEAST` the answer is a guess.
        """
        z = _complex(xy)
        labels = hypotheses(len(z))
        z = z - z.sum() / len(z)
        there, lengths = self._hypothetical(len(z))
        way = there @ z
        lengths = lengths * sqrt(np.vdot(z, z).real)
        likeness = np.abs(way) / np.maximum(lengths, 1e-12)
        best = int(likeness.argmax())
        return Match(labels[best].copy(), phase(way[best]), float(likeness[best]))

    def turn(self, xy: Iterable[Sequence[float]], labels: Iterable[int]) -> float:
        """Yaw in rad of touches (k, 2), k >= 2, with known fingers (k,)."""
        z = [complex(p[0], -p[1]) for p in xy]
        there = [self._place_of[label] for label in labels]
        # Like `match`, for one labelling: plain numbers are quicker than arrays of two or three.
        middle, centre = sum(z) / len(z), sum(there) / len(there)
        way = sum((b - centre).conjugate() * (a - middle) for a, b in zip(z, there, strict=True))
        return phase(way)

    def _hypothetical(self, count: int) -> tuple[Complex, Array]:
        """Conjugate positions (P, k) of all labellings relative to their middles, and their norms
        (P,)."""
        table = self._laid.get(count)
        if table is None:
            there = self.places[hypotheses(count)]
            there = there - there.mean(axis=1, keepdims=True)
            table = self._laid[count] = there.conj(), np.linalg.norm(there, axis=1)
        return table


def of_capture(capture: Capture) -> NaturalLayout:
    """The natural layout of a capture's subject.

    Raises:
        CaptureError: No frame has all five fingers down.
    """
    return NaturalLayout(capture.xy[capture.down.all(axis=1)])


def _complex(xy: ArrayLike) -> Complex:
    xy = np.asarray(xy, float)
    return np.asarray(xy[..., 0] - 1j * xy[..., 1])
