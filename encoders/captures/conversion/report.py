"""What a conversion keeps and drops, and by which rule."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class ConversionRules:
    """When a contact or a frame is dropped, and how frames are cut into takes.

    Attributes:
        rate: Hz, frames of the capture.
        shortest: s; a contact that lives less is a glitch.
        fastest: m/s; no finger on a surface is faster, a contact that is has jumped.
        stuck: s; a contact that never ends and has not moved for so long was not seen to lift.
        reach: m between a touch and a fingertip, beyond which they are not the same finger.
        doubt: Share of a contact's life that it may be nearer to another finger than its own.
        gap: s, longest gap of a recording that is bridged by a straight line.
        pause: s without a frame after which a new take begins.
        longest_take: s; longer ones are cut, because validation splits a capture by takes.
    """

    rate: float = 30.0
    shortest: float = 0.05
    fastest: float = 3.0
    stuck: float = 2.0
    reach: float = 0.025
    doubt: float = 0.2
    gap: float = 0.1
    pause: float = 0.5
    longest_take: float = 10.0


@dataclass
class ConversionReport:
    """Counts of what was dropped, by reason, and what was found out on the way.

    Attributes:
        contacts: Reason -> contacts dropped whole.
        frames: Reason -> frames dropped.
        parts: Reason -> pieces of contacts or of the log that were cut off.
        notes: Name -> value: scale, residuals, clock offset and the like; JSON values.
    """

    contacts: dict[str, int] = field(default_factory=dict)
    frames: dict[str, int] = field(default_factory=dict)
    parts: dict[str, int] = field(default_factory=dict)
    notes: dict[str, Any] = field(default_factory=dict)

    def drop_contacts(self, reason: str, count: int = 1) -> None:
        """Counts dropped contacts."""
        _add(self.contacts, reason, count)

    def drop_frames(self, reason: str, count: int) -> None:
        """Counts dropped frames."""
        _add(self.frames, reason, count)

    def drop_parts(self, reason: str, count: int = 1) -> None:
        """Counts dropped pieces."""
        _add(self.parts, reason, count)

    def as_json(self) -> dict[str, Any]:
        """For a capture's `meta`."""
        return {
            "dropped_contacts": self.contacts,
            "dropped_frames": self.frames,
            "dropped_parts": self.parts,
            **self.notes,
        }


def _add(counts: dict[str, int], reason: str, count: int) -> None:
    if count:
        counts[reason] = counts.get(reason, 0) + int(count)
