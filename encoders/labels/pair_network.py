"""Evidence of a single frame: a small network that scores the labels of pairs of contacts.

    context = mean over contacts i of  g(contact i)
    s_ij    = f(context, contact i, contact j, features of the pair)        (5, 5) scores
    score of a labelling = sum over ordered pairs i, j of s_ij[label i, label j]

g and f are perceptrons with rectifiers. The probabilities of the labellings are the softmax of
their scores, over all labellings (at most 120). The answer does not depend on the order of the
contacts, and the weights are the same for all numbers of contacts.
`python -m training names` in a checkout trains the network.

`NetworkEvidence` calibrates the network's probabilities, and multiplies them by prior odds of the
usual finger sets.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from math import log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.labels.labelling import finger_sets, hypotheses, normalised, set_of_labelling
from models.arithmetic import Array, matrix_product, vector_matrix
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

CONTACT_FEATURES, PAIR_FEATURES = 6, 6
"""Number of features of a contact, and of a pair in addition to those of its two contacts."""

LEAST_SPREAD = 0.05
"""Least spread and distance (inches) of contacts as divisors in features."""

SHAPES: dict[str, tuple[int | str, int | str]] = {
    "g1": (CONTACT_FEATURES, "g"),
    "g2": ("g", "context"),
    "f_context": ("context", "f"),
    "f_first": (CONTACT_FEATURES, "f"),
    "f_second": (CONTACT_FEATURES, "f"),
    "f_between": (PAIR_FEATURES, "f"),
    "f2": ("f", "h"),
    "f3": ("h", len(FINGERS) ** 2),
}
"""Rows and columns of the weight matrices; a name stands for a size that the file decides."""

BIASES = {"g1": "g1_bias", "g2": "g2_bias", "f_context": "f1_bias", "f2": "f2_bias"}
"""Name of a layer's weights -> name of its bias. The scores have no bias, because it would be the
same for all labellings."""


@cache
def ordered_pairs(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of the first and second contact of all count (count - 1) ordered pairs."""
    pairs = [(i, j) for i in range(count) for j in range(count) if i != j]
    first, second = np.array(pairs, np.intp).T
    return first, second


@cache
def score_places(count: int) -> NDArray[np.intp]:
    """Indices (P, pairs), in the raveled scores (pairs, 25), of the scores that are added for each
    labelling."""
    first, second = ordered_pairs(count)
    labels = hypotheses(count)
    number = len(FINGERS)
    pair = np.arange(len(first)) * number**2
    return pair + labels[:, first] * number + labels[:, second]


def contact_features(xy: Array) -> tuple[Array, Array]:
    """Features of contacts.

    Args:
        xy: (..., k, 2) m on the surface.

    Returns:
        Features (..., k, 6), and places (..., k, 2), inches relative to the contacts' middle.
    """
    k = xy.shape[-2]
    inches = xy / METRES_PER_INCH
    middle = inches[..., :1, :]
    for i in range(1, k):
        middle = middle + inches[..., i : i + 1, :]
    places = inches - middle / k
    squares = places * places
    total = squares[..., 0] + squares[..., 1]
    spread = total[..., :1]
    for i in range(1, k):
        spread = spread + total[..., i : i + 1]
    spread = np.maximum(np.sqrt(spread / k), LEAST_SPREAD)[..., None]
    features = np.empty((*xy.shape[:-1], CONTACT_FEATURES))
    features[..., :2] = places
    features[..., 2:4] = places / spread
    features[..., 4:5] = spread
    features[..., 5] = k - 3.5
    return features, places


def pair_features(places: Array) -> Array:
    """Features (..., pairs, 6) of all ordered pairs of contacts at places (..., k, 2), inches."""
    first, second = ordered_pairs(places.shape[-2])
    between = places[..., second, :] - places[..., first, :]
    squares = between * between
    apart = np.maximum(np.sqrt(squares[..., 0] + squares[..., 1]), LEAST_SPREAD)[..., None]
    features = np.empty((*between.shape[:-1], PAIR_FEATURES))
    features[..., :2] = between
    features[..., 2:4] = between / apart
    features[..., 4:5] = apart
    features[..., 5:6] = 1.0 / (0.5 + apart)
    return features


class PairNetwork:
    """The network with its weights. It adds in fixed order, so that all machines give equal bits.

    Args:
        weights: Matrices of `SHAPES` and their biases, by name.

    Raises:
        EncoderError: A weight is missing, of the wrong shape or not finite.
    """

    def __init__(self, weights: Mapping[str, NDArray[Any]]) -> None:
        _check_weights(weights)
        self.weights = {k: np.ascontiguousarray(v, np.float64) for k, v in weights.items()}

    def scores(self, xy: Array) -> Array:
        """Scores (P,) of the labellings of `hypotheses(k)`, for contacts (k, 2) in m, k >= 2."""
        w = self.weights
        features, places = contact_features(xy)
        first, second = ordered_pairs(len(xy))
        hidden = _rectified(matrix_product(features, w["g1"]) + w["g1_bias"])
        parts = _rectified(matrix_product(hidden, w["g2"]) + w["g2_bias"])
        context = parts[0]
        for part in parts[1:]:
            context = context + part
        common = vector_matrix(context / len(xy), w["f_context"]) + w["f1_bias"]
        inputs = matrix_product(features, w["f_first"])[first]
        inputs += matrix_product(features, w["f_second"])[second]
        inputs += matrix_product(pair_features(places), w["f_between"])
        inputs += common
        hidden = _rectified(matrix_product(_rectified(inputs), w["f2"]) + w["f2_bias"])
        table = matrix_product(hidden, w["f3"]).ravel()
        chosen = table[score_places(len(xy))]
        total = chosen[:, 0]
        for pair in range(1, chosen.shape[1]):
            total = total + chosen[:, pair]
        return total


def _rectified(x: Array) -> Array:
    return np.maximum(x, 0.0, out=x)


def _check_weights(weights: Mapping[str, NDArray[Any]]) -> None:
    """Checks names, shapes and values of a network's weights.

    Raises:
        EncoderError: A weight is missing, of the wrong shape or not finite.
    """
    sizes: dict[str, int] = {}
    for name, shape in SHAPES.items():
        wanted: list[tuple[str, tuple[int | str, ...]]] = [(name, shape)]
        if name in BIASES:
            wanted.append((BIASES[name], shape[1:]))
        for key, expected in wanted:
            value = weights.get(key)
            if value is None or value.ndim != len(expected) or not np.isfinite(value).all():
                raise EncoderError(
                    "a weight of the network is missing or damaged",
                    where=key,
                    got=None if value is None else value.shape,
                    expected=f"{len(expected)} axes of finite numbers",
                )
            for size, axis in zip(value.shape, expected, strict=True):
                if size != (sizes.setdefault(axis, size) if isinstance(axis, str) else axis):
                    raise EncoderError(
                        "the weights of the network do not fit each other",
                        where=key,
                        got=value.shape,
                        expected=str(tuple(sizes.get(str(a), a) for a in expected)),
                    )


LONE_FINGER = (0.15, 0.40, 0.25, 0.10, 0.10)
"""Probability of each finger for a single contact. Assumed, since captures have no single contacts:
people point with the index finger or the middle finger."""

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
others, 2016), and slide neighbouring fingers together. The values are assumed, not fitted;
`benchmarks.pinches` shows their effect."""

FRESH = 0.12
"""Root mean square change (inches) of a layout at which its evidence counts as about 40 % new."""


def set_prior(usual: Mapping[tuple[int, ...], float] = USUAL_SETS) -> dict[int, Array]:
    """Prior log probabilities (P,) of the labellings, by number of contacts."""
    prior = {1: np.array([log(p) for p in LONE_FINGER])}
    for count in range(2, len(FINGERS) + 1):
        weights = np.array([log(usual.get(finger_set, 1.0)) for finger_set in finger_sets(count)])
        prior[count] = normalised(weights[set_of_labelling(count)])
    return prior


class NetworkEvidence:
    """Probabilities of labellings: the network's calibrated probabilities times prior odds of the
    finger sets.

    Args:
        network: Network that was trained on equally frequent finger sets.
        sharpness: Number of contacts, 2 to 5 -> factor on the network's log probabilities, which
            calibrates them for people on whom it was not trained.
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
