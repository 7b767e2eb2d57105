"""Which hand a contact belongs to, where two hands touch one surface; before any labelling.

A contact gets a hand once, shortly after it came down, together with all others that came down with
it, and keeps it until it is lifted: a label that flips during a grip loses what is held, and a hand
that does so even more. Of all ways to share new contacts out, the one is taken that keeps each
hand's contacts together, near to where that hand is or was.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.frames import FINGERS, Contact, TouchFrame

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SplitSettings:
    """How contacts are shared out.

    Attributes:
        settle: s that a new contact waits for others of its hand; it is reported after that.
        span: m, farthest apart that two contacts of one hand are.
        pull: Share of the squared distance to where a lifted hand is expected, per contact, which
            counts like the same squared distance between contacts.
        begin: m2, what it costs that a lifted hand comes down at all.
        crossed: m2, what it costs that the hands come down crossed.
        memory: s for which a lifted hand is expected where it was, before it is where it belongs.
    """

    settle: float = 0.048
    span: float = 0.21
    pull: float = 0.15
    begin: float = 0.008
    crossed: float = 0.010
    memory: float = 1.0


_TOO_FAR = 1.0
"""m2 per m beyond the span."""
_MOST = 10
"""Contacts that are shared out at once; of more, those that came first."""


class HandSplitter:
    """Shares the contacts of one surface out to two hands, frame by frame.

    Args:
        homes: (2, 2) m on the surface, where each hand is expected while nothing is known: that of
            a right hand to the right of the left one's.
        settings: See `SplitSettings`.
    """

    def __init__(self, homes: ArrayLike, settings: SplitSettings | None = None) -> None:
        self.settings = settings or SplitSettings()
        self._homes = np.asarray(homes, float)
        self.reset()

    def reset(self) -> None:
        """Forgets all contacts, as at the start."""
        self._hand: dict[int, int] = {}
        self._since: dict[int, float] = {}
        self._places: dict[int, Array] = {}
        self._last: list[tuple[float, Array]] = [(-np.inf, home) for home in self._homes]

    def step(self, frame: TouchFrame) -> tuple[TouchFrame, TouchFrame]:
        """The frames of both hands.

        A contact that waits, or belongs to no hand (both have five fingers down), is in neither.
        What was cancelled is told to the hand that had it; both get the lift control.

        Args:
            frame: All contacts of the surface.
        """
        down = {c.id: np.array((c.x, c.y)) for c in frame.contacts}
        self._forget(down, frame.time)
        self._places = down
        for i in down:
            if i not in self._hand:
                self._since.setdefault(i, frame.time)
        waited = [frame.time - since for since in self._since.values()]
        if waited and max(waited) >= self.settings.settle - 1e-9:
            self._decide(frame.time)
        return self._part(frame, 0), self._part(frame, 1)

    def hand(self, contact: int) -> int | None:
        """The hand (0 or 1) of a contact that is down; None while it waits, or has none."""
        hand = self._hand.get(contact, -1)
        return None if hand < 0 else hand

    def _part(self, frame: TouchFrame, hand: int) -> TouchFrame:
        contacts: tuple[Contact, ...] = tuple(
            c for c in frame.contacts if self._hand.get(c.id) == hand
        )
        gone = frozenset(i for i in frame.cancelled if self._gone.get(i) == hand)
        return replace(frame, contacts=contacts, cancelled=gone)

    def _forget(self, down: dict[int, Array], now: float) -> None:
        """Drops what was lifted, and remembers where the hands were."""
        for hand in (0, 1):
            of_hand = [self._places[i] for i, h in self._hand.items() if h == hand]
            if of_hand:
                self._last[hand] = (now, np.mean(of_hand, axis=0))
        self._gone = {i: hand for i, hand in self._hand.items() if i not in down}
        self._hand = {i: hand for i, hand in self._hand.items() if i in down}
        self._since = {i: since for i, since in self._since.items() if i in down}

    def _decide(self, now: float) -> None:
        """Gives every waiting contact its hand."""
        first = sorted(self._since, key=lambda i: (self._since[i], i))
        new, rest = first[:_MOST], first[_MOST:]
        places = np.array([self._places[i] for i in new])
        held = [self._held(hand) for hand in (0, 1)]
        room = [len(FINGERS) - len(h) for h in held]
        best, least = (-1,) * len(new), np.inf
        # With more new contacts than free fingers, some are nobody's.
        nobody = (-1,) if len(new) > sum(room) else ()
        for shares in product((0, 1, *nobody), repeat=len(new)):
            given = [shares.count(hand) for hand in (0, 1)]
            if given[0] > room[0] or given[1] > room[1]:
                continue
            if nobody and sum(given) < sum(room):
                continue
            cost = self._cost(np.array(shares), places, held, now)
            if cost < least:
                best, least = shares, cost
        self._hand.update(zip(new, best, strict=True))
        self._hand.update(dict.fromkeys(rest, -1))
        self._since.clear()

    def _held(self, hand: int) -> Array:
        """(n, 2) m, contacts that a hand has."""
        places = [self._places[i] for i, h in self._hand.items() if h == hand]
        return np.array(places).reshape(-1, 2)

    def _cost(self, shares: Array, places: Array, held: list[Array], now: float) -> float:
        """m2, how unlikely a way to share contacts out is."""
        s = self.settings
        total, middles, begins = 0.0, [], False
        for hand in (0, 1):
            new = places[shares == hand]
            mine = np.vstack([held[hand], new])
            if not len(mine):
                continue
            middle = mine.mean(axis=0)
            middles.append(middle)
            total += float(np.sum((mine - middle) ** 2))
            apart = np.linalg.norm(mine[:, None] - mine[None], axis=-1).max()
            total += _TOO_FAR * max(float(apart) - s.span, 0.0)
            if len(new) and not len(held[hand]):
                begins = True
                seen, place = self._last[hand]
                expected = place if now - seen <= s.memory else self._homes[hand]
                total += s.begin + s.pull * len(new) * float(np.sum((middle - expected) ** 2))
        if begins and len(middles) == 2:
            across = (middles[0] - middles[1]) @ (self._homes[0] - self._homes[1])
            total += s.crossed if across < 0.0 else 0.0
        return total
