"""PCA-IK in the place of an encoder, so that it can drive a session as the others do.

It learns nothing but components and neighbours, which takes a moment, so nothing is stored: the
model is made from the built-in capture when it is asked for. The fingertip correction needs to know
how an encoder errs; validating this one, block by block, takes minutes, and it errs where the
quadratic does (away from the fingertips), so the quadratic's covariance stands in for its own.
"""

from __future__ import annotations

import json
from functools import cache, cached_property
from hashlib import blake2b

from encoders.pca_ik import PcaIkEncoder
from encoders.trained import TrainedModel, builtin

NAME = "pca-ik"


class PcaIkModel(TrainedModel):
    """A model whose encoder is inverse kinematics."""

    @cached_property
    def digest(self) -> str:
        """BLAKE2b over what it was made from, hexadecimal."""
        options = {k: v for k, v in vars(self.encoder).items() if isinstance(v, int | float | str)}
        text = json.dumps([NAME, options, builtin("quadratic").digest], sort_keys=True)
        return blake2b(text.encode(), digest_size=16).hexdigest()


@cache
def pca_ik_model() -> TrainedModel:
    """The paper's PCA-IK with its own numbers, fitted to the built-in capture."""
    like = builtin("quadratic")
    encoder = PcaIkEncoder().fit(like.training_u, like.training_pose)
    return PcaIkModel(
        NAME,
        encoder,  # type: ignore[arg-type]  # all that a session asks of it is predict
        like.residual_covariance,
        like.training_u,
        like.training_pose,
        {k: v for k, v in like.meta.items() if k not in ("degree", "ridge")},
    )
