"""Decides which of the hands that a device sees is the right one, and which the left."""

from __future__ import annotations

from models.arithmetic.products import distance
from models.frames import HandFrame, TrackedHand, Vector

_FAR = 0.30
"""m, distance from a hand's last place beyond which a new hand does not take over its side while
both are possible."""


class HandSides:
    """Tracks the sides of hands by id and position, where the device does not know them.

    Two hands seen at once are distinguished by x, since arms do not cross in the paper. A side,
    once given to a hand's id, stays with it; a new id gets the side whose last place is nearest.

    Args:
        sides: The wanted sides.
    """

    def __init__(self, sides: tuple[str, ...]) -> None:
        self.sides = sides
        self.reset()

    def reset(self) -> None:
        """Forgets all hands."""
        self._ids: dict[str, int] = {}
        self._places: dict[str, Vector] = {}

    def choose(self, frame: HandFrame) -> dict[str, TrackedHand]:
        """The wanted hands that are visible, by side."""
        chosen: dict[str, TrackedHand] = {}
        for hand in frame.hands:
            if hand.side in self.sides:
                # The more certain one, if a device reports the same side for two hands.
                known = chosen.get(hand.side or "")
                if known is None or hand.confidence > known.confidence:
                    chosen[hand.side or ""] = hand
        unknown = [h for h in frame.hands if h.side is None]
        free = [s for s in self.sides if s not in chosen]
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
        return chosen

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
