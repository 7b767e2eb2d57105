"""Findings of a verification: each names a file, a line where there is one, and a cause."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path


class Kind(StrEnum):
    """Kinds of findings."""

    MISSING = "missing"
    ORPHANED = "orphaned"
    CHANGED = "changed"
    REORDERED = "reordered"


@dataclass(frozen=True)
class Finding:
    """Something that is not as the journals say.

    Attributes:
        kind: What happened to it.
        path: The file, relative to the folder of the study.
        what: The cause, in words.
        line: Number of the line, from 1; None for a whole file.
    """

    kind: Kind
    path: str
    what: str
    line: int | None = None

    def __str__(self) -> str:
        line = "" if self.line is None else f", line {self.line}"
        return f"{self.path}{line}: {self.kind}: {self.what}"


@dataclass
class Findings:
    """Results of a verification.

    Attributes:
        root: Folder of the study.
        found: What is wrong.
        notes: Lines about what is as it may be, such as attempts that were broken off.
        counts: Numbers of what was compared, and of what legitimate changes have left.
    """

    root: Path
    found: list[Finding] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)

    @property
    def sound(self) -> bool:
        """True if nothing is wrong."""
        return not self.found

    def add(self, kind: Kind, path: Path, what: str, line: int | None = None) -> None:
        """Adds a finding about a file or folder of the study."""
        self.found.append(Finding(kind, self.name(path), what, line))

    def name(self, path: Path) -> str:
        """Name of a file relative to the folder of the study."""
        return path.relative_to(self.root).as_posix()

    def compare(self, path: Path, expected: bytes, source: str) -> bool:
        """Compares a file with what it must contain; a difference is a finding with its line.

        Args:
            path: The file.
            expected: What it must contain.
            source: What this follows from, for the finding.

        Returns:
            True if both are equal.
        """
        try:
            data = path.read_bytes()
        except FileNotFoundError:
            self.add(Kind.MISSING, path, f"it follows from {source}")
            return False
        if data == expected:
            return True
        line = first_difference(data, expected)
        self.add(Kind.CHANGED, path, f"it is not what follows from {source}", line)
        return False


def first_difference(data: bytes, expected: bytes) -> int:
    """Number of the first line in which two texts differ, from 1."""
    mine, other = data.split(b"\n"), expected.split(b"\n")
    pairs = zip(mine, other, strict=False)
    different = (i for i, (a, b) in enumerate(pairs, start=1) if a != b)
    return next(different, min(len(mine), len(other)))
