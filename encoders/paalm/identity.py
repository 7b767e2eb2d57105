"""Decides the sides of the hands and the labels of the fingers that a device reports.

The paper sorts fingers by x and counts from the thumb. When a finger vanishes, every later finger
gets its neighbour's label. `TrackedIdentity` instead weighs four pieces of evidence for every
visible finger and every label:

- the distance from the last position of the finger with this label (an unseen finger is assumed to
  stay in place, in palm coordinates);
- the distance of the visible finger's line from the knuckle of the finger with this label;
- the device's id of the finger;
- the excess of the visible length over the full length of the finger with this label.

The most likely assignment of labels to all fingers is chosen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations
from math import exp, perm, sqrt

import numpy as np
from numpy.typing import ArrayLike

from encoders.paalm.calibration import HandCalibration
from encoders.paalm.palm import Palm, palm_of
from models.arithmetic import Array, distance, squared_lengths
from models.frames import FINGERS, HandFrame, TrackedFinger, TrackedHand, Vector
from models.reader_report import SIDE_MENDED

_FIVE = len(FINGERS)
_ASSIGNMENTS = [
    np.array(list(permutations(range(_FIVE), k)), dtype=np.intp).reshape(perm(_FIVE, k), k)
    for k in range(_FIVE + 1)
]
"""All labellings of k fingers, at most 120; testing all of them is quicker than a solver."""
_BACKWARDS = [
    ((ways[:, :, None] < ways[:, None]) & (ways[:, :, None] > 0)).reshape(len(ways), -1)
    for ways in _ASSIGNMENTS
]
"""Booleans (n, k * k), for n labellings of k fingers: True for each pair of fingers in which the
first has the lower label and neither is labelled as the thumb."""

_SIDEWAYS, _IN_PLANE, _THUMB = 0.004, 0.010, 0.020
"""Standard deviations (m) of the distance between a finger's line and its own knuckle. The first is
for the distance sideways. The second is for the distance in the plane of bending; it is larger,
since the line of a bent finger's visible part does not pass through the knuckle. The third is for
the thumb in any direction; the thumb's visible part begins at the end of its first bone."""
_STILL, _LOST = 0.006, 0.030
"""Standard deviations (m) of a tip's step from frame to frame, and of the movement of a tip that
has not been seen for long."""
_LOST_AFTER = 0.15
"""Time constant (s) with which the standard deviation of an unseen tip grows."""
_LOOK_AGAIN = 0.1
"""Time (s) after which labels are evaluated again even if nothing seems to have changed."""
_JUMP = 0.015
"""Largest step (m) of a tip; after a larger step, the same id may belong to another finger."""
_SAME_ID = 16.0
"""Reduction of the cost of a label if the finger has the same id as before. It is finite, since
devices swap ids. A deviation of s standard deviations costs s^2 / 2."""
_ABREAST = 0.012
"""Distance (m) across the palm by which two fingertips may be in the wrong order."""
_CROSSED = 100.0
"""Cost of two fingertips that are in the wrong order by more than `_ABREAST`. It exceeds all other
evidence about both fingers."""
_TOO_LONG = 0.06
"""Standard deviation of the excess of a finger's length over its standard length, as a share of the
standard length."""
_CAP = 30.0
"""Limit of each squared deviation, so that no single piece of evidence decides."""


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
        calibration: Calibration of the hand.
        knuckles: (5, 3) m, positions of the knuckles in palm coordinates.
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
        """Replaces the hand's knuckles and lengths.

        Args:
            by: (3,) m, shift of the knuckles from their calibrated positions.
            standard: (5,) m, full lengths of the fingers.
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
        """The previous labels, or None if ids or positions require a new evaluation."""
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
        """Costs (k, 5) of every label for every finger; a lower cost is more likely."""
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
        # `at` is the point of the line that is nearest to the knuckle in the plane of bending.
        flat = squared_lengths(lines[:, 1:]) + 1e-3
        at = (to[..., 1] * lines[:, None, 1] + to[..., 2] * lines[:, None, 2]) / flat[:, None]
        rest = to - at[..., None] * lines[:, None]
        in_plane = squared_lengths(rest[..., 1:])
        missed = rest[..., 0] ** 2 / _SIDEWAYS**2 + in_plane / _IN_PLANE**2
        along = to[:, 0, 0] * lines[:, 0] + to[:, 0, 1] * lines[:, 1] + to[:, 0, 2] * lines[:, 2]
        missed[:, 0] = squared_lengths(to[:, 0] - along[:, None] * lines) / _THUMB**2
        return np.asarray(missed)


def _crossed(across: Array) -> Array:
    """Costs (n,) of fingers in the wrong order, for all n assignments of labels to k fingers.

    The tips of index to little finger should be in this order across the palm. The thumb is exempt,
    since it may pass under the palm.

    Args:
        across: (k,) m, positions of the tips across the palm.
    """
    beyond = across[:, None] - across > _ABREAST
    return np.asarray(_CROSSED * (_BACKWARDS[len(across)] & beyond.ravel()).sum(axis=1))


_FAR = 0.30
"""If both sides are tracked, a new hand gets a side only within this distance (m) of the last place
of that side's hand."""
_NEAR = 0.10
"""A hand within this distance (m) of the last place of a side's hand counts as the same hand, even
if the device reports the other side for a moment."""
_THUMB_BEHIND = 0.020
"""Least distance (m) by which a thumb's tip is nearer to the palm than the fingertips."""
_SURE = 5
"""Majority, in frames, of thumbs on one side that decides the side of a hand."""
_MOST = 50
"""Limit of this majority, so that a mistake can be corrected. It also limits the number of frames
in which a reported side is corrected."""
_ENOUGH, _CONTRARY = 50, 0.25
"""Least number of frames of a recording that show a side, and greatest share of these frames that
may show the other side."""
_REMEMBERED = 64
"""Number of stored ids beyond which the ids of vanished hands are forgotten."""


class HandSides:
    """Tracks the sides of hands by thumb, id and position, if the device does not report them.

    A hand whose thumb has been seen has the side that its thumb shows. If no thumb has been seen,
    two new hands are distinguished by x; the paper assumes that arms do not cross. The hand with an
    id keeps its side until its thumb shows the other side. A hand with a new id gets the side whose
    hand was last nearest.

    A device that reports sides confuses them for short times. A hand that is near the last place of
    a side, and that has the same id or is alone, therefore keeps this side for up to 50 frames. Of
    two hands with the same side, the previously chosen hand is chosen again, or else the hand with
    the higher confidence.

    Args:
        sides: Sides of the hands to track.
        counts: Receives the numbers of hands that were left out, or whose side was corrected, by
            reason.
    """

    def __init__(self, sides: tuple[str, ...], counts: Counter[str] | None = None) -> None:
        self.sides = sides
        self.counts: Counter[str] = Counter() if counts is None else counts
        self.reset()

    def reset(self) -> None:
        """Forgets all hands."""
        self._ids: dict[str, int] = {}
        self._thumbs: dict[int, int] = {}
        self._places: dict[str, Vector] = {}
        self._mistaken: Counter[str] = Counter()

    def choose(self, frame: HandFrame) -> dict[str, TrackedHand]:
        """The tracked hands that are visible, by side."""
        chosen: dict[str, TrackedHand] = {}
        hands = [self._steady(hand, len(frame.hands) == 1) for hand in frame.hands]
        for side in self.sides:
            same = [h for h in hands if h.side == side]
            if same:
                before = self._ids.get(side)
                chosen[side] = max(same, key=lambda h: (h.id == before, h.confidence))
        unknown = [h for h in hands if h.side is None]
        free = [s for s in self.sides if s not in chosen]
        if len(self.sides) == 2:
            for hand in list(unknown):
                side = self._by_thumb(hand)
                if side in free:
                    chosen[side] = hand
                    unknown.remove(hand)
                    free.remove(side)
        for side in list(free):
            same = [h for h in unknown if h.id == self._ids.get(side)]
            if same:
                chosen[side] = same[0]
                unknown.remove(same[0])
                free.remove(side)
        if len(free) == 2 and len(unknown) >= 2:
            left, *_, right = sorted(unknown, key=lambda h: h.palm[0])
            chosen |= {"left": left, "right": right}
        else:
            self._nearest(chosen, unknown, free)
        for side, hand in chosen.items():
            self._ids[side], self._places[side] = hand.id, hand.palm
        if len(chosen) < len(hands):
            others = sum(h.side not in (None, *self.sides) for h in hands)
            self.counts["hands of another side"] += others
            self.counts["further hands of the same side"] += len(hands) - len(chosen) - others
        return chosen

    def _steady(self, hand: TrackedHand, alone: bool) -> TrackedHand:
        """The hand, with its side corrected if the device confuses sides for a moment."""
        for side, known in self._ids.items():
            if (
                (alone or known == hand.id)
                and hand.side not in (None, side)
                and self._mistaken[side] < _MOST
                and distance(hand.palm, self._places[side]) < _NEAR
            ):
                self._mistaken[side] += 1
                self.counts[SIDE_MENDED] += 1
                return replace(hand, side=side)
        if hand.side is not None:
            self._mistaken[hand.side] = 0
        return hand

    def _by_thumb(self, hand: TrackedHand) -> str:
        """Side of a hand by its thumb in this and past frames; empty if it is unknown."""
        if len(self._thumbs) > _REMEMBERED:
            self._thumbs = {i: self._thumbs[i] for i in self._ids.values() if i in self._thumbs}
        now = self._thumbs.get(hand.id, 0) + _thumb_side(hand)
        self._thumbs[hand.id] = min(max(now, -_MOST), _MOST)
        return "" if abs(now) < _SURE else "right" if now > 0 else "left"

    def _nearest(
        self, chosen: dict[str, TrackedHand], unknown: list[TrackedHand], free: list[str]
    ) -> None:
        # Without earlier frames, the hand farther to the right is the right hand.
        guess = {"right": (0.12, 0.0, 0.2), "left": (-0.12, 0.0, 0.2)}
        while unknown and free:
            pairs = [
                (distance(h.palm, self._places.get(s, guess[s])), s, i)
                for s in free
                for i, h in enumerate(unknown)
            ]
            apart, side, index = min(pairs)
            if apart > _FAR and len(self.sides) > 1 and side in self._places:
                return
            chosen[side] = unknown.pop(index)
            free.remove(side)


def side_by_thumb(frames: Sequence[HandFrame]) -> str:
    """Side of the hand in a recording of one hand, by its thumb.

    Args:
        frames: Frames of a device that does not report sides. Only frames with a single hand, of
            unknown side, are used.

    Returns:
        `right` or `left`; empty where too few frames show the thumb, or they contradict each other.
    """
    alone = [f.hands[0] for f in frames if len(f.hands) == 1]
    shown = Counter(_thumb_side(hand) for hand in alone if hand.side is None)
    side = max((1, -1), key=shown.__getitem__)
    if shown[side] < _ENOUGH or shown[-side] > _CONTRARY * shown[side]:
        return ""
    return "right" if side > 0 else "left"


def _thumb_side(hand: TrackedHand) -> int:
    """1 if the thumb is that of a right hand, -1 for a left hand, 0 if the side is unclear."""
    if len(hand.fingers) < 4:
        return 0
    palm = palm_of(hand, "right")
    places = [palm.place(f.end) for f in hand.fingers]
    thumb, *fingers = sorted(places, key=lambda place: place[1])
    across = [place[0] for place in fingers]
    if thumb[1] > fingers[0][1] - _THUMB_BEHIND or min(across) < thumb[0] < max(across):
        return 0
    return 1 if thumb[0] < min(across) else -1
