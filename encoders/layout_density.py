"""How often the fingers of a hand touch in which layout: a density learned from a capture.

For every set of 2 to 5 fingers, the layout of their touches (their places relative to their middle,
so that the density does not depend on where on the surface the hand is) has a kernel density over
layouts of the training frames. A kernel is not round: hands turn and open as wholes, and a capture
holds only some of these turns and openings, so each kernel is stretched along the turn and along
the size of its layout. With layouts as complex vectors x and p, both directions are read off one
inner product <p, x>, and a kernel costs as much as a round one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import combinations, permutations

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.labelling import hypotheses
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

Array = NDArray[np.float64]

_LEAST_SIZE = 0.05
"""inches. Size below which a layout counts as this large: contacts on one spot have no turn."""


@dataclass(frozen=True)
class KernelShape:
    """Width of the kernels of a layout density.

    Attributes:
        width: Standard deviation of every coordinate, inches.
        turn: Standard deviation of the turn of a layout about its middle, rad.
        size: Standard deviation of the logarithm of its size.
        borrow: Weight of all frames in which other fingers touch as well, against those in which
            exactly these fingers touch. Fingers that rest beside others lie much as alone.

    Raises:
        EncoderError: A number is out of range.
    """

    width: float = 0.1
    turn: float = 0.1
    size: float = 0.05
    borrow: float = 2.0

    def __post_init__(self) -> None:
        for name, value, least, most in (
            ("width", self.width, 1e-3, 10.0),
            ("turn", self.turn, 0.0, 10.0),
            ("size", self.size, 0.0, 10.0),
            ("borrow", self.borrow, 0.0, 1e3),
        ):
            if not least <= value <= most:
                raise EncoderError(
                    f"the kernels' {name} is out of range", got=value, expected=f"{least} to {most}"
                )


@dataclass(frozen=True)
class Prototypes:
    """Layouts around which kernels stand, for all finger sets of one size.

    Attributes:
        layout: (S, M, k) complex, x + i y of the touches in the order of the fingers, inches,
            with the middle at 0; S sets in the order of `finger_sets(k)`.
        weight: (S, M) share of each kernel; sums to 1 over a set, 0 where a place is not used.
        prior: (S,) probability of each set.
    """

    layout: NDArray[np.complex128]
    weight: Array
    prior: Array


@cache
def finger_sets(count: int) -> tuple[tuple[int, ...], ...]:
    """All sets of `count` fingers, in lexicographic order."""
    return tuple(combinations(range(len(FINGERS)), count))


@cache
def _arrangement(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """How hypotheses are made of finger sets and orders.

    Returns:
        orders (k!, k): which contact stands in each place of the sorted set; and (P,) where each
        labelling of `hypotheses(count)` is found in a table (S, k!).
    """
    orders = list(permutations(range(count)))
    sets = finger_sets(count)
    place = np.empty(len(hypotheses(count)), np.intp)
    for row, labels in enumerate(hypotheses(count).tolist()):
        order = tuple(int(i) for i in np.argsort(labels))
        place[row] = sets.index(tuple(sorted(labels))) * len(orders) + orders.index(order)
    return np.array(orders, np.intp), place


class LayoutDensity:
    """Kernel density of touch layouts with their labels.

    Args:
        prototypes: By number of contacts, 2 to 5.
        shape: Of the kernels.
    """

    def __init__(self, prototypes: Mapping[int, Prototypes], shape: KernelShape) -> None:
        self.prototypes, self.shape = dict(prototypes), shape
        self._forms = {k: _Form(k, p, shape) for k, p in self.prototypes.items()}

    def log_density(self, xy: Array) -> Array:
        """log p(labelling, layout) of every labelling of `hypotheses(k)`, (P,).

        Args:
            xy: (k, 2) m on the surface, k = 2 to 5. The density is per square inch to the k - 1.
        """
        form = self._forms[len(xy)]
        z = (xy[:, 0] + 1j * xy[:, 1]) / METRES_PER_INCH
        return form.log_density(z - z.mean())


class _Form:
    """The kernels of one number of contacts, prepared for evaluation.

    With c = <p, x> and r = |p|, a kernel's exponent is a quadratic form in Re c (along the size)
    and Im c (along the turn) plus |x|^2, which is the same for all labellings.
    """

    def __init__(self, count: int, prototypes: Prototypes, shape: KernelShape) -> None:
        p = prototypes.layout
        r2 = np.maximum(np.sum(np.abs(p) ** 2, axis=2), _LEAST_SIZE**2)
        narrow = shape.width**2
        along_size = narrow + shape.size**2 * r2
        along_turn = narrow + shape.turn**2 * r2
        constant = -0.5 * (
            r2 / along_size
            + (2 * count - 4) * np.log(2 * np.pi * narrow)
            + np.log(2 * np.pi * along_size)
            + np.log(2 * np.pi * along_turn)
        )
        with np.errstate(divide="ignore"):
            constant += np.log(prototypes.weight) + np.log(prototypes.prior)[:, None]
        self._sets = len(p)
        # Kernels down, labellings across.
        self._conjugate = np.ascontiguousarray(p.conj().reshape(-1, count), np.complex64)
        columns = (
            0.5 * (1.0 / narrow - 1.0 / along_size) / r2,
            1.0 / along_size,
            0.5 * (1.0 / narrow - 1.0 / along_turn) / r2,
            np.maximum(constant, -1e30),
        )
        self._size2, self._size1, self._turn2, self._constant = (
            np.ascontiguousarray(c.reshape(-1, 1), np.float32) for c in columns
        )
        self._narrow = narrow
        self._orders, self._place = _arrangement(count)

    def log_density(self, z: NDArray[np.complex128]) -> Array:
        arranged = z[self._orders].T.astype(np.complex64)
        c = self._conjugate @ arranged
        along = c.real
        exponent = (self._size2 * along + self._size1) * along
        exponent += self._turn2 * np.square(c.imag)
        exponent += self._constant
        table = exponent.reshape(self._sets, -1, len(self._orders))
        highest = table.max(axis=1)
        total = np.exp(table - highest[:, None, :]).sum(axis=1)
        density = (highest + np.log(total)).astype(float).ravel()[self._place]
        result: Array = density - 0.5 * float(np.sum(np.abs(z) ** 2)) / self._narrow
        return result


def prototypes_of(capture: Capture, borrow: float, most: int) -> dict[int, Prototypes]:
    """Prototypes of all numbers of contacts from the frames of a capture.

    Args:
        capture: Labelled touches.
        borrow: See `KernelShape.borrow`.
        most: Largest number of prototypes a set; of more frames, an even selection is taken.

    Raises:
        EncoderError: Some finger set occurs in no frame, not even together with other fingers.
    """
    found = {}
    for count in range(2, len(FINGERS) + 1):
        layouts, weights, frames = [], [], []
        for fingers in finger_sets(count):
            own, more = _frames_of(capture, fingers)
            frames.append(len(own))
            own, more = _evenly(own, most), _evenly(more, most if borrow > 0 else 0)
            chosen = np.concatenate([own, more])
            if not len(chosen):
                raise EncoderError(
                    "some fingers never touch together in the capture",
                    got=[FINGERS[f] for f in fingers],
                    expected="every set of two or more fingers",
                )
            share = borrow / (1.0 + borrow) if len(own) else 1.0
            weights.append(
                np.concatenate(
                    [
                        np.full(len(own), (1.0 - share if len(more) else 1.0) / max(len(own), 1)),
                        np.full(len(more), share / max(len(more), 1)),
                    ]
                )
            )
            xy = capture.xy[chosen][:, fingers] / METRES_PER_INCH
            z = xy[..., 0] + 1j * xy[..., 1]
            # In single precision, as it is kept, so that a belief from a file decides alike.
            layouts.append((z - z.mean(axis=1, keepdims=True)).astype(np.complex64).astype(complex))
        prior = (np.array(frames) + 1.0) / (np.sum(frames) + len(frames))
        found[count] = _padded(count, layouts, weights, prior)
    return found


def _frames_of(
    capture: Capture, fingers: tuple[int, ...]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Frames in which exactly these fingers touch, and those in which others touch as well."""
    all_down = capture.down[:, fingers].all(axis=1)
    exactly = all_down & (capture.down.sum(axis=1) == len(fingers))
    return np.flatnonzero(exactly), np.flatnonzero(all_down & ~exactly)


def _evenly(frames: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    if len(frames) <= most:
        return frames
    if most == 0:
        return frames[:0]
    return frames[np.linspace(0, len(frames) - 1, most).round().astype(int)]


def _padded(
    count: int, layouts: list[NDArray[np.complex128]], weights: list[Array], prior: Array
) -> Prototypes:
    most = max(len(w) for w in weights)
    layout = np.zeros((len(layouts), most, count), complex)
    weight = np.zeros((len(layouts), most))
    for i, (z, w) in enumerate(zip(layouts, weights, strict=True)):
        layout[i, : len(z)] = z
        weight[i, : len(w)] = w
    return Prototypes(layout, weight, prior)
