"""Polynomial encoders: every degree of freedom is a polynomial of the contact vector.

Equations 1 (quadratic), 2 (linear) and 3 (cubic) of Chung, Kim, Han and Pollard (2015). For 15
inputs they have K = 136, 16 and 816 terms. Because s_i is 0 or 1 and a lifted finger stands at
(-1, -1), some terms repeat others (s^2 = s, x s = x + 1 - s): of the 136 quadratic terms only 121
are independent. The fit therefore goes through a singular value decomposition of scaled columns,
which takes the shortest of all equal solutions; predictions do not depend on the choice.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import lstsq

from models.errors import EncoderError

Array = NDArray[np.float64]

_RCOND = 1e-10
"""Singular values below this share of the largest count as zero: far below those of independent
terms (measured on captures of the simulated subject: above 1e-6), far above rounding (1e-15)."""


def monomials(width: int, degree: int) -> list[tuple[int, ...]]:
    """Input indices of every term, the constant first, then by degree."""
    terms: list[tuple[int, ...]] = []
    for d in range(degree + 1):
        terms += combinations_with_replacement(range(width), d)
    return terms


class PolynomialEncoder:
    """Least-squares polynomial from inputs to outputs.

    Args:
        degree: 1, 2 or 3.
        ridge: Penalty on the standardised coefficients, as a share of the number of frames;
            0 is plain least squares, as in the paper.

    Attributes:
        coef_: (K, n_outputs) coefficients of the terms of `monomials`.
        rank_: Number of independent terms found by the fit (plain least squares only).
        n_inputs_, n_outputs_: Widths seen by the fit.
    """

    def __init__(self, degree: int = 2, ridge: float = 0.0) -> None:
        self.degree = degree
        self.ridge = ridge

    def fit(self, U: ArrayLike, Q: ArrayLike) -> PolynomialEncoder:
        """Learns from inputs U (T, width) and outputs Q (T, n_outputs).

        Raises:
            EncoderError: Shapes disagree, a value is not finite, or the degree or ridge is not
                one that this encoder has.
        """
        U, Q = np.asarray(U, float), np.asarray(Q, float)
        self._check(U, Q)
        self.n_inputs_, self.n_outputs_ = U.shape[1], Q.shape[1]
        self._plan(self.n_inputs_)
        X = self.terms(U)
        if self.ridge > 0:
            self.coef_ = ridge_path(X, Q, [self.ridge])[0]
            self.rank_ = X.shape[1]
            return self
        scale = np.sqrt(np.mean(X * X, axis=0))
        scale[scale == 0] = 1.0
        solution, _, self.rank_, _ = lstsq(X / scale, Q, cond=_RCOND, lapack_driver="gelsd")
        self.coef_ = solution / scale[:, None]
        return self

    def predict(self, U: ArrayLike) -> Array:
        """Outputs (T, n_outputs) of inputs (T, width), or (n_outputs,) of one input (width,)."""
        if not hasattr(self, "coef_"):
            raise EncoderError("the encoder has learned nothing yet", remedy="Call fit first")
        U = np.asarray(U, float)
        if U.shape[-1] != self.n_inputs_:
            raise EncoderError(
                "wrong number of inputs", got=U.shape[-1], expected=str(self.n_inputs_)
            )
        return self.terms(U) @ self.coef_

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

    def load(self, coef: ArrayLike, n_inputs: int) -> PolynomialEncoder:
        """Takes over coefficients (K, n_outputs) learned earlier."""
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
        return self

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

    def _check(self, U: Array, Q: Array) -> None:
        if self.degree not in (1, 2, 3):
            raise EncoderError("no such degree", got=self.degree, expected="1, 2 or 3")
        if not 0 <= self.ridge < np.inf:
            raise EncoderError("no such ridge", got=self.ridge, expected="0 or more, finite")
        if U.ndim != 2 or Q.ndim != 2 or len(U) != len(Q) or not len(U):
            raise EncoderError(
                "inputs and outputs do not belong together",
                got=(U.shape, Q.shape),
                expected="(T, width) and (T, n_outputs)",
            )
        if not (np.isfinite(U).all() and np.isfinite(Q).all()):
            raise EncoderError("inputs and outputs must be finite")


def ridge_path(X: Array, Q: Array, ridges: Sequence[float]) -> Array:
    """(len(ridges), K, n_outputs) coefficients of terms X (T, K), one set for every penalty.

    Penalties are on standardised terms, the constant is not penalised; the costly part, the terms'
    products, is done once for all of them.
    """
    mean, std = X.mean(axis=0), X.std(axis=0)
    # A term that never varies carries nothing; without this it would be divided by nothing.
    std[std < 1e-12 * np.maximum(1.0, np.abs(mean))] = np.inf
    Z = (X - mean) / std
    centre = Q.mean(axis=0)
    gram, right = Z.T @ Z, Z.T @ (Q - centre)
    weights = np.empty((len(ridges), X.shape[1], Q.shape[1]))
    for i, ridge in enumerate(ridges):
        penalised = gram + ridge * len(X) * np.eye(len(gram))
        weights[i] = np.linalg.solve(penalised, right) / std[:, None]
        weights[i, 0] = centre - mean @ weights[i]
    return weights


class LinearEncoder(PolynomialEncoder):
    """Equation 2: 16 terms for 15 inputs."""

    def __init__(self, ridge: float = 0.0) -> None:
        super().__init__(1, ridge)


class QuadraticEncoder(PolynomialEncoder):
    """Equation 1, the paper's encoder: 136 terms for 15 inputs."""

    def __init__(self, ridge: float = 0.0) -> None:
        super().__init__(2, ridge)


class CubicEncoder(PolynomialEncoder):
    """Equation 3: 816 terms for 15 inputs."""

    def __init__(self, ridge: float = 0.0) -> None:
        super().__init__(3, ridge)
