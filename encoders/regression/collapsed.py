"""Polynomials of contact vectors with everything left out that their finger set already says.

Of the 15 numbers of a contact vector only the touching fingers' coordinates are free: a touching
finger's flag is 1, a lifted one's is 0, and its place is (-1, -1). For a set of k fingers every
term of a polynomial is therefore plus or minus one of the monomials of 2k coordinates, or nothing.
A quadratic has 15, 28, 45 and 66 of them for 2 to 5 fingers rather than 136, a cubic 35, 84, 165
and 286 rather than 816. Nothing is approximated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations, combinations_with_replacement
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.input_vector import CONTACT_VECTOR_SIZE, LIFTED
from models.arithmetic.arrays import Array
from models.arithmetic.products import matrix_product
from models.errors import EncoderError
from models.frames import FINGERS

Indices = NDArray[np.intp]

FLAGS = 2 * len(FINGERS)
"""Index of the first contact flag."""

SETS: tuple[tuple[int, ...], ...] = tuple(
    fingers for k in range(1, len(FINGERS) + 1) for fingers in combinations(range(len(FINGERS)), k)
)
"""All 31 sets of touching fingers, the small ones first."""

_FLAG_BYTES = FLAGS * np.dtype(float).itemsize
"""Where the flags begin in a contact vector's bytes."""

WEIGHTS = 1 << np.arange(len(FINGERS))
"""A set's code is the sum of its fingers' weights, 1 to 31."""


def monomials(width: int, degree: int) -> list[tuple[int, ...]]:
    """Input indices of every term, the constant first, then by degree."""
    terms: list[tuple[int, ...]] = []
    for d in range(degree + 1):
        terms += combinations_with_replacement(range(width), d)
    return terms


def set_name(fingers: Sequence[int]) -> str:
    """`thumb+ring`, say."""
    return "+".join(FINGERS[f] for f in fingers)


def set_code(fingers: Sequence[int]) -> int:
    """The code of a set of fingers."""
    return int(sum(WEIGHTS[f] for f in fingers))  # any order: whole numbers


def set_codes(U: Array) -> Indices:
    """(T,) codes of the finger sets of inputs (T, width); 0 for what is not a contact vector."""
    if U.shape[1] != CONTACT_VECTOR_SIZE:
        return np.zeros(len(U), np.intp)
    flags = U[:, FLAGS:]
    down = flags == 1.0
    away = (U[:, 0:FLAGS:2] == LIFTED) & (U[:, 1:FLAGS:2] == LIFTED)
    proper = np.all(down | ((flags == 0.0) & away), axis=1)
    codes: Indices = np.where(proper, down @ WEIGHTS, 0)  # any order: whole numbers
    return codes


@dataclass(frozen=True)
class Collapse:
    """The K terms of a polynomial for one set of fingers, in which r monomials are left.

    Attributes:
        fingers: The set.
        factors: (degree, r) places in the contact vector whose numbers multiply to a monomial.
            The flag of a touching finger stands for 1, so that all have equally many factors.
        monomial: (K,) which monomial a term is.
        sign: (K,) 1, -1 or 0 that it is to be multiplied by.
    """

    fingers: tuple[int, ...]
    factors: Indices
    monomial: Indices
    sign: Array

    def terms(self, U: Array) -> Array:
        """(T, r) monomials of contact vectors (T, 15) of this set."""
        X: Array = U.take(self.factors[0], axis=1)
        for places in self.factors[1:]:
            X *= U.take(places, axis=1)
        return X

    def coefficients(self, coef: Array) -> Array:
        """(r, n_outputs) of the monomials, from those of all terms (K, n_outputs)."""
        collapsed = np.zeros((self.factors.shape[1], coef.shape[1]))
        np.add.at(collapsed, self.monomial, self.sign[:, None] * coef)
        return collapsed


@cache
def collapse(
    fingers: tuple[int, ...], degree: int, origin: int | None = None, lifted: float = LIFTED
) -> Collapse:
    """The collapse of a polynomial of contact vectors for a set of fingers.

    Args:
        fingers: The set.
        degree: Of the polynomial.
        origin: The finger of the set that is at (0, 0), as the leftmost one is, if that is to be
            made use of: 6, 15, 28 and 45 quadratic monomials are left for 2 to 5 fingers.
        lifted: Both coordinates of a lifted finger.
    """
    coordinates = [2 * f + axis for f in fingers if f != origin for axis in range(2)]
    one = FLAGS + fingers[0]
    left = list(combinations_with_replacement([one, *coordinates], degree))
    row = {tuple(sorted(places)): i for i, places in enumerate(left)}
    monomial, sign = [], []
    for term in monomials(CONTACT_VECTOR_SIZE, degree):
        factor, places = 1.0, [one] * (degree - len(term))
        for place in term:
            if place in coordinates:
                places.append(place)
                continue
            places.append(one)
            if place < FLAGS:
                factor *= 0.0 if place // 2 == origin else lifted
            elif place - FLAGS not in fingers:
                factor = 0.0
        monomial.append(row[tuple(sorted(places))])
        sign.append(factor)
    factors = np.transpose(left).astype(np.intp)
    return Collapse(fingers, factors, np.array(monomial), np.array(sign))


class ContactPoses:
    """A fitted polynomial encoder, prepared for contact vectors.

    It gives what the encoder's `predict` gives, to rounding, several times as fast. Places of
    lifted fingers are not read: by the contact vector's definition they are (-1, -1). Buffers are
    made once and used for every pose, so an object serves one thread at a time.

    Args:
        coef: (K, n_outputs) coefficients of an encoder's terms for 15 inputs.
        degree: Of the polynomial.
    """

    def __init__(self, coef: Array, degree: int) -> None:
        self.n_outputs_ = coef.shape[1]
        self._collapses = {set_code(s): collapse(s, degree) for s in SETS}
        self._coef: dict[int, Array] = {
            c: found.coefficients(coef) for c, found in self._collapses.items()
        }
        self._squares = {} if degree > 2 else dict(map(self._square, SETS))

    def _square(self, fingers: tuple[int, ...]) -> tuple[bytes, tuple[Any, ...]]:
        """A set's flags as they stand in memory, and what a single pose needs.

        With v the flag and the free coordinates, every output is a sum of products v_i v_j. Two
        products of a vector and a matrix, v' (A v'), cost fewer calls of NumPy than gathering all
        monomials, and calls are what a single pose costs.
        """
        code = set_code(fingers)
        factors = self._collapses[code].factors
        # A linear term is a product with the flag, which is 1.
        pair = np.vstack([factors, np.broadcast_to(factors[:1, :1], factors.shape)])[:2]
        places = np.unique(pair)
        row, column = np.searchsorted(places, pair)
        matrix = np.zeros((len(places), len(places), self.n_outputs_))
        matrix[row, column] = self._coef[code]
        v, half = np.empty((1, len(places))), np.empty((len(places), self.n_outputs_))
        flags = np.isin(range(len(FINGERS)), fingers).astype(float).tobytes()
        return flags, (places, v, matrix.reshape(len(places), -1), half.reshape(1, -1), half)

    def __call__(self, u: Array) -> Array:
        """(n_outputs,) outputs of one contact vector (15,).

        Raises:
            EncoderError: It is not a contact vector.
        """
        try:
            places, v, matrix, flat, half = self._squares[u.tobytes()[_FLAG_BYTES:]]
            u.take(places, 0, v[0], "clip")
        except (KeyError, AttributeError, TypeError, ValueError):
            # Not as quickly recognised; the checked way takes it, or says what it is.
            return self.predict(np.asarray(u, float)[None])[0]
        mujoco.mju_mulMatMat(flat, v, matrix)
        outputs = np.empty((1, self.n_outputs_))
        mujoco.mju_mulMatMat(outputs, v, half)
        return outputs[0]

    def predict(self, U: ArrayLike) -> Array:
        """(T, n_outputs) outputs of contact vectors (T, 15).

        Raises:
            EncoderError: They are no contact vectors.
        """
        U = np.asarray(U, float)
        codes = checked_codes(U)
        out = np.empty((len(U), self.n_outputs_))
        for code in np.flatnonzero(np.bincount(codes)).tolist():
            rows = codes == code
            X: Array = self._collapses[code].terms(U[rows])
            out[rows] = matrix_product(X, self._coef[code])
        return out


def checked_codes(U: Array) -> Indices:
    """(T,) codes of the finger sets of contact vectors (T, 15).

    Raises:
        EncoderError: They are no contact vectors. Places of lifted fingers are not looked at.
    """
    if U.ndim != 2 or U.shape[1] != CONTACT_VECTOR_SIZE:
        raise EncoderError(
            "these are no contact vectors", got=U.shape, expected=f"(T, {CONTACT_VECTOR_SIZE})"
        )
    flags = U[:, FLAGS:]
    down = flags == 1.0
    codes: Indices = down @ WEIGHTS  # any order: whole numbers
    wrong = ~(codes.astype(bool) & np.all(down | (flags == 0.0), axis=1))
    if wrong.any():
        raise EncoderError(
            "these are no contact vectors",
            where=f"row {int(np.argmax(wrong))}",
            got=U[np.argmax(wrong), FLAGS:].tolist(),
            expected="contact flags 0 or 1, one of them 1",
        )
    return codes
