"""The mean training pose as an encoder: the baseline for all other encoders."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.encoder import Encoder
from models.arithmetic.arrays import Array
from models.errors import EncoderError


class MeanEncoder(Encoder):
    """Predicts the mean training pose for any touches.

    Attributes:
        mean_: (n,) mean of the outputs.
    """

    mean_: Array

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        """Learns the mean of outputs (T, n)."""
        self.mean_ = np.asarray(Q, float).mean(axis=0)
        return self

    def predict(self, U: ArrayLike) -> Array:
        """The mean (T, n) for inputs (T, width), or (n,) for one input."""
        return np.broadcast_to(self.mean_, (*np.shape(U)[:-1], len(self.mean_))).copy()

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The mean pose."""
        return {"mean": self.mean_}

    def restore(self, arrays: Mapping[str, NDArray[Any]], U: Array, Q: Array) -> Self:
        """See `Encoder.restore`."""
        mean = arrays.get("mean")
        if mean is None or mean.shape != Q.shape[1:] or not np.isfinite(mean).all():
            raise EncoderError(
                "the stored mean pose does not fit the encoder", expected=f"{Q.shape[1:]}"
            )
        self.mean_ = mean
        return self
