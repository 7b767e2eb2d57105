"""Letting go: fingers keep the width of their grip until they spread, and then let go at once.

A grip stores force in the servos of every finger, also along the faces of the thing. Fingers that
open little by little give it back to the thing, which turns and follows them. Fingers that are
lifted are ghosts in one step, and leave the thing where it is. So are fingers that spread: while
they open by a few millimetres their tips stay where they press, and then the hand is a ghost.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import expm1, sqrt

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length, squared_lengths, total
from models.frames import FINGERS
from models.scene import CONTROL_PERIOD

OPENED = 0.004
"""m that the fingers have spread, each from the middle of all, when they let go. Resting touches
tremble by a millimetre."""
SURE = 0.001
"""m that the fingers have spread, from which on they are expected to spread further."""
FADING = 0.07
"""m/s at which tips return to their touches once they need not be kept."""
MEMORY = 1.0
"""s, time constant with which a narrower grip is forgotten, so that fingers which open slowly
loosen it."""

_Touches = Mapping[int, tuple[float, float]]
"""(x, y) m on the surface by finger."""


class Grip:
    """The width that the solid fingers of a hand keep.

    Attributes:
        offsets: (5, 2) m along the surface, y down, from touches to where the tips are kept; None
            if all are 0.
    """

    def __init__(self) -> None:
        self.offsets: Array | None = None
        self._narrow: dict[int, float] = {}
        self._kept: dict[int, float] = {}

    def step(self, touches: _Touches, solid: frozenset[int]) -> bool:
        """True in the step in which the fingers let go.

        Args:
            touches: Touches of all fingers.
            solid: Fingers that are solid now.
        """
        self.offsets = _faded(self.offsets)
        holding = sorted(solid & touches.keys())
        if len(holding) < 2:
            self._narrow = {}
            return False
        n = len(holding)
        x = total(touches[f][0] for f in holding) / n
        y = total(touches[f][1] for f in holding) / n
        ways = {f: (touches[f][0] - x, touches[f][1] - y) for f in holding}
        far = {f: sqrt(right * right + down * down) for f, (right, down) in ways.items()}
        if self._narrow.keys() != far.keys():
            self._narrow, self._kept = far, {}
            return False
        before, kept = self._kept, {}
        for finger, now in far.items():
            wider = now - self._narrow[finger]
            self._narrow[finger] += wider if wider < 0.0 else _FORGOTTEN * wider
            kept[finger] = now - self._narrow[finger]
        self._kept = kept
        opened = total(kept.values()) / n
        if opened > OPENED:
            self._narrow = {}
            return True
        fading = self.offsets
        self.offsets = np.zeros((len(FINGERS), 2)) if fading is None else fading
        for finger, way in kept.items():
            # The tips get this offset in the next step, when the touches have opened further.
            further = way - before.get(finger, way) if opened > SURE else 0.0
            share = (way + max(further, 0.0)) / far[finger] if way > 0.0 else 0.0
            right, down = ways[finger]
            wanted = np.array([-share * right, -share * down])
            if fading is None or length(wanted) >= length(fading[finger]):
                self.offsets[finger] = wanted
        return False


def _faded(offsets: Array | None) -> Array | None:
    """Offsets (5, 2) m after a control period without a grip; None if all are 0."""
    if offsets is None:
        return None
    far = np.sqrt(squared_lengths(offsets))
    left = np.maximum(far - FADING * CONTROL_PERIOD, 0.0)
    return offsets * (left / np.maximum(far, 1e-12))[:, None] if left.any() else None


_FORGOTTEN = -expm1(-CONTROL_PERIOD / MEMORY)
