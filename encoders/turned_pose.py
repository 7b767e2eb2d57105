"""The turned encoder for one contact vector after another, as sessions ask for it.

What `TurnedEncoder.predict` does for any number of frames costs, for a single one, mostly calls of
NumPy. Here everything that a set of touching fingers decides is prepared once per set, what is left
of a quadratic is v' A v with the touching fingers' coordinates in v, and of the first rounds only
the turn is worked out, which is all that they are for. Results agree to rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from encoders.collapsed import FLAGS, collapse
from encoders.contact_vector import LIFTED
from models.frames import FINGERS
from models.pose import ROOT_ROTATION
from models.rotations import turn_about_normal, turned_about_normal
from models.surface import METRES_PER_INCH

Array = NDArray[np.float64]

_MIDDLE = 0.0
"""Both coordinates of a lifted finger in the turned frame, whose origin is the touches' middle."""


class _Quadratic:
    """v' A v for every output, v being 1 and the coordinates of one set of fingers."""

    def __init__(self, coef: Array, fingers: tuple[int, ...], lifted: float) -> None:
        found = collapse(fingers, 2, None, lifted)
        places = [FLAGS + fingers[0], *(2 * f + axis for f in fingers for axis in range(2))]
        row = {place: i for i, place in enumerate(places)}
        self._outputs = coef.shape[1]
        A = np.zeros((len(places), len(places), self._outputs))
        for pair, values in zip(found.factors.T.tolist(), found.coefficients(coef), strict=True):
            A[row[pair[0]], row[pair[1]]] += values
        self._first = A.reshape(len(places), -1)
        self._shape = (len(places), self._outputs)

    def __call__(self, v: Array) -> Array:
        # `dot` is what `@` is, to the bit, at two thirds of the price.
        found: Array = v.dot(v.dot(self._first).reshape(self._shape))
        return found


class TurnedPose:
    """A fitted turned encoder, prepared for single contact vectors.

    Args:
        coef: (1 + rounds, 136, 48) coefficients of its quadratics.
    """

    def __init__(self, coef: Array) -> None:
        self._coef = coef
        self._sets: dict[tuple[float, ...], tuple[tuple[int, ...], list[_Quadratic]]] = {}

    def __call__(self, u: Array) -> Array | None:
        """(48,) relative pose of a contact vector (15,); None if `u` is no contact vector."""
        numbers = u.tolist()
        flags = tuple(numbers[FLAGS:])
        prepared = self._sets.get(flags)
        if prepared is None:
            prepared = self._prepare(flags)
            if prepared is None:
                return None
        fingers, (first, *others) = prepared
        for f, flag in enumerate(flags):
            if flag == 0.0 and (numbers[2 * f] != LIFTED or numbers[2 * f + 1] != LIFTED):
                return None
        x = [numbers[2 * f] for f in fingers]
        y = [-numbers[2 * f + 1] for f in fingers]
        v = [1.0]
        for f in fingers:
            v += numbers[2 * f : 2 * f + 2]
        # All rounds but the last are for the turn alone, and predict the root's rotation only.
        w = first(np.array(v))
        turn = turn_about_normal(w)
        mx, my = sum(x) / len(x), sum(y) / len(y)
        x, y = [a - mx for a in x], [a - my for a in y]
        for stage in others[:-1]:
            w = stage(_turned(x, y, turn))
            turn = turn_about_normal(turned_about_normal(w, turn))
        q = others[-1](_turned(x, y, turn))
        c, s = cos(turn), sin(turn)
        px, py = float(q[0]), float(q[1])
        q[0] = c * px - s * py + mx * METRES_PER_INCH
        q[1] = s * px + c * py + my * METRES_PER_INCH
        q[ROOT_ROTATION] = turned_about_normal(q[ROOT_ROTATION], turn)
        return q

    def _prepare(self, flags: tuple[float, ...]) -> tuple[tuple[int, ...], list[_Quadratic]] | None:
        if not set(flags) <= {0.0, 1.0} or not any(flags) or len(self._coef) < 2:
            return None
        fingers = tuple(f for f in range(len(FINGERS)) if flags[f])
        last = len(self._coef) - 1
        quadratics = [
            _Quadratic(
                coef if i == last else coef[:, ROOT_ROTATION],
                fingers,
                _MIDDLE if i else LIFTED,
            )
            for i, coef in enumerate(self._coef)
        ]
        self._sets[flags] = fingers, quadratics
        return self._sets[flags]


def _turned(x: Sequence[float], y: Sequence[float], turn: float) -> Array:
    """1 and coordinates about the touches' middle, y up, turned back by `turn`."""
    c, s = cos(turn), sin(turn)
    v = [1.0]
    for a, b in zip(x, y, strict=True):
        v.append(c * a + s * b)
        v.append(c * b - s * a)
    return np.array(v)
