"""Merges the folders of one study from two sites into a new folder; both stay unchanged.

If the sites gave one pseudonym to two people, the second person gets another one. A participant in
both folders, as in an older copy, is included once, with the longer journal. Participant numbers
are kept, since orders depend on them, so that participants of two sites may have the same number;
`sites.csv` lists the site of every participant.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from uuid import uuid4

from models.errors import StudyError
from models.json_input import checked, decoded_record
from sandbox.recording.recording import SUFFIX, packed, read_stored
from sandbox.study.record.build import changes
from sandbox.study.record.chain import (
    DIGEST,
    WITHDRAWAL,
    Record,
    chained,
    record_line,
    without_chain,
)
from sandbox.study.record.file_digests import recording_digests
from sandbox.study.record.files import (
    LOCK_FILES,
    TEMPORARY,
    json_bytes,
    locked,
    remove_locks,
    write_atomically,
)
from sandbox.study.record.folder import (
    LOCK,
    SCHEMA,
    SETTINGS,
    STUDY_FILE,
    STUDY_JOURNAL,
    WITHDRAWN,
    StudyFolder,
    copy_earlier_designs,
    write_design,
)
from sandbox.study.record.journal import journal_bytes, now, read_journal
from sandbox.study.record.pseudonym import new_pseudonym
from sandbox.study.record.stored_sessions import JOURNAL, session_folders, sessions_of
from sandbox.study.record.trial_files import TRIALS
from sandbox.study.share.export_folder import new_folder
from sandbox.study.share.privacy_records import RecordingEnd
from sandbox.study.share.withdraw import REMOVED, SITES, withdrawn
from sandbox.study.tables.column import csv_bytes
from sandbox.study.tables.tables import rebuild_all
from sandbox.trial.settings import encoded

Say = Callable[[str], object]

MERGED, MOVED = "merged", "moved"
"""Kinds of the records of a merge, in the journal of the study and in those of sessions."""


@dataclass
class Merged:
    """Results of a merge.

    Attributes:
        people: Number of participants after the merge.
        renamed: New pseudonyms of participants whose old one was in use, by site and old pseudonym.
        both: Pseudonyms of participants who were in both folders.
        left_out: Pseudonyms of participants who have withdrawn at one of the sites.
    """

    people: int = 0
    renamed: dict[str, str] = field(default_factory=dict)
    both: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)


def merge(first: StudyFolder, second: StudyFolder, out: Path, force: str = "") -> Merged:
    """Writes the merged study of two sites.

    Args:
        first, second: The sites' folders.
        out: The new folder, which must not exist.
        force: Reason for merging although program or encoders differ; it is logged.

    Raises:
        StudyError: The folders belong to different studies, a session is open, a participant
            continued at both sites, or the new folder cannot be written.
    """
    different = _check(first, second, force)
    sites = {"A": first, "B": second}
    merged = Merged()
    new_id = str(uuid4())
    chosen = _choose(sites, merged)
    with new_folder(out) as work:
        about = {
            "schema": SCHEMA,
            "study": new_id,
            "experiment": first.design.name,
            "mode": first.mode,
            "created": now(),
            "build": first.build,
            SETTINGS: encoded(first.settings),
        }
        write_atomically(work / STUDY_FILE, json_bytes(about))
        write_design(work, first.design)
        for study in (first, second):
            copy_earlier_designs(study.path, work)
        _write_journal(work, about, sites, chosen, different, force)
        for (site, old), new in chosen.items():
            _copy(sites[site].path, old, work, new, new_id)
        write_atomically(work / SITES, sites_bytes(read_journal(work / STUDY_JOURNAL)))
        rebuild_all(StudyFolder.at(work))
        remove_locks(work)
    merged.people = len(chosen)
    return merged


def _check(first: StudyFolder, second: StudyFolder, force: str) -> list[str]:
    """Checks that the folders belong to one study; returns the differences of their programs."""
    if first.path.resolve() == second.path.resolve():
        raise StudyError("both folders are the same folder", where=str(first.path))
    for what, mine, other in (
        ("kinds of data", first.mode, second.mode),
        ("designs", first.design.digest, second.design.digest),
    ):
        if mine != other:
            raise StudyError(
                f"the folders have different {what}",
                where=str(second.path),
                got=other,
                expected=mine,
                remedy="Only folders of the same study can be merged",
            )
    different = changes(first.build, second.build)
    if different and not force:
        raise StudyError(
            "the sites ran with different programs",
            where=str(second.path),
            got=", ".join(different),
            remedy='Merge them anyway with --force-different "REASON", which is logged',
        )
    return different


def _choose(sites: Mapping[str, StudyFolder], merged: Merged) -> dict[tuple[str, str], str]:
    """Chooses the pseudonym of every participant, by site and old pseudonym."""
    gone = set().union(*(withdrawn(study) for study in sites.values()))
    chosen: dict[tuple[str, str], str] = {}
    taken = gone | {p.ppid for study in sites.values() for p in study.participants()}
    for site, study in sites.items():
        for person in study.participants():
            ppid = person.ppid
            if ppid in gone:
                # An old copy of a withdrawn participant must not come back under a new pseudonym.
                merged.left_out.append(ppid)
            elif ("A", ppid) in chosen and site == "B":
                longer = _same_person(sites["A"], study, ppid)
                if longer is None:
                    chosen[site, ppid] = new = _fresh(taken)
                    merged.renamed[f"{site} {ppid}"] = new
                    continue
                merged.both.append(ppid)
                if longer is study:
                    del chosen["A", ppid]
                    chosen[site, ppid] = ppid
            else:
                chosen[site, ppid] = ppid
    return chosen


def _same_person(first: StudyFolder, second: StudyFolder, ppid: str) -> StudyFolder | None:
    """Site with the longer journal of a participant in both folders; None if the pseudonym belongs
    to two different people."""
    journals = [_records(study, ppid) for study in (first, second)]
    if not all(journals):
        # A participant who has not begun has only a pseudonym.
        return first if journals[0] or not journals[1] else second
    one, other = ([_plain(r) for r in journal if r["kind"] != MOVED] for journal in journals)
    if one[0] != other[0]:
        return None
    shared = min(len(one), len(other))
    if one[:shared] != other[:shared]:
        raise StudyError(
            "a participant continued at both sites",
            where=str(second.path),
            got=ppid,
            remedy="Decide which folder holds the right data, and remove the other",
        )
    return first if len(one) >= len(other) else second


def _plain(record: Record) -> Record:
    """A record without its place in the journal, which an earlier merge has changed."""
    return {key: value for key, value in without_chain(record).items() if key != "n"}


def _records(study: StudyFolder, ppid: str) -> list[Record]:
    """All journal records of a participant's sessions, in order."""
    return [
        record for session in sessions_of(study, study.find(ppid)) for record in session.records
    ]


def _fresh(taken: set[str]) -> str:
    name = new_pseudonym()
    while name in taken:
        name = new_pseudonym()
    taken.add(name)
    return name


def _write_journal(
    work: Path,
    about: Record,
    sites: Mapping[str, StudyFolder],
    chosen: Mapping[tuple[str, str], str],
    different: list[str],
    force: str,
) -> None:
    """Writes the journal of the merged study: its lock, the sites, then the records of both."""
    of = {site: [new for (s, _), new in chosen.items() if s == site] for site in sites}
    heads = {site: study.records() for site, study in sites.items()}
    head = {"time": now(), "clock": 0.0}
    records: list[Record] = [
        {**head, "kind": LOCK, **about},
        {
            **head,
            "kind": MERGED,
            "sites": {
                site: {
                    "study": study.id,
                    "ppids": of[site],
                    "records": len(heads[site]),
                    "digest_of_last": heads[site][-1][DIGEST] if heads[site] else "",
                }
                for site, study in sites.items()
            },
            **({"reason": force, "changed": different} if different else {}),
        },
    ]
    tombstones: set[str] = set()
    for site in sites:
        for record in heads[site]:
            ppid = record.get("ppid")
            if record["kind"] == WITHDRAWN:
                if ppid not in tombstones:
                    records.append(record)
                tombstones.add(str(ppid))
            elif record["kind"] in (WITHDRAWAL, REMOVED):
                # What these are about is no longer in this chain.
                continue
            elif ppid is None:
                # The lock and upgrades of a site are not those of the merged study.
                records.append({**record, "site": site})
            elif (site, ppid) in chosen:
                records.append({**record, "ppid": chosen[site, ppid]})
    write_atomically(work / STUDY_JOURNAL, journal_bytes(records))


def _copy(source: Path, old: str, work: Path, new: str, study: str) -> None:
    """Copies the folder of a participant, with the new id of the study and the new pseudonym."""
    if not (source / old).exists():
        return
    with ExitStack() as stack:
        for session in session_folders(source / old):
            if os.access(session, os.W_OK):
                what = f"participant {old}"
                stack.enter_context(locked(session / ".lock", wait=False, what=what))
        shutil.copytree(source / old, work / new, ignore=_ignored)
    for session in session_folders(work / new):
        if (session / JOURNAL).exists():
            _rename(session, new, old, study)


def _rename(session: Path, new: str, old: str, study: str) -> None:
    """Tells a copied session the id of the merged study, and its pseudonym in it.

    The journal stays as it is, with a record at its end. Recordings name the pseudonym; where it is
    another one they are written anew, with their digests in that record.
    """
    path = session / JOURNAL
    recordings = {}
    for recording in sorted((session / TRIALS).glob("*.jsonl*")) if new != old else ():
        where = str(recording)
        kept = [_renamed(line, new, where) for line in read_stored(recording).data.split(b"\n")]
        data = b"\n".join(kept)
        small = recording.suffix == SUFFIX
        write_atomically(recording, packed(data) if small else data, durable=False)
        plain = recording.with_name(recording.name.removesuffix(SUFFIX))
        recordings[f"{TRIALS}/{plain.name}"] = recording_digests(plain)
    records = read_journal(path)
    if not records:
        return
    last = records[-1]
    entry = {
        "n": len(records),
        "time": now(),
        "clock": last["clock"],
        "kind": MOVED,
        "study": study,
        "ppid": new,
        "recordings": recordings,
    }
    line = chained(entry, last[DIGEST])[1]
    write_atomically(path, b"".join(map(record_line, records)) + line, durable=False)


def _renamed(line: bytes, new: str, where: str) -> bytes:
    """A recording's line with its pseudonym replaced, if it has one.

    Raises:
        StudyError: The line is damaged.
    """
    if not line.startswith((b'{"kind":"header"', b'{"kind":"end"')):
        return line
    what = "the recording is damaged, so its pseudonym cannot be changed"
    values = decoded_record(line, StudyError, what=what, where=where)
    about = values
    if values["kind"] == "end":
        checked(values, RecordingEnd, StudyError, what=what, where=where)
        about = values["result"]
    if isinstance(about.get("study"), dict):
        about["study"]["ppid"] = new
    return json.dumps(values, separators=(",", ":"), ensure_ascii=False).encode()


def sites_bytes(records: list[Record]) -> bytes:
    """Content of `sites.csv` according to the journal of the merged study."""
    sites: Mapping[str, Any] = next((r["sites"] for r in records if r["kind"] == MERGED), {})
    rows = [{"ppid": ppid, "site": site} for site in sites for ppid in sites[site]["ppids"]]
    return csv_bytes(rows, ["ppid", "site"])


def _ignored(folder: str, names: list[str]) -> list[str]:
    return [name for name in names if name in LOCK_FILES or name.startswith(TEMPORARY)]
