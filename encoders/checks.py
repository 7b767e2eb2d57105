"""Checks an encoder for its author: everything that an encoder must keep to.

    from encoders import check_encoder

    def test_our_encoder():
        check_encoder(KernelRidge)

A session does not do this: training checks what it stores, once, and a session what it predicts.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from encoders.capture import Capture
from encoders.encoder import Encoder
from encoders.regression.registry import (
    ENCODER_PLUGINS,
    checked,
    find_encoder,
    origin_of,
    source_digest,
)
from encoders.regression.train import check_repeatable, predicted, train_encoder
from encoders.regression.trained import TrainedModel, builtin_capture
from models.errors import EncoderError

EVERY = 40
"""Frames of the built-in capture from one that is learned to the next: all takes, quickly."""

_TRIED = 100
"""Number of frames whose poses are predicted."""


def check_encoder(encoder: type[Any] | str, capture: Capture | None = None) -> None:
    """Checks that an encoder keeps to the rules for encoders; for its author, as Gymnasium's
    `check_env`.

    It is trained as a session trains it, twice.

    Args:
        encoder: The class, or how it is named on the command line: `FILE.py:CLASS`.
        capture: What it learns from; None is every fortieth frame of the built-in capture.

    Raises:
        EncoderError: The first rule that the encoder breaks: it is no encoder, cannot be found
            again, cannot learn, predict or be stored, predicts poses of another shape or that are
            not finite, changes its input, learns something else from the same frames, or predicts
            something else after other predictions.
    """
    if isinstance(encoder, str):
        kind = find_encoder(encoder)
    else:
        kind = checked(encoder, getattr(encoder, "__qualname__", repr(encoder)[:80]))
    name = kind.__qualname__
    origin_of(kind)
    source_digest(kind)
    frames = capture or builtin_capture().select(np.arange(0, len(builtin_capture()), EVERY))
    model = train_encoder(frames, name, kind)
    again = train_encoder(frames, name, kind)
    check_repeatable(model.encoder, again.encoder, model.training_u[:_TRIED])
    with ENCODER_PLUGINS.guarded(name, "the encoder cannot predict for contacts"):
        model.encoder.for_contacts().predict(model.training_u[:1])
    _check_history(model.encoder, model, name)


def _check_history(encoder: Encoder, model: TrainedModel, name: str) -> None:
    """Checks that predictions do not depend on those before them.

    Raises:
        EncoderError: They do, so that a recording would not replay.
    """
    some = model.training_u[:_TRIED]
    before = predicted(encoder, some)
    predicted(encoder, model.training_u[-_TRIED:])
    if not np.array_equal(before, predicted(encoder, some)):
        raise EncoderError(
            "a prediction depends on the ones before it",
            where=f"{name}.predict",
            expected="equal poses of equal contact vectors, to the bit: sessions replay",
        )
