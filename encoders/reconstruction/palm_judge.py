"""Tells palms from fingers by width and height of contacts, their growth, and where they lie.

Only contacts with an extent are judged; a device that measures none has no palms here. A judgement
uses nothing but what was reported so far. Until it is sure, a contact is unsure: it must get no
name. A palm stays one until it leaves; a finger may still become a palm.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum

from encoders.reconstruction.contact_courses import SizeCourse
from encoders.reconstruction.palm_place import place_odds
from models.frames import Contact

LANDED, DECIDED_BY = 0.10, 0.45
"""s after touch-down. From the first on a contact's place counts too, as the other fingers of a
grip have landed. At the second the likelier of both is taken, after the slowest growth of a palm
and a few reports more."""

PALM_ODDS, FINGER_ODDS = 4.0, -4.5
"""Log-odds by size beyond which a contact is a palm, and by size and place below which it is a
finger, before `DECIDED_BY`. A place alone makes no palm by then: fingers may still land."""

LATE_ODDS = 0.0
"""Log-odds by size and place above which it is a palm from then on. Sizes of 25 to 28 mm, which
either may have, give -1.4."""

CERTAIN = 8.0
"""Log-odds by size that no place changes."""

LARGE = 0.020
"""m, least width or height that makes a finger that is certain looked at again; saves time."""


_ROUNDING = 1e-9
"""s; times are sums of control periods."""


class Kind(StrEnum):
    """Kinds of contacts."""

    UNSURE = "unsure"
    FINGER = "finger"
    PALM = "palm"


@dataclass
class _Judged:
    """A contact's sizes, what it is taken for, and its last log-odds by size.

    `settled`: its last report changed nothing.
    """

    course: SizeCourse
    kind: Kind = Kind.UNSURE
    odds: float = 0.0
    settled: bool = False

    def certain(self, time: float) -> bool:
        """True if only a large report can change anything."""
        if self.kind is Kind.PALM:
            return True
        late = time - self.course.began >= DECIDED_BY
        return late and self.kind is Kind.FINGER and self.odds < -CERTAIN


@dataclass
class PalmJudge:
    """Judges the contacts of one device, frame by frame."""

    _judged: dict[int, _Judged] = field(default_factory=dict)

    def reset(self) -> None:
        """Forgets all contacts."""
        self._judged = {}

    def kind(self, contact: int) -> Kind:
        """Kind of the contact with this id; a finger if it has no extent."""
        judged = self._judged.get(contact)
        return Kind.FINGER if judged is None else judged.kind

    def step(self, time: float, contacts: Iterable[Contact]) -> None:
        """Judges the contacts of the next frame.

        Args:
            time: s, session time, which never runs backwards.
            contacts: All contacts that are down.
        """
        down = {c.id: c for c in contacts}
        self._judged = {i: judged for i, judged in self._judged.items() if i in down}
        for contact in down.values():
            if contact.extent is None:
                continue
            if contact.id not in self._judged:
                self._judged[contact.id] = _Judged(SizeCourse(time))
            judged = self._judged[contact.id]
            judged.settled = judged.certain(time) and max(contact.extent) < LARGE
            if judged.settled:
                judged.course.pause(time)
            else:
                judged.course.report(time, contact.extent)
        for i in sorted(self._judged):
            judged = self._judged[i]
            if judged.kind is not Kind.PALM and not judged.settled:
                judged.kind = self._decision(judged, down[i], down, time)

    def _decision(
        self, judged: _Judged, contact: Contact, down: dict[int, Contact], time: float
    ) -> Kind:
        size = odds = judged.odds = judged.course.odds
        age = time - judged.course.began + _ROUNDING
        if age >= LANDED and -CERTAIN < size < CERTAIN:
            others = [
                (c.x, c.y)
                for i, c in down.items()
                if i != contact.id and self.kind(i) is not Kind.PALM
            ]
            odds += place_odds((contact.x, contact.y), others)
        late = age >= DECIDED_BY
        if odds > LATE_ODDS if late else size > PALM_ODDS:
            return Kind.PALM
        if late or odds < FINGER_ODDS:
            return Kind.FINGER
        return judged.kind
