"""Kernel density of touch layouts.

A layout is the positions of touches relative to their middle, so that the density does not depend
on the hand's place on the surface. Every set of 2 to 5 fingers has a kernel density over known
layouts. Kernels are not round: hands rotate and open as wholes, and known layouts have only some of
these rotations and openings, so each kernel is stretched along rotation and size of its layout.
With layouts as complex vectors x and p, both directions follow from one inner product <p, x>, and a
kernel costs as much as a round one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import combinations, permutations
from math import fsum, log, pi

import numpy as np
from numpy.typing import NDArray

from encoders.labels.labelling import hypotheses
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.arithmetic.products import matrix_product, squared_lengths
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


@cache
def finger_sets(count: int) -> tuple[tuple[int, ...], ...]:
    """All sets of `count` fingers, in lexicographic order."""
    return tuple(combinations(range(len(FINGERS)), count))


@cache
def set_of_labelling(count: int) -> NDArray[np.intp]:
    """Index (P,) in `finger_sets(count)` of the fingers of every labelling of
    `hypotheses(count)`."""
    number = {fingers: i for i, fingers in enumerate(finger_sets(count))}
    return np.array([number[tuple(sorted(row))] for row in hypotheses(count).tolist()], np.intp)


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
    """Kernel density of touch layouts given their labels.

    Args:
        layouts: Known layouts by number of contacts, 2 to 5; each gets a kernel.
        shapes: Shape of the kernels by number of contacts.
    """

    def __init__(self, layouts: Mapping[int, Layouts], shapes: Mapping[int, KernelShape]) -> None:
        self._forms = {k: _Form(p, shapes[k]) for k, p in layouts.items()}

    def log_density(self, xy: Array) -> Array:
        """log p(layout | labelling), (P,), of the labellings of `hypotheses(k)`.

        Args:
            xy: (k, 2) m on the surface, k = 2 to 5. The density is per square inch to the power k -
                1.
        """
        form = self._forms[len(xy)]
        inches = xy / METRES_PER_INCH
        return form.log_density(inches - inches.mean(axis=0))


class _Form:
    """The kernels of one number of contacts, prepared for evaluation.

    With c = <p, x> and r = |p|, a kernel's exponent is a quadratic form in Re c (along the size)
    and Im c (along the rotation) plus |x|^2, which is the same for all labellings.
    """

    def __init__(self, p: Layouts, shape: KernelShape) -> None:
        self._sets, number, count = p.shape
        r2 = squared_lengths(p.real) + squared_lengths(p.imag)
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
        flat = p.reshape(-1, count).T
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

    def log_density(self, places: Array) -> Array:
        """Log densities (P,) of all labellings of touches (k, 2), inches from their middle."""
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
