"""The contact vector `u`: the paper's 15 numbers, the only input of every encoder.

u = (x1, y1, .., x5, y5, s1, .., s5): fingertip positions in inches relative to the leftmost contact
(x right, y down), then contact flags; a lifted finger is (-1, -1) with flag 0.
Source: Chung, Kim, Han, Pollard (2015), section 2, and section 4 for the units.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

LIFTED = -1.0
"""Both coordinates of a finger that does not touch; the paper found that the value matters
little."""

CONTACT_VECTOR_SIZE = 15

_NOTHING = [LIFTED] * (2 * len(FINGERS)) + [0.0] * len(FINGERS)
"""Contact vector of a hand without contacts."""


def leftmost(xy: ArrayLike, ids: ArrayLike | None = None) -> int:
    """Index of the leftmost of the contacts (k, 2); ties: smaller y, then smaller id."""
    xy = np.asarray(xy, float)
    order = np.arange(len(xy)) if ids is None else np.asarray(ids)
    return int(np.lexsort((order, xy[:, 1], xy[:, 0]))[0])


def contact_vector(contacts: Mapping[int, tuple[float, float]]) -> Array:
    """The contact vector of labelled contacts.

    Args:
        contacts: label (thumb 0 .. little 4) -> (x, y) in inches, x right and y down, from any
            common origin: the result does not depend on it.

    Returns:
        (15,) u.

    Raises:
        EncoderError: No contact is given, a label is not a finger, or a position is not finite.
    """
    if not contacts:
        raise EncoderError("a contact vector needs at least one contact", expected="1 to 5")
    labels = sorted(contacts)
    if labels[0] < 0 or labels[-1] >= len(FINGERS):
        raise EncoderError("no such finger", got=labels, expected="labels 0 to 4")
    places = [tuple(contacts[label]) for label in labels]
    for place in places:
        if not (len(place) == 2 and isfinite(place[0]) and isfinite(place[1])):
            raise EncoderError(
                "positions must be finite pairs", got=places, expected="(x, y) in inches"
            )
    u = list(_NOTHING)
    left, top = min(places)
    for label, (x, y) in zip(labels, places, strict=True):
        u[2 * label : 2 * label + 2] = x - left, y - top
        u[10 + label] = 1.0
    return np.array(u, float)


def contact_vectors(xy: ArrayLike) -> tuple[Array, Array]:
    """Contact vectors of many frames.

    Args:
        xy: (T, 5, 2) m, surface position by label, NaN where the finger is lifted. Every frame
            has at least one contact.

    Returns:
        U (T, 15) with positions in inches, and the leftmost contact (T, 2) in metres.
    """
    xy = np.asarray(xy, float)
    down = ~np.isnan(xy[..., 0])
    x = np.where(down, xy[..., 0], np.inf)
    y = np.where(down, xy[..., 1], np.inf)
    tied = x == x.min(axis=1, keepdims=True)
    first = np.argmin(np.where(tied, y, np.inf), axis=1)
    origin = xy[np.arange(len(xy)), first]
    inches = (xy - origin[:, None, :]) / METRES_PER_INCH
    U = np.empty((len(xy), CONTACT_VECTOR_SIZE))
    U[:, :10] = np.where(down[..., None], inches, LIFTED).reshape(len(xy), 10)
    U[:, 10:] = down
    return U, origin
