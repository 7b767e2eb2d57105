"""Encoders as an earlier release shipped them, for its recordings."""

from __future__ import annotations

from functools import cache

from encoders.kept import ENCODER, PCA_IK, checked, kept_folder, kept_model
from encoders.regression.model_registry import pca_ik_like
from encoders.regression.trained import TrainedModel, builtin, load_model
from encoders.store import load_capture


@cache
def kept_encoder(digest: str) -> TrainedModel:
    """The model of a digest, as it was.

    Args:
        digest: Digest of the model.

    Raises:
        EncoderError: None is kept, or it is damaged.
    """
    kept = kept_model(digest, ENCODER, PCA_IK)
    if kept.kind == PCA_IK:
        shipped = builtin("quadratic")
        model = pca_ik_like(shipped if shipped.digest == kept.like else kept_encoder(kept.like))
    else:
        capture = load_capture(kept_folder() / kept.capture) if kept.capture else None
        model = load_model(kept_folder() / kept.file, capture)
    checked(model.digest, kept)
    return model
