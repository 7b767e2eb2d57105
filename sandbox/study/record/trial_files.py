"""The files of trials in a session's folder, and short names of trials: NAME/3B5G5T/S001/T007.

`trials/T007.jsonl.gz` is the recording of the first attempt at trial 7, and
`trials/T007.a2.jsonl.gz` the recording of the second attempt. `trials/T007.frames.csv.gz` and
`trials/T007.a2.frames.csv.gz` have the frames of these attempts. A recording is a plain file until
its trial has ended. Then it is compressed, without loss of data if the program fails or is killed
meanwhile. After a power cut, a complete recording may have no record in the journal.
"""

from __future__ import annotations

import re
from pathlib import Path

from models.errors import RecordingError, StudyError
from sandbox.recording.recording import (
    SUFFIX,
    Recording,
    load_recording,
    packed,
    read_stored,
    stored,
)
from sandbox.study.record.copies import JOURNAL, person_folders, session_folders
from sandbox.study.record.durable_files import study_error, write_atomically
from sandbox.study.record.journal import digest_of, read_journal
from sandbox.study.record.state import SessionState, is_broken
from sandbox.system.files import sync_folder
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import recorded_settings

TRIAL = re.compile(r"T\d+(\.a\d+)?")
TRIALS = "trials"


def attempt_files(folder: Path) -> list[str]:
    """Names, without `.gz`, of all recordings in a session's folder of trials, in order.

    The file with the last states of a diverged attempt, which is next to its recording, is left
    out.
    """
    names = {path.name.removesuffix(SUFFIX) for path in folder.glob("T*.jsonl*")}
    return sorted(name for name in names if TRIAL.fullmatch(name.removesuffix(".jsonl")))


def recording_digest(path: Path) -> str | None:
    """Digest of the lines of a recording, compressed or not; None if it is missing.

    Args:
        path: Path of the recording without `.gz`.

    Raises:
        OSError: The file cannot be read.
    """
    try:
        return digest_of(read_stored(path).data)
    except FileNotFoundError:
        return None


def frames_of(recording: Path) -> Path:
    """File of the 62.5 Hz frames of a recording.

    Args:
        recording: Path of the recording without `.gz`.
    """
    return recording.with_name(f"{recording.stem}.frames.csv.gz")


def find_recordings(name: str, out: Path) -> list[Path]:
    """Finds the recordings that a name refers to, in order.

    Args:
        name: A file; a trial such as `NAME/3B5G5T/S001/T007`; or a study, participant or session,
            for all of its trials. A trial without `S001` stands for that trial of every session.
        out: Folder of studies, in which names are looked up that do not exist in the current
            folder.

    Raises:
        RecordingError: No recording has that name.
    """
    path = Path(name)
    if stored(path).is_file():
        return [path]
    for base in (Path(), out):
        paths = _of_folder(base / path)
        if paths:
            return paths
    # The longest existing part of the name inside the folder of studies helps to find the mistake.
    near = next((p for p in (out / path).parents if p.is_relative_to(out) and p.is_dir()), None)
    kept = [p.name for p in near.iterdir() if p.is_dir() and p.name[0] != "."] if near else []
    raise RecordingError(
        "this folder has no recordings" if path.is_dir() else "no such recording",
        where=name,
        expected="a file, or a trial such as NAME/3B5G5T/S001/T007"
        + (f"; in {near} there are {', '.join(sorted(kept)[:6])}" if kept else ""),
        # Names of files have a suffix; names of trials have none.
        remedy=None if path.suffix else "For studies in another folder, add --out",
    )


def finished_only(files: list[Path]) -> tuple[list[Path], int]:
    """Leaves out recordings of attempts that were broken off, such as by a kill.

    Args:
        files: Recordings of a study.

    Returns:
        The recordings of finished attempts, and the number of all other recordings.

    Raises:
        StudyError: A journal is damaged.
    """
    ended: dict[Path, set[str]] = {}
    for session in {file.parent.parent for file in files}:
        records = read_journal(session / JOURNAL)
        ended[session] = {
            Path(r["file"]).name for r in records if r["kind"] == "trial_end" and not is_broken(r)
        }
    finished = [file for file in files if file.name in ended[file.parent.parent]]
    return finished, len(files) - len(finished)


def _of_folder(path: Path) -> list[Path]:
    """Recordings of a trial, or of a folder of a study; empty if the path is neither."""
    if TRIAL.fullmatch(path.name):
        return [file for session in _sessions(path.parent) for file in _trial(session, path.name)]
    folders = (session / TRIALS for session in _sessions(path))
    return [folder / name for folder in folders for name in attempt_files(folder)]


def _sessions(path: Path) -> list[Path]:
    """Session folders at a path, which may be a session, a participant or a study."""
    if path.name == TRIALS:
        path = path.parent
    if (path / TRIALS).is_dir():
        return [path]
    return session_folders(path) or [s for p in person_folders(path) for s in session_folders(p)]


def _trial(session: Path, name: str) -> list[Path]:
    """The recording of the attempt with this name. If the name has no attempt number, it is that of
    the attempt that counts. Empty if there is no recording."""
    exact = session / TRIALS / f"{name}.jsonl"
    if "." not in name:
        counted = SessionState.of(read_journal(session / JOURNAL)).counted(int(name[1:]))
        if counted is not None:
            exact = session / counted.start["file"]
    return [exact] if stored(exact).is_file() else []


def pack(recording: Path) -> Path:
    """Replaces the recording of a finished trial by a compressed file.

    The plain file is deleted only after the compressed file has been flushed to the disk and read
    back. If the program is killed before that, both files remain, with the same content; the next
    call deletes the plain file.

    Args:
        recording: Path of the recording without `.gz`. Nothing is done if only the compressed file
            exists.

    Returns:
        The compressed file.

    Raises:
        StudyError: The compressed file cannot be written; the recording is unchanged.
    """
    target = recording.with_name(recording.name + SUFFIX)
    try:
        if not recording.exists():
            return target
        data = recording.read_bytes()
    except OSError as error:
        raise study_error(error, recording, "the recording cannot be read") from None
    write_atomically(target, packed(data))
    try:
        stored = read_stored(target)
        if stored.data != data or not stored.whole:
            target.unlink()
            raise StudyError(
                "the file that was read back differs from what was written",
                where=str(target),
                remedy="Stop using this disk; the uncompressed recording is still there",
            )
        recording.unlink()
        sync_folder(recording.parent)
    except OSError as error:
        raise study_error(error, recording, "the recording cannot be compressed") from None
    return target


def _ended(path: Path) -> Recording | None:
    """The recording if it is complete, whether its attempt was broken off or not; else None."""
    if not stored(path).exists():
        return None
    try:
        recording = load_recording(path)
    except RecordingError:
        # The program was killed before the first line was complete.
        return None
    return None if recording.damage or recording.end is None else recording


def finished_result(path: Path) -> TrialResult | None:
    """Result at the end of a recording; None if it is incomplete or was broken off."""
    recording = _ended(path)
    if recording is None or recording.end is None or recording.end["result"].get("broken_off"):
        return None
    return TrialResult.from_json(recording.end["result"], str(path))


def recorded_seconds(path: Path, result: TrialResult) -> float:
    """Real time that a finished trial took according to its recording, s.

    This is the simulated time, plus the times in which no simulated time passed (`STOOD_STILL`).
    """
    recording = load_recording(path)
    assert recording.end is not None
    simulated = recording.end["step"] * recorded_settings(recording.header).physics.timestep
    stood = sum((result.measures or {}).get(name) or 0.0 for name in STOOD_STILL)
    return round(float(simulated + stood), 6)  # any order: the sum is rounded


STOOD_STILL = ("waited_s", "away_s", "lost_s")
"""Measures that are real times in which no simulated time passes, s."""


def unknown_recordings(session: Path, state: SessionState) -> list[str]:
    """Recordings to which no record of the session refers: names without `.gz`, in order.

    Args:
        session: Folder of the session.
        state: State of the session according to its journal.
    """
    started = {a.start["file"] for attempts in state.attempts.values() for a in attempts}
    known = started | state.recordings.keys()
    files = [f"{TRIALS}/{name}" for name in attempt_files(session / TRIALS)]
    return [file for file in files if file not in known]


def is_whole(path: Path) -> bool:
    """True if a recording is complete, whether its attempt was broken off or not."""
    return _ended(path) is not None


def whole_leftovers(session: Path, state: SessionState) -> list[str]:
    """The complete recordings among `unknown_recordings`; see `is_whole`."""
    return [file for file in unknown_recordings(session, state) if is_whole(session / file)]
