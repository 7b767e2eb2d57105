"""Compares the journals of a study with witnesses (`sandbox.study.record.witness`)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from models.errors import StudyError
from models.json_input import LARGEST, decoded, read_bytes
from sandbox.study.audit.findings import Findings, Kind
from sandbox.study.audit.journals import ReadJournal, check_head
from sandbox.study.record.folder import STUDY_JOURNAL
from sandbox.study.record.witness import Witness


def read_witnesses(path: Path) -> list[Witness]:
    """Reads a file of witnesses.

    Raises:
        StudyError: It cannot be read, has no witness, or a line is none.
    """
    what = "not a file of witnesses"
    data = read_bytes(path, StudyError, what=what, largest=LARGEST)
    found = [
        decoded(line, Witness, StudyError, what=what, where=f"{path}, line {number}")
        for number, line in enumerate(data.split(b"\n"), start=1)
        if line.strip()
    ]
    if not found:
        raise StudyError(f"{what}: it is empty", where=str(path))
    return found


def check_witnesses(
    findings: Findings,
    study_id: str,
    witnesses: Mapping[str, list[Witness]],
    journals: Mapping[str, ReadJournal],
    withdrawn: set[str],
    merged: set[str],
) -> None:
    """Checks that journals still have the records that witnesses know of.

    Args:
        findings: Takes what is wrong.
        study_id: Id of the study.
        witnesses: Witnesses by name of their file.
        journals: Journals by name; see `Witness`.
        withdrawn: Pseudonyms of participants who have withdrawn.
        merged: Ids of the studies that were merged into this one.
    """
    for file, some in witnesses.items():
        for number, witness in enumerate(some, start=1):
            source = f"witness {number} of {file}"
            if witness.study not in (study_id, *merged):
                findings.notes.append(f"{source} is of another study")
            elif witness.journal.partition("/")[0] in withdrawn:
                findings.counts["witnesses of participants who have withdrawn"] += 1
            elif witness.study != study_id and witness.journal == STUDY_JOURNAL:
                findings.counts["witnesses of merged studies, not compared"] += 1
            elif witness.journal not in journals:
                path = findings.root / witness.journal
                findings.add(Kind.MISSING, path, f"{source} knows of its journal")
            else:
                check_head(
                    findings,
                    journals[witness.journal],
                    witness.records,
                    witness.digest,
                    source,
                )
                findings.counts["witnesses compared"] += 1
