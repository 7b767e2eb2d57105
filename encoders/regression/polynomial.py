"""Polynomial encoders: every degree of freedom is a polynomial of the contact vector.

Equations 1 (quadratic), 2 (linear) and 3 (cubic) of Chung, Kim, Han and Pollard (2015). For 15
inputs they have K = 136, 16 and 816 terms. A flag s_i is 0 or 1, and a lifted finger is at
(-1, -1), so some terms depend on other terms (s^2 = s, x s = x + 1 - s): of the 136 quadratic terms
only 121 are independent. Many coefficients therefore fit equally well, and the fit
(`encoders.regression.least_squares`) takes those with the smallest norm. Predictions do not depend
on this choice.

The file defines the encoders first, then a reduced polynomial for contact vectors (`Collapse`).
Once the set of touching fingers is fixed, only their coordinates are free: the flag of a touching
finger is 1, the flag of a lifted finger is 0, and its position is (-1, -1). For k touching fingers
every term of the polynomial is then 0, or plus or minus a monomial of 2k coordinates. A quadratic
has 15, 28, 45 and 66 such monomials for 2 to 5 fingers rather than 136 terms; a cubic has 35, 84,
165 and 286 rather than 816. The reduction is exact.
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
"""All 31 sets of touching fingers, from the smallest to the largest."""

_FLAG_BYTES = FLAGS * np.dtype(float).itemsize
"""Offset (bytes) of the flags in the memory of a contact vector."""

_WEIGHTS = 1 << np.arange(len(FINGERS))
"""Weights of the fingers; the code of a finger set is the sum of its weights, 1 to 31."""

_LEAST_FINGERS = 2
"""Number of fingers of the smallest sets in `missing_sets_`. Captures drop frames of a single
finger, because one finger has no layout."""


class PolynomialEncoder(Encoder):
    """Least-squares polynomial from inputs to outputs.

    Args:
        degree: 1, 2 or 3.
        ridge: Penalty on the standardised coefficients, as a share of the number of frames;
            0 is plain least squares, as in the paper.

    Attributes:
        coef_: (K, n_outputs) coefficients, one row for each term of `monomials`.
        rank_: Number of independent terms found by the fit (plain least squares only).
        n_inputs_, n_outputs_: Numbers of columns of U and Q in the fit.
        constant_inputs_: Indices of inputs that had the same value in all frames.
        missing_sets_: Names (such as `thumb+ring`) of the sets of two to five fingers that occur in
            no frame; predictions for these sets are extrapolations. Empty if the inputs are not
            contact vectors.
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
            EncoderError: Shapes disagree, a value is not finite, the degree is not 1, 2 or 3, or
                the ridge is negative or not finite.
        """
        return self.fit_blocks([(U, Q)])

    def fit_blocks(self, blocks: Iterable[tuple[ArrayLike, ArrayLike]]) -> Self:
        """Learns from any number of pairs (U, Q); the result is that of all frames together.

        Only one block is in memory at a time; about ten thousand frames make a good block.

        Raises:
            EncoderError: As `fit`; or blocks differ in their numbers of columns; or there is no
                frame.
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
                    "a block of frames does not have as many columns as the first block",
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
        """The encoder prepared for fast prediction from contact vectors.

        After `pose = encoder.for_contacts()`, `pose(u)` predicts from one contact vector (15,) and
        `pose.predict(U)` from many. Both return the outputs of `predict`, up to rounding, several
        times as fast.

        Raises:
            EncoderError: The encoder has learned nothing, or its inputs are not contact vectors.
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
        """Values (..., K) of all terms for inputs (..., width)."""
        U = np.asarray(U, float)
        X = np.empty((*U.shape[:-1], self._terms))
        X[..., 0] = 1.0
        X[..., 1 : 1 + U.shape[-1]] = U
        for start, stop, shorter, last in self._products:
            # A term of degree d is a term of degree d - 1 times one more input.
            X[..., start:stop] = X[..., shorter] * U[..., last]
        return X

    def load(self, coef: ArrayLike, n_inputs: int, U: Array | None = None) -> Self:
        """Takes over coefficients of an earlier fit.

        Args:
            coef: (K, n_outputs) coefficients.
            n_inputs: Width of the inputs.
            U: (T, n_inputs) inputs from which the coefficients were learned, for `missing_sets_`.
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
        """Prepares the products that form the terms of each degree from terms one degree lower."""
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
    """Returns the stored array `coef`, after checking it.

    Raises:
        EncoderError: The array is missing, has another shape, or is not finite floating point.
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
    """True if a value can be a ridge penalty: a finite number of at least 0."""
    if not isinstance(value, int | float | np.number) or isinstance(value, bool):
        return False
    # JSON integers may be larger than any float.
    return bool(0 <= value <= sys.float_info.max)


def _check(U: Array, Q: Array) -> None:
    if U.ndim != 2 or Q.ndim != 2 or len(U) != len(Q) or not len(U):
        raise EncoderError(
            "inputs and outputs do not have matching shapes",
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
    """Indices of the inputs multiplied in each term: the constant term first, then by degree."""
    terms: list[tuple[int, ...]] = []
    for d in range(degree + 1):
        terms += combinations_with_replacement(range(width), d)
    return terms


def _set_name(fingers: Sequence[int]) -> str:
    """Name of a finger set, such as `thumb+ring`."""
    return "+".join(FINGERS[f] for f in fingers)


def set_code(fingers: Sequence[int]) -> int:
    """Code of a finger set: the sum of its fingers' `_WEIGHTS`."""
    return int(sum(_WEIGHTS[f] for f in fingers))  # any order: whole numbers


def set_codes(U: Array) -> Indices:
    """Codes (T,) of the finger sets of inputs (T, width); 0 for rows that are no contact
    vectors."""
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
    """Reduction of a polynomial's K terms to r monomials, for one set of touching fingers.

    Attributes:
        fingers: The set.
        factors: (degree, r) indices into the contact vector; the numbers in a column multiply to a
            monomial. The flag of a touching finger, which is 1, fills up columns of lower degree.
        monomial: (K,) index of the monomial to which each term reduces.
        sign: (K,) factor 1, -1 or 0 by which each term equals its monomial.
    """

    fingers: tuple[int, ...]
    factors: Indices
    monomial: Indices
    sign: Array

    def terms(self, U: Array) -> Array:
        """Monomials (T, r) of contact vectors (T, 15) with this finger set."""
        X: Array = U.take(self.factors[0], axis=1)
        for places in self.factors[1:]:
            X *= U.take(places, axis=1)
        return X

    def coefficients(self, coef: Array) -> Array:
        """Coefficients (r, n_outputs) of the monomials, summed from those of all terms."""
        collapsed = np.zeros((self.factors.shape[1], coef.shape[1]))
        np.add.at(collapsed, self.monomial, self.sign[:, None] * coef)
        return collapsed


@cache
def collapse(fingers: tuple[int, ...], degree: int, lifted: float = LIFTED) -> Collapse:
    """Reduction of a polynomial of contact vectors for a set of touching fingers.

    Args:
        fingers: The set.
        degree: Degree of the polynomial.
        lifted: Value of both coordinates of a lifted finger.
    """
    coordinates = [2 * f + axis for f in fingers for axis in range(2)]
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
                factor *= lifted
            elif place - FLAGS not in fingers:
                factor = 0.0
        monomial.append(row[tuple(sorted(places))])
        sign.append(factor)
    factors = np.transpose(left).astype(np.intp)
    return Collapse(fingers, factors, np.array(monomial), np.array(sign))


class ContactPoses:
    """A fitted polynomial encoder, prepared for contact vectors.

    It returns the outputs of the encoder's `predict`, up to rounding, several times as fast. It
    does not read the positions of lifted fingers, which are (-1, -1) by definition of the contact
    vector. Buffers are reused for every pose, so only one thread at a time may use an object.

    Args:
        coef: (K, n_outputs) coefficients of an encoder's terms for 15 inputs.
        degree: Degree of the polynomial.
    """

    def __init__(self, coef: Array, degree: int) -> None:
        self.n_outputs_ = coef.shape[1]
        self._collapses = {set_code(s): collapse(s, degree) for s in SETS}
        self._coef: dict[int, Array] = {
            c: found.coefficients(coef) for c, found in self._collapses.items()
        }
        self._squares = {} if degree > 2 else dict(map(self._square, SETS))

    def _square(self, fingers: tuple[int, ...]) -> tuple[bytes, tuple[Any, ...]]:
        """Bytes of a finger set's flags, and the arrays that predict a single pose for this set.

        If v holds the flag and the free coordinates, every output is a sum of products v_i v_j.
        Two products of a vector and a matrix, v' (A v'), take fewer NumPy calls than gathering all
        monomials. Calls dominate the time of a single pose.
        """
        code = set_code(fingers)
        factors = self._collapses[code].factors
        # For degree 1, the flag (which is 1) is the second factor of every product.
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
            EncoderError: `u` is not a contact vector.
        """
        try:
            places, v, matrix, flat, half = self._squares[u.tobytes()[_FLAG_BYTES:]]
            u.take(places, 0, v[0], "clip")
        except (KeyError, AttributeError, TypeError, ValueError):
            # `predict` handles other types, higher degrees and memory layouts, or raises the error.
            return self.predict(np.asarray(u, float)[None])[0]
        mujoco.mju_mulMatMat(flat, v, matrix)
        outputs = np.empty((1, self.n_outputs_))
        mujoco.mju_mulMatMat(outputs, v, half)
        return outputs[0]

    def predict(self, U: ArrayLike) -> Array:
        """Outputs (T, n_outputs) of contact vectors (T, 15).

        Raises:
            EncoderError: A row of U is not a contact vector.
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
    """Codes (T,) of the finger sets of contact vectors (T, 15).

    Positions of lifted fingers are not checked.

    Raises:
        EncoderError: A row of U is not a contact vector.
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
