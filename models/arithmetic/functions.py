"""Transcendental functions of arrays, by the system's libm.

NumPy has several versions of these functions and chooses one for the processor; their last digits
differ. What becomes part of a simulation's state is computed here, number by number, by the libm
that MuJoCo calls as well. A hundred numbers cost about 6 us.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic.arrays import Array


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


def asin(x: ArrayLike) -> Array:
    """Angles (...) in rad of sines from -1 to 1."""
    return _each(math.asin, x)


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
