"""Array types, and arithmetic whose result is the same on every machine.

Here, matrix products and solutions of linear equations add their terms in a fixed order. NumPy and
SciPy use BLAS and LAPACK for these products and solutions; the order of the terms in BLAS and
LAPACK depends on the processor. Numbers that become part of a simulation's state are therefore
computed here. Small matrices use MuJoCo's own routines, whose results are the same for one version
of MuJoCo and one architecture. Stacks of tiny matrices are computed term by term. Arrays for MuJoCo
are float64 and C-contiguous.

Transcendental functions of arrays call the system's libm for each number, as MuJoCo does. NumPy has
several versions of these functions and chooses one for the processor; their last digits differ. A
hundred numbers take about 6 us.

Two machines are compared by digests of numbers that they compute. Version numbers are not enough:
one version of glibc has several variants of its functions and chooses one for the processor. A
digest therefore covers some thousand values of these functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from hashlib import blake2b
from math import sqrt

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

# Numbers: positions, poses, times, probabilities.
Array = NDArray[np.float64]
# Booleans that select elements of another array.
Mask = NDArray[np.bool_]
Single = NDArray[np.float32]


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
    """Sum of numbers, added from the first to the last. The sum of whole numbers is exact.

    From version 3.12 on, Python's `sum` compensates the rounding of floats, so its last digits
    differ from those of earlier versions.
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

    Two vectors give an array of shape (), which can be used as a number.
    """
    a, b = np.asarray(a, float), np.asarray(b, float)
    if b.ndim == 1:
        return stacked_applied(a[None], b)[0] if a.ndim == 1 else stacked_applied(a, b)
    return stacked_applied(b.T, a) if a.ndim == 1 else stacked_product(a, b)


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


def exp(x: ArrayLike) -> Array:
    """Exponentials of numbers (...); infinite where they are too large."""
    return _each(_exp, x)


def exp_of_many(x: Single) -> Single:
    """Exponentials of many numbers (...) of 0 or less, in single precision.

    It uses only element-wise sums and products, which every processor rounds alike, and is ten
    times as fast as libm. The relative error is below 3e-7. Below -87 the result is 0.
    """
    # x = n log 2 + rest. log 2 is split into two parts; n times the first part is exact.
    n = np.rint(x * _LOG2_E)
    rest = x - n * _LOG_2
    rest -= n * _LOG_2_REST
    result = rest * _SERIES[0]
    for coefficient in _SERIES[1:-1]:
        result += coefficient
        result *= rest
    result += _SERIES[-1]
    # As a float, 2 to the power n has the bits of n + 127, shifted left by 23 places.
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
"""Largest number of rounds over all pairs of rows; about eight are usually enough."""
_SMALL = 1e-30
"""Ratio of the largest squared off-diagonal element to the largest squared element, below which a
matrix counts as diagonal."""


def eigen(S: Array) -> tuple[Array, Array]:
    """Eigenvalues (n,), largest first, and eigenvectors (n, n) in columns, of a symmetric S (n, n).

    The largest component of every eigenvector is positive. The method is Jacobi's (Golub and Van
    Loan, Matrix Computations, 8.5). It is slower than LAPACK, but it uses only sums, products and
    square roots of single numbers, in a fixed order.
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


_ASKED = 400
"""Number of values of each function in a digest."""


@cache
def libm_digest() -> str:
    """Digest of values of the system's libm, for the functions that MuJoCo and this project
    call."""
    digest = blake2b(digest_size=6)
    for function in (math.sin, math.cos, math.tan, math.atan, math.exp, math.expm1):
        for x in _numbers(function.__name__, 6.0):
            digest.update(_bytes(function(x)))
    for function in (math.log, math.log1p, math.sqrt):
        for x in _numbers(function.__name__, 50.0):
            digest.update(_bytes(function(abs(x) + 1e-9)))
    for function in (math.asin, math.acos):
        for x in _numbers(function.__name__, 1.0):
            digest.update(_bytes(function(x)))
    for x, y in zip(_numbers("first", 5.0), _numbers("second", 5.0), strict=True):
        digest.update(_bytes(math.atan2(y, x)))
        digest.update(_bytes(math.pow(abs(x), y)))
        digest.update(_bytes(math.fmod(x, y)))
    return digest.hexdigest()


@cache
def arithmetic_digest() -> str:
    """Digest of products, solutions, sums and rotations, by MuJoCo and by NumPy.

    Everything is computed in fixed order and without libm, so the digest is equal for equal builds
    of MuJoCo.
    """
    digest = blake2b(digest_size=6)
    A, B = _matrix("A", 15, 48), _matrix("B", 48, 48)
    x = _matrix("x", 1, 48)[0]
    S = times_transposed(A, A)
    S[np.diag_indices(len(S))] += 1.0
    solution = solve_positive(S.copy(), np.ascontiguousarray(x[: len(S)]))
    sent = [
        matrix_product(A, B),
        S,
        transposed_times(A, A),
        matrix_vector(B, x),
        vector_matrix(x, B),
        solution,
        stacked_product(B.reshape(-1, 4, 4), B.reshape(-1, 4, 4)),
        squared_lengths(B),
        np.array(length(x)),
        *eigen(times_transposed(A[:6], A[:6])),
        exp_of_many((-20.0 * np.abs(B)).astype(np.float32)),
        B.mean(axis=0),
        B.sum(axis=1),
        A.sum(),
        np.interp(x, np.sort(x), B[0]),
    ]
    for array in sent:
        digest.update(np.ascontiguousarray(array).tobytes())
    quaternion = np.zeros(4)
    for row in A:
        mujoco.mju_mulQuat(quaternion, row[:4].copy(), row[4:8].copy())
        digest.update(quaternion.tobytes())
    return digest.hexdigest()


def _numbers(seed: str, size: float) -> Iterator[float]:
    """Numbers from -size to size that every machine draws alike: bytes of a hash, scaled."""
    stream = blake2b(seed.encode(), digest_size=64).digest()
    count = 0
    while True:
        for i in range(0, 64, 8):
            if count == _ASKED:
                return
            share = int.from_bytes(stream[i : i + 8], "little") / 2.0**64
            yield size * (2.0 * share - 1.0)
            count += 1
        stream = blake2b(stream, digest_size=64).digest()


def _matrix(seed: str, rows: int, columns: int) -> Array:
    """Matrix (rows, columns) of numbers from -1 to 1."""
    numbers: list[float] = []
    part = 0
    while len(numbers) < rows * columns:
        numbers += _numbers(f"{seed} {part}", 1.0)
        part += 1
    return np.array(numbers[: rows * columns]).reshape(rows, columns)


def _bytes(x: float) -> bytes:
    return np.float64(x).tobytes()
