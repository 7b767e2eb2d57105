"""Keeps the models that released recordings name, in a folder that ships, by their digests."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import asdict, replace
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

from encoders.kept import (
    ENCODER,
    HISTORY,
    INDEX,
    PCA_IK,
    POPULATION,
    KeptModel,
    kept_folder,
    kept_models,
)
from encoders.labels.population_belief import load_population_belief
from encoders.labels.trained_belief import load_belief
from encoders.regression.model_registry import MODELS, find_model
from encoders.regression.trained import BUILTIN, builtin_folder, load_model
from encoders.store import load_capture
from models.errors import RecordingError
from sandbox.trial.assembly import digests
from sandbox.trial.settings import RunSettings
from tools.release.released import FOLDER, releases

ROOT = Path(__file__).resolve().parents[2]
CAPTURE = "capture.npz"


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


def keep(
    data: Path | None = None, out: Path | None = None, folder: Path = FOLDER
) -> list[KeptModel]:
    """Copies the models of a folder that releases name to the folder of kept models.

    Args:
        data: Folder of models, such as `encoders/data` of a release; None: those that ship now.
        out: Folder of kept models; None: the one that ships.
        folder: Folder of releases.

    Returns:
        The models that were not kept before.

    Raises:
        EncoderError: A model cannot be read.
    """
    data, out = data or builtin_folder(), out or kept_folder()
    wanted = {digest for release in releases(folder) for digest in release.models()}
    before = json.loads((out / INDEX).read_text("utf-8")) if (out / INDEX).is_file() else {}
    new = [m for m in _models_of(data) if m.digest in wanted and m.digest not in before]
    pca_ik = {r["encoder"]: r for e in releases(folder) for r in e.recordings.values()}
    quadratic = next((m for m in _models_of(data) if m.name == "quadratic"), None)
    for digest, entry in pca_ik.items():
        if f"--encoder {PCA_IK}" in entry["made_by"] and digest not in before and quadratic:
            new.append(KeptModel(digest, PCA_IK, PCA_IK, like=quadratic.digest))
            if quadratic not in new and quadratic.digest not in before:
                new.append(quadratic)
    if not new:
        return []
    out.mkdir(parents=True, exist_ok=True)
    entries = dict(before)
    for index, model in enumerate(new):
        stored = replace(
            model, file=_copied(data, model.file, out), capture=_copied(data, model.capture, out)
        )
        new[index] = stored
        values = asdict(stored)
        digest = values.pop("digest")
        entries[digest] = {name: value for name, value in values.items() if value}
    text = json.dumps(dict(sorted(entries.items())), indent=1) + "\n"
    (out / INDEX).write_text(text, encoding="utf-8")
    return new


def keep_of(revision: str, out: Path | None = None) -> list[KeptModel]:
    """Keeps the models as they were at a revision of this repository, such as a release's tag.

    Raises:
        RecordingError: The revision, or its models, are not in this repository.
    """
    with TemporaryDirectory() as scratch:
        archive = Path(scratch) / "data.tar"
        asked = ["git", "archive", "-o", str(archive), revision, "encoders/data"]
        got = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=False)
        if got.returncode:
            raise RecordingError(
                "no such revision with models", where=revision, got=got.stderr.strip()
            )
        shutil.unpack_archive(archive, scratch, filter="data")
        return keep(Path(scratch) / "encoders" / "data", out)


def _models_of(data: Path) -> list[KeptModel]:
    """The models in a folder of shipped models, by their digests."""
    capture = load_capture(data / CAPTURE)
    found = []
    for name in (*BUILTIN, POPULATION):
        own = name == POPULATION
        file = f"{name}.npz"
        digest = load_model(data / file, None if own else capture).digest
        found.append(KeptModel(digest, ENCODER, name, file, "" if own else CAPTURE))
    belief, names = load_belief(data / "belief.npz"), load_population_belief(data / "names.npz")
    found.append(KeptModel(belief.digest, HISTORY, HISTORY, "belief.npz"))
    found.append(KeptModel(names.digest, POPULATION, POPULATION, "names.npz"))
    return found


def _copied(data: Path, file: str, out: Path) -> str:
    """Copies a file under a name that has its digest; that name."""
    if not file:
        return ""
    content = (data / file).read_bytes()
    name = f"{Path(file).stem}-{sha256(content).hexdigest()[:16]}{Path(file).suffix}"
    (out / name).write_bytes(content)
    return name
