"""Recordings of releases, in a folder a version, and what their index says of them.

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

from models.errors import RecordingError

FOLDER = Path(__file__).resolve().parents[2] / "tests" / "released"
INDEX = "index.json"
SUFFIX = ".jsonl.gz"


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

    def write(self) -> None:
        """Writes the index."""
        known = {
            "candidate": self.candidate,
            "versions": self.versions,
            "recordings": dict(sorted(self.recordings.items())),
        }
        text = json.dumps(known, indent=1) + "\n"
        (self.folder / INDEX).write_text(text, encoding="utf-8")


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
            remedy=f"`python -m tools.release record {version}` makes it",
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
