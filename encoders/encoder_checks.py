"""Checks, for the author of an encoder, that it obeys all rules for encoders.

    from encoders import check_encoder

    def test_our_encoder():
        check_encoder(KernelRidge)

A session does not make these checks. Training checks the stored arrays once, and a session checks
the predictions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from encoders.capture import Capture
from encoders.encoder import Encoder
from encoders.regression.encoder_registry import (
    ENCODER_PLUGINS,
    checked,
    find_encoder,
    origin_of,
    source_digest,
)
from encoders.regression.trained import TrainedModel, builtin_capture
from encoders.regression.training import check_repeatable, predicted, train_encoder
from models.errors import EncoderError

EVERY = 40
"""Step between the frames of the built-in capture from which the checks train. Every take is
covered, in a short time."""

_TRIED = 100
"""Number of frames whose poses are predicted."""


def check_encoder(encoder: type[Any] | str, capture: Capture | None = None) -> None:
    """Checks that an encoder obeys the rules for encoders; for its author, like Gymnasium's
    `check_env`.

    The encoder is trained twice, in the same way as for a session.

    Args:
        encoder: The class, or its name on the command line: `FILE.py:CLASS`.
        capture: Training data; None takes every fortieth frame of the built-in capture.

    Raises:
        EncoderError: The encoder breaks a rule; the error names the first broken rule. The class is
            not an encoder or cannot be found again; it cannot learn, predict or be stored; its
            poses have a wrong shape or are not finite; it changes its input; it learns differently
            from equal frames; or its predictions depend on earlier predictions.
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
    """Checks that predictions do not depend on earlier predictions.

    Raises:
        EncoderError: A prediction depends on earlier predictions, so a recording would not replay.
    """
    some = model.training_u[:_TRIED]
    before = predicted(encoder, some)
    predicted(encoder, model.training_u[-_TRIED:])
    if not np.array_equal(before, predicted(encoder, some)):
        raise EncoderError(
            "a prediction depends on earlier predictions",
            where=f"{name}.predict",
            expected="bit-identical poses for equal contact vectors, so that sessions replay",
        )
