"""Witnesses: digests of journals that are kept where nobody who has the study can write.

Who can write into a study's folder can also compute all its digests anew. A witness cannot be
computed anew: a file of lines (`--witness FILE`), a stream of Lab Streaming Layer that another
machine records, or a line that somebody has written down.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

from msgspec import Struct

from sandbox.study.record.chain import DIGEST
from sandbox.study.record.files import study_error
from sandbox.study.record.folder import STUDY_JOURNAL
from sandbox.study.record.journal import now, read_journal
from sandbox.study.record.session_folder import SessionFolder


class Witness(Struct):
    """A line of a file of witnesses.

    Attributes:
        study: Id of the study.
        journal: The journal: `study.jsonl`, or `PPID/S001`.
        records: Number of its records.
        digest: Digest of the last of them.
        time: When it was written, for people.
    """

    study: str
    journal: str
    records: int
    digest: str
    time: str = ""


def witnesses_of(session: SessionFolder) -> list[Witness]:
    """Witnesses of a session and of its study, as they are now."""
    study, time = session.study, now()
    records = read_journal(study.path / STUDY_JOURNAL)
    name = f"{session.person.ppid}/{session.path.name}"
    journal = session.journal
    return [
        Witness(study.id, name, len(journal.records), journal.head, time),
        Witness(study.id, STUDY_JOURNAL, len(records), str(records[-1][DIGEST]), time),
    ]


def add_witnesses(path: Path, witnesses: list[Witness]) -> None:
    """Appends witnesses to a file, durably.

    Raises:
        StudyError: The file cannot be written.
    """
    try:
        with path.open("ab") as file:
            for witness in witnesses:
                file.write(json.dumps(witness_json(witness), ensure_ascii=False).encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise study_error(error, path, "the witness cannot be written") from None


def witness_json(witness: Witness) -> dict[str, str | int]:
    """A witness as JSON values."""
    return {
        "study": witness.study,
        "journal": witness.journal,
        "records": witness.records,
        "digest": witness.digest,
        "time": witness.time,
    }
