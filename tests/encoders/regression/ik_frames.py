"""Frames, encoders and yardsticks that the tests of inverse kinematics share.

Encoders learn from every twentieth frame of the built-in, simulated capture, and predict others.
"""

from __future__ import annotations

import numpy as np
import pytest

from encoders import PcaIkEncoder, contact_vector
from encoders.regression.regularised_ik import MapIkEncoder, NullSpaceIkEncoder
from encoders.regression.touch_ik import TouchIkEncoder
from encoders.regression.trained import builtin_capture
from models.kinematics import Kinematics
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH

CAPTURE = builtin_capture()
LEARNED, UNSEEN = np.arange(0, len(CAPTURE), 20), np.arange(7, len(CAPTURE), 240)
U, Q = CAPTURE.u[LEARNED], CAPTURE.relative[LEARNED]
NEW = CAPTURE.u[UNSEEN]
KINEMATICS = Kinematics(ADULT)

# Few iterations where a truth does not depend on their number.
PCA = PcaIkEncoder(iterations=10).fit(U, Q)
ENCODERS = {
    "pca": PCA,
    "pca, root free": PcaIkEncoder(iterations=10, free="root", start="projected").fit(U, Q),
    "pca, components only": PcaIkEncoder(iterations=10, free="nothing", start="mean").fit(U, Q),
    "null space, mean": NullSpaceIkEncoder(iterations=10).fit(U, Q),
    "null space, neighbour": NullSpaceIkEncoder(iterations=10, desired="neighbour").fit(U, Q),
    "likeliest": MapIkEncoder(iterations=10).fit(U, Q),
}
KINDS = [PcaIkEncoder, NullSpaceIkEncoder, MapIkEncoder]

every_encoder = pytest.mark.parametrize("encoder", ENCODERS.values(), ids=ENCODERS)
every_kind = pytest.mark.parametrize("kind", KINDS)


def row(*fingers: int) -> np.ndarray:
    """A contact vector of these fingers, spread as fingers are."""
    places = [(0.0, 2.6), (1.4, 0.5), (2.3, 0.2), (3.1, 0.5), (3.8, 1.2)]
    return contact_vector({f: places[f] for f in fingers})


def targets_of(contacts: np.ndarray, height: float) -> np.ndarray:
    """(T, 5, 3) m of contact vectors, written anew; meaningless for lifted fingers."""
    x, y = contacts[:, 0:10:2] * METRES_PER_INCH, contacts[:, 1:10:2] * METRES_PER_INCH
    return np.stack([x, -y, np.full_like(x, height)], axis=-1)


def misses(encoder: TouchIkEncoder, contacts: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(T,) m, farthest touching fingertip of poses from its target."""
    tips = Kinematics(encoder.skeleton).tips(q)
    off = np.linalg.norm(tips - targets_of(contacts, encoder.pad_height_), axis=2)
    return np.where(contacts[:, 10:] == 1, off, 0.0).max(axis=1)
