"""Rules of a conversion, and its report of dropped contacts and frames."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from models.reader_report import ReaderReport


@dataclass(frozen=True)
class ConversionRules:
    """Rules for dropping contacts and frames, and for cutting frames into takes.

    Attributes:
        rate: Hz, frames of the capture.
        shortest: s; a contact that lives less is a glitch.
        fastest: m/s, greatest speed of a finger on a surface; a faster contact has jumped.
        stuck: s; for a contact that never ends and has not moved for longer, the lift was missed.
        reach: m, largest distance between a touch and its fingertip.
        doubt: Greatest share of a contact's life that it may be nearer to another finger than to
            its own.
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
    """Counts of dropped contacts and frames, by reason, and estimated values.

    Attributes:
        contacts: Number of contacts dropped whole, by reason.
        frames: Number of dropped frames, by reason.
        parts: Number of pieces cut off from contacts or the log, by reason.
        notes: Estimated values by name, such as scale, residuals and clock offset; JSON values.
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

    def add_reading(self, reading: ReaderReport) -> None:
        """Adds what the reader of a file left out and assumed."""
        for reason, count in reading.left_out.items():
            self.drop_parts(reason, count)
        if reading.assumed:
            self.notes["file"] = "; ".join(reading.assumed)

    def as_json(self) -> dict[str, Any]:
        """JSON values for a capture's `meta`."""
        return {
            "dropped_contacts": self.contacts,
            "dropped_frames": self.frames,
            "dropped_parts": self.parts,
            **self.notes,
        }


def _add(counts: dict[str, int], reason: str, count: int) -> None:
    if count:
        counts[reason] = counts.get(reason, 0) + int(count)
