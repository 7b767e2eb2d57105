"""What one look at the touches says about their labels, before any history."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.layout_density import LayoutDensity
from models.errors import EncoderError

Array = NDArray[np.float64]

LONE_FINGER = (0.15, 0.40, 0.25, 0.10, 0.10)
"""Probability that a lone contact is this finger. An assumption, not learned: a lone touch has no
layout and captures hold none. People point with the index finger, or with the middle one."""


class LabelEvidence:
    """Probabilities of the labellings of contacts at one moment.

    Args:
        density: Of touch layouts.
        trust: Share with which the logarithm of the density counts. A kernel density takes frames
            for independent and is too sure of itself; validation finds how much.

    Raises:
        EncoderError: The trust is not positive.
    """

    def __init__(self, density: LayoutDensity, trust: float) -> None:
        if not 0.0 < trust <= 10.0:
            raise EncoderError("trust is out of range", got=trust, expected="above 0, at most 10")
        self.density, self.trust = density, trust

    def log_posterior(self, xy: Array) -> Array:
        """(P,) log probability of every labelling of `hypotheses(k)` given contacts (k, 2) in m."""
        if len(xy) == 1:
            return np.log(LONE_FINGER)
        return normalised(self.trust * self.density.log_density(xy))


def normalised(log_weights: Array) -> Array:
    """Logarithms of probabilities that sum to 1, from logarithms of weights (P,)."""
    shifted = log_weights - log_weights.max()
    result: Array = shifted - np.log(np.exp(shifted).sum())
    return result
