"""Decides which of the hands that a device sees is the right one, and which the left."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from encoders.paalm.palm import palm_of
from models.arithmetic import distance
from models.frames import HandFrame, TrackedHand, Vector
from models.reader_report import SIDE_MENDED

_FAR = 0.30
"""m, distance from a hand's last place beyond which a new hand does not take over its side while
both are possible."""
_NEAR = 0.10
"""m from a hand's last place within which it is the same one, if the device names its other side
for a moment."""
_THUMB_BEHIND = 0.020
"""m by which a thumb's tip is nearer to the palm than those of the fingers."""
_SURE = 5
"""Frames, more on one side than on the other, that decide by the thumb."""
_MOST = 50
"""Limit of these frames, so that a mistake can be mended."""
_ENOUGH, _CONTRARY = 50, 0.25
"""Frames of a recording that must show a side, and share of these that may show the other one."""
_REMEMBERED = 64
"""Number of the device's ids beyond which those of hands that are gone are forgotten."""


class HandSides:
    """Tracks the sides of hands by thumb, id and position, where the device does not know them.

    A hand whose thumb has been seen has the side of its thumb. Otherwise two hands seen at once are
    distinguished by x, since arms do not cross in the paper. A side, once given to a hand's id,
    stays with it until its thumb says otherwise; a new id gets the side whose last place is
    nearest.

    A device that knows sides mistakes them for moments: a hand of the same id, or a single one,
    near its last place keeps its side for up to `_MOST` frames. Of two hands of one side, the one
    that was chosen before stays, and else the device's more certain one.

    Args:
        sides: The wanted sides.
        counts: Receives numbers of hands that are left out or mended, by reason.
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
        """The wanted hands that are visible, by side."""
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
            self.counts["hands beside the one of their side"] += len(hands) - len(chosen) - others
        return chosen

    def _steady(self, hand: TrackedHand, alone: bool) -> TrackedHand:
        """The hand, of the side that it just had."""
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
        """Side of a hand by its thumb in this and in past frames; empty where it is not known."""
        if len(self._thumbs) > _REMEMBERED:
            self._thumbs = {i: self._thumbs[i] for i in self._ids.values() if i in self._thumbs}
        now = self._thumbs.get(hand.id, 0) + _thumb_side(hand)
        self._thumbs[hand.id] = min(max(now, -_MOST), _MOST)
        return "" if abs(now) < _SURE else "right" if now > 0 else "left"

    def _nearest(
        self, chosen: dict[str, TrackedHand], unknown: list[TrackedHand], free: list[str]
    ) -> None:
        # Without a past, the right hand is the one farther right.
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
    """Side of the only hand of a recording by its thumb.

    Args:
        frames: Frames of a device that does not know sides. Those with another number of hands than
            one, and hands whose side is known, do not count.

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
    """1 if the thumb is where a right hand has it, -1 for a left hand, 0 if it cannot be told."""
    if len(hand.fingers) < 4:
        return 0
    palm = palm_of(hand, "right")
    places = [palm.place(f.end) for f in hand.fingers]
    thumb, *fingers = sorted(places, key=lambda place: place[1])
    across = [place[0] for place in fingers]
    if thumb[1] > fingers[0][1] - _THUMB_BEHIND or min(across) < thumb[0] < max(across):
        return 0
    return 1 if thumb[0] < min(across) else -1
