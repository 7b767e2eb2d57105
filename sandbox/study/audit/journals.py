"""Reads journals line by line, and names every record that is missing, changed or moved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from pathlib import Path

from models.errors import StudyError
from sandbox.study.audit.findings import Findings, Kind
from sandbox.study.record.chain import DIGEST, PREVIOUS, Chain, Record
from sandbox.study.record.journal import checked_record


@dataclass(frozen=True)
class ReadJournal:
    """A journal that was read.

    Attributes:
        path: Its file.
        records: The records whose chain is right, in order.
        lines: Number of the line of each of them.
        ends: Size of the file up to the end of each of them, bytes.
        sound: True if there was no finding.
    """

    path: Path
    records: list[Record] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    ends: list[int] = field(default_factory=list)
    sound: bool = True

    def count_at(self, size: int) -> int | None:
        """Number of records in the first bytes of the file; None if these end inside a record."""
        if size == 0:
            return 0
        return self.ends.index(size) + 1 if size in self.ends else None

    def digest_at(self, count: int) -> str:
        """Digest of the record with which the first records end; empty if it is not there."""
        return str(self.records[count - 1][DIGEST]) if 0 < count <= len(self.records) else ""


def read_journal_whole(path: Path, findings: Findings) -> ReadJournal:
    """Reads a journal to its end, whatever is wrong with it; a missing one is a finding."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        findings.add(Kind.MISSING, path, "the journal is not there")
        return ReadJournal(path, sound=False)
    *lines, rest = data.split(b"\n")
    before = len(findings.found)
    chain, kept = Chain(), []
    last: Record | None = None
    for number, line in enumerate(lines, start=1):
        try:
            record = checked_record(line, f"line {number}")
        except StudyError as error:
            if number == len(lines) and line.endswith(b"\0"):
                findings.notes.append(f"{findings.name(path)}: ends in zeros, after a power cut")
                break
            findings.add(Kind.CHANGED, path, f"{error.what}{_got(error)}", number)
            chain.head, last = "", None
            continue
        follows = not chain.take(line, record, number) or (number > 1 and last is None)
        if not follows:
            _name_break(findings, path, record, last, number)
        kept.append((number, record))
        last = record
    changed = set(chain.changed())
    for number in changed:
        findings.add(Kind.CHANGED, path, "its digest is not that of what it says", number)
    if rest:
        _name_rest(findings, path, rest, len(lines) + 1)
    ends = list(accumulate(len(line) + 1 for line in lines))
    sound = [(n, r) for n, r in kept if n not in changed]
    findings.counts["records"] += len(sound)
    findings.counts["records that a withdrawal has replaced"] += chain.replaced()
    return ReadJournal(
        path,
        [record for _, record in sound],
        [number for number, _ in sound],
        [ends[number - 1] for number, _ in sound],
        len(findings.found) == before,
    )


def check_head(
    findings: Findings, journal: ReadJournal, count: int, digest: str, source: str
) -> None:
    """Checks that a journal still begins with as many records as somebody else knows of.

    Args:
        findings: Takes what is wrong.
        journal: The journal.
        count: Number of records.
        digest: Digest of the last of them.
        source: Who knows it, for the finding.
    """
    if not journal.sound or journal.digest_at(count) == digest:
        return
    there = len(journal.records)
    if there < count:
        last = "" if count == there + 1 else f" to {count}"
        findings.add(
            Kind.MISSING,
            journal.path,
            f"records {there + 1}{last}; {source} knows of {count}",
            there + 1,
        )
    else:
        what = f"record {count} is not the one that {source} knows of"
        findings.add(Kind.CHANGED, journal.path, what, count)


def _name_break(
    findings: Findings, path: Path, record: Record, last: Record | None, number: int
) -> None:
    """Names what is wrong where a record does not follow the one before it."""
    expected = 0 if last is None else last["n"] + 1
    n = record["n"]
    if n > expected:
        gone = f"record {expected}" if n == expected + 1 else f"records {expected} to {n - 1}"
        findings.add(Kind.MISSING, path, f"{gone}, before this line", number)
    elif n < expected:
        what = f"record {n} comes after record {expected - 1}"
        findings.add(Kind.REORDERED, path, what, number)
    else:
        what = "the record before it is not the one it was written after"
        findings.add(Kind.CHANGED, path, what, number)


def _name_rest(findings: Findings, path: Path, rest: bytes, number: int) -> None:
    """Names what follows the last line break: after a kill, a part of a record."""
    try:
        record = checked_record(rest[:-1], "")
        whole = PREVIOUS in record
    except StudyError:
        whole = False
    if whole:
        findings.add(Kind.CHANGED, path, "the end of the line", number)
    else:
        findings.notes.append(
            f"{findings.name(path)}, line {number}: half written when the program was killed"
        )


def _got(error: StudyError) -> str:
    return "" if error.got is None else f" (got {error.got})"


def numbered(journal: ReadJournal, kinds: Sequence[str]) -> list[tuple[int, Record]]:
    """Records of some kinds, with the numbers of their lines."""
    pairs = zip(journal.lines, journal.records, strict=True)
    return [(number, record) for number, record in pairs if record["kind"] in kinds]
