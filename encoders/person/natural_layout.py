"""The natural layout of five fingertips, which gives labels and yaw of four or five touches.

The five fingertips of a hand form an arc with the thumb aside. Four or five touches are rotated and
scaled for the best fit to that arc. This gives the fingers' labels and the hand's yaw without prior
knowledge of either, for a hand of any size from any side. (Labellers, which also label two or three
fingers, need prior knowledge of the usual yaw of hands.)

Layouts are complex numbers here, x + iy with y up the screen: a product rotates and scales.

The module also warns if a hand's yaw is outside the range of the encoder's training data. Encoders
are not rotation-invariant: in the training data, the device lies in front of the person, as in the
paper. The yaw must be estimated from the touches. The yaw of the encoder's pose is unusable, since
the encoder explains the touches of a turned hand by wrong fingers at the usual yaw. Two or three
touches fit the natural layout in several ways, so their yaw follows from their labels. So a hand
that turns after it has come down is still noticed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from math import atan2, fsum, pi, remainder, sqrt
from operator import add
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.labels.labelling import hypotheses
from models import arithmetic
from models.arithmetic import Array, matrix_vector, squared_lengths
from models.errors import CaptureError
from models.message import Message

if TYPE_CHECKING:
    from encoders.capture import Capture


Complex = NDArray[np.complex128]

LEAST = 4
"""Least number of touches that determine labels and yaw; three touches fit in several ways."""

_ROUNDS = 20
"""Number of rounds that rotate layouts onto their mean; the mean converges long before the last."""


class Match(NamedTuple):
    """Fit of touches to the natural layout."""

    labels: NDArray[np.int64]
    """Finger (k,) of every touch."""
    turn: float
    """Yaw in rad, counterclockwise from the natural layout of a hand straight in front of its
    owner."""
    likeness: float
    """Correlation of the two layouts' coordinates, 0 to 1; 1 for the same shape."""


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
        # The shape alone does not define a yaw of 0; it is the average yaw of the hands.
        yaw = _angles(_inner(mean, z))
        ahead = atan2(fsum(arithmetic.sin(yaw).tolist()), fsum(arithmetic.cos(yaw).tolist()))
        self.places: Complex = _turned(mean, np.full(len(mean), ahead))
        self.turns: Array = _angles(_inner(self.places, z))
        self._place_of = [(z.real, z.imag) for z in self.places.tolist()]
        self._laid: dict[int, tuple[Array, Array]] = {}

    def match(self, xy: ArrayLike) -> Match:
        """Finds the fingers of touches, for a right hand of any size and yaw.

        Args:
            xy: (k, 2) m, 2 to 5 touches; with fewer than `LEAST`, the result is a guess.
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
        # As `match`, for one labelling. For two or three numbers, plain floats are faster than
        # arrays.
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
        """For all P labellings of `count` = k touches, the natural positions relative to their
        middle.

        Returns:
            Matrix (2 P, 2 k) whose product with touches gives real and imaginary parts of their
            inner products with the positions; and the norms (P,) of the positions.
        """
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
    return arithmetic.atan2(z.imag, z.real)


def _turned(z: Complex, angle: Array) -> Complex:
    """Complex numbers (...) turned by angles (...) in rad."""
    c, s = arithmetic.cos(angle), arithmetic.sin(angle)
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


RARE = 0.005
"""Share of the training frames at either end that the range leaves out as outliers."""

_FIVE = 50
"""Least number of frames with five fingers from which a range can be estimated."""


_LATEST: dict[str, tuple[Array, YawRange]] = {}
"""The last computed range, with its input."""


@dataclass(frozen=True)
class YawRange:
    """Range of the hands' yaw in an encoder's training data.

    Attributes:
        layout: Natural layout of these hands, which gives the yaw.
        low, high: Ends of the range (rad), counterclockwise; 0 is the average yaw.
    """

    layout: NaturalLayout
    low: float
    high: float

    @classmethod
    def of(cls, U: Array) -> YawRange:
        """Computes the range from contact vectors (T, 15) of the training data.

        Raises:
            CaptureError: Too few of the vectors have five fingers.
        """
        known = _LATEST.get("range")
        if known is not None and known[0] is U:
            # All trials of a run need the same range.
            return known[1]
        five = U[U[:, 10:].all(axis=1)]
        if len(five) < _FIVE:
            raise CaptureError(
                "too few frames with five fingers to estimate the range of yaw",
                got=len(five),
                expected=f"{_FIVE} or more",
            )
        layout = NaturalLayout(five[:, :10].reshape(-1, 5, 2))
        turns = np.sort(layout.turns)
        places = np.array([RARE, 1.0 - RARE]) * (len(turns) - 1)
        low, high = np.interp(places, np.arange(len(turns)), turns)
        yaw_range = cls(layout, float(low), float(high))
        _LATEST["range"] = (U, yaw_range)
        return yaw_range

    def turn(self, u: Array) -> float | None:
        """Yaw in rad of a contact vector's hand; None for a single touch."""
        numbers = u.tolist()
        fingers = [f for f in range(5) if numbers[10 + f]]
        if len(fingers) < 2:
            return None
        if len(fingers) < LEAST:
            return self.layout.turn([numbers[2 * f : 2 * f + 2] for f in fingers], fingers)
        return self.layout.match(u[:10].reshape(5, 2)[fingers]).turn

    def beyond(self, turn: float) -> float:
        """Angle in rad by which a yaw is outside of the range; 0 inside."""
        if self.low <= turn <= self.high:
            return 0.0
        # The nearer end of the range counts.
        return min(abs(remainder(end - turn, 2 * pi)) for end in (self.low, self.high))


@dataclass(frozen=True)
class YawWarningSettings:
    """Settings of the yaw warning.

    Attributes:
        outside: A hand counts as outside if its yaw is farther than this angle (rad) beyond the
            range.
        inside: A hand outside counts as inside again if its yaw is nearer than this angle (rad) to
            the range.
        lasting: Time (s) for which a hand must be outside before the warning starts, and inside
            before it ends.
        apart: Least time between the beginnings of two warnings (s).
        every: Time (s) between two checks of a hand; a check at every control step is not needed.
    """

    outside: float = float(np.deg2rad(15.0))
    inside: float = float(np.deg2rad(5.0))
    lasting: float = 0.4
    apart: float = 10.0
    every: float = 0.1


class YawMonitor:
    """Watches one hand's yaw.

    Args:
        range: Range of the training data.
        settings: Settings of the warning.

    Attributes:
        notice: Notice to the person; empty without a warning.
        warnings: Number of warnings so far.
    """

    def __init__(self, range: YawRange, settings: YawWarningSettings | None = None) -> None:
        self.range, self.settings = range, settings or YawWarningSettings()
        self.reset()

    def reset(self) -> None:
        """Returns to the initial state."""
        self.notice: str = ""
        self.warnings = 0
        self._since: float | None = None
        self._warned = self._looked = -np.inf

    def step(self, time: float, u: Array | None) -> str:
        """Processes a contact vector (15,), None without labelled touches; returns the notice."""
        if time - self._looked < self.settings.every - 1e-9:
            return self.notice
        self._looked = time
        turn = None if u is None else self.range.turn(u)
        if turn is None:
            # Without touches there is no yaw, and the notice stays until the next touches.
            self._since = None
            return self.notice
        s, beyond = self.settings, self.range.beyond(turn)
        changed = beyond < s.inside if self.notice else beyond > s.outside
        if not changed:
            self._since = None
            return self.notice
        self._since = time if self._since is None else self._since
        if time - self._since < s.lasting - 1e-9:
            return self.notice
        if self.notice:
            self.notice, self._since = "", None
        elif time - self._warned >= s.apart:
            low, high = np.rad2deg([self.range.low, self.range.high])
            self.notice = Message(
                "hand_turned",
                "the hand seems turned by {degrees} degrees, beyond the {low} to {high} that were "
                "trained: see --turn",
                degrees=f"{np.rad2deg(turn):.0f}",
                low=f"{low:.0f}",
                high=f"{high:.0f}",
            )
            self.warnings += 1
            self._warned, self._since = time, None
        return self.notice
