"""Backup of a study: one archive, which is read back and compared before it gets its name.

A backup may be made while sessions run. Journals are copied first. The recording of a trial is on
the disk before the journal calls it finished, so the archive contains the recording of every
finished trial of its journals. Of what is written meanwhile, it leaves out what its journals do not
know: trials that began after them, with their tables, and the logs of their sessions.
"""

from __future__ import annotations

import gzip
import io
import os
import re
import tarfile
import time
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path, PurePosixPath

from models.errors import StudyError
from sandbox.recording.recording import SUFFIX, stored
from sandbox.study.record.files import LOCK_FILES, TEMPORARY, make_folder, study_error
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.journal import parse_records
from sandbox.study.record.leftovers import LOG, lost_records
from sandbox.study.record.stored_sessions import JOURNAL, SESSIONS
from sandbox.study.record.trial_files import TRIALS
from sandbox.study.share.export_folder import refuse_existing
from sandbox.system.files import sync_file, sync_folder

SUMS = "SHA256SUMS"
"""Name of the list of digests in an archive, in the format of `sha256sum --check`."""

COARSE = 1_000_000_000
"""ns by which the time of a file may lag behind the clock."""
_ATTEMPT = re.compile(r"T\d{3,}(?:\.a\d+)?")
"""Name of an attempt in the name of a file."""


@dataclass(frozen=True)
class BackupContents:
    """Content of a backup: pseudonyms, and numbers of files, bytes and finished trials."""

    ppids: tuple[str, ...]
    files: int
    bytes: int
    trials: int


@dataclass(frozen=True)
class _Known:
    """What a session's journal knows: its number of records, and names such as T001 and T002.a2."""

    records: int
    attempts: frozenset[str]

    @classmethod
    def of(cls, journal: bytes, where: Path) -> _Known:
        """Reads a journal."""
        records, _ = parse_records(journal, where)
        started = frozenset(Path(r["file"]).stem for r in records if r["kind"] == "trial_start")
        return cls(len(records), started)


def back_up(study: StudyFolder, out: Path) -> BackupContents:
    """Writes a study into an archive, and reads it back.

    Args:
        study: The study.
        out: Path of the archive, .tar.gz, which must not exist.

    Raises:
        StudyError: The path exists, the archive cannot be written, or its content differs when it
            is read back. No archive is left then.
    """
    refuse_existing(out)
    if study.path.resolve() in out.resolve().parents:
        raise StudyError(
            "the backup would be inside the study folder",
            where=str(out),
            remedy="Put it on another disk",
        )
    make_folder(out.parent)
    work = out.parent / f"{TEMPORARY}{os.getpid()}-{out.name}"
    try:
        _write(study.path, work)
        checked = check_backup(work)
        sync_file(work)
        refuse_existing(out)
        work.rename(out)
        sync_folder(out.parent)
    except OSError as error:
        raise study_error(error, out, "the backup cannot be written") from None
    finally:
        work.unlink(missing_ok=True)
    return checked


def check_backup(path: Path) -> BackupContents:
    """Reads a whole archive and checks all digests, and the recordings of all finished trials.

    Raises:
        StudyError: The file is damaged, incomplete, or not a backup of a study.
    """
    sums, digests = "", {}
    journals: dict[str, bytes] = {}
    size = 0
    try:
        with tarfile.open(path, "r:gz") as archive:
            for member in archive:
                stream = archive.extractfile(member)
                data = stream.read() if stream else b""
                inside = str(PurePosixPath(*PurePosixPath(member.name).parts[1:]))
                if inside == SUMS:
                    sums = data.decode()
                    continue
                digests[inside] = sha256(data).hexdigest()
                size += len(data)
                if inside.endswith("journal.jsonl"):
                    journals[inside] = data
            # Reading to the end makes gzip compare its own checksum.
            while archive.fileobj and archive.fileobj.read(1 << 20):
                pass
    except (OSError, EOFError, tarfile.TarError, ValueError, zlib.error) as error:
        raise StudyError(
            "the backup is damaged",
            where=str(path),
            got=str(error)[:120],
            remedy="Make another backup; the study itself is unchanged",
        ) from None
    listed = {line[66:]: line[:64] for line in sums.splitlines()}
    wrong = sorted(n for n in {*listed, *digests} if listed.get(n) != digests.get(n))
    if not listed or wrong or "study.json" not in digests:
        raise StudyError(
            "the backup is damaged" if listed else "not a backup of a study",
            where=str(path),
            got=", ".join(wrong[:5]) or None,
            expected=f"every file as listed in {SUMS}",
        )
    trials = sum(_finished(name, data, digests, path) for name, data in journals.items())
    ppids = tuple(sorted({PurePosixPath(name).parts[0] for name in journals}))
    return BackupContents(ppids, len(digests), size, trials)


def _finished(name: str, data: bytes, digests: dict[str, str], path: Path) -> int:
    """Counts the finished trials of a journal, and checks that their recordings exist."""
    records, _ = parse_records(data, Path(name))
    ended = [r["file"] for r in records if r["kind"] == "trial_end"]
    here = PurePosixPath(name).parent
    lost = [f for f in ended if not {str(here / f), str(here / (f + SUFFIX))} & digests.keys()]
    if lost:
        raise StudyError(
            "recordings of finished trials are missing", where=str(path), got=", ".join(lost[:5])
        )
    return len(ended)


def _write(folder: Path, work: Path) -> None:
    sums = []
    # The archive has no times and no owners, so that equal studies give equal archives.
    with (
        work.open("wb") as file,
        gzip.GzipFile("", "wb", 6, file, mtime=0) as packed,
        tarfile.open(fileobj=packed, mode="w") as archive,
    ):
        for name, data in _contents(folder):
            sums.append(f"{sha256(data).hexdigest()}  {name}\n")
            _add(archive, f"{folder.resolve().name}/{name}", data)
        _add(archive, f"{folder.resolve().name}/{SUMS}", "".join(sums).encode())


def _contents(folder: Path) -> Iterator[tuple[str, bytes]]:
    """Names and contents of all files, journals first."""
    began = time.time_ns() - COARSE
    # All journals are read before the folders are listed.
    journals = {
        path: path.read_bytes()
        for path in sorted((*folder.glob("*.jsonl"), *folder.glob(f"*/{SESSIONS}/{JOURNAL}")))
    }
    for path, data in journals.items():
        yield path.relative_to(folder).as_posix(), data
    known = {
        path.parent: _Known.of(data, path)
        for path, data in journals.items()
        if path.parent != folder
    }
    listed = sorted(path for path in folder.rglob("*") if not path.is_dir())
    # A study that was restored from a backup still has that one's list.
    yielded = {*journals, folder / SUMS}
    for listing in listed:
        # A recording may have been compressed since it was listed.
        path = stored(listing)
        temporary = path.name in LOCK_FILES or path.name.startswith(TEMPORARY)
        if path in yielded or temporary or path.is_symlink() or not path.is_file():
            continue
        yielded.add(path)
        try:
            if _is_of_a_later_trial(path, folder, known, began):
                continue
            data = path.read_bytes()
        except FileNotFoundError:
            path = path.with_name(path.name + SUFFIX)
            if path in yielded or not path.is_file():
                continue
            yielded.add(path)
            if _is_of_a_later_trial(path, folder, known, began):
                continue
            data = path.read_bytes()
        yield path.relative_to(folder).as_posix(), data


def _is_of_a_later_trial(
    path: Path, folder: Path, known: Mapping[Path, _Known], began: int
) -> bool:
    """True for what a session has written since the journals were read, and its journal does not
    know: of a session that has begun since, for everything.

    Raises:
        FileNotFoundError: The file is gone.
    """
    session = next((p for p in path.parents if p.parent.parent == folder), None)
    if session is None or not session.match(SESSIONS) or path.stat().st_mtime_ns < began:
        return False
    if session not in known:
        return True
    if path == session / LOG:
        return lost_records(session, known[session].records) > 0
    attempts = {*_ATTEMPT.findall(path.name)}
    return path.parent.name in (TRIALS, "trackers") and not attempts <= known[session].attempts


def _add(archive: tarfile.TarFile, name: str, data: bytes) -> None:
    entry = tarfile.TarInfo(name)
    entry.size = len(data)
    entry.mode = 0o644
    archive.addfile(entry, io.BytesIO(data))
