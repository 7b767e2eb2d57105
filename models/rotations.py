"""Rotation vectors, matrices and unit quaternions (w, x, y, z), in batches.

Contains only the functions that the inner loops need, for arrays of shape (..., 3): one 60 Hz frame
and a capture of ten thousand frames use the same code.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike

from models import arithmetic
from models.arithmetic import Array, squared_lengths, stacked_product

Vector = tuple[float, float, float]

_SMALL = 1e-6
"""Angle in radians below which series replace the closed forms (their error is then 1e-13)."""


def skew(v: ArrayLike) -> Array:
    """Matrices (..., 3, 3) with skew(v) @ a == cross(v, a)."""
    v = np.asarray(v, float)
    out = np.zeros((*v.shape, 3))
    out[..., 0, 1], out[..., 0, 2] = -v[..., 2], v[..., 1]
    out[..., 1, 0], out[..., 1, 2] = v[..., 2], -v[..., 0]
    out[..., 2, 0], out[..., 2, 1] = -v[..., 1], v[..., 0]
    return out


def exp(w: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3) in radians (Rodrigues)."""
    a, b, _, k, k2 = _series(np.asarray(w, float))
    return np.eye(3) + a * k + b * k2


def exp_and_left_jacobian(w: ArrayLike) -> tuple[Array, Array]:
    """exp(w) and left Jacobian J, both (..., 3, 3): exp(w + d) = exp(J d) exp(w), small d."""
    a, b, c, k, k2 = _series(np.asarray(w, float))
    eye = np.eye(3)
    return eye + a * k + b * k2, eye + b * k + c * k2


def _series(w: Array) -> tuple[Array, Array, Array, Array, Array]:
    """sin t/t, (1-cos t)/t^2, (t-sin t)/t^3 shaped (..., 1, 1), and skew(w), skew(w)^2."""
    t2 = squared_lengths(w)[..., None, None]
    t = np.sqrt(t2)
    small = t < _SMALL
    t_safe = np.where(small, 1.0, t)
    t2_safe = t_safe * t_safe
    a = np.where(small, 1.0 - t2 / 6.0, arithmetic.sin(t_safe) / t_safe)
    # 1 - cos loses half the digits for small angles; 2 sin^2(t/2) does not.
    half = arithmetic.sin(0.5 * t_safe)
    b = np.where(small, 0.5 - t2 / 24.0, 2.0 * half * half / t2_safe)
    c = np.where(small, 1.0 / 6.0 - t2 / 120.0, (1.0 - a) / t2_safe)
    k = skew(w)
    return a, b, c, k, stacked_product(k, k)


def log(R: ArrayLike) -> Array:
    """Rotation vectors (..., 3), angle in [0, pi], of rotation matrices (..., 3, 3)."""
    return quaternion_log(matrix_to_quaternion(R))


def log_of_axes(x: Vector, y: Vector, z: Vector) -> Vector:
    """`log` of a single rotation with columns x, y and z, in plain floats."""
    # Four times the squares of the quaternion's components; the largest is not small.
    squares = (
        1.0 + x[0] + y[1] + z[2],
        1.0 + x[0] - y[1] - z[2],
        1.0 - x[0] + y[1] - z[2],
        1.0 - x[0] - y[1] + z[2],
    )
    best = squares.index(max(squares))
    if best == 0:
        q = squares[0], y[2] - z[1], z[0] - x[2], x[1] - y[0]
    elif best == 1:
        q = y[2] - z[1], squares[1], x[1] + y[0], z[0] + x[2]
    elif best == 2:
        q = z[0] - x[2], x[1] + y[0], squares[2], y[2] + z[1]
    else:
        q = x[1] - y[0], z[0] + x[2], y[2] + z[1], squares[3]
    norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    w, u, v, t = (c / (-norm if q[0] < 0.0 else norm) for c in q)
    n = sqrt(u * u + v * v + t * t)
    scale = 2.0 * atan2(n, w) / n if n > _SMALL else 2.0
    return scale * u, scale * v, scale * t


def matrix_to_quaternion(R: ArrayLike) -> Array:
    """Unit quaternions (..., 4), w >= 0, of rotation matrices (..., 3, 3); accurate at any
    angle."""
    R = np.asarray(R, float)
    m = R.reshape(-1, 3, 3)
    # The symmetric matrix whose diagonal contains 4 w^2, 4 x^2, 4 y^2, 4 z^2. Its row with the
    # largest diagonal element is the quaternion times a number that is not small.
    s = np.empty((len(m), 4, 4))
    d = m[:, [0, 1, 2], [0, 1, 2]]
    s[:, 0, 0] = 1 + d[:, 0] + d[:, 1] + d[:, 2]
    s[:, 1, 1] = 1 + d[:, 0] - d[:, 1] - d[:, 2]
    s[:, 2, 2] = 1 - d[:, 0] + d[:, 1] - d[:, 2]
    s[:, 3, 3] = 1 - d[:, 0] - d[:, 1] + d[:, 2]
    s[:, 0, 1] = s[:, 1, 0] = m[:, 2, 1] - m[:, 1, 2]
    s[:, 0, 2] = s[:, 2, 0] = m[:, 0, 2] - m[:, 2, 0]
    s[:, 0, 3] = s[:, 3, 0] = m[:, 1, 0] - m[:, 0, 1]
    s[:, 1, 2] = s[:, 2, 1] = m[:, 1, 0] + m[:, 0, 1]
    s[:, 1, 3] = s[:, 3, 1] = m[:, 0, 2] + m[:, 2, 0]
    s[:, 2, 3] = s[:, 3, 2] = m[:, 2, 1] + m[:, 1, 2]
    best = np.argmax(s[:, range(4), range(4)], axis=1)
    q = s[np.arange(len(m)), best]
    q /= np.sqrt(squared_lengths(q))[:, None]
    q *= np.where(q[:, :1] < 0, -1.0, 1.0)
    return q.reshape(*R.shape[:-2], 4)


def quaternion_log(q: ArrayLike) -> Array:
    """Rotation vectors (..., 3), angle in [0, pi], of unit quaternions (..., 4) w, x, y, z."""
    q = np.asarray(q, float)
    q = q * np.where(q[..., :1] < 0, -1.0, 1.0)
    v = q[..., 1:]
    n = np.sqrt(squared_lengths(v))[..., None]
    small = n < _SMALL
    scale = np.where(small, 2.0, 2.0 * arithmetic.atan2(n, q[..., :1]) / np.where(small, 1.0, n))
    return scale * v


def quaternion_exp(w: ArrayLike) -> Array:
    """Unit quaternions (..., 4) of rotation vectors (..., 3)."""
    w = np.asarray(w, float)
    t = np.sqrt(squared_lengths(w))[..., None]
    small = t < _SMALL
    share = np.where(small, 0.5, arithmetic.sin(0.5 * t) / np.where(small, 1.0, t))
    return np.concatenate([arithmetic.cos(0.5 * t), share * w], axis=-1)


def quaternion_to_matrix(q: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    return exp(quaternion_log(q))


def geodesic_angle(a: ArrayLike, b: ArrayLike) -> Array:
    """Angle in radians (...) of the rotation from exp(a) to exp(b), rotation vectors (..., 3)."""
    relative = stacked_product(np.swapaxes(exp(a), -1, -2), exp(b))
    return np.sqrt(squared_lengths(log(relative)))


def unwrap_near(w: ArrayLike, reference: ArrayLike) -> Array:
    """The rotation vector (..., 3) nearest to `reference` among those of the same rotation as w.

    These are w + 2 pi k axis for whole numbers k.
    """
    w, reference = np.asarray(w, float), np.asarray(reference, float)
    t = np.sqrt(squared_lengths(w))[..., None]
    axis = np.where(t < _SMALL, 0.0, w / np.where(t < _SMALL, 1.0, t))
    turns = np.round(np.sum((reference - w) * axis, axis=-1, keepdims=True) / (2 * np.pi))
    return w + 2 * np.pi * turns * axis


def turned_about_normal(w: ArrayLike, turn: float) -> tuple[float, float, float]:
    """The rotation vector of exp((0, 0, turn)) exp(w) for a single w (3,), turn in rad.

    Computed in plain floats, in a tenth of the time of the batched functions.
    """
    x, y, z = np.asarray(w, float).tolist()
    t = sqrt(x * x + y * y + z * z)
    s = sin(0.5 * t) / t if t > _SMALL else 0.5 - t * t / 48.0
    a, x, y, z = cos(0.5 * t), s * x, s * y, s * z
    c, s = cos(0.5 * turn), sin(0.5 * turn)
    a, x, y, z = c * a - s * z, c * x - s * y, c * y + s * x, c * z + s * a
    n = sqrt(x * x + y * y + z * z)
    # The sign selects the rotation by at most pi; for a negative cosine, atan2 alone would give the
    # longer rotation.
    sign = -1.0 if a < 0 else 1.0
    scale = sign * (2.0 * atan2(n, sign * a) / n if n > _SMALL else 2.0)
    return scale * x, scale * y, scale * z


def turn_about_normal(w: Array | Vector) -> float:
    """Angle in rad of the rotation about (0, 0, 1) nearest to exp(w), for a single w (3,)."""
    x, y, z = w.tolist() if isinstance(w, np.ndarray) else w
    t2 = x * x + y * y + z * z
    t = sqrt(t2)
    a = sin(t) / t if t > _SMALL else 1.0 - t2 / 6.0
    half = sin(0.5 * t) / t if t > _SMALL else 0.5 - t2 / 48.0
    # exp(w) = I + a skew(w) + b skew(w)^2; only four of its components are needed.
    return atan2(2.0 * a * z, 2.0 - 2.0 * half * half * (t2 + z * z))


def unwrapped(w: Array, reference: Array) -> Array:
    """`unwrap_near` for a single vector (3,)."""
    x, y, z = w.tolist()
    t = sqrt(x * x + y * y + z * z)
    if t < _SMALL:
        return w
    u, v, r = reference.tolist()
    ahead = (u - x) * x + (v - y) * y + (r - z) * z
    turns = round(ahead / (t * 2.0 * pi))
    return w if not turns else w * (1.0 + 2.0 * pi * turns / t)
