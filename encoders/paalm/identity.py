"""Labels the fingers that a device sees: by the paper's order, or by tracking.

The paper sorts by x and counts from the thumb. When a finger vanishes, every later one gets its
neighbour's label. The tracked identity weighs, for every visible finger and every label: the
finger's last position (an unseen finger is assumed to stay, in palm coordinates), the distance of
the finger's line from that finger's knuckle, the device's own id, and whether the visible length
exceeds that finger's length. The most likely assignment of all fingers together is chosen.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from math import exp, perm, sqrt

import numpy as np
from numpy.typing import ArrayLike

from encoders.paalm.calibration import HandCalibration
from encoders.paalm.palm import Palm
from models.arithmetic import Array, squared_lengths
from models.frames import FINGERS, TrackedFinger, Vector

_FIVE = len(FINGERS)
_ASSIGNMENTS = [
    np.array(list(permutations(range(_FIVE), k)), dtype=np.intp).reshape(perm(_FIVE, k), k)
    for k in range(_FIVE + 1)
]
"""All labellings of k fingers, at most 120: trying them all is quicker than a solver."""
_BACKWARDS = [
    ((ways[:, :, None] < ways[:, None]) & (ways[:, :, None] > 0)).reshape(len(ways), -1)
    for ways in _ASSIGNMENTS
]
"""(n, k * k) booleans: true for two of k fingers whose labels are in the order of the hand, the
thumb left out."""

_SIDEWAYS, _IN_PLANE, _THUMB = 0.004, 0.010, 0.020
"""m, spread of the distance of a finger's line from its own knuckle: sideways, within its plane of
bending (the line of a bent finger's visible part does not pass through the knuckle), and in any
direction for the thumb, whose visible part begins at the end of its first bone."""
_STILL, _LOST = 0.006, 0.030
"""m, spread of a tip's step from frame to frame, and of a tip that has been unseen for long."""
_LOST_AFTER = 0.15
"""s in which the spread of an unseen tip grows most of the way."""
_LOOK_AGAIN = 0.1
"""s after which labels are evaluated again although nothing seems to have changed."""
_JUMP = 0.015
"""m. A tip that moved farther since the last frame may be another finger with the same id."""
_SAME_ID = 16.0
"""Weight of the device's id, relative to half-squared deviations; finite, since devices swap
ids."""
_ABREAST = 0.012
"""m across the palm by which two fingertips may be in the wrong order."""
_CROSSED = 100.0
"""Weight of two fingers that are farther in the wrong order: more than all else of both."""
_TOO_LONG = 0.06
"""Share, spread of a length beyond a finger's standard."""
_CAP = 30.0
"""Limit of each piece of evidence, so that none decides alone."""


def paper_order(fingers: Sequence[TrackedFinger], side: str) -> list[int]:
    """The paper's labels: rank by the device's x among the visible fingers."""
    order = sorted(range(len(fingers)), key=lambda i: fingers[i].tip[0], reverse=side == "left")
    names = [0] * len(fingers)
    for rank, i in enumerate(order):
        names[i] = min(rank, _FIVE - 1)
    return names


class TrackedIdentity:
    """Tracks the labels of one hand's fingers.

    Args:
        calibration: The hand, measured open.
        knuckles: (5, 3) m, in palm coordinates.
    """

    def __init__(self, calibration: HandCalibration, knuckles: Array) -> None:
        self._calibration = calibration
        self._first_knuckles = knuckles.copy()
        self._first_knuckles[0] = calibration.bases[0]
        self.reset()

    def reset(self) -> None:
        """Returns to the initial state, an open hand."""
        self.learn((0.0, 0.0, 0.0), self._calibration.standard)
        self._tips = self._calibration.tips.copy()
        self._places: list[Vector] = [(x, y, z) for x, y, z in self._tips.tolist()]
        self._looked_at = -np.inf
        self._seen_at = [-np.inf] * _FIVE
        self._ids: list[int | None] = [None] * _FIVE

    def learn(self, by: Vector, standard: ArrayLike) -> None:
        """Takes over what was learned of the hand.

        Args:
            by: (3,) m by which the knuckles are elsewhere than they were calibrated.
            standard: (5,) m, full lengths.
        """
        self._knuckles = self._first_knuckles + by
        self._standard = np.asarray(standard, float)

    def names(self, fingers: Sequence[TrackedFinger], palm: Palm, time: float) -> list[int]:
        """Labels, 0 to 4, of the visible fingers, at most five."""
        if not fingers:
            return []
        places = [palm.place(f.tip) for f in fingers]
        same = self._unchanged(fingers, places, time)
        if same is not None:
            return same
        self._looked_at = time
        tips = np.array(places)
        cost = self._costs(fingers, tips, palm, time)
        ways = _ASSIGNMENTS[len(fingers)]
        total = cost[np.arange(len(fingers)), ways].sum(axis=1)
        total += _crossed(tips[:, 0])
        best = ways[int(np.argmin(total))].tolist()
        for i, name in enumerate(best):
            self._tips[name] = tips[i]
            self._places[name] = places[i]
            self._seen_at[name] = time
            self._ids = [None if known == fingers[i].id else known for known in self._ids]
            self._ids[name] = fingers[i].id
        return best

    def _unchanged(
        self, fingers: Sequence[TrackedFinger], places: list[Vector], time: float
    ) -> list[int] | None:
        """The previous labels, if ids and positions give no reason to evaluate them again; else
        None."""
        if time - self._looked_at > _LOOK_AGAIN or any(f.id not in self._ids for f in fingers):
            return None
        names = [self._ids.index(f.id) for f in fingers]
        before = [self._places[name] for name in names]
        for (x, y, z), (a, b, c) in zip(places, before, strict=True):
            if sqrt((x - a) * (x - a) + (y - b) * (y - b) + (z - c) * (z - c)) > _JUMP:
                return None
        for i, name in enumerate(names):
            self._tips[name] = self._places[name] = places[i]
            self._seen_at[name] = time
        return names

    def _costs(
        self, fingers: Sequence[TrackedFinger], tips: Array, palm: Palm, time: float
    ) -> Array:
        """Half-squared deviations (k, 5) of every finger from every label."""
        lines = np.array([palm.turn(f.direction) for f in fingers])
        lengths = np.array([f.length for f in fingers])
        spread = np.array(
            [
                _STILL + (_LOST - _STILL) * (1.0 - exp(-(time - at) / _LOST_AFTER))
                for at in self._seen_at
            ]
        )
        moved = squared_lengths(tips[:, None] - self._tips) / spread**2
        missed = self._missed(tips, lines)
        longer = np.maximum(lengths[:, None] / self._standard - 1.05, 0.0) ** 2 / _TOO_LONG**2
        cost = 0.5 * (np.minimum(moved, _CAP) + np.minimum(missed, _CAP) + np.minimum(longer, _CAP))
        for i, finger in enumerate(fingers):
            if finger.id in self._ids:
                cost[i, self._ids.index(finger.id)] -= _SAME_ID
        return np.asarray(cost)

    def _missed(self, tips: Array, lines: Array) -> Array:
        """Squared deviations (k, 5) of fingers' lines from knuckles."""
        to = self._knuckles - tips[:, None]
        # The nearest point of the line, in the plane of bending.
        flat = squared_lengths(lines[:, 1:]) + 1e-3
        at = (to[..., 1] * lines[:, None, 1] + to[..., 2] * lines[:, None, 2]) / flat[:, None]
        rest = to - at[..., None] * lines[:, None]
        in_plane = squared_lengths(rest[..., 1:])
        missed = rest[..., 0] ** 2 / _SIDEWAYS**2 + in_plane / _IN_PLANE**2
        along = to[:, 0, 0] * lines[:, 0] + to[:, 0, 1] * lines[:, 1] + to[:, 0, 2] * lines[:, 2]
        missed[:, 0] = squared_lengths(to[:, 0] - along[:, None] * lines) / _THUMB**2
        return np.asarray(missed)


def _crossed(across: Array) -> Array:
    """Weights (n,) of all assignments of k fingers in which fingers change places.

    The tips of the four fingers are in the order of the fingers; the thumb may pass under the palm.

    Args:
        across: (k,) m, the tips' places across the palm.
    """
    beyond = across[:, None] - across > _ABREAST
    return np.asarray(_CROSSED * (_BACKWARDS[len(across)] & beyond.ravel()).sum(axis=1))
