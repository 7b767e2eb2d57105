"""Polynomial encoders: every degree of freedom is a polynomial of the contact vector.

Equations 1 (quadratic), 2 (linear) and 3 (cubic) of Chung, Kim, Han and Pollard (2015). For 15
inputs they have K = 136, 16 and 816 terms. Because s_i is 0 or 1 and a lifted finger stands at
(-1, -1), some terms repeat others (s^2 = s, x s = x + 1 - s): of the 136 quadratic terms only 121
are independent. The fit (`encoders.regression.least_squares`) therefore takes the shortest of all
equal solutions; predictions do not depend on the choice.

The encoders stand first; then a polynomial of contact vectors with everything left out that their
finger set already says. Of the 15 numbers of a contact vector only the touching fingers'
coordinates are free: a touching finger's flag is 1, a lifted one's is 0, and its place is (-1, -1).
For a set of k fingers every term of a polynomial is therefore plus or minus one of the monomials of
2k coordinates, or nothing. A quadratic has 15, 28, 45 and 66 of them for 2 to 5 fingers rather than
136, a cubic 35, 84, 165 and 286 rather than 816. Nothing is approximated.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations, combinations_with_replacement
from math import comb
from numbers import Integral
from typing import Any, Self

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.encoder import Encoder
from encoders.input_vector import CONTACT_VECTOR_SIZE, LIFTED
from models.arithmetic import Array, matrix_product
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

_WEIGHTS = 1 << np.arange(len(FINGERS))
"""A set's code is the sum of its fingers' weights, 1 to 31."""

_LEAST_FINGERS = 2
"""A set that a training can be missed in: one finger has no layout, and captures drop it."""


class PolynomialEncoder(Encoder):
    """Least-squares polynomial from inputs to outputs.

    Args:
        degree: 1, 2 or 3.
        ridge: Penalty on the standardised coefficients, as a share of the number of frames;
            0 is plain least squares, as in the paper.

    Attributes:
        coef_: (K, n_outputs) coefficients of the terms of `monomials`.
        rank_: Number of independent terms found by the fit (plain least squares only).
        n_inputs_, n_outputs_: Widths seen by the fit.
        constant_inputs_: Places of inputs that were the same in all frames.
        missing_sets_: Names (`thumb+ring`) of the sets of two to five fingers that no frame had:
            what is predicted for those is extrapolated. Empty if the inputs are no contact vectors.
    """

    def __init__(self, degree: int = 2, ridge: float = 0.0) -> None:
        self.degree = degree
        self.ridge = ridge
        self.coef_: Array
        self._learned = False
        self._codes: frozenset[int] | None = None

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        """Learns from inputs U (T, width) and outputs Q (T, n_outputs).

        Raises:
            EncoderError: Shapes disagree, a value is not finite, or the degree or ridge is not
                one that this encoder has.
        """
        return self.fit_blocks([(U, Q)])

    def fit_blocks(self, blocks: Iterable[tuple[ArrayLike, ArrayLike]]) -> Self:
        """Learns from any number of pairs (U, Q), as from all their frames together.

        Only one block is held at a time; some ten thousand frames make a good block.

        Raises:
            EncoderError: As `fit`, or blocks differ in their numbers of columns, or there is none.
        """
        from encoders.regression.least_squares import LeastSquares

        self._check_options()
        sums = LeastSquares(self.degree, self.terms)
        for given in blocks:
            U, Q = (np.asarray(array, float) for array in given)
            _check(U, Q)
            if not sums.frames:
                self.n_inputs_, self.n_outputs_ = U.shape[1], Q.shape[1]
                self._plan(self.n_inputs_)
            elif (U.shape[1], Q.shape[1]) != (self.n_inputs_, self.n_outputs_):
                raise EncoderError(
                    "a block of frames has other numbers of columns than the first one",
                    got=f"{U.shape[1]} inputs and {Q.shape[1]} outputs",
                    expected=f"{self.n_inputs_} inputs and {self.n_outputs_} outputs",
                )
            sums.add(U, Q)
        if not sums.frames:
            raise EncoderError("there is nothing to learn from", expected="one frame or more")
        if self.ridge > 0:
            self.coef_, self.rank_ = sums.ridge([self.ridge])[0], self._terms
        else:
            self.coef_, self.rank_ = sums.solve()
        self.constant_inputs_ = tuple(np.flatnonzero(sums.least == sums.greatest).tolist())
        self._codes = None if sums.has_unknown_sets else sums.codes
        self._learned = True
        return self

    @property
    def missing_sets_(self) -> tuple[str, ...]:
        learned = self._codes
        if learned is None:
            return ()
        return tuple(
            _set_name(s) for s in SETS if len(s) >= _LEAST_FINGERS and set_code(s) not in learned
        )

    def for_contacts(self) -> ContactPoses:
        """The encoder prepared for contact vectors, one at a time or many.

        `pose = encoder.for_contacts()` once, then `pose(u)` for one contact vector (15,) and
        `pose.predict(U)` for many, give what `predict` gives, several times as fast.

        Raises:
            EncoderError: The encoder has learned nothing, or from other inputs than contact
                vectors.
        """
        self._check_learned()
        if self.n_inputs_ != CONTACT_VECTOR_SIZE:
            raise EncoderError(
                "this encoder does not take contact vectors",
                got=f"{self.n_inputs_} inputs",
                expected=str(CONTACT_VECTOR_SIZE),
            )
        return ContactPoses(self.coef_, self.degree)

    def predict(self, U: ArrayLike) -> Array:
        """Outputs (T, n_outputs) of inputs (T, width), or (n_outputs,) of one input (width,)."""
        self._check_learned()
        U = np.asarray(U, float)
        if U.shape[-1] != self.n_inputs_:
            raise EncoderError(
                "wrong number of inputs", got=U.shape[-1], expected=str(self.n_inputs_)
            )
        terms = self.terms(U)
        outputs = matrix_product(terms.reshape(-1, self._terms), self.coef_)
        return outputs.reshape(*terms.shape[:-1], self.n_outputs_)

    def terms(self, U: ArrayLike) -> Array:
        """(..., K) values of all terms at inputs (..., width)."""
        U = np.asarray(U, float)
        X = np.empty((*U.shape[:-1], self._terms))
        X[..., 0] = 1.0
        X[..., 1 : 1 + U.shape[-1]] = U
        for start, stop, shorter, last in self._products:
            # A term of degree d is a term of degree d - 1 times one more input.
            X[..., start:stop] = X[..., shorter] * U[..., last]
        return X

    def load(self, coef: ArrayLike, n_inputs: int, U: Array | None = None) -> Self:
        """Takes over coefficients (K, n_outputs) learned earlier.

        Args:
            coef: The coefficients.
            n_inputs: Width of the inputs.
            U: (T, n_inputs) that they were learned from, for `knows` and `missing_sets_`.
        """
        self.coef_ = np.asarray(coef, float)
        self.n_inputs_, self.n_outputs_ = n_inputs, self.coef_.shape[1]
        self._plan(n_inputs)
        if len(self.coef_) != self._terms:
            raise EncoderError(
                "coefficients do not fit the encoder",
                got=len(self.coef_),
                expected=f"{self._terms} terms",
            )
        self.rank_ = self._terms
        codes = frozenset() if U is None else frozenset(np.unique(set_codes(U)).tolist())
        self._codes = None if U is None or 0 in codes else codes
        self._learned = True
        return self

    def configuration(self) -> dict[str, Any]:
        """Degree and ridge."""
        return {"degree": self.degree, "ridge": self.ridge}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The coefficients, in single precision."""
        self._check_learned()
        return {"coef": self.coef_.astype(np.float32)}

    def restore(self, arrays: Mapping[str, NDArray[Any]], U: Array, Q: Array) -> Self:
        """See `Encoder.restore`."""
        self._check_options()
        terms = comb(U.shape[1] + self.degree, self.degree)
        return self.load(stored_coefficients(arrays, (terms, Q.shape[1])), U.shape[1], U)

    def _plan(self, width: int) -> None:
        """Prepares the products that make the terms of each degree from those of the one below."""
        terms = monomials(width, self.degree)
        place = {term: i for i, term in enumerate(terms)}
        self._terms = len(terms)
        self._products = []
        for d in range(2, self.degree + 1):
            chosen = [t for t in terms if len(t) == d]
            start = place[chosen[0]]
            shorter = np.array([place[t[:-1]] for t in chosen])
            last = np.array([t[-1] for t in chosen])
            self._products.append((start, start + len(chosen), shorter, last))

    def _check_options(self) -> None:
        whole = isinstance(self.degree, Integral) and not isinstance(self.degree, bool)
        if not whole or self.degree not in (1, 2, 3):
            raise EncoderError("no such degree", got=self.degree, expected="1, 2 or 3")
        if not is_ridge(self.ridge):
            raise EncoderError("no such ridge", got=self.ridge, expected="0 or more, finite")

    def _check_learned(self) -> None:
        if not self._learned:
            raise EncoderError("the encoder has learned nothing yet", remedy="Call fit first")


def stored_coefficients(arrays: Mapping[str, NDArray[Any]], shape: tuple[int, ...]) -> Array:
    """The stored array `coef`, checked.

    Raises:
        EncoderError: It is missing, has another shape, or is not finite floating point.
    """
    coef = arrays.get("coef")
    if coef is None or coef.dtype.kind != "f" or coef.shape != shape:
        raise EncoderError(
            "the coefficients are not the encoder's",
            where="coef",
            got="nothing" if coef is None else f"{coef.dtype} {coef.shape}",
            expected=f"floating point {shape}",
        )
    if not np.isfinite(coef).all():
        raise EncoderError("values must be finite", where="coef")
    return coef.astype(float)


def is_ridge(value: object) -> bool:
    """True for a value that can be a penalty: a finite number that is not negative."""
    if not isinstance(value, int | float | np.number) or isinstance(value, bool):
        return False
    # Whole numbers of JSON may be larger than any float.
    return bool(0 <= value <= sys.float_info.max)


def _check(U: Array, Q: Array) -> None:
    if U.ndim != 2 or Q.ndim != 2 or len(U) != len(Q) or not len(U):
        raise EncoderError(
            "inputs and outputs do not belong together",
            got=(U.shape, Q.shape),
            expected="(T, width) and (T, n_outputs)",
        )
    if not (np.isfinite(U).all() and np.isfinite(Q).all()):
        raise EncoderError("inputs and outputs must be finite")


class LinearEncoder(PolynomialEncoder):
    """Linear regression, the paper's equation 2: 16 terms for 15 inputs.

    Args:
        ridge: Penalty on the standardised coefficients; 0 is plain least squares.

    `fit(U, Q)` learns from inputs (T, width) and outputs (T, n) of any width. `predict(U)` gives
    (T, n), or (n,) for one input (width,). For hands, U are contact vectors, Q relative poses.
    """

    def __init__(self, ridge: float = 0.0) -> None:
        super().__init__(1, ridge)


class QuadraticEncoder(PolynomialEncoder):
    """Quadratic regression, the paper's encoder (equation 1): 136 terms for 15 inputs.

    Args:
        ridge: Penalty on the standardised coefficients; 0 is plain least squares.

    `fit(U, Q)` learns from inputs (T, width) and outputs (T, n) of any width. `predict(U)` gives
    (T, n), or (n,) for one input (width,). For hands, U are contact vectors, Q relative poses.
    """

    def __init__(self, ridge: float = 0.0) -> None:
        super().__init__(2, ridge)


class CubicEncoder(PolynomialEncoder):
    """Cubic regression, the paper's equation 3: 816 terms for 15 inputs.

    Args:
        ridge: Penalty on the standardised coefficients; 0 is plain least squares.

    `fit(U, Q)` learns from inputs (T, width) and outputs (T, n) of any width. `predict(U)` gives
    (T, n), or (n,) for one input (width,). For hands, U are contact vectors, Q relative poses.
    """

    def __init__(self, ridge: float = 0.0) -> None:
        super().__init__(3, ridge)


def monomials(width: int, degree: int) -> list[tuple[int, ...]]:
    """Input indices of every term, the constant first, then by degree."""
    terms: list[tuple[int, ...]] = []
    for d in range(degree + 1):
        terms += combinations_with_replacement(range(width), d)
    return terms


def _set_name(fingers: Sequence[int]) -> str:
    """`thumb+ring`, say."""
    return "+".join(FINGERS[f] for f in fingers)


def set_code(fingers: Sequence[int]) -> int:
    """The code of a set of fingers."""
    return int(sum(_WEIGHTS[f] for f in fingers))  # any order: whole numbers


def set_codes(U: Array) -> Indices:
    """(T,) codes of the finger sets of inputs (T, width); 0 for what is not a contact vector."""
    if U.shape[1] != CONTACT_VECTOR_SIZE:
        return np.zeros(len(U), np.intp)
    flags = U[:, FLAGS:]
    down = flags == 1.0
    away = (U[:, 0:FLAGS:2] == LIFTED) & (U[:, 1:FLAGS:2] == LIFTED)
    proper = np.all(down | ((flags == 0.0) & away), axis=1)
    codes: Indices = np.where(proper, down @ _WEIGHTS, 0)  # any order: whole numbers
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
        codes = _checked_codes(U)
        out = np.empty((len(U), self.n_outputs_))
        for code in np.flatnonzero(np.bincount(codes)).tolist():
            rows = codes == code
            X: Array = self._collapses[code].terms(U[rows])
            out[rows] = matrix_product(X, self._coef[code])
        return out


def _checked_codes(U: Array) -> Indices:
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
    codes: Indices = down @ _WEIGHTS  # any order: whole numbers
    wrong = ~(codes.astype(bool) & np.all(down | (flags == 0.0), axis=1))
    if wrong.any():
        raise EncoderError(
            "these are no contact vectors",
            where=f"row {int(np.argmax(wrong))}",
            got=U[np.argmax(wrong), FLAGS:].tolist(),
            expected="contact flags 0 or 1, one of them 1",
        )
    return codes
