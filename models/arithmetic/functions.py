"""Transcendental functions of arrays, by the system's libm, and eigenvalues in a fixed order.

NumPy has several versions of these functions and chooses one for the processor; their last digits
differ. What becomes part of a simulation's state is computed here, number by number, by the libm
that MuJoCo calls as well. A hundred numbers cost about 6 us.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic.arrays import Array

Single = NDArray[np.float32]


def _each(function: Callable[[float], float], x: ArrayLike) -> Array:
    x = np.asarray(x, float)
    values = np.fromiter(map(function, x.ravel().tolist()), float, x.size)
    return values.reshape(x.shape)


def sin(x: ArrayLike) -> Array:
    """Sines of angles (...) in rad."""
    return _each(math.sin, x)


def cos(x: ArrayLike) -> Array:
    """Cosines of angles (...) in rad."""
    return _each(math.cos, x)


def asin(x: ArrayLike) -> Array:
    """Angles (...) in rad, -pi/2 to pi/2, of sines."""
    return _each(math.asin, x)


def exp(x: ArrayLike) -> Array:
    """Exponentials of numbers (...); infinite where they are too large."""
    return _each(_exp, x)


def exp_of_many(x: Single) -> Single:
    """Exponentials of many numbers (...) of 0 or less, in single precision.

    Sums and products of single numbers alone, which every processor rounds alike, ten times as
    quick as libm. The relative error is below 3e-7; below -87 the result is 0.
    """
    # x = n log 2 + rest; log 2 comes in two parts, of which the first times n is exact.
    n = np.rint(x * _LOG2_E)
    rest = x - n * _LOG_2
    rest -= n * _LOG_2_REST
    result = rest * _SERIES[0]
    for coefficient in _SERIES[1:-1]:
        result += coefficient
        result *= rest
    result += _SERIES[-1]
    # 2 to the power n is its bits: the exponent, shifted by 127 and 23 places.
    np.maximum(n, _LEAST_POWER, out=n)
    bits = n.astype(np.int32)
    bits += 127
    bits <<= 23
    result *= bits.view(np.float32)
    return result


_LOG2_E = np.float32(1.4426950408889634)
_LOG_2 = np.float32(0.693359375)
_LOG_2_REST = np.float32(math.log(2.0) - 0.693359375)
_SERIES = tuple(np.float32(1.0 / math.factorial(n)) for n in range(7, -1, -1))
"""Taylor's series of exp for -0.35 to 0.35, highest power first."""
_LEAST_POWER = np.float32(-127.0)


def log(x: ArrayLike) -> Array:
    """Natural logarithms of numbers (...) of 0 or more; minus infinity for 0."""
    return _each(_log, x)


def atan2(y: ArrayLike, x: ArrayLike) -> Array:
    """Angles (...) in rad, -pi to pi, of points (x, y)."""
    y, x = np.broadcast_arrays(np.asarray(y, float), np.asarray(x, float))
    values = np.fromiter(map(math.atan2, y.ravel().tolist(), x.ravel().tolist()), float, y.size)
    return values.reshape(y.shape)


def power(x: ArrayLike, exponent: float) -> Array:
    """Positive numbers (...) raised to an exponent."""
    return _each(lambda number: math.pow(number, exponent), x)


def log_sum_exp(a: Array, b: Array) -> Array:
    """log(exp(a) + exp(b)) of two arrays of one shape, without overflow."""
    larger, smaller = np.maximum(a, b), np.minimum(a, b)
    apart = np.where(larger == smaller, 0.0, smaller - larger)
    return larger + _each(math.log1p, exp(apart))


def _exp(x: float) -> float:
    try:
        return math.exp(x)
    except OverflowError:
        return math.inf


def _log(x: float) -> float:
    return math.log(x) if x else -math.inf


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
