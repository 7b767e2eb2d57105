"""Models that earlier releases shipped, kept for their recordings and found by digest.

A recording's header names its encoder and its labels with a digest each. When a model that ships is
trained anew, the one of a release goes to `data/kept`, where an index leads from digests to files.
Models are loaded from there as they were.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from models.errors import EncoderError

PREFIX = "kept:"
"""Begins the name of a kept encoder; its digest follows."""

INDEX = "index.json"

ENCODER, PCA_IK, HISTORY, POPULATION = "encoder", "pca-ik", "history", "population"
"""Kinds of kept models: an encoder from a file, inverse kinematics made from one, and the names of
the labels `history` and `population`."""

_REMEDY = "Install hand-sandbox again"


@dataclass(frozen=True)
class KeptModel:
    """A model of an earlier release.

    Attributes:
        digest: Digest of the model, as recordings name it.
        kind: `encoder`, `pca-ik`, `history` or `population`.
        name: Name that it had.
        file: Its file in the folder of kept models; empty for `pca-ik`.
        capture: File of the capture that it was trained on, where its own file has none.
        like: Digest of the encoder that `pca-ik` was made from.
    """

    digest: str
    kind: str
    name: str
    file: str = ""
    capture: str = ""
    like: str = ""


def kept_folder() -> Path:
    """Folder of kept models; it is absent while every released model still ships."""
    return Path(str(files("encoders"))) / "data" / "kept"


def kept_models() -> dict[str, KeptModel]:
    """All kept models by digest.

    Raises:
        EncoderError: The index is damaged.
    """
    path = kept_folder() / INDEX
    if not path.is_file():
        return {}
    try:
        known = json.loads(path.read_text(encoding="utf-8"))
        return {digest: KeptModel(digest, **values) for digest, values in known.items()}
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise EncoderError(
            "the index of kept models is damaged",
            where=str(path),
            got=str(error),
            remedy=_REMEDY,
        ) from None


def kept_model(digest: str, *kinds: str) -> KeptModel:
    """The kept model of a digest and one of these kinds.

    Raises:
        EncoderError: None is kept.
    """
    model = kept_models().get(digest)
    if model is None or model.kind not in kinds:
        raise EncoderError(
            "no such model is kept",
            where="recording",
            got=digest,
            expected=f"one that {kept_folder() / INDEX} lists",
            remedy="Use the version of the sandbox that the recording's header names",
        )
    return model


def checked(digest: str, model: KeptModel) -> None:
    """Refuses a kept model whose file has another digest than its index says.

    Raises:
        EncoderError: The digests differ.
    """
    if digest != model.digest:
        raise EncoderError(
            "a kept model is damaged, or this version computes its digest in another way",
            where=str(kept_folder() / (model.file or INDEX)),
            got=digest,
            expected=model.digest,
            remedy=_REMEDY,
        )
