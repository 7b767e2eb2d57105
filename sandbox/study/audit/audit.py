"""Verifies the folder of a study: every journal, recording, table and the lock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from models.errors import InputError
from sandbox.study.audit.derived import (
    AuditedSession,
    check_session_tables,
    check_study_tables,
)
from sandbox.study.audit.findings import Findings, Kind
from sandbox.study.audit.journals import (
    ReadJournal,
    check_head,
    numbered,
    read_journal_whole,
)
from sandbox.study.audit.session_files import INFO, TRACKERS, check_files
from sandbox.study.audit.witness import check_witnesses
from sandbox.study.record.build import code_digest
from sandbox.study.record.chain import Record
from sandbox.study.record.files import LOCK_FILES, TEMPORARY, json_bytes
from sandbox.study.record.folder import (
    ANONYMISED,
    DESIGN_FILE,
    EARLIER,
    STUDY_FILE,
    STUDY_JOURNAL,
    WITHDRAWN,
    Participant,
    StudyFolder,
    about_of,
    design_files,
    participants_of,
)
from sandbox.study.record.session_folder import BEGUN, LOST, SEALED
from sandbox.study.record.stored_sessions import JOURNAL, SESSIONS, session_path
from sandbox.study.record.trial_files import TRIALS
from sandbox.study.record.witness import Witness
from sandbox.study.share.export_log import COPIED, COPIES
from sandbox.study.share.merge import MERGED, sites_bytes
from sandbox.study.share.privacy import ABOUT
from sandbox.study.share.withdraw import SITES
from sandbox.study.tables.tables import SOURCES

PARTS = (TRIALS, TRACKERS, INFO)
"""Folders of a session."""


@dataclass(frozen=True)
class Audit:
    """Result of a verification.

    Attributes:
        findings: What is wrong, what is as it may be, and how much was compared.
        finished: Recordings of finished attempts that are as they were written, without `.gz`.
    """

    findings: Findings
    finished: list[Path] = field(default_factory=list)


def is_study(path: Path) -> bool:
    """True if a folder is a study's, even if a file of it is missing."""
    return any((path / name).is_file() for name in (STUDY_FILE, STUDY_JOURNAL, DESIGN_FILE))


def audit(path: Path, witnesses: Mapping[str, list[Witness]] | None = None) -> Audit:
    """Verifies a study; states of recordings are not replayed.

    Args:
        path: Folder of the study.
        witnesses: Witnesses to compare with, by name of their file.
    """
    findings = Findings(path)
    journal = read_journal_whole(path / STUDY_JOURNAL, findings)
    people = _people(findings, journal)
    study = _check_lock(findings, journal)
    _check_copies(findings, journal)
    sessions, finished, journals = [], [], {STUDY_JOURNAL: journal}
    for person in people:
        for session, files, read in _check_person(findings, journal, person):
            journals[f"{person.ppid}/{read.path.parent.name}"] = read
            finished += files
            if session is not None:
                sessions.append(session)
    if journal.sound:
        _check_entries(findings, {person.ppid for person in people}, study)
    _check_tables(findings, study, journal, journals, sessions)
    withdrawn = {r["ppid"] for _, r in numbered(journal, (WITHDRAWN,))}
    merged = [r["sites"].values() for _, r in numbered(journal, (MERGED,)) if "site" not in r]
    findings.counts["participants"] = len(people)
    findings.counts["participants who have withdrawn"] = len(withdrawn)
    findings.counts["merged sites"] = sum(map(len, merged))
    findings.counts["anonymous copy"] = len(numbered(journal, (ANONYMISED,)))
    if witnesses:
        study_id = journal.records[0].get("study", "") if journal.records else ""
        ids = {site["study"] for sites in merged for site in sites}
        check_witnesses(findings, study_id, witnesses, journals, withdrawn, ids)
    return Audit(findings, finished)


def _people(findings: Findings, journal: ReadJournal) -> list[Participant]:
    try:
        return participants_of(journal.records)
    except InputError as error:
        findings.add(Kind.CHANGED, journal.path, str(error))
        return []


def _check_lock(findings: Findings, journal: ReadJournal) -> StudyFolder | None:
    """Checks `study.json` and the design; returns the study if both are as the journal says."""
    root = findings.root
    if not journal.sound:
        findings.notes.append(
            "the lock, the design and the tables were not compared: the journal of the study is "
            "damaged"
        )
        return None
    try:
        about = about_of(journal.records, journal.path)
    except InputError as error:
        findings.add(Kind.MISSING, journal.path, str(error), 1)
        return None
    if not findings.compare(root / STUDY_FILE, json_bytes(about), "the journal of the study"):
        return None
    findings.counts["files of the lock compared"] += 1
    if not (root / DESIGN_FILE).is_file():
        findings.add(Kind.MISSING, root / DESIGN_FILE, "the study is locked to it")
        return None
    try:
        study = StudyFolder.at(root)
    except InputError as error:
        findings.add(Kind.CHANGED, root / DESIGN_FILE, f"it cannot be read: {error}")
        return None
    if study.design.digest != about["build"]["design"]:
        findings.add(
            Kind.CHANGED, root / DESIGN_FILE, "it is not the design that the study is locked to"
        )
        return None
    same = [
        findings.compare(root / name, data, "the design that the study is locked to")
        for name, data in design_files(study.design).items()
    ]
    findings.counts["files of the lock compared"] += sum(same)
    for path in sorted((root / EARLIER).glob("*")):
        if study.design_of(path.name).digest != path.name:
            findings.notes.append(f"{findings.name(path)}: a design that cannot be read here")
    return study if all(same) else None


def _check_copies(findings: Findings, journal: ReadJournal) -> None:
    """Checks the log of copies, and what merges and anonymous copies have written."""
    if not journal.sound:
        return
    root = findings.root
    logged = [r for _, r in numbered(journal, (COPIED,)) if "site" not in r]
    if logged or (root / COPIES).exists():
        copies = read_journal_whole(root / COPIES, findings)
        for record in logged if copies.sound else ():
            check_head(
                findings,
                copies,
                record["records"],
                record["digest_of_last"],
                STUDY_JOURNAL,
            )
    if any("site" not in r for _, r in numbered(journal, (MERGED,))):
        findings.compare(root / SITES, sites_bytes(journal.records), "the journal of the study")
    for _, record in numbered(journal, (ANONYMISED,)):
        findings.compare(root / ABOUT, json_bytes(record["about"]), "the journal of the study")


def _check_person(
    findings: Findings, journal: ReadJournal, person: Participant
) -> list[tuple[AuditedSession | None, list[Path], ReadJournal]]:
    """Checks the sessions of a participant.

    Returns:
        For each session: what its tables are compared with (None if its journal is not sound), the
        recordings that are as they were written, and its journal.
    """
    of = [r for _, r in numbered(journal, (BEGUN, SEALED, LOST)) if r["ppid"] == person.ppid]
    begun = {r["session"] for r in of}
    folder = findings.root / person.ppid
    there = {int(path.name[1:]) for path in folder.glob(SESSIONS)}
    results = []
    for number in sorted(begun | there):
        path = session_path(findings.root, person.ppid, number)
        seals = [r for r in of if r["kind"] == SEALED and r["session"] == number]
        if number not in there:
            findings.add(Kind.MISSING, path, f"session {number} of {person.ppid} has begun")
            continue
        if not (path / JOURNAL).exists() and not seals:
            findings.notes.append(f"{findings.name(path)}: it was opened, and nothing was done")
            continue
        if number not in begun and journal.sound:
            findings.add(Kind.ORPHANED, path, f"{STUDY_JOURNAL} does not know this session")
        read = read_journal_whole(path / JOURNAL, findings)
        for seal in _in_force(of, number):
            check_head(findings, read, seal["records"], seal["digest_of_last"], STUDY_JOURNAL)
        sealed = max((r["records"] for r in seals), default=0)
        settled = bool(sealed) and sealed == len(read.records)
        files = check_files(findings, read, settled)
        findings.counts["records whose loss was accepted"] += sum(
            r["records"] for _, r in numbered(read, (LOST,))
        )
        findings.counts["sessions"] += 1
        _check_session_entries(findings, path)
        session = None
        if read.sound:
            session = AuditedSession(person, number, read, files.are_sound, sealed)
        results.append((session, files.finished, read))
    return results


def _in_force(records: list[Record], session: int) -> list[Record]:
    """What the journal of the study knows of a session's journal, without accepted losses.

    Args:
        records: Its records on the participant, in order.
        session: Number of the session.
    """
    known: list[Record] = []
    for record in records:
        if record["session"] != session or record["kind"] == BEGUN:
            continue
        if record["kind"] == LOST:
            known = [r for r in known if r["records"] <= record["records"]]
        known.append(record)
    return known


def _check_session_entries(findings: Findings, session: Path) -> None:
    """Names files in a session's folder that nothing there has written."""
    tables = ("participant_details.csv", "settings.json", "log.csv")
    known = {JOURNAL, *LOCK_FILES, *PARTS, *CSV}
    for path in sorted((*session.iterdir(), *(session / INFO).glob("*"))):
        inside = path.parent != session
        if path.name.startswith(TEMPORARY) or path.name in (tables if inside else known):
            continue
        findings.add(Kind.ORPHANED, path, "nothing in a session has this name")


CSV = (
    "trial_results.csv",
    "questionnaires.csv",
    "questionnaire_scores.csv",
    "codebook.csv",
)
"""Tables of a session, beside those in its folder of information."""


def _check_entries(findings: Findings, people: set[str], study: StudyFolder | None) -> None:
    """Names folders of nobody, and counts files that are not a part of the study."""
    known = {
        STUDY_FILE,
        STUDY_JOURNAL,
        DESIGN_FILE,
        EARLIER,
        COPIES,
        SITES,
        ABOUT,
        SOURCES,
        *LOCK_FILES,
        "participants.csv",
        *CSV,
        *people,
    }
    if study is not None:
        known |= {name.partition("/")[0] for name in design_files(study.design)}
    for path in sorted(findings.root.iterdir()):
        if path.name in known:
            continue
        if path.is_dir() and any(path.glob(SESSIONS)):
            findings.add(Kind.ORPHANED, path, f"{STUDY_JOURNAL} knows no such participant")
        else:
            findings.notes.append(f"{path.name}: not a part of the study's record")


def _check_tables(
    findings: Findings,
    study: StudyFolder | None,
    journal: ReadJournal,
    journals: Mapping[str, ReadJournal],
    sessions: list[AuditedSession],
) -> None:
    """Compares all tables, if everything that they follow from is as it was written."""
    if study is None:
        return
    if not all(of.sound for of in journals.values()):
        findings.notes.append("the tables were not compared: a journal is damaged")
        return
    locked = study.build.get("program")
    if locked != code_digest():
        findings.notes.append(
            f"the tables of sessions and of the study were not compared: the study is locked to "
            f"program {locked}, and this is {code_digest()}"
        )
        return
    before = check_study_tables(findings, study, journal, sessions)
    for session in sessions:
        check_session_tables(findings, study, session, before.get(session.name, 0))
