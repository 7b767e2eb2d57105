"""Rules of a conversion, and its report of dropped contacts and frames."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from models.reader_report import ReaderReport


@dataclass(frozen=True)
class ConversionRules:
    """Rules for dropping contacts and frames, and for cutting frames into takes.

    Attributes:
        rate: Frame rate (Hz) of the capture.
        shortest: Shortest life of a contact (s); shorter contacts are dropped as glitches.
        fastest: Greatest speed (m/s) of a finger on a surface; a faster movement is a jump.
        stuck: Longest rest (s) at the end of a contact. After a longer rest, the device is assumed
            to have missed the lift, and the rest is cut off.
        reach: Largest distance (m) between a touch and its fingertip.
        doubt: Largest share of a contact's life in which another finger may be nearer than the
            contact's own finger.
        gap: Longest gap (s) of a recording that is interpolated linearly.
        pause: Time (s) without a frame after which a new take begins.
        longest_take: Longest take (s). Longer takes are cut, because validation splits a capture by
            takes.
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
        parts: Number of parts cut from contacts or from the log, by reason.
        notes: Estimated values by name, such as scale, residuals and clock offset, as JSON values.
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
        """Counts parts cut from contacts or from the log."""
        _add(self.parts, reason, count)

    def add_reading(self, reading: ReaderReport) -> None:
        """Adds the rows that a file's reader left out and the assumptions that it made."""
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
