"""Recordings of releases, in a folder a version, their index, and the verdict of their replay.

`index.json` of a version has, for each recording, its digest, the digests of its models and its
state hash at the end; whether the version is a candidate, which may still be recorded anew; and the
versions of what computed, whose fingerprint decides which verdict is promised.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from encoders.kept import kept_models
from encoders.regression.model_registry import MODELS, find_model
from models.errors import HandSandboxError, RecordingError
from sandbox.recording.recording import load_recording
from sandbox.trial.assembly import digests
from sandbox.trial.replay import replay
from sandbox.trial.settings import RunSettings

FOLDER = Path(__file__).resolve().parents[1] / "released"
INDEX = "index.json"
SUFFIX = ".jsonl.gz"
OUTCOME_ALONE = ("task-gather", "other-servos")
"""Recordings of which another machine is promised the outcome, and no places. Twelve dice push each
other in the one, soft servos push soft things in the other, so that a rounded digit grows there
(docs/results.md)."""


@dataclass(frozen=True)
class Release:
    """The recordings of a version.

    Attributes:
        version: The version, as in pyproject.toml.
        folder: Their folder.
        candidate: The version is not out yet; its recordings may be made anew.
        versions: Versions of what computed, as in the headers.
        recordings: Name -> `sha256` of the file, `encoder` and `labels` (digests), `state_hash`,
            `status`, and `made_by`, the command.
    """

    version: str
    folder: Path
    candidate: bool
    versions: dict[str, str]
    recordings: dict[str, dict[str, str]]

    def path(self, name: str) -> Path:
        """File of a recording."""
        return self.folder / f"{name}{SUFFIX}"

    def models(self) -> dict[str, str]:
        """Digest -> `encoder` or `labels`, of all models that the recordings name."""
        return {
            digest: kind
            for entry in self.recordings.values()
            for kind in ("encoder", "labels")
            if (digest := entry[kind])
        }


def load(version: str, folder: Path = FOLDER) -> Release:
    """Reads the index of a version.

    Raises:
        RecordingError: There is none, or it is damaged.
    """
    path = folder / version / INDEX
    try:
        known: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        return Release(
            version, path.parent, known["candidate"], known["versions"], known["recordings"]
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise RecordingError(
            "the index of a release cannot be read",
            where=str(path),
            got=str(error),
        ) from None


def releases(folder: Path = FOLDER) -> list[Release]:
    """All versions whose recordings are kept, in order of their numbers."""

    def numbers(version: str) -> list[int]:
        return [int(part) for part in version.split(".")]

    versions = [path.parent.name for path in folder.glob(f"*/{INDEX}")]
    return [load(version, folder) for version in sorted(versions, key=numbers)]


def file_digest(path: Path) -> str:
    """SHA-256 of a file, hexadecimal."""
    return sha256(path.read_bytes()).hexdigest()


@dataclass(frozen=True)
class Verdict:
    """What the replay of one recording gave.

    Attributes:
        name: Name of the recording.
        holds: The promise is kept.
        says: The verdict in words.
    """

    name: str
    holds: bool
    says: str


def verdict(release: Release, name: str) -> Verdict:
    """Replays a recording: to the bit where the fingerprint is equal, else the second verdict."""
    path, entry = release.path(name), release.recordings[name]
    if not path.is_file() or file_digest(path) != entry["sha256"]:
        return Verdict(name, False, "its file is missing, or not the one that was released")
    try:
        recording = load_recording(path)
        session, found = replay(recording)
        session.close()
    except HandSandboxError as error:
        return Verdict(name, False, str(error))
    if found.exact and found.complete:
        return Verdict(name, True, f"{found.compared} states equal to the bit")
    if found.same_machine:
        return Verdict(name, False, f"states differ from physics step {found.first_difference} on")
    agreed = found.agreement
    if agreed is None:
        return Verdict(name, False, "states differ, and no poses can be compared")
    distance = f"objects within {agreed.objects_mm:.2f} mm, hands within {agreed.hands_mm:.2f} mm"
    outcome = "same outcome" if agreed.same_outcome else "another outcome"
    holds = agreed.holds or (name in OUTCOME_ALONE and agreed.same_outcome is True)
    return Verdict(name, holds, f"another machine: {outcome}, {distance}")


def shipped() -> set[str]:
    """Digests of all encoders and labels that ship with this version."""
    found = {find_model(name, print).digest for name in MODELS}
    for labels in ("history", "population"):
        found.add(digests(RunSettings(labels=labels))["labels"])
    return found


def missing(folder: Path = FOLDER) -> dict[str, str]:
    """Digest -> version of models that a release names and that are neither shipped nor kept."""
    here = shipped() | set(kept_models())
    return {
        digest: release.version
        for release in releases(folder)
        for digest in release.models()
        if digest not in here
    }
