"""The contract of an encoder: relative poses from contact vectors, learned from examples.

Shapes and units, for T frames:

- `U` (T, 15), contact vectors: five (x, y) in inches relative to the leftmost contact, (-1, -1)
  where a finger is lifted, then five flags, 1 where a finger touches (`encoders.input_vector`).
- `Q` (T, 48), relative poses: position of the root in metres relative to the leftmost contact, then
  the root's rotation vector and those of 14 ball joints in radians (`models.pose`).

Built-in encoders are in `encoders.regression`. `encoders.regression.encoder_registry` lists them by
name. docs/write-an-encoder.md explains how to write another encoder.
"""

from __future__ import annotations

import json
from abc import abstractmethod
from collections.abc import Mapping
from hashlib import blake2b
from typing import Any, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import Array


class Predictor(Protocol):
    """Predicts poses; the only part of an encoder that labellers need."""

    def predict(self, U: ArrayLike, /) -> Array:
        """Relative poses (T, 48) of contact vectors (T, 15)."""


@runtime_checkable
class Encoder(Protocol):
    """A stateless estimator of relative poses; base class of custom encoders.

    `fit` and `predict` are required. All other methods have defaults: no options, nothing stored
    but the training frames, and no quicker form for contact vectors.

    The class must be callable without arguments. Equal frames must give equal encoders, and a
    prediction must not depend on earlier predictions, since sessions replay to the bit.
    """

    @abstractmethod
    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        """Learns from contact vectors U (T, 15) and relative poses Q (T, 48); returns itself."""

    @abstractmethod
    def predict(self, U: ArrayLike) -> Array:
        """Relative poses (T, 48) of contact vectors (T, 15), or (48,) of one contact vector (15,).

        A session predicts one pose per touch frame, which should take less than a millisecond.
        """

    def configuration(self) -> dict[str, Any]:
        """Arguments of the constructor, as JSON values, that create an equal encoder.

        The default is for encoders without options.
        """
        return {}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Learned arrays by name, in the precision in which they are stored.

        The default stores nothing; `restore` then fits the encoder again to the training frames.
        """
        return {}

    def restore(self, arrays: Mapping[str, NDArray[Any]], U: Array, Q: Array) -> Self:
        """Takes over the learned arrays of an encoder with equal options; returns itself.

        Args:
            arrays: Result of `arrays`.
            U: (T, 15) training frames in single precision; a model's file contains them.
            Q: (T, 48) their relative poses, also in single precision.

        Raises:
            EncoderError: The arrays do not fit an encoder with these options.
        """
        return self.fit(U, Q)

    def for_contacts(self) -> Predictor:
        """The fastest predictor for contact vectors. The default is the encoder itself."""
        return self

    def digest(self) -> str:
        """BLAKE2b over configuration and learned arrays, hexadecimal."""
        hash_ = blake2b(digest_size=16)
        hash_.update(json.dumps(self.configuration(), sort_keys=True).encode())
        for name, array in sorted(self.arrays().items()):
            hash_.update(f"{name} {array.dtype.str} {array.shape}".encode())
            hash_.update(np.ascontiguousarray(array).tobytes())
        return hash_.hexdigest()
