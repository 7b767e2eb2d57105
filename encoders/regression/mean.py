"""The mean training pose as an encoder: the baseline for all other encoders."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from encoders.encoder import Encoder
from models.arithmetic.arrays import Array


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
