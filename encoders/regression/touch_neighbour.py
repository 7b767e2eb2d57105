"""Finds the training frames with the most similar touches.

This is the rule of the paper of 2015 for its inverse kinematics (section 3): frames are compared by
the positions of their touches, not by poses. Only frames with the same touching fingers can be
compared; if there are none, this implementation uses frames in which other fingers touch as well.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.input_vector import CONTACT_VECTOR_SIZE, contact_vectors
from models.arithmetic.arrays import Array, Mask
from models.arithmetic.products import squared_lengths, times_transposed
from models.errors import EncoderError
from models.frames import FINGERS
from models.pose import relative_pose
from models.surface import METRES_PER_INCH

_PLACES = 2 * len(FINGERS)


def touches_of(U: ArrayLike) -> tuple[Mask, Array]:
    """Masks (T, 5) and positions (T, 5, 2) of the touching fingers of contact vectors (T, 15).

    Positions are in metres relative to the leftmost contact, x right and y down, NaN where a finger
    is lifted. The leftmost contact is determined again, so that a common shift of a row has no
    effect.

    Raises:
        EncoderError: Wrong width, a value that is not finite, a flag that is neither 0 nor 1, or a
            row without any contact.
    """
    U = np.asarray(U, float)
    if U.ndim != 2 or U.shape[1] != CONTACT_VECTOR_SIZE:
        raise EncoderError(
            "wrong number of inputs", got=U.shape, expected=f"contact vectors {CONTACT_VECTOR_SIZE}"
        )
    if not np.isfinite(U).all():
        raise EncoderError("contact vectors must be finite", where=_first_row(~np.isfinite(U)))
    flags = U[:, _PLACES:]
    odd = (flags != 0.0) & (flags != 1.0)
    if odd.any():
        raise EncoderError(
            "a contact flag is neither 0 nor 1", where=_first_row(odd), got=float(flags[odd][0])
        )
    down = flags == 1.0
    if not down.any(axis=1).all():
        raise EncoderError(
            "a contact vector has no contact",
            where=_first_row(~down.any(axis=1, keepdims=True)),
            expected="1 to 5 fingers down",
        )
    places = U[:, :_PLACES].reshape(-1, len(FINGERS), 2) * METRES_PER_INCH
    places = np.where(down[..., None], places, np.nan)
    if not len(places):
        return down, places
    return down, places - contact_vectors(places)[1][:, None, :]


def finger_names(fingers: Mask) -> str:
    """Names of the fingers of a mask (5,), such as 'thumb, index'."""
    return ", ".join(name for name, down in zip(FINGERS, fingers, strict=True) if down)


class TouchNeighbours:
    """Training frames, grouped by the set of their touching fingers.

    The frames for a set are those with exactly these fingers down; if there are none, those in
    which at least these touch, with touches and pose relative to the leftmost of these.

    Args:
        down: (T, 5) mask of touching fingers.
        places: (T, 5, 2) m relative to the leftmost contact, as `touches_of` gives them.
        Q: (T, 48) relative poses.
    """

    def __init__(self, down: Mask, places: Array, Q: Array) -> None:
        self._down, self._places, self._poses = down, places, Q
        self._frames: dict[bytes, tuple[Array, Array]] = {}

    def nearest(self, fingers: Mask, places: Array) -> Array:
        """Poses (n, 48) of the frames whose touches are nearest to given ones.

        The nearest frame has the least sum of squared distances over the touching fingers; of
        equals, the first is taken. A single touch has no layout and is equally near to all frames:
        the result is then the mean pose of all comparable frames.

        Args:
            fingers: (5,) mask of touching fingers.
            places: (n, 5, 2) m relative to the leftmost contact.

        Raises:
            EncoderError: These fingers touch together in no training frame.
        """
        layouts, poses = self._comparable(fingers)
        if fingers.sum() == 1:
            return np.tile(poses.mean(axis=0), (len(places), 1))
        wanted = places[:, fingers].reshape(len(places), -1)
        # |a - b|^2 less |a|^2, which is the same for all frames.
        distance = squared_lengths(layouts) - 2.0 * times_transposed(wanted, layouts)
        nearest: Array = poses[np.argmin(distance, axis=1)]
        return nearest

    def _comparable(self, fingers: Mask) -> tuple[Array, Array]:
        """Layouts (F, 2 k) m and relative poses (F, 48) of the frames for a set of fingers."""
        key = fingers.tobytes()
        if key not in self._frames:
            rows = np.flatnonzero((self._down == fingers).all(axis=1))
            if not len(rows):
                rows = np.flatnonzero(self._down[:, fingers].all(axis=1))
            if not len(rows):
                raise EncoderError(
                    "no training frame has these fingers down together",
                    where=finger_names(fingers),
                    remedy="Add a take with these fingers to the capture",
                )
            kept = np.where(fingers[:, None], self._places[rows], np.nan)
            _, origin = contact_vectors(kept)
            layouts = (kept - origin[:, None, :])[:, fingers].reshape(len(rows), -1)
            self._frames[key] = layouts, relative_pose(self._poses[rows], origin)
        return self._frames[key]


def _first_row(wrong: Mask) -> str:
    return f"row {int(np.flatnonzero(wrong.any(axis=1))[0])}"
