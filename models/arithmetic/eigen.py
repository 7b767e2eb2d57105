"""Eigenvectors of a symmetric matrix, in arithmetic that every processor rounds alike."""

from __future__ import annotations

import numpy as np

from models.arithmetic.arrays import Array

_SWEEPS = 60
"""Most rounds over all pairs of rows; about eight are the rule."""
_SMALL = 1e-30
"""Share of the squared diagonal below which what is left beside it counts as nothing."""


def eigen(S: Array) -> tuple[Array, Array]:
    """Eigenvalues (n,), largest first, and eigenvectors (n, n) in columns, of a symmetric S (n, n).

    The largest component of every eigenvector is positive. Jacobi's method (Golub and Van Loan,
    Matrix Computations, 8.5): slower than LAPACK, but it takes only sums, products and square roots
    of single numbers, whose order is fixed here.
    """
    A = np.array(S, float)
    n = len(A)
    V = np.eye(n)
    for _ in range(_SWEEPS):
        aside = A - np.diag(np.diag(A))
        if float((aside * aside).max(initial=0.0)) <= _SMALL * float((A * A).max(initial=0.0)):
            break
        for p in range(n - 1):
            for q in range(p + 1, n):
                _rotate(A, V, p, q)
    values = np.diag(A).copy()
    order = np.argsort(-values, kind="stable")
    vectors = V[:, order]
    largest = vectors[np.abs(vectors).argmax(axis=0), np.arange(n)]
    return values[order], vectors * np.where(largest < 0.0, -1.0, 1.0)


def _rotate(A: Array, V: Array, p: int, q: int) -> None:
    """Turns rows and columns p and q so that A[p, q] becomes 0."""
    beside = float(A[p, q])
    if beside == 0.0:
        return
    half = (float(A[q, q]) - float(A[p, p])) / (2.0 * beside)
    root = np.sqrt(half * half + 1.0)
    t = 1.0 / (half + root) if half >= 0.0 else 1.0 / (half - root)
    c = 1.0 / np.sqrt(t * t + 1.0)
    s = t * c
    for M in (A.T, A, V.T):
        row = c * M[p] - s * M[q]
        M[q] = s * M[p] + c * M[q]
        M[p] = row
    A[p, q] = A[q, p] = 0.0
