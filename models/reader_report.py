"""Report of a file reader: parts that it left out or mended, and its assumptions.

A reader returns its report with its result. A command that reads a file prints the report in one
line.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

SIDE_MENDED = "hands that were named for the other side"
"""Reason for mended hands: the device briefly reported the wrong side."""


@dataclass
class ReaderReport:
    """Parts of a file that were left out or mended, by reason, and assumptions about it.

    Attributes:
        left_out: Number of parts by reason, such as "rows without a number".
        assumed: Sentences without a full stop, such as "names are not UTF-8; read as Latin-1".
        mended: Number of parts by fault.
    """

    left_out: Counter[str] = field(default_factory=Counter)
    assumed: list[str] = field(default_factory=list)
    mended: Counter[str] = field(default_factory=Counter)

    def leave_out(self, reason: str, count: int = 1) -> None:
        """Counts parts that are left out."""
        if count:
            self.left_out[reason] += count

    def add_counts(self, counts: Mapping[str, int]) -> None:
        """Adds counts of a decoder or reconstructor by reason."""
        for reason, count in counts.items():
            if reason == SIDE_MENDED:
                self.mended[reason] += count
            else:
                self.leave_out(reason, count)

    def assume(self, sentence: str) -> None:
        """Adds an assumption, once."""
        if sentence not in self.assumed:
            self.assumed.append(sentence)

    def add(self, report: ReaderReport) -> None:
        """Adds the report on another file, such as that of a skeleton."""
        self.left_out.update(report.left_out)
        self.mended.update(report.mended)
        for sentence in report.assumed:
            self.assume(sentence)

    def __bool__(self) -> bool:
        """True if anything was left out, mended or assumed."""
        return bool(self.line())

    @property
    def main_reason(self) -> str:
        """The most frequent reason with its count; empty if nothing was left out."""
        return "".join(f"{count} {reason}" for reason, count in self.left_out.most_common(1))

    def copy(self) -> ReaderReport:
        """The report as it is now."""
        return ReaderReport(self.left_out.copy(), list(self.assumed), self.mended.copy())

    def line(self) -> str:
        """The whole report in one line; empty if nothing was left out, mended or assumed."""
        parts = []
        for word, counts in (("left out", self.left_out), ("mended", self.mended)):
            listed = ", ".join(f"{count} {reason}" for reason, count in counts.most_common())
            parts += [f"{word}: {listed}"] if listed else []
        return "; ".join((*parts, *self.assumed))
