"""Digests of what this machine computes, to name what differs between two machines.

Version numbers do not say enough: one version of glibc has several variants of its functions and
chooses by the processor. So the functions are asked for some thousand values, and these are
digested.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from hashlib import blake2b

import mujoco
import numpy as np

from models.arithmetic import functions, products
from models.arithmetic.arrays import Array
from models.arithmetic.functions import eigen

_ASKED = 400
"""Numbers that every function is asked for."""


@cache
def libm_digest() -> str:
    """Digest of the values of the system's libm, for the functions that MuJoCo and we call."""
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

    All of it is in fixed order and takes no libm, so equal wherever MuJoCo's build is.
    """
    digest = blake2b(digest_size=6)
    A, B = _matrix("A", 15, 48), _matrix("B", 48, 48)
    x = _matrix("x", 1, 48)[0]
    S = products.times_transposed(A, A)
    S[np.diag_indices(len(S))] += 1.0
    solution = products.solve_positive(S.copy(), np.ascontiguousarray(x[: len(S)]))
    sent = [
        products.matrix_product(A, B),
        S,
        products.transposed_times(A, A),
        products.matrix_vector(B, x),
        products.vector_matrix(x, B),
        solution,
        products.stacked_product(B.reshape(-1, 4, 4), B.reshape(-1, 4, 4)),
        products.squared_lengths(B),
        np.array(products.length(x)),
        *eigen(products.times_transposed(A[:6], A[:6])),
        functions.exp_of_many((-20.0 * np.abs(B)).astype(np.float32)),
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
