"""Log of the copies of a study, from which a withdrawn participant must be removed as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.journal import Journal, read_journal

COPIES = "copies.jsonl"
COPIED = "copied"
"""Kind of the record in the journal of the study: how long the log of copies is now."""


@dataclass(frozen=True)
class Copy:
    """A copy of a study's data.

    Attributes:
        what: `backup`, `export`, `bids`, `merge`, or `site` (a folder that was merged into this).
        path: Path of the copy.
        time: Time of writing.
        ppids: Pseudonyms of the participants in it.
        there: True if it still exists at this path.
    """

    what: str
    path: Path
    time: str
    ppids: tuple[str, ...]
    there: bool


def log_copy(study: StudyFolder, what: str, path: Path, ppids: Sequence[str]) -> None:
    """Records that a copy was made; see `Copy`.

    Raises:
        StudyError: The log cannot be written.
    """
    with study.lock():
        journal = Journal(study.path / COPIES)
        try:
            journal.append(what, durable=True, path=str(path.resolve()), ppids=list(ppids))
            records, head = len(journal.records), journal.head
        finally:
            journal.close()
    study.note(COPIED, records=records, digest_of_last=head)


def copies(study: StudyFolder, ppid: str | None = None) -> list[Copy]:
    """Returns the recorded copies: all, or those that contain a participant.

    Raises:
        StudyError: The log is damaged.
    """
    path = study.path / COPIES
    if not path.exists():
        return []
    copies_made = [
        Copy(r["kind"], Path(r["path"]), r["time"], tuple(r["ppids"]), Path(r["path"]).exists())
        for r in read_journal(path)
        if r["kind"] != "recovered"
    ]
    return [copy for copy in copies_made if ppid is None or ppid in copy.ppids]
