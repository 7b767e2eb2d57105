"""Least squares over any number of frames. The memory does not grow with the number of frames.

Frames come in blocks. Each block of terms and outputs [X Q] is stacked below the triangle of the
previous blocks, and a QR decomposition reduces both to one triangle. The triangle contains all
information that a fit needs. Its condition number is that of X. The condition number of X'X would
be the square of it. Up to rounding, the solution is that of the whole matrix. Frames of one finger
set are reduced together, in the few monomials of that set (`encoders.regression.polynomial`), and
the triangles of all sets are stacked at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from encoders.regression.polynomial import SETS, collapse, set_code, set_codes
from models.arithmetic import Array

RCOND = 1e-10
"""Singular values below this share of the largest singular value count as zero. Independent terms
have shares above 1e-6 on captures of the simulated subject, and rounding gives about 1e-15."""

_ROWS = 4096
"""Number of frames reduced at once. Larger blocks exceed the processor's caches, smaller blocks
repeat work."""

# This module and SciPy are imported only for a fit. A program that only predicts does not load
# them.


class LeastSquares:
    """Accumulates the least-squares problem of a polynomial fit as triangles.

    Args:
        degree: Degree of the polynomial.
        terms: Function that computes all K terms (T, K) of inputs (T, width), the constant first.

    Attributes:
        frames: Number of frames so far.
        codes: Codes of the finger sets of all contact vectors so far
            (`encoders.regression.polynomial`).
        has_unknown_sets: True if some inputs were not contact vectors.
        least, greatest: (width,) least and greatest value of each input.
    """

    def __init__(self, degree: int, terms: Callable[[Array], Array]) -> None:
        self._degree, self._terms = degree, terms
        self._triangles: dict[int, Array] = {}
        self.frames = 0

    @property
    def codes(self) -> frozenset[int]:
        return frozenset(self._triangles) - {0}

    @property
    def has_unknown_sets(self) -> bool:
        return 0 in self._triangles

    def add(self, U: Array, Q: Array) -> None:
        """Adds frames: finite inputs (T, width) and outputs (T, n_outputs)."""
        if not self.frames:
            self.least = np.full(U.shape[1], np.inf)
            self.greatest = -self.least
        self.least = np.minimum(self.least, U.min(axis=0))
        self.greatest = np.maximum(self.greatest, U.max(axis=0))
        self.frames += len(U)
        self._outputs = Q.shape[1]
        codes = set_codes(U)
        for code in np.flatnonzero(np.bincount(codes)):
            rows = np.flatnonzero(codes == code)
            for start in range(0, len(rows), _ROWS):
                chosen = rows[start : start + _ROWS]
                self._reduce(int(code), U[chosen], Q[chosen])

    def _reduce(self, code: int, U: Array, Q: Array) -> None:
        X = collapse(_FINGERS[code], self._degree).terms(U) if code else self._terms(U)
        above = self._triangles.get(code)
        self._triangles[code] = triangle(X, Q, *(() if above is None else (above,)))

    def stacked(self) -> tuple[Array, Array]:
        """Terms (m, K) and outputs (m, n_outputs) with the same least-squares problem as all
        frames.

        m is a few thousand.
        """
        terms, outputs = [], []
        for code, reduced in self._triangles.items():
            left = reduced[:, : -self._outputs]
            if code:
                reduction = collapse(_FINGERS[code], self._degree)
                left = left[:, reduction.monomial] * reduction.sign
            terms.append(left)
            outputs.append(reduced[:, -self._outputs :])
        return np.concatenate(terms), np.concatenate(outputs)

    def solve(self) -> tuple[Array, int]:
        """Least-squares coefficients (K, n_outputs) of the terms, and the rank of the terms.

        If many coefficients fit equally well, those with the smallest norm are chosen, after the
        terms are scaled to equal length.
        """
        from scipy.linalg import lstsq

        X, Q = self.stacked()
        scale = np.sqrt(np.einsum("mk,mk->k", X, X))
        # A term that is zero in all frames has no scale; avoid a division by zero.
        scale[scale == 0] = 1.0
        solution, _, rank, _ = lstsq(X / scale, Q, cond=RCOND, lapack_driver="gelsd")
        return solution / scale[:, None], int(rank)

    def ridge(self, ridges: Sequence[float]) -> Array:
        """Coefficients (len(ridges), K, n_outputs), one set for every penalty; see `ridge_path`."""
        X, Q = self.stacked()
        whole = triangle(X, Q)
        # The first term is the constant, a column of length sqrt(frames). Row 0 of the triangle,
        # divided by this length, is the mean. The other rows give the variation about the mean.
        mean, centre = np.split(whole[0] / whole[0, 0], [X.shape[1]])
        rest, outputs = np.split(whole[1:], [X.shape[1]], axis=1)
        std = _steady(np.linalg.norm(rest, axis=0) / np.sqrt(self.frames), mean)
        gram, right = _normal(rest, outputs, std)
        return _penalised(gram, right, mean, std, centre, self.frames, ridges)


_FINGERS = {set_code(fingers): fingers for fingers in SETS}


def triangle(X: Array, Q: Array, above: Array | None = None) -> Array:
    """Upper triangle R with R'R = [X Q]'[X Q] (+ above'above), of no more rows than columns."""
    from scipy.linalg.lapack import dgeqrf

    n = X.shape[1] + Q.shape[1]
    held = 0 if above is None else len(above)
    work = np.empty((held + len(X), n), order="F")
    if above is not None:
        work[:held] = above
    work[held:, : X.shape[1]] = X
    work[held:, X.shape[1] :] = Q
    reduced, _, _, _ = dgeqrf(work, overwrite_a=1)
    return np.triu(reduced[:n])


def ridge_path(X: Array, Q: Array, ridges: Sequence[float]) -> Array:
    """Coefficients (len(ridges), K, n_outputs) of terms X (T, K), one set for every penalty.

    Penalties apply to standardised terms, except the constant. The costly part, the products of
    the terms, is computed once for all penalties.
    """
    mean, std = X.mean(axis=0), _steady(X.std(axis=0), X.mean(axis=0))
    centre = Q.mean(axis=0)
    gram, right = _normal(X - mean, Q - centre, std)
    return _penalised(gram, right, mean, std, centre, len(X), ridges)


def _steady(std: Array, mean: Array) -> Array:
    """Standard deviations; infinite for terms that never vary, which then get the coefficient 0."""
    return np.where(std < 1e-12 * np.maximum(1.0, np.abs(mean)), np.inf, std)


def _normal(X: Array, Q: Array, std: Array) -> tuple[Array, Array]:
    Z = X / std
    return Z.T @ Z, Z.T @ Q


def _penalised(
    gram: Array,
    right: Array,
    mean: Array,
    std: Array,
    centre: Array,
    frames: int,
    ridges: Sequence[float],
) -> Array:
    weights = np.empty((len(ridges), *right.shape))
    for i, ridge in enumerate(ridges):
        penalised = gram + ridge * frames * np.eye(len(gram))
        weights[i] = np.linalg.solve(penalised, right) / std[:, None]
        weights[i, 0] = centre - mean @ weights[i]
    return weights
