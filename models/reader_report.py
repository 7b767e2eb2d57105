"""What a reader of somebody's file left out and what it assumed.

A reader returns its report with its result, and a command that reads the file prints it in one
line.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field


@dataclass
class ReaderReport:
    """Parts of a file that were left out, by reason, and assumptions about it.

    Attributes:
        left_out: Number of parts by reason, such as "rows without a number".
        assumed: Sentences without a full stop, such as "names are not UTF-8; read as Latin-1".
    """

    left_out: Counter[str] = field(default_factory=Counter)
    assumed: list[str] = field(default_factory=list)

    def leave_out(self, reason: str, count: int = 1) -> None:
        """Counts parts that are left out."""
        if count:
            self.left_out[reason] += count

    def assume(self, sentence: str) -> None:
        """Adds an assumption, once."""
        if sentence not in self.assumed:
            self.assumed.append(sentence)

    def add(self, report: ReaderReport) -> None:
        """Adds the report on another file, such as that of a skeleton."""
        self.left_out.update(report.left_out)
        for sentence in report.assumed:
            self.assume(sentence)

    def line(self) -> str:
        """Everything in one line; empty if nothing was left out or assumed."""
        counts = ", ".join(f"{count} {reason}" for reason, count in self.left_out.most_common())
        return "; ".join((*([f"left out: {counts}"] if counts else []), *self.assumed))
