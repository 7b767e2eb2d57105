"""The natural layout of five fingertips, which gives labels and yaw of four or five touches.

The five fingertips of a hand form an arc with the thumb aside. Four or five touches, rotated and
scaled for the best fit to that arc, give the fingers' labels and the hand's yaw without prior
knowledge of either, for a hand of any size from any side. (Labellers, which also label two or three
fingers, need prior knowledge of the usual yaw of hands.)

Layouts are complex numbers here, x + iy with y up the screen: a product then turns and scales.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from math import atan2, fsum, sqrt
from operator import add
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.labels.labelling import hypotheses
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.arithmetic.products import matrix_vector, squared_lengths
from models.errors import CaptureError

if TYPE_CHECKING:
    from encoders.capture import Capture

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
            mean = _turned(z, -_angles(_inner(mean, z))[:, None]).mean(axis=0)
        # The shape does not define straight ahead: it is the hands' average yaw.
        yaw = _angles(_inner(mean, z))
        ahead = atan2(fsum(functions.sin(yaw).tolist()), fsum(functions.cos(yaw).tolist()))
        self.places: Complex = _turned(mean, np.full(len(mean), ahead))
        self.turns: Array = _angles(_inner(self.places, z))
        self._place_of = [(z.real, z.imag) for z in self.places.tolist()]
        self._laid: dict[int, tuple[Array, Array]] = {}

    def match(self, xy: ArrayLike) -> Match:
        """Finds the fingers of touches, for a right hand of any size and yaw.

        Args:
            xy: (k, 2) m, 2 to 5 touches; below `LEAST` the answer is a guess.
        """
        z = _complex(xy)
        labels = hypotheses(len(z))
        z = z - z.sum() / len(z)
        there, lengths = self._hypothetical(len(z))
        real, imaginary = matrix_vector(there, np.concatenate([z.real, z.imag])).reshape(2, -1)
        lengths = lengths * sqrt(fsum((z.real * z.real + z.imag * z.imag).tolist()))
        likeness = np.sqrt(real * real + imaginary * imaginary)
        likeness /= np.maximum(lengths, 1e-12)
        best = int(likeness.argmax())
        turn = atan2(imaginary[best], real[best])
        return Match(labels[best].copy(), turn, float(likeness[best]))

    def turn(self, xy: Iterable[Sequence[float]], labels: Iterable[int]) -> float:
        """Yaw in rad of touches (k, 2), k >= 2, with known fingers (k,)."""
        # Like `match`, for one labelling: plain numbers are quicker than arrays of two or three.
        places = [(p[0], -p[1]) for p in xy]
        there = [self._place_of[label] for label in labels]
        mx, my = _middle(places)
        cx, cy = _middle(there)
        real = imaginary = 0.0
        for (ax, ay), (bx, by) in zip(places, there, strict=True):
            ax, ay, bx, by = ax - mx, ay - my, bx - cx, by - cy
            real += bx * ax + by * ay
            imaginary += bx * ay - by * ax
        return atan2(imaginary, real)

    def _hypothetical(self, count: int) -> tuple[Array, Array]:
        """Inner products with the positions of all labellings relative to their middles, as a
        matrix (2 P, 2 k) for real and imaginary parts; and the norms (P,) of those positions."""
        table = self._laid.get(count)
        if table is None:
            there = self.places[hypotheses(count)]
            there = there - there.mean(axis=1, keepdims=True)
            lengths = np.sqrt(squared_lengths(there.real) + squared_lengths(there.imag))
            inner = np.block([[there.real, there.imag], [-there.imag, there.real]])
            table = self._laid[count] = inner, lengths
        return table


def _inner(a: Complex, b: Complex) -> Complex:
    """Inner products (...), a conjugated, of vectors (..., k), terms added from the first to the
    last.

    NumPy's own products of complex numbers are not the same on all processors.
    """
    real = a.real * b.real + a.imag * b.imag
    imaginary = a.real * b.imag - a.imag * b.real
    product = np.empty(real.shape[:-1], complex)
    product.real, product.imag = (
        reduce(add, (part[..., k] for k in range(part.shape[-1]))) for part in (real, imaginary)
    )
    return product


def _angles(z: Complex) -> Array:
    """Angles (...) in rad of complex numbers (...)."""
    return functions.atan2(z.imag, z.real)


def _turned(z: Complex, angle: Array) -> Complex:
    """Complex numbers (...) turned by angles (...) in rad."""
    c, s = functions.cos(angle), functions.sin(angle)
    real, imaginary = z.real * c - z.imag * s, z.real * s + z.imag * c
    turned = np.empty(real.shape, complex)
    turned.real, turned.imag = real, imaginary
    return turned


def _middle(places: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Mean of places (x, y), added from the first to the last."""
    x = y = 0.0
    for px, py in places:
        x, y = x + px, y + py
    return x / len(places), y / len(places)


def of_capture(capture: Capture) -> NaturalLayout:
    """The natural layout of a capture's subject.

    Raises:
        CaptureError: No frame has all five fingers down.
    """
    return NaturalLayout(capture.xy[capture.down.all(axis=1)])


def _complex(xy: ArrayLike) -> Complex:
    xy = np.asarray(xy, float)
    return np.asarray(xy[..., 0] - 1j * xy[..., 1])
