"""Compiled polynomial encoders for contact vectors (extra `fast`: numba).

Everything is compiled when the module is imported, and cached on disk; nothing compiles later.
Sessions do not use it: their arithmetic must not depend on installed packages, or replays would
differ.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.input_vector import CONTACT_VECTOR_SIZE
from encoders.numba_extra import ANY_ORDER, NumbaError, njit
from encoders.regression.collapsed import FLAGS, SETS, ContactPoses, collapse, set_code
from models.arithmetic.arrays import Array
from models.frames import FINGERS

_F = len(FINGERS)
_KEYS = _F << _F
"""A key is a set's code times 5 plus the finger at (0, 0)."""


@njit("int64(float64[::1])", fastmath=ANY_ORDER, cache=True)
def _key(u):  # type: ignore[no-untyped-def]
    """Key of a contact vector; -1 for an invalid one."""
    code, origin = 0, -1
    for f in range(_F):
        if u[FLAGS + f] == 1.0:
            code += 1 << f
            if origin < 0 and u[2 * f] == 0.0 and u[2 * f + 1] == 0.0:
                origin = f
        elif u[FLAGS + f] != 0.0:
            return -1
    return code * _F + origin if origin >= 0 else -1


@njit("void(float64[::1], uint32[:, ::1], int64, float64[::1])", fastmath=ANY_ORDER, cache=True)
def _monomials(u, factors, start, x):  # type: ignore[no-untyped-def]
    """Fills `x` with the values of monomials from `start` on."""
    n = x.shape[0]
    if factors.shape[0] == 2:
        first, second = factors[0, start : start + n], factors[1, start : start + n]
        for r in range(n):
            x[r] = u[first[r]] * u[second[r]]
        return
    for d in range(factors.shape[0]):
        place = factors[d, start : start + n]
        for r in range(n):
            x[r] = u[place[r]] if d == 0 else x[r] * u[place[r]]


@njit(
    "bool(float64[::1], int64[::1], uint32[:, ::1], float64[:, ::1], float64[::1], float64[::1])",
    fastmath=ANY_ORDER,
    cache=True,
)
def _one(u, starts, factors, coef, x, out):  # type: ignore[no-untyped-def]
    """Fills in the outputs of one contact vector; returns false for an invalid one."""
    key = _key(u)
    if key < 0:
        return False
    start, stop = starts[key], starts[key + 1]
    x = x[: stop - start]
    _monomials(u, factors, start, x)
    for n in range(out.shape[0]):
        out[n] = 0.0
    # Four rows at a time, so that outputs are read and written a quarter as often.
    for r in range(0, stop - start, 4):
        a, b, c, d = x[r], x[r + 1], x[r + 2], x[r + 3]
        w = coef[start + r : start + r + 4]
        for n in range(out.shape[0]):
            out[n] += (a * w[0, n] + b * w[1, n]) + (c * w[2, n] + d * w[3, n])
    return True


@njit(
    "bool(float64[:, ::1], int64[::1], uint32[:, ::1], float64[:, ::1], float64[:, ::1])",
    fastmath=ANY_ORDER,
    cache=True,
)
def _many(U, starts, factors, coef, out):  # type: ignore[no-untyped-def]
    """Fills in the outputs of contact vectors, grouped by key; returns false if one is invalid."""
    frames = U.shape[0]
    keys = np.empty(frames, np.int64)
    ends = np.zeros(_KEYS + 1, np.int64)
    for t in range(frames):
        keys[t] = _key(U[t])
        if keys[t] < 0:
            return False
        ends[keys[t] + 1] += 1
    for key in range(_KEYS):
        ends[key + 1] += ends[key]
    order = np.empty(frames, np.int64)
    for t in range(frames):
        order[ends[keys[t]]] = t
        ends[keys[t]] += 1
    first = 0
    while first < frames:
        key = keys[order[first]]
        last, start, stop = ends[key], starts[key], starts[key + 1]
        X = np.empty((last - first, stop - start))
        for i in range(first, last):
            _monomials(U[order[i]], factors, start, X[i - first])
        Q = np.dot(X, coef[start:stop])
        for i in range(first, last):
            q, row = Q[i - first], out[order[i]]
            for n in range(row.shape[0]):
                row[n] = q[n]
        first = last
    return True


class FastContactPoses(ContactPoses):
    """Compiled `ContactPoses` for contact vectors with a finger at (0, 0), as all real ones have.

    Other vectors, and arrays other than C-ordered doubles, fall back to the slower class.
    """

    def __init__(self, coef: Array, degree: int) -> None:
        super().__init__(coef, degree)
        starts, factors, rows = np.zeros(_KEYS + 1, np.int64), [], []
        by_code = {set_code(fingers): fingers for fingers in SETS}
        for key in range(_KEYS):
            fingers, origin = by_code.get(key // _F, ()), key % _F
            starts[key + 1] = starts[key]
            if origin not in fingers:
                continue
            reduced = collapse(fingers, degree, origin)
            # Padded to a multiple of four with monomials that have zero coefficients.
            spare = -reduced.factors.shape[1] % 4
            one = FLAGS + fingers[0]
            factors.append(np.pad(reduced.factors, ((0, 0), (0, spare)), constant_values=one))
            rows.append(np.pad(reduced.coefficients(coef), ((0, spare), (0, 0))))
            starts[key + 1] += len(rows[-1])
        self._starts, self._factors = starts, np.ascontiguousarray(np.hstack(factors), np.uint32)
        self._rows = _aligned(np.vstack(rows))
        self._values = np.empty(int(np.diff(starts).max()))
        self._shape = (self.n_outputs_,)

    def __call__(self, u: Array) -> Array:
        """See `ContactPoses`."""
        out = np.empty(self._shape)
        try:
            if len(u) == CONTACT_VECTOR_SIZE and _one(
                u, self._starts, self._factors, self._rows, self._values, out
            ):
                return out
        except (TypeError, NumbaError):
            # The compiled function does not accept this type of array; numba says so in two ways.
            return super().__call__(u)
        return super().__call__(u)

    def predict(self, U: ArrayLike) -> Array:
        """See `ContactPoses`."""
        U = np.ascontiguousarray(U, float)
        if U.ndim == 2 and U.shape[1] == CONTACT_VECTOR_SIZE:
            out = np.empty((len(U), self.n_outputs_))
            if _many(U, self._starts, self._factors, self._rows, out):
                return out
        return super().predict(U)


def _aligned(array: Array) -> Array:
    """Copy of an array that begins at a cache line."""
    room = np.empty(array.size + 8)
    skipped = -room.ctypes.data % 64 // 8
    copy = room[skipped : skipped + array.size].reshape(array.shape)
    copy[:] = array
    return copy
