"""Frames, encoders and yardsticks that the tests of inverse kinematics share.

Encoders learn from every twentieth frame of the built-in, simulated capture, and predict others.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from encoders import PcaIkEncoder, contact_vector
from encoders.regression.trained import builtin_capture
from models.kinematics import Kinematics
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH

KINEMATICS = Kinematics(ADULT)

# Few iterations where a truth does not depend on their number.
ENCODERS: dict[str, Callable[[], PcaIkEncoder]] = {
    "pca": lambda: PcaIkEncoder(iterations=10),
    "pca, root free": lambda: PcaIkEncoder(iterations=10, free="root", start="projected"),
    "pca, components only": lambda: PcaIkEncoder(iterations=10, free="nothing", start="mean"),
}

every_encoder = pytest.mark.parametrize("name", ENCODERS)


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


@cache
def fitted(name: str) -> PcaIkEncoder:
    """One of `ENCODERS`, which has learned from `touches` and `poses`."""
    return ENCODERS[name]().fit(touches(), poses())


def pca() -> PcaIkEncoder:
    """The first of `ENCODERS`."""
    return fitted("pca")


def row(*fingers: int) -> np.ndarray:
    """A contact vector of these fingers, spread as fingers are."""
    places = [(0.0, 2.6), (1.4, 0.5), (2.3, 0.2), (3.1, 0.5), (3.8, 1.2)]
    return contact_vector({f: places[f] for f in fingers})


def targets_of(contacts: np.ndarray, height: float) -> np.ndarray:
    """(T, 5, 3) m of contact vectors, written anew; meaningless for lifted fingers."""
    x, y = contacts[:, 0:10:2] * METRES_PER_INCH, contacts[:, 1:10:2] * METRES_PER_INCH
    return np.stack([x, -y, np.full_like(x, height)], axis=-1)


def misses(encoder: PcaIkEncoder, contacts: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(T,) m, farthest touching fingertip of poses from its target."""
    tips = Kinematics(encoder.skeleton).tips(q)
    off = np.linalg.norm(tips - targets_of(contacts, encoder.pad_height_), axis=2)
    return np.where(contacts[:, 10:] == 1, off, 0.0).max(axis=1)
