"""Whether places are so far inside of a surface."""

from __future__ import annotations

import numpy as np

from models.arithmetic.arrays import Array


def inside(places: Array, border: float, size: Array) -> bool:
    """True if places (n, 2) m on a surface of a size (2,) m are all so far, m, from its border."""
    return bool(np.all(places >= border) and np.all(places <= size - border))
