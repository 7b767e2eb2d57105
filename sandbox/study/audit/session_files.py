"""Compares the files of a session with its journal: recordings, and tables derived from them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import Any

from sandbox.recording.recording import GZIP, SUFFIX, read_stored
from sandbox.study.audit.findings import Findings, Kind
from sandbox.study.audit.journals import ReadJournal, numbered
from sandbox.study.record.chain import Record, digest_of
from sandbox.study.record.file_digests import DATA, PACKED
from sandbox.study.record.files import TEMPORARY
from sandbox.study.record.recorded_result import finished_result
from sandbox.study.record.trial_files import TRIALS

TRACKERS, INFO = "trackers", "session_info"
LEFT_OUT = "left_out"
"""In the place of the digests of a recording that an anonymous copy lacks."""


@dataclass(frozen=True)
class SessionFiles:
    """Result of the comparison.

    Attributes:
        finished: Recordings of finished attempts that are as they were written, without `.gz`.
        are_sound: True if nothing is missing or changed.
    """

    finished: list[Path]
    are_sound: bool


def check_files(findings: Findings, journal: ReadJournal, settled: bool) -> SessionFiles:
    """Compares the recordings and their tables with the journal of the session.

    Args:
        findings: Takes what is wrong.
        journal: The journal of the session.
        settled: True if the session was closed after its last record, so that nothing can be left
            of a program that was killed.
    """
    session = journal.path.parent
    finished, known, all_sound = [], set(), True
    for line, record, digests in _recordings(journal):
        path = session / record["file"]
        known |= {path.name, path.name + SUFFIX}
        whose = (
            f"trial {record['trial']}, attempt {record['attempt']}"
            if "trial" in record
            else "an attempt without records"
        )
        sound = _check_recording(findings, path, digests, f"{whose} (journal line {line})")
        all_sound &= sound
        if record["kind"] == "trial_end":
            # The last states of an attempt that diverged, which `sandbox replay` plays.
            if dump := record["result"].get("dump"):
                known.add(PureWindowsPath(dump).name)
            findings.counts["finished trials"] += 1
            if sound and digests is not None and LEFT_OUT not in digests:
                finished.append(path)
            findings.counts["trials that were taken in by hand"] += "taken_in" in record
        elif record["kind"] == "set_aside":
            findings.counts["recordings that were set aside by hand"] += 1
        elif record["kind"] == "trial_broken":
            findings.counts["attempts that were broken off"] += 1
    started = {r["file"] for _, r in numbered(journal, ("trial_start",))}
    for file in sorted(started):
        name = Path(file).name
        if name not in known:
            known |= {name, name + SUFFIX}
            findings.counts["attempts that were broken off"] += 1
            findings.notes.append(
                f"{findings.name(session / file)}: the program ended in this attempt, and has not "
                "been started again"
            )
    if journal.sound:
        _check_unknown_recordings(findings, session / TRIALS, known, settled)
    tables = _check_tables(findings, journal, settled)
    return SessionFiles(finished, all_sound and tables)


def _recordings(journal: ReadJournal) -> list[tuple[int, Record, dict[str, Any] | None]]:
    """Line, record and latest digests of every recording that a record has digests of."""
    latest: dict[str, dict[str, Any] | None] = {}
    first: dict[str, tuple[int, Record]] = {}
    for line, record in zip(journal.lines, journal.records, strict=True):
        if "recording" in record and "file" in record:
            latest[record["file"]] = record["recording"]
            if record["kind"] != "packed":
                first[record["file"]] = (line, record)
        if record["kind"] == "moved":
            latest |= record["recordings"]
    return [(line, record, latest[file]) for file, (line, record) in first.items()]


def _check_recording(
    findings: Findings, path: Path, digests: dict[str, Any] | None, whose: str
) -> bool:
    """Checks a recording against its digests; returns True if it is as it was written."""
    files = [p for p in (path, path.with_name(path.name + SUFFIX)) if p.exists()]
    if digests is None or LEFT_OUT in digests:
        findings.counts["recordings that an anonymous copy lacks"] += digests is not None
        for file in files:
            findings.add(Kind.ORPHANED, file, f"{whose} had no recording")
        return not files
    if not files:
        written = path.with_name(path.name + SUFFIX) if digests.get(PACKED) else path
        findings.add(Kind.MISSING, written, f"the recording of {whose}")
        return False
    for file in files:
        raw = file.read_bytes()
        data, whole = read_stored(file)
        packed = digests.get(PACKED)
        if not whole or digest_of(data) != digests[DATA]:
            findings.add(Kind.CHANGED, file, f"it is not the recording of {whose}")
            return False
        if raw.startswith(GZIP) and packed and digest_of(raw) != packed:
            what = f"the compressed file is another one; its content is the recording of {whose}"
            findings.add(Kind.CHANGED, file, what)
            return False
    findings.counts["recordings compared"] += 1
    return True


def _check_unknown_recordings(
    findings: Findings, folder: Path, known: set[str], settled: bool
) -> None:
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if path.name in known:
            continue
        plain = path.with_name(path.name.removesuffix(SUFFIX))
        if not path.name.startswith(TEMPORARY) and finished_result(plain) is not None:
            findings.add(
                Kind.ORPHANED,
                path,
                "a whole recording without a record; `sandbox study recover` offers to take it in "
                "or set it aside",
            )
        elif settled:
            findings.add(Kind.ORPHANED, path, "no record names it")
        else:
            findings.notes.append(f"{findings.name(path)}: left by a program that was killed")


def _check_tables(findings: Findings, journal: ReadJournal, settled: bool) -> bool:
    """Compares the tables of trials with their digests; returns True if all are sound."""
    folder = journal.path.parent / TRACKERS
    expected: dict[str, tuple[int, str]] = {}
    built = set()
    for line, record in numbered(journal, ("tables", "set_aside")):
        stem = Path(record["file"]).stem
        built.add(stem)
        expected = {k: v for k, v in expected.items() if _stem(k) != stem}
        expected |= {name: (line, digest) for name, digest in record["files"].items()}
    sound = True
    for name, (line, digest) in expected.items():
        path = folder / name
        if not path.exists():
            findings.add(Kind.MISSING, path, f"a table of a trial (journal line {line})")
        elif digest_of(path.read_bytes()) != digest:
            findings.add(
                Kind.CHANGED, path, f"it is not the table that was written (journal line {line})"
            )
        else:
            findings.counts["tables of trials compared"] += 1
            continue
        sound = False
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if path.name in expected:
            continue
        if journal.sound and (settled or (_stem(path.name) in built)):
            findings.add(Kind.ORPHANED, path, "no record names it")
        elif journal.sound:
            findings.notes.append(f"{findings.name(path)}: left by a program that was killed")
    return sound


def _stem(name: str) -> str:
    """Name of the recording that a table was derived from, without suffix."""
    return name.partition("_")[2].removesuffix(".gz").rpartition(".")[0]
