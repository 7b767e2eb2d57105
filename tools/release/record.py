"""Records the trials that a release keeps."""

from __future__ import annotations

import contextlib
import io
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

from models.errors import RecordingError
from sandbox.cli.main import main
from sandbox.recording.recording import load_recording
from sandbox.recording.recording_file import packed
from tools.release.plan import TUIO, recordings
from tools.release.released import FOLDER, INDEX, SUFFIX, Release, file_digest, load


def record(version: str, folder: Path = FOLDER, only: list[str] | None = None) -> Release:
    """Records all trials of a version that is not out yet, in place of earlier ones.

    Args:
        version: The version.
        folder: Folder of releases.
        only: Names of recordings to make; the others stay. None makes all.

    Raises:
        RecordingError: The version is out, or a trial failed.
    """
    place = folder / version
    old = load(version, folder) if (place / INDEX).is_file() else None
    if old is not None and not old.candidate:
        raise RecordingError(
            "this version is out, and its recordings are kept as they are",
            where=str(place),
            remedy="Record the next version",
        )
    if only is None and place.exists():
        shutil.rmtree(place)
    place.mkdir(parents=True, exist_ok=True)
    made_by = recordings(FOLDER.relative_to(FOLDER.parents[1]).as_posix())
    for name, words in made_by.items():
        if only is None or name in only:
            plain = place / f"{name}.jsonl"
            plain.unlink(missing_ok=True)
            (_over_tuio if name == TUIO else _run)(words, plain)
            path = place / f"{name}{SUFFIX}"
            path.write_bytes(packed(plain.read_bytes()))
            plain.unlink()
            print(f"{name}: {path.stat().st_size:,} bytes", flush=True)
    release = _indexed(version, place, made_by)
    release.write()
    return release


def _indexed(version: str, place: Path, made_by: dict[str, str]) -> Release:
    """What the headers and ends of the recordings in a folder say."""
    entries, known = {}, {}
    for name, words in made_by.items():
        path = place / f"{name}{SUFFIX}"
        if not path.is_file():
            continue
        recording = load_recording(path)
        if recording.end is None:
            raise RecordingError("the trial did not end", where=name, got=recording.damage)
        header, result = recording.header, recording.end["result"]
        known = header["versions"]
        entries[name] = {
            "made_by": f"sandbox run {words}",
            "sha256": file_digest(path),
            **{kind: str(digest) for kind, digest in header["digests"].items()},
            "status": str(result["status"]),
            "state_hash": str(result["state_hash"]),
        }
    # What computed counts; on which processor is nobody's business.
    noted = {part: value for part, value in known.items() if part != "processor"}
    return Release(version, place, True, noted, entries)


def _run(words: str, path: Path) -> None:
    """Runs a trial and records it."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        status = main(["run", *words.split(), "--record", str(path)])
    if status != 0:
        raise RecordingError("a trial failed", where=words, got=said.getvalue().strip()[-300:])


def _over_tuio(words: str, path: Path) -> None:
    """Records a trial whose touches are sent over the network by another process.

    The sent touches are those of the simulated user in the trial of the same seed, at their pace.
    """
    touches = path.with_name("touches.jsonl")
    _run(words.replace("--device tuio", "--surface ipad2"), touches)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    program = [sys.executable, "-m", "sandbox"]
    listener = subprocess.Popen(
        [*program, "run", *words.split(), *f"--surface ipad2 --port {port} --record".split(), path],
        stdout=subprocess.DEVNULL,
    )
    time.sleep(4.0)
    sender = subprocess.run(
        [*program, "touches", "send", str(touches), "--tuio", f"127.0.0.1:{port}"],
        stdout=subprocess.DEVNULL,
        check=False,
    )
    touches.unlink()
    if listener.wait(120) or sender.returncode:
        raise RecordingError("touches did not come over the network", where=words)
