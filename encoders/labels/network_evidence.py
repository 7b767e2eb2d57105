"""Evidence of a single frame by the network that was trained on a population."""

from __future__ import annotations

from collections.abc import Mapping
from math import log

import numpy as np

from encoders.labels.label_sums import normalised
from encoders.labels.layout_density import finger_sets, set_of_labelling
from encoders.labels.pair_network import PairNetwork
from models.arithmetic.arrays import Array
from models.frames import FINGERS

LONE_FINGER = (0.15, 0.40, 0.25, 0.10, 0.10)
"""Probability that a single contact is this finger. Assumed: captures have no single contacts.
People point with the index finger, or with the middle one."""

USUAL_SETS: Mapping[tuple[int, ...], float] = {
    (0, 1): 8.0,
    (0, 2): 2.5,
    (1, 2): 5.0,
    (2, 3): 3.0,
    (0, 1, 2): 5.0,
    (1, 2, 3): 3.5,
    (0, 1, 2, 3): 1.5,
}
"""Prior odds of finger sets relative to any other set of as many fingers. People pinch with thumb
and index finger, then add fingers in their order (the precision grasps in the taxonomy of Feix and
others, 2016), and slide neighbouring fingers together. Assumed, with `benchmarks.pinches` in
view."""

FRESH = 0.12
"""inches, root mean square change of a layout that makes most of it new evidence."""


def set_prior(usual: Mapping[tuple[int, ...], float] = USUAL_SETS) -> dict[int, Array]:
    """Log probabilities (P,) of the labellings before anything is seen, by number of contacts."""
    prior = {1: np.array([log(p) for p in LONE_FINGER])}
    for count in range(2, len(FINGERS) + 1):
        weights = np.array([log(usual.get(fingers, 1.0)) for fingers in finger_sets(count)])
        prior[count] = normalised(weights[set_of_labelling(count)])
    return prior


class NetworkEvidence:
    """Probabilities of labellings: the network's, calibrated, times the usual sets of fingers.

    Args:
        network: Trained on finger sets that are equally frequent.
        sharpness: Factor on the network's log probabilities by number of contacts, 2 to 5, which
            makes them true for people it was not trained on.
        usual: Prior odds of finger sets.
    """

    def __init__(
        self,
        network: PairNetwork,
        sharpness: Mapping[int, float],
        usual: Mapping[tuple[int, ...], float] = USUAL_SETS,
    ) -> None:
        self.network, self.sharpness, self.usual = network, dict(sharpness), dict(usual)
        self._prior = set_prior(usual)

    def log_posterior(self, xy: Array) -> Array:
        """Log probabilities (P,) of the labellings of `hypotheses(k)` given contacts (k, 2) in
        m."""
        count = len(xy)
        if count == 1:
            return self._prior[1]
        scores = self.network.scores(xy)
        return normalised(self.sharpness[count] * scores + self._prior[count])
