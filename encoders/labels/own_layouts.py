"""A person's own layouts of five fingers, which label themselves, as evidence about fewer fingers.

Five touches of one hand are named without error even for strangers: there is one thumb, and the
others follow it in order. So such layouts are kept, and all their parts are known layouts of this
person's fingers. Nothing else is learned: a confident answer about two fingers may be wrong, and
would confirm itself.

The evidence is a kernel density of touch layouts. A layout is the positions of touches relative to
their middle, so that the density does not depend on the hand's place on the surface. Every set of
fingers has a kernel density over known layouts. Kernels are not round: hands rotate and open as
wholes, and known layouts have only some of these rotations and openings, so each kernel is
stretched along rotation and size of its layout. With layouts as complex vectors x and p, both
directions follow from one inner product <p, x>, and a kernel costs as much as a round one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import permutations
from math import fsum, log, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.labels.labelling import finger_sets, hypotheses, set_of_labelling
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.arithmetic.products import matrix_product, squared_lengths, total
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

Layouts = NDArray[np.complex128]
"""(S, M, k): for each of the S sets of `finger_sets(k)` M layouts, x + i y of the touches in the
order of the fingers, inches, with the middle at 0."""

_LEAST_SIZE = 1e-3
"""inches, avoids a division by zero for contacts on one spot, which have no rotation and no
size."""


@dataclass(frozen=True)
class KernelShape:
    """Width of the kernels of a layout density.

    Attributes:
        width: Standard deviation of every coordinate, inches.
        turn: Standard deviation of the rotation of a layout about its middle, rad.
        size: Standard deviation of the logarithm of its size.
    """

    width: float = 0.1
    turn: float = 0.1
    size: float = 0.05


MOST = 24
"""Layouts that are kept; the oldest makes room for a new one."""

NEW = 0.12
"""inches, least root mean square distance of a new layout from all that are kept, after the best
shift: the same posture again tells nothing new."""

SHAPE = KernelShape(width=0.25, turn=0.22, size=0.16)
"""Kernel shape: how much a person's later layouts differ from the kept ones."""

FAR = (3.0, 4.0, 5.0)
"""Standard deviations from a kept layout beyond which it has no say, for 2, 3 and 4 contacts."""

_WIDEST = 12.0
"""inches, greatest distance of two touches of one hand."""

_LEAST = 0.2
"""inches, least distance of two fingertips' middles."""


class OwnLayouts:
    """Layouts of a person's five fingers.

    Args:
        layouts: (n, 5, 2) m, touches by finger on the surface, in the frame of a right hand; the
            newest last. At most `MOST` are kept.

    Attributes:
        layouts: (n, 5, 2) inches, each with its middle at 0, rounded to a thousandth.

    Raises:
        EncoderError: A layout is not finite, or is not that of a right hand.
    """

    def __init__(self, layouts: ArrayLike = ()) -> None:
        xy = np.asarray(layouts, float)
        xy = xy.reshape(0, len(FINGERS), 2) if xy.size == 0 else xy
        if xy.shape[1:] != (len(FINGERS), 2) or not np.isfinite(xy).all():
            raise EncoderError(
                "not layouts of five fingers",
                got=np.shape(layouts),
                expected="finite positions (n, 5, 2) in metres",
            )
        self.layouts: Array = np.array([_centred(one / METRES_PER_INCH) for one in xy[-MOST:]])
        self.layouts = self.layouts.reshape(-1, len(FINGERS), 2)
        for layout in self.layouts:
            if not _like_a_hand(layout):
                raise EncoderError(
                    "no hand touches like this",
                    where="a layout of five fingers",
                    got=layout.round(2).tolist(),
                    expected=f"distances of {_LEAST:g} to {_WIDEST:g} inches between fingertips",
                    remedy="Forget the layouts of the profile, and touch with five fingers again",
                )
            if not _of_right_hand(layout):
                raise EncoderError(
                    "this layout is of the other hand",
                    where="a layout of five fingers",
                    got=layout.round(2).tolist(),
                    expected="thumb to little finger clockwise, as a right hand's",
                    remedy="Forget the layouts of the profile, and touch with five fingers again",
                )

    def __len__(self) -> int:
        return len(self.layouts)

    @property
    def metres(self) -> Array:
        """The layouts (n, 5, 2) in m."""
        return self.layouts * METRES_PER_INCH

    def with_new(self, xy: Array) -> OwnLayouts:
        """These layouts and another one (5, 2) m by finger; the same object if it is not new."""
        layout = _centred(np.asarray(xy, float) / METRES_PER_INCH)
        if not (_like_a_hand(layout) and _of_right_hand(layout)):
            return self
        off = self.layouts - layout
        if len(off) and (squared_lengths(off.reshape(len(off), -1)) < 5 * NEW**2).any():
            return self
        grown = np.concatenate([self.layouts, layout[None]])
        return OwnLayouts(grown * METRES_PER_INCH)

    def log_evidence(self, xy: Array) -> Array:
        """Log weights (P,) of the labellings of contacts (k, 2) in m, k = 2 to 4; 0 is neutral."""
        density, log_far = self._densities[len(xy)]
        return functions.log_sum_exp(density.log_density(xy) - log_far, np.zeros(1))

    @cached_property
    def _densities(self) -> dict[int, tuple[LayoutDensity, float]]:
        z = self.layouts[..., 0] + 1j * self.layouts[..., 1]
        densities = {}
        for count in range(2, len(FINGERS)):
            parts = np.stack([z[:, fingers] for fingers in finger_sets(count)])
            parts = parts - parts.mean(axis=2, keepdims=True)
            density = LayoutDensity(parts, SHAPE)
            # The density of the widest kernel's middle, and that `FAR` standard deviations away.
            peak = -(2 * count - 2) * log(SHAPE.width * 2.5066282746310002) - log(len(z))
            densities[count] = density, peak - 0.5 * FAR[count - 2] ** 2
        return densities


def _like_a_hand(layout: Array) -> bool:
    """True if five touches (5, 2) in inches are no nearer and no farther than a hand's."""
    i, j = np.triu_indices(len(FINGERS), 1)
    between = np.sqrt(squared_lengths(layout[i] - layout[j]))
    return bool((between > _LEAST).all() and (between < _WIDEST).all())


def _of_right_hand(layout: Array) -> bool:
    """True if touches (5, 2), thumb first and y down, go clockwise about their middle.

    The signed area of their pentagon is positive; so it is for all layouts of simulated people.
    """
    x, y = layout.T.tolist()
    after = [*range(1, len(FINGERS)), 0]
    return total(x[i] * y[k] - x[k] * y[i] for i, k in enumerate(after)) > 0.0


def _centred(layout: Array) -> Array:
    middle = layout[0]
    for place in layout[1:]:
        middle = middle + place
    return np.round(layout - middle / len(FINGERS), 3)


@cache
def _arrangement(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Relation between hypotheses, finger sets and orders of contacts.

    Returns:
        orders (k!, k): the contact in each place of the sorted set; and (P,): the index of each
        labelling of `hypotheses(count)` in a table (S, k!).
    """
    orders = list(permutations(range(count)))
    order_of = [orders.index(tuple(order)) for order in np.argsort(hypotheses(count)).tolist()]
    return np.array(orders, np.intp), set_of_labelling(count) * len(orders) + np.array(order_of)


class LayoutDensity:
    """Kernel density of layouts of k touches given their labels.

    With c = <p, x> and r = |p|, a kernel's exponent is a quadratic form in Re c (along the size)
    and Im c (along the rotation) plus |x|^2, which is the same for all labellings.

    Args:
        layouts: (S, M, k) known layouts, k = 2 to 5; each gets a kernel.
        shape: Shape of the kernels.
    """

    def __init__(self, layouts: Layouts, shape: KernelShape) -> None:
        self._sets, number, count = layouts.shape
        r2 = squared_lengths(layouts.real) + squared_lengths(layouts.imag)
        narrow = shape.width**2
        along_size = narrow + shape.size**2 * r2
        along_turn = narrow + shape.turn**2 * r2
        constant = -log(number) - 0.5 * (
            r2 / along_size
            + (2 * count - 4) * log(2 * pi * narrow)
            + functions.log(2 * pi * along_size)
            + functions.log(2 * pi * along_turn)
        )
        # Rows are labellings and columns the many kernels, so that rows are long; real and
        # imaginary parts are separate, since half of a complex array is not contiguous.
        flat = layouts.reshape(-1, count).T
        along, across = np.vstack([flat.real, flat.imag]), np.vstack([-flat.imag, flat.real])
        self._directions = np.hstack([along, across])
        # Both differences vanish with the size, faster than the divisor does.
        divisor = np.maximum(r2, _LEAST_SIZE**2)
        columns = (
            0.5 * (1.0 / narrow - 1.0 / along_size) / divisor,
            1.0 / along_size,
            0.5 * (1.0 / narrow - 1.0 / along_turn) / divisor,
            constant,
        )
        self._size2, self._size1, self._turn2, self._constant = (
            np.ascontiguousarray(c.ravel(), np.float32) for c in columns
        )
        self._narrow = narrow
        self._orders, self._place = _arrangement(count)

    def log_density(self, xy: Array) -> Array:
        """log p(layout | labelling), (P,), of the labellings of `hypotheses(k)`.

        Args:
            xy: (k, 2) m on the surface. The density is per square inch to the power k - 1.
        """
        inches = xy / METRES_PER_INCH
        places = inches - inches.mean(axis=0)
        arranged = places[self._orders]
        x = np.concatenate([arranged[..., 0], arranged[..., 1]], axis=1)
        # Single precision is enough for the many kernels, and half as long to read.
        both = matrix_product(x, self._directions).astype(np.float32)
        along, across = np.split(both, 2, axis=1)
        exponent = self._size2 * along
        exponent += self._size1
        exponent *= along
        np.square(across, out=across)
        across *= self._turn2
        exponent += across
        exponent += self._constant
        table = exponent.reshape(len(self._orders) * self._sets, -1)
        highest = table.max(axis=1)
        table -= highest[:, None]
        total = functions.exp_of_many(table).sum(axis=1)
        densities = (highest + functions.log(total)).reshape(len(self._orders), self._sets)
        result: Array = densities.T.ravel()[self._place]
        return result - 0.5 * fsum(squared_lengths(places).tolist()) / self._narrow
