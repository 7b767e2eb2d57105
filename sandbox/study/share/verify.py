"""Verifies that a study's data are as they were written, in nine checks (`POINTS`).

Nothing is repaired or written. The remains of a killed program are not findings: a half-written
last line, an attempt without an end, an incomplete recording. They are counted or noted.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from models.errors import StudyError
from models.message import counted
from sandbox.recording.recording import SUFFIX, load_recording, read_stored, stored
from sandbox.recording.versions import states_difference
from sandbox.study.design.session_plan import session_plan, trials_of
from sandbox.study.record.build import code_digest
from sandbox.study.record.copies import JOURNAL, SESSIONS, copies
from sandbox.study.record.folder import FILES, Participant, StudyFolder, readable_design
from sandbox.study.record.journal import HASH, Record, digest_of, sound_records
from sandbox.study.record.notes import SEALED, Seal, broken_seals, read_notes, seals_of, withdrawn
from sandbox.study.record.records import END, RUNS, TRIAL, TRIAL_END
from sandbox.study.record.state import SessionState, is_broken
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.record.trial_files import TRIALS, frames_of, is_whole, unknown_recordings
from sandbox.study.share.masking import LEFT_OUT
from sandbox.study.tables.column import TABLES as FOLDER
from sandbox.study.tables.frame_table import frames_again
from sandbox.study.tables.tables import table_files
from sandbox.trial.replay import Verification

FOLDERS, CHAINS, SEALS, RECORDINGS, STATES, FRAMES, TABLES, PLANS, GONE = (
    "folders",
    "lines of the records",
    "seals",
    "recordings",
    "states of the trials",
    "frames",
    "tables",
    "numbers, orders and seeds",
    "withdrawals",
)
NOT_COMPARED = "not compared"
"""First words of the result of a check that could not be made."""
POINTS = (FOLDERS, CHAINS, SEALS, RECORDINGS, STATES, FRAMES, TABLES, PLANS, GONE)
"""The checks, by the name under which their results are printed."""


@dataclass(frozen=True)
class Finding:
    """A difference from the data as they were written.

    Attributes:
        path: The file or folder, relative to the folder of the study.
        what: Description of the difference.
        line: Number of the line, from 1; None for a whole file.
    """

    path: str
    what: str
    line: int | None = None

    def __str__(self) -> str:
        line = "" if self.line is None else f", line {self.line}"
        return f"{self.path}{line}: {self.what}"


@dataclass
class Verified:
    """Result of a verification.

    Attributes:
        root: Folder of the study.
        found: Findings by check.
        compared: Text on what was compared, by check.
        notes: Lines about normal states, such as attempts that were broken off.
    """

    root: Path
    found: dict[str, list[Finding]] = field(default_factory=lambda: {p: [] for p in POINTS})
    compared: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @property
    def sound(self) -> bool:
        """True if there are no findings."""
        return not any(self.found.values())

    def add(self, point: str, path: Path, what: str, line: int | None = None) -> None:
        """Adds a finding about a file or folder of the study."""
        self.found[point].append(Finding(self.name(path), what, line))

    def note(self, path: Path, what: str) -> None:
        """Adds a line about a normal state."""
        self.notes.append(f"{self.name(path)}: {what}")

    def name(self, path: Path) -> str:
        """Name of a file relative to the folder of the study."""
        return path.relative_to(self.root).as_posix()

    def lines(self) -> Iterator[str]:
        """Yields a line for each check, with its result and what was compared."""
        for point in POINTS:
            wrong, compared = len(self.found[point]), self.compared.get(point, "")
            if wrong:
                yield f"{point}: {wrong} wrong ({compared or 'nothing to compare'})"
            elif not compared or compared.startswith("0 "):
                yield f"{point}: nothing to check"
            elif compared.startswith(NOT_COMPARED):
                yield f"{point}: {compared}"
            else:
                yield f"{point}: right ({compared})"


@dataclass(frozen=True)
class _Read:
    """The journal of a session, up to its first damaged line.

    Attributes:
        path: File of the journal.
        person: The participant; None without notes about a participant.
        number: Number of the session.
        records: Records before the first damaged line.
        sound: True if no line is damaged.
    """

    path: Path
    person: Participant | None
    number: int
    records: list[Record]
    sound: bool


def verify(path: Path, seals: Path | None = None, replays: bool = True) -> Verified:
    """Verifies a study.

    Args:
        path: Folder of the study.
        seals: A copy of `notes/SITE.jsonl` that was stored elsewhere; the journals must also match
            its seals.
        replays: False leaves out the checks of states and frames, which replay the recordings.

    Raises:
        StudyError: The path is not the folder of a study, notes cannot be read, or the copy has no
            seals.
    """
    study, done = StudyFolder.at(path), Verified(path)
    copy = read_notes(seals) if seals else []
    if seals and not any(note["kind"] == SEALED for note in copy):
        raise StudyError(
            "no seals to compare with",
            where=str(seals),
            expected="a copy of the study's notes/A.jsonl, which was stored elsewhere",
        )
    people = {person.ppid: person for person in study.participants()}
    known = _check_folders(done)
    sessions = [_read(done, file, people.get(file.parents[1].name)) for file in known]
    lines = sum(len(session.records) for session in sessions)
    done.compared[CHAINS] = f"{counted(lines, 'line')} of {counted(len(sessions), 'session')}"
    _check_seals(done, study, sessions, copy)
    finished = [file for session in sessions for file in _check_recordings(done, session)]
    _check_replays(done, finished if replays else [])
    if finished and not replays:
        done.compared[STATES] = f"{NOT_COMPARED}: nothing was replayed"
    _check_tables(done, study, all(session.sound for session in sessions))
    for session in sessions:
        _check_plan(done, session)
    done.compared[PLANS] = counted(len(sessions), "session")
    _check_design(done, study)
    _check_withdrawals(done, study)
    return done


def _check_folders(done: Verified) -> list[Path]:
    """Adds a finding for each copy of a folder inside of the study.

    Returns:
        The journals of all sessions, without those in copies.
    """
    apart = copies(done.root)
    for copy in apart:
        done.add(FOLDERS, copy.path, str(copy))
    left_out = {copy.path for copy in apart}
    files = sorted(done.root.glob(f"*/{SESSIONS}/{JOURNAL}"))
    done.compared[FOLDERS] = counted(len(files), "folder of a session", "folders of sessions")
    return [f for f in files if not left_out & {f.parent, f.parents[1]}]


def _read(done: Verified, path: Path, person: Participant | None) -> _Read:
    """Reads the journal of a session up to its first damaged line, and adds a finding for it."""
    data = path.read_bytes()
    records, sound, damage = sound_records(data, path)
    rest, number = data[sound:], len(records) + 1
    if damage is not None:
        found = (("got", damage.got), ("expected", damage.expected))
        told = ", ".join(f"{name} {what}" for name, what in found if what is not None)
        done.add(CHAINS, path, f"{damage.what} ({told})" if told else damage.what, number)
    elif rest.endswith(b"\0\n"):
        done.note(path, "ends in zeros, after a power cut")
    elif rest:
        done.note(path, f"line {number} is half written, as when a program was killed")
    return _Read(path, person, int(path.parent.name[1:]), records, damage is None)


def _check_seals(
    done: Verified, study: StudyFolder, sessions: Sequence[_Read], copy: Sequence[Record]
) -> None:
    known = {(s.path.parents[1].name, s.number): s for s in sessions}
    gone = withdrawn(study.records())
    kept = [note for note in [*study.records(), *copy] if note["kind"] == SEALED]
    for ppid, number in dict.fromkeys((n["ppid"], n["session"]) for n in kept):
        if (ppid, number) not in known and ppid not in gone:
            path = session_path(done.root, ppid, number) / JOURNAL
            done.add(SEALS, path, "missing: the session was sealed")
    count = 0
    for (ppid, number), session in known.items():
        seals = seals_of(study.path, ppid, number)
        seals += [
            Seal(n["records"], n[HASH])
            for n in copy
            if (n.get("ppid"), n.get("session")) == (ppid, number)
        ]
        count += len(seals)
        if not session.sound:
            continue
        lacks, unlike = broken_seals(session.records, seals)
        if lacks:
            done.add(
                SEALS, session.path, f"missing: the last {counted(lacks, 'line')} that were sealed"
            )
        if unlike:
            done.add(SEALS, session.path, "changed: a line is not the line that was sealed")
        ended = any(record["kind"] == END for record in session.records)
        if ended and not seals:
            done.add(SEALS, session.path, "no seal: the notes of its site are not in this folder")
    done.compared[SEALS] = counted(count, "seal")


def _check_recordings(done: Verified, session: _Read) -> list[Path]:
    """Compares the recordings of a session with their digests in its journal.

    Returns:
        The unchanged recordings of finished attempts, without `.gz`.
    """
    folder = session.path.parent
    digests: dict[str, str | None] = {}
    ended = set()
    for record in session.records:
        if "recording" in record and "file" in record:
            digests[record["file"]] = record["recording"]
        if record["kind"] == TRIAL_END and not is_broken(record):
            ended.add(record["file"])
    right = {file for file, digest in digests.items() if _is_right(done, folder / file, digest)}
    text = done.compared.get(RECORDINGS, "0").split()[0]
    done.compared[RECORDINGS] = counted(int(text) + len(right), "recording")
    if session.sound:
        for file in unknown_recordings(folder, SessionState.of(session.records)):
            path = stored(folder / file)
            if is_whole(folder / file):
                done.add(RECORDINGS, path, "a whole recording without a record")
            else:
                done.note(path, "incomplete: the program was killed while it wrote this file")
    return [folder / file for file in sorted(ended & right)]


def _is_right(done: Verified, path: Path, digest: str | None) -> bool:
    """True if a recording matches the digest in its record. Otherwise a finding is added, except
    for a missing recording whose record states that there is none."""
    files = [p for p in (path, path.with_name(path.name + SUFFIX)) if p.exists()]
    if digest in (None, LEFT_OUT):
        for file in files:
            done.add(RECORDINGS, file, "unexpected: by the journal, its attempt has no recording")
        return False
    if not files:
        done.add(RECORDINGS, path.with_name(path.name + SUFFIX), "missing")
        return False
    for file in files:
        data, whole = read_stored(file)
        if not whole or digest_of(data) != digest:
            done.add(RECORDINGS, file, "changed: its digest is not that in the record")
            return False
    return True


def _check_replays(done: Verified, finished: Sequence[Path]) -> None:
    """Replays finished attempts, and compares their states and frames with the stored data."""
    others: Counter[str] = Counter()
    played, frames = 0, 0
    for path in finished:
        if reason := states_difference(load_recording(path).header):
            others[reason] += 1
            continue
        verification, made = frames_again(path)
        played += 1
        if not verified(verification):
            done.add(STATES, stored(path), _differs(verification))
        if made is None or not frames_of(path).exists():
            continue
        frames += 1
        if frames_of(path).read_bytes() != made:
            done.add(FRAMES, frames_of(path), "changed: a replay gives other frames")
    done.compared[STATES] = f"{counted(played, 'recording')} replayed"
    there = len(list(done.root.glob(f"*/{SESSIONS}/{TRIALS}/*.frames.csv.gz")))
    none = f"{NOT_COMPARED}: no recording was replayed for the frames in {counted(there, 'file')}"
    done.compared[FRAMES] = counted(frames, "file") if frames or not there else none
    for reason, count in others.items():
        done.notes.append(f"{counted(count, 'recording')} not replayed: {reason}")


def verified(verification: Verification) -> bool:
    """True if a recording is complete, and its states are equal, or agree within the bound for
    another machine."""
    agrees = (
        not verification.same_machine
        and verification.agreement is not None
        and verification.agreement.holds
    )
    return (verification.exact or agrees) and verification.complete


def _differs(verification: Verification) -> str:
    """Text on the differences that a replay has found."""
    if verification.exact:
        return "incomplete: its states are equal, but it ends before the end of the trial"
    why = (verification.task_change, *verification.differs_in)
    because = "; ".join(filter(None, why))
    where = f"its states differ from physics step {verification.first_difference} on"
    return f"{where}: {because}" if because else where


def _check_tables(done: Verified, study: StudyFolder, sound: bool) -> None:
    if not any((study.path / FOLDER).glob("*.csv")):
        done.compared[TABLES] = f"{NOT_COMPARED}: there are none"
        return
    if not sound:
        done.compared[TABLES] = f"{NOT_COMPARED}: a record is damaged"
        return
    if study.build.get("program") != code_digest():
        done.compared[TABLES] = (
            f"{NOT_COMPARED}: the study is locked to another program than this one"
        )
        return
    folder = study.path / FOLDER
    made: Mapping[str, bytes] = table_files(study)
    there = {name for name in made if (folder / name).exists()}
    for name in sorted(there):
        if (folder / name).read_bytes() != made[name]:
            what = (
                "differs from the table that follows from the records; "
                "`sandbox study tables` makes it again"
            )
            done.add(TABLES, folder / name, what)
    done.compared[TABLES] = counted(len(there), "table")


def _check_plan(done: Verified, session: _Read) -> None:
    """Checks the participant, and the levels and seeds of all trials.

    The participant's values in the journal must be those in notes.jsonl. The levels and seeds must
    follow from the participant's number and the design in the journal.
    """
    if not session.sound or not session.records:
        return
    person, start = session.person, session.records[0]
    if person is None:
        done.add(PLANS, session.path.parents[1], "no person: the folder has no notes.jsonl")
        return
    # The number may change until a trial has begun; see `StudyFolder.include`.
    runs = [record for record in session.records if record["kind"] in RUNS]
    begun = any(record["kind"] == TRIAL for record in session.records)
    start = {**start, "number": runs[-1].get("number") if begun else person.number}
    wrong = [name for name, value in vars(person).items() if start.get(name) != value]
    if wrong:
        what = (
            f"notes.jsonl and the record of session {session.number} differ in {', '.join(wrong)}"
        )
        done.add(PLANS, session.path.parents[1], what)
        return
    planned: dict[int, tuple[object, object]] = {}
    for line, record in enumerate(session.records, start=1):
        if record["kind"] in RUNS and FILES in record:
            design = readable_design(record[FILES])
            if design is None:
                done.note(session.path, f"line {line}: this version cannot read the design")
                return
            if design.digest != record["design"]:
                done.add(PLANS, session.path, "the design does not match its recorded digest", line)
            plan = trials_of(session_plan(design, person.number, session.number))
            planned = {trial.number: (trial.levels, trial.seed) for trial in plan}
        elif record["kind"] == TRIAL and planned.get(record["trial"]) != (
            record["levels"],
            record["seed"],
        ):
            what = f"trial {record['trial']} has other levels or another seed than planned"
            done.add(PLANS, session.path, what, line)


def _check_design(done: Verified, study: StudyFolder) -> None:
    """Checks that the design in the folder is the design to which the study is locked."""
    if study.design.digest != study.build["design"]:
        what = "changed: it is not the design to which the study is locked"
        done.add(PLANS, study.path / "design.toml", what)


def _check_withdrawals(done: Verified, study: StudyFolder) -> None:
    gone = withdrawn(study.records())
    for ppid in sorted(gone):
        if (study.path / ppid).exists():
            done.add(GONE, study.path / ppid, "data of a person who has withdrawn")
    done.compared[GONE] = counted(len(gone), "withdrawal")
