"""Trained models by name, as `--encoder` takes them: built in, in a file, or trained when needed.

An external encoder is an untrained class. It is trained on the built-in capture, as the models in
`BUILTIN` were. If training takes long, the model is stored in the user's cache folder. Its file is
named by a digest of the encoder's source file, its configuration and the capture.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from hashlib import blake2b
from pathlib import Path
from tempfile import NamedTemporaryFile
from time import perf_counter
from typing import TYPE_CHECKING

from encoders.encoder import Encoder
from encoders.regression.encoder_registry import (
    ENCODER_PLUGINS,
    find_encoder,
    is_external,
    origin_of,
    source_digest,
)
from encoders.regression.trained import (
    BUILTIN,
    POPULATION,
    SCHEMA,
    TrainedModel,
    builtin,
    builtin_capture,
    load_model,
)
from models.errors import EncoderError, unknown_name

if TYPE_CHECKING:
    from encoders.regression.pca_ik import PcaIkEncoder

PCA_IK = "pca-ik"

MODELS = (*BUILTIN, POPULATION, PCA_IK)
"""Names of the models that are always available."""

DEFAULT_MODEL = POPULATION
"""Name of the model that is used if no model is named."""

LONG = 2.0
"""Training time (s) above which a trained model is stored in the cache folder."""


@dataclass(frozen=True)
class PcaIkModel(TrainedModel):
    """A model whose encoder is inverse kinematics.

    Attributes:
        like: Digest of the model to whose capture it was fitted.
    """

    encoder: PcaIkEncoder
    like: str = ""

    @cached_property
    def digest(self) -> str:
        """BLAKE2b over the options, the learned numbers and the digest of the other model,
        hexadecimal."""
        given = {k: v for k, v in self.encoder.configuration().items() if v is not None}
        learned = {
            "pad_height_": self.encoder.pad_height_,
            "tip_misfit_": self.encoder.tip_misfit_,
        }
        text = json.dumps([PCA_IK, given | learned, self.like], sort_keys=True)
        return blake2b(text.encode(), digest_size=16).hexdigest()


@cache
def pca_ik_model() -> TrainedModel:
    """The paper's PCA-IK with the paper's settings, fitted to the built-in capture."""
    return pca_ik_like(builtin("quadratic"))


def pca_ik_like(like: TrainedModel) -> TrainedModel:
    """The paper's PCA-IK with the paper's settings, fitted to another model's training data."""
    from encoders.regression.pca_ik import PcaIkEncoder

    return PcaIkModel(
        PCA_IK,
        PcaIkEncoder().fit(like.training_u, like.training_pose),
        like.residual_covariance,
        like.training_u,
        like.training_pose,
        {k: v for k, v in like.meta.items() if k not in ("degree", "ridge")},
        like=like.digest,
    )


def find_model(name: str, tell: Callable[[str], None]) -> TrainedModel:
    """Finds a model by name: a built-in model, a file, or an external encoder, which is trained.

    Args:
        name: One of `MODELS`, a file made by `sandbox train`, `FILE.py:CLASS`, `MODULE:CLASS`, or
            the name of an encoder that an installed package offers.
        tell: Called with a line of text before an encoder is trained, and afterwards.

    Raises:
        EncoderError: There is no such model, or it cannot be used.
    """
    if name in (*BUILTIN, POPULATION):
        return builtin(name)
    if name == PCA_IK:
        return pca_ik_model()
    if is_external(name):
        return _trained(find_encoder(name), tell)
    check_model_name(name)
    return load_model(Path(name))


def check_model_name(name: str) -> None:
    """Checks that `find_model` accepts a name, without loading or training a model.

    Raises:
        EncoderError: There is no such model, file or encoder.
    """
    if name not in MODELS and not is_external(name) and not Path(name).exists():
        raise unknown_name(
            "there is no such encoder",
            name,
            (*MODELS, *sorted(ENCODER_PLUGINS.offered())),
            where="--encoder",
            others="a file made by `sandbox train`, or FILE.py:CLASS",
            kind=EncoderError,
        )


def cache_folder() -> Path:
    """Folder for models that took long to train, at the usual place of the operating system.

    Raises:
        EncoderError: The folder is unknown, for example for a user without an account in a
            container.
    """
    windows = sys.platform == "win32"
    variable = "LOCALAPPDATA" if windows else "XDG_CACHE_HOME"
    inside = Path("AppData", "Local") if windows else Path(".cache")
    try:
        base = os.environ.get(variable) or Path.home() / inside
    except RuntimeError as error:
        raise EncoderError(
            "no home folder is known", got=str(error), remedy=f"Set HOME or {variable} to a folder"
        ) from None
    return Path(base) / "hand-sandbox" / "encoders"


@cache
def _trained(kind: type[Encoder], tell: Callable[[str], None]) -> TrainedModel:
    """The model of an external class, read from the cache or trained now."""
    kept = cache_folder() / f"{_key(kind)}.npz"
    if kept.exists():
        try:
            return load_model(kept, builtin_capture())
        except EncoderError as error:
            tell(f"a model in the cache folder cannot be used: {error}")
    from encoders.regression.training import train_encoder

    tell(f"training {kind.__qualname__} on the built-in capture of a simulated subject")
    began = perf_counter()
    model = train_encoder(builtin_capture(), kind.__qualname__, kind)
    took = perf_counter() - began
    tell(f"trained in {took:.1f} s" + (keep_model(model, kept) if took > LONG else ""))
    return model


def _key(kind: type[Encoder]) -> str:
    """Digest of all inputs of the training."""
    with ENCODER_PLUGINS.guarded(kind.__qualname__, "the encoder's `configuration` fails"):
        configuration = kind().configuration()
    parts = [
        SCHEMA,
        origin_of(kind),
        source_digest(kind),
        configuration,
        builtin("quadratic").digest,
    ]
    with ENCODER_PLUGINS.guarded(
        kind.__qualname__, "the encoder's configuration is not made of JSON values"
    ):
        text = json.dumps(parts, sort_keys=True)
    return blake2b(text.encode(), digest_size=16).hexdigest()


def keep_model(model: TrainedModel, path: Path) -> str:
    """Writes a model, without its training data, to the cache folder.

    An existing file is replaced only once the new file is complete.

    Args:
        model: The model.
        path: File in `cache_folder()`.

    Returns:
        End of a message: where the model is stored, or why it could not be written.
    """
    from encoders.regression.training import save_model

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=path.parent, suffix=".npz", delete=False) as file:
            scratch = Path(file.name)
        save_model(model, scratch, training=False)
        scratch.replace(path)
    except OSError as error:
        return f"; the model cannot be stored for the next time: {error}"
    return f"; stored in {path.parent}"
