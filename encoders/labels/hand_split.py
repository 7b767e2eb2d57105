"""Assigns contacts to two hands on one surface, before any labelling.

A contact is assigned to a hand once, shortly after its touch-down, together with all contacts that
landed at about the same time. It stays with this hand until it lifts, because a change during a
grip would drop the object. New contacts are assigned so that the contacts of each hand are close
together, and near the present or last place of this hand.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.frames import FINGERS, Contact, TouchFrame


@dataclass(frozen=True)
class SplitSettings:
    """Settings of the assignment to hands.

    Attributes:
        settle: Time (s) for which a new contact waits for further contacts of its hand before it is
            assigned and reported.
        span: Largest distance (m) between two contacts of one hand.
        pull: Weight of the squared distance per contact to the expected place of a lifted hand,
            relative to squared distances between contacts.
        begin: Cost (m2) of bringing down a lifted hand.
        crossed: Cost (m2) of hands that come down crossed.
        memory: Time (s) for which a lifted hand is expected at its last place. After this time it
            is expected at its home.
    """

    settle: float = 0.048
    span: float = 0.21
    pull: float = 0.15
    begin: float = 0.008
    crossed: float = 0.010
    memory: float = 1.0


_TOO_FAR = 1.0
"""Cost (m2) per metre by which a hand's contacts are farther apart than the span."""
_MOST = 10
"""Largest number of contacts that are assigned at once; of more contacts, only those that landed
first are assigned. One contact more than there are free fingers is considered, so that the contact
that fits worst can be left out."""


class HandSplitter:
    """Assigns the contacts of one surface to two hands, frame by frame.

    Args:
        homes: (2, 2) m on the surface, default place of each hand. The right hand's place is to the
            right of the left hand's.
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
        """Splits a frame into two frames, one for each hand.

        A contact is left out while it waits, and if no hand had a free finger for it. A cancelled
        contact is reported in the frame of its hand. Both frames have the lift control.

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
        """The hand (0 or 1) of a contact that is down; None while it waits or has no hand."""
        hand = self._hand.get(contact, -1)
        return None if hand < 0 else hand

    def _part(self, frame: TouchFrame, hand: int) -> TouchFrame:
        contacts: tuple[Contact, ...] = tuple(
            c for c in frame.contacts if self._hand.get(c.id) == hand
        )
        gone = frozenset(i for i in frame.cancelled if self._gone.get(i) == hand)
        return replace(frame, contacts=contacts, cancelled=gone)

    def _forget(self, down: dict[int, Array], now: float) -> None:
        """Forgets lifted contacts, and stores the last places of the hands."""
        for hand in (0, 1):
            of_hand = [self._places[i] for i, h in self._hand.items() if h == hand]
            if of_hand:
                self._last[hand] = (now, np.mean(of_hand, axis=0))
        self._gone = {i: hand for i, hand in self._hand.items() if i not in down}
        self._hand = {i: hand for i, hand in self._hand.items() if i in down}
        self._since = {i: since for i, since in self._since.items() if i in down}

    def _decide(self, now: float) -> None:
        """Assigns every waiting contact to a hand."""
        first = sorted(self._since, key=lambda i: (self._since[i], i))
        held = [self._held(hand) for hand in (0, 1)]
        room = [len(FINGERS) - len(h) for h in held]
        # Every further contact would double or triple the computing time, for which the session
        # waits.
        most = min(sum(room) + 1, _MOST)
        new, rest = first[:most], first[most:]
        places = np.array([self._places[i] for i in new])
        best, least = (-1,) * len(new), np.inf
        parts: list[dict[tuple[int, ...], _Part]] = [{}, {}]
        for shares in all_shares(len(new), room):
            cost = self._cost(shares, places, held, now, parts)
            if cost < least:
                best, least = shares, cost
        self._hand.update(zip(new, best, strict=True))
        self._hand.update(dict.fromkeys(rest, -1))
        self._since.clear()

    def _held(self, hand: int) -> Array:
        """Positions (n, 2) m of a hand's contacts."""
        places = [self._places[i] for i, h in self._hand.items() if h == hand]
        return np.array(places).reshape(-1, 2)

    def _cost(
        self,
        shares: tuple[int, ...],
        places: Array,
        held: list[Array],
        now: float,
        parts: list[dict[tuple[int, ...], _Part]],
    ) -> float:
        """Cost (m2) of an assignment of contacts; the assignment with the least cost is chosen.

        Args:
            shares: Hand of each new contact, or -1.
            places: (n, 2) m, positions of the new contacts.
            held: Positions (n, 2) m of each hand's contacts so far.
            now: Time (s) of the frame.
            parts: Cache for each hand: indices of its new contacts -> contribution to the cost.
        """
        total, middles, begins = 0.0, [], False
        for hand in (0, 1):
            new = tuple(i for i, share in enumerate(shares) if share == hand)
            if not new and not len(held[hand]):
                continue
            part = parts[hand].get(new)
            if part is None:
                part = parts[hand][new] = self._part_of(hand, places[list(new)], held[hand], now)
            middles.append(part.middle)
            for term in part.terms:
                total += term
            begins = begins or part.begins
        if begins and len(middles) == 2:
            across = (middles[0] - middles[1]) @ (self._homes[0] - self._homes[1])
            total += self.settings.crossed if across < 0.0 else 0.0
        return total

    def _part_of(self, hand: int, new: Array, held: Array, now: float) -> _Part:
        """Contribution to the cost of a hand with some new contacts."""
        s = self.settings
        mine = np.vstack([held, new])
        middle = mine.mean(axis=0)
        apart = np.linalg.norm(mine[:, None] - mine[None], axis=-1).max()
        terms = [
            float(np.sum((mine - middle) ** 2)),
            _TOO_FAR * max(float(apart) - s.span, 0.0),
        ]
        begins = bool(len(new)) and not len(held)
        if begins:
            seen, place = self._last[hand]
            expected = place if now - seen <= s.memory else self._homes[hand]
            terms.append(s.begin + s.pull * len(new) * float(np.sum((middle - expected) ** 2)))
        return _Part(middle, terms, begins)


class _Part(NamedTuple):
    """Contribution of a hand to the cost of an assignment.

    Attributes:
        middle: (2,) m, mean of the hand's contacts.
        terms: Terms of the cost (m2), in the order in which they are added.
        begins: True if the hand was lifted and comes down.
    """

    middle: Array
    terms: list[float]
    begins: bool


def all_shares(n: int, room: list[int]) -> Iterator[tuple[int, ...]]:
    """All assignments of n contacts to two hands with limited room, in a fixed order.

    Only contacts in excess of the room get no hand (-1).
    """
    left = [*room, max(n - sum(room), 0)]
    shares: list[int] = []

    def rest() -> Iterator[tuple[int, ...]]:
        if len(shares) == n:
            yield tuple(shares)
            return
        for share in (0, 1, -1):
            if left[share]:
                left[share] -= 1
                shares.append(share)
                yield from rest()
                shares.pop()
                left[share] += 1

    return rest()
