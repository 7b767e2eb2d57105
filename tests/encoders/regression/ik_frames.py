"""Every twentieth frame of the built-in, simulated capture to learn from, and others to predict."""

from __future__ import annotations

from functools import cache

import numpy as np

from encoders.regression.trained import builtin_capture


@cache
def touches() -> np.ndarray:
    """(T, 15) contact vectors that encoders learn from."""
    return builtin_capture().u[::20]


@cache
def poses() -> np.ndarray:
    """(T, 48) relative poses that belong to them."""
    return builtin_capture().relative[::20]


@cache
def new_touches() -> np.ndarray:
    """(T, 15) contact vectors of other frames."""
    return builtin_capture().u[7::240]
