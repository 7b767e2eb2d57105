"""Products of matrices, and solutions of linear equations, in an order that never changes.

NumPy and SciPy hand these to BLAS and LAPACK, which add in another order on every processor. What
becomes part of a simulation's state is computed here instead: small matrices by MuJoCo's own
routines, which are the same for one version of MuJoCo and one architecture, stacks of tiny ones
term by term. Arrays for MuJoCo are float64 and C-contiguous.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import sqrt

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic.arrays import Array


def matrix_product(A: Array, B: Array) -> Array:
    """A B (n, p) of A (n, m) and B (m, p)."""
    product = np.empty((len(A), B.shape[1]))
    mujoco.mju_mulMatMat(product, A, B)
    return product


def times_transposed(A: Array, B: Array) -> Array:
    """A B' (n, p) of A (n, m) and B (p, m)."""
    product = np.empty((len(A), len(B)))
    mujoco.mju_mulMatMatT(product, A, B)
    return product


def transposed_times(A: Array, B: Array) -> Array:
    """A' B (n, p) of A (m, n) and B (m, p)."""
    product = np.empty((A.shape[1], B.shape[1]))
    mujoco.mju_mulMatTMat(product, A, B)
    return product


def matrix_vector(A: Array, x: Array) -> Array:
    """A x (n,) of A (n, m) and x (m,)."""
    product = np.empty(len(A))
    mujoco.mju_mulMatVec(product, A, x)
    return product


def vector_matrix(x: Array, A: Array) -> Array:
    """x' A (m,) of x (n,) and A (n, m)."""
    product = np.empty(A.shape[1])
    mujoco.mju_mulMatTVec(product, A, x)
    return product


def solve_positive(S: Array, r: Array) -> Array:
    """x (n,) with S x = r, for a symmetric positive definite S (n, n), which is overwritten.

    Only the lower triangle of S is read.

    Raises:
        ArithmeticError: S is not positive definite.
    """
    if mujoco.mju_cholFactor(S, _LEAST_PIVOT) < len(S):
        raise ArithmeticError("the matrix is not positive definite")
    x = np.empty(len(S))
    mujoco.mju_cholSolve(x, S, r)
    return x


_LEAST_PIVOT = 1e-300
"""Smallest diagonal element of a factor that counts as positive."""


def stacked_product(A: Array, B: Array) -> Array:
    """A B (..., n, p) of stacks A (..., n, m) and B (..., m, p) with small m, term by term.

    Leading axes are broadcast. Every term is one exactly rounded product, and terms are added from
    the first to the last.
    """
    product: Array = A[..., :, 0, None] * B[..., 0, None, :]
    for k in range(1, A.shape[-1]):
        product += A[..., :, k, None] * B[..., k, None, :]
    return product


def stacked_applied(A: Array, x: Array) -> Array:
    """A x (..., n) of stacks of matrices A (..., n, m) and vectors x (..., m), as
    `stacked_product`."""
    applied: Array = A[..., :, 0] * x[..., 0, None]
    for k in range(1, A.shape[-1]):
        applied += A[..., :, k] * x[..., k, None]
    return applied


def squared_lengths(x: Array) -> Array:
    """Squared lengths (...) of vectors (..., m), terms added from the first to the last."""
    total: Array = x[..., 0] * x[..., 0]
    for k in range(1, x.shape[-1]):
        total = total + x[..., k] * x[..., k]
    return total


def total(numbers: Iterable[float]) -> float:
    """Sum of numbers, added from the first to the last; of whole numbers it is exact.

    Python's `sum` of floats compensates their rounding from version 3.12 on, and has other last
    digits there.
    """
    so_far: float = 0
    for number in numbers:
        so_far += number
    return so_far


def length(x: Array) -> float:
    """Length of a vector (m,)."""
    total = 0.0
    for component in x.tolist():
        total += component * component
    return sqrt(total)


def distance(a: Iterable[float], b: Iterable[float]) -> float:
    """Distance of two points (m,). `math.dist` is not the same in all versions of Python."""
    total = 0.0
    for x, y in zip(a, b, strict=True):
        total += (x - y) * (x - y)
    return sqrt(total)


def small_product(a: ArrayLike, b: ArrayLike) -> Array:
    """a @ b of small vectors (m,) or matrices (n, m), terms added from the first to the last.

    Two vectors give an array without axes, as a number.
    """
    a, b = np.asarray(a, float), np.asarray(b, float)
    if b.ndim == 1:
        return stacked_applied(a[None], b)[0] if a.ndim == 1 else stacked_applied(a, b)
    return stacked_applied(b.T, a) if a.ndim == 1 else stacked_product(a, b)
