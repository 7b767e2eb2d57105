"""Contract of labellers, enumeration of labellings, and the paper's labelling rule.

k contacts can be labelled in P(5, k) = 5! / (5 - k)! ways: 5, 20, 60, 120, 120 for 1 to 5 contacts.
A labeller chooses one of them. `PaperLabels` does it as section 2 of Chung, Kim, Han and Pollard
(2015) says: reconstruct the hand for every labelling, and take the one whose reconstruction lies
closest to some pose of the training data.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import permutations
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from encoders.input_vector import CONTACT_VECTOR_SIZE, LIFTED, leftmost
from encoders.labels.nearest_neighbour import NearestNeighbour
from encoders.regression.trained import TrainedModel
from models.arithmetic.arrays import Array
from models.arithmetic.products import matrix_product
from models.errors import EncoderError
from models.frames import FINGERS
from models.pose import JOINTS
from models.surface import METRES_PER_INCH

Labels = NDArray[np.int64]

INDEX = 1
"""The index finger's label."""

METRICS = ("joints", "pose", "mahalanobis", "touches")
"""Metrics of `PaperLabels` for the distance between a reconstruction and a training frame."""

_FLAG_SCALE = 20.0
"""inches, weight of a contact flag in the metric `touches`: more than the length of a hand, so that
layouts of the same fingers are always closer than layouts of other fingers."""


@dataclass(frozen=True)
class Labelling:
    """The fingers of all contacts.

    Attributes:
        labels: Finger (thumb 0 .. little 4) by contact id; no finger occurs twice. Read-only, as
            labellers may return the same object again.
        probability: Probability of all labels together, 0 to 1.
        chances: Function that returns the probabilities (5,) of the fingers by contact id; None if
            only that of all labels together is known.
    """

    labels: Mapping[int, int]
    probability: float
    chances: Callable[[], Mapping[int, Array]] | None = field(
        default=None, compare=False, repr=False
    )

    def chance(self, contact: int) -> float:
        """Probability of the label of one contact, 0 to 1, whatever the labels of the others."""
        if self.chances is None:
            return self.probability
        return float(self._known_chances[contact][self.labels[contact]])

    @cached_property
    def _known_chances(self) -> Mapping[int, Array]:
        return {} if self.chances is None else self.chances()


class Labeller(Protocol):
    """Contract of labellers; called whenever the set of contacts has changed.

    Attributes:
        remembers: True for a labeller with history, which may be called at every frame.
    """

    @property
    def remembers(self) -> bool: ...

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        """Labels all contacts.

        Args:
            contacts: Position (x, y) m on the surface, x right and y down, by id; 1 to 5 contacts.
            fixed: Labels that must be kept (by id), those of a hand that is down. The other
                contacts get the remaining fingers.

        Raises:
            EncoderError: Contacts or fixed labels do not follow this description.
        """

    def reset(self) -> None:
        """Forgets all contacts, as when the hand has left the surface."""

    def restart(self) -> None:
        """Forgets everything since the beginning of a trial."""


@cache
def hypotheses(count: int) -> Labels:
    """All labellings (P, count) of `count` contacts, in lexicographic order; read-only.

    Raises:
        EncoderError: The count is not one of 1 to 5.
    """
    if count not in range(1, len(FINGERS) + 1):
        raise EncoderError(
            "a hand does not have so many fingers", got=count, expected="1 to 5 contacts"
        )
    table = np.array(list(permutations(range(len(FINGERS)), count)), np.int64)
    table.flags.writeable = False
    return table


def true_row(fingers: NDArray[np.intp]) -> int:
    """Row of `hypotheses(k)` in which the contacts have these fingers (k,)."""
    return int(np.flatnonzero((hypotheses(len(fingers)) == fingers).all(axis=1))[0])


def arranged(
    contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
) -> tuple[tuple[int, ...], Array]:
    """Ids and positions (k, 2) of contacts in an order that depends on their positions alone.

    The order is from left to right, so that results depend neither on the order in which a device
    lists contacts nor on its ids.

    Raises:
        EncoderError: Contacts or fixed labels are not as `Labeller.assign` expects them.
    """
    if not 1 <= len(contacts) <= len(FINGERS):
        raise EncoderError(
            "cannot label so many contacts", got=len(contacts), expected="1 to 5 contacts"
        )
    ids = tuple(sorted(contacts, key=lambda i: (*contacts[i], i)))
    xy = np.array([contacts[i] for i in ids], float)
    if xy.shape != (len(ids), 2) or not np.isfinite(xy).all():
        raise EncoderError(
            "contacts must have finite places", got=xy.tolist(), expected="(x, y) in metres"
        )
    strangers = [i for i in fixed if i not in contacts]
    given = list(fixed.values())
    if strangers or len(set(given)) < len(given) or not set(given) <= set(range(len(FINGERS))):
        raise EncoderError(
            "fixed labels do not fit the contacts",
            got=dict(fixed),
            expected=f"different fingers 0 to 4 for ids among {sorted(contacts)}",
        )
    return ids, xy


def allowed(ids: tuple[int, ...], fixed: Mapping[int, int]) -> NDArray[np.bool_]:
    """Booleans (P,): the labellings of the contacts, in their order, that keep the fixed labels."""
    table = hypotheses(len(ids))
    keeps = np.ones(len(table), bool)
    for place, contact in enumerate(ids):
        if contact in fixed:
            keeps &= table[:, place] == fixed[contact]
    return keeps


def labelled_contact_vectors(xy: Array, labels: Labels) -> Array:
    """Contact vectors (P, 15) of the same contacts under many labellings.

    Args:
        xy: (k, 2) m on the surface.
        labels: (P, k) finger of every contact in every labelling.
    """
    relative = (xy - xy[leftmost(xy)]) / METRES_PER_INCH
    U = np.full((len(labels), CONTACT_VECTOR_SIZE), LIFTED)
    U[:, 2 * len(FINGERS) :] = 0.0
    rows = np.arange(len(labels))[:, None]
    U[rows, 2 * labels] = relative[:, 0]
    U[rows, 2 * labels + 1] = relative[:, 1]
    U[rows, 2 * len(FINGERS) + labels] = 1.0
    return U


class PaperLabels:
    """The paper's rule: the labelling whose reconstruction has the closest training pose.

    The search is exact and without history. The reported probability is always 1. The paper has no
    rule for a single contact, which has no layout and does not occur in its data. Here it is
    labelled as the index finger.

    Args:
        model: Trained encoder and its training frames.
        metric: Distance between poses; the paper does not say which. `joints`: Euclidean over the
            42 ball joint components in degrees. `pose`: all 48, centimetres and degrees.
            `mahalanobis`: all 48, by the covariance of the training poses. `touches`: not poses,
            but contact vectors in inches, compared with training frames of the same fingers; the
            paper's rule for inverse kinematics (its section 3).

    Raises:
        EncoderError: The metric is unknown.
    """

    remembers = False

    def __init__(self, model: TrainedModel, metric: str = "joints") -> None:
        if metric not in METRICS:
            raise EncoderError("no such metric", got=metric, expected=", ".join(METRICS))
        self.metric = metric
        self._poses = model.encoder.for_contacts()
        if metric == "touches":
            self._map = np.diag(np.repeat([1.0, _FLAG_SCALE], [2 * len(FINGERS), len(FINGERS)]))
            frames = np.asarray(model.training_u, float)
        else:
            frames = np.asarray(model.training_pose, float)
            self._map = _pose_map(metric, frames)
        self._search = NearestNeighbour(matrix_product(frames, self._map))

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        """See `Labeller.assign`."""
        ids, xy = arranged(contacts, fixed)
        if len(ids) == 1:
            return Labelling({ids[0]: fixed.get(ids[0], INDEX)}, 1.0)
        labels = hypotheses(len(ids))
        if fixed:
            labels = labels[allowed(ids, fixed)]
        chosen = labels[self._closest(xy, labels)]
        return Labelling(dict(zip(ids, chosen.tolist(), strict=True)), 1.0)

    def reset(self) -> None:
        """Does nothing: the rule has no history."""

    def restart(self) -> None:
        """Does nothing, likewise."""

    def _closest(self, xy: Array, labels: Labels) -> int:
        U = labelled_contact_vectors(xy, labels)
        guesses = U if self.metric == "touches" else self._poses.predict(U)
        return self._search.closest(matrix_product(guesses, self._map)).query


def _pose_map(metric: str, frames: Array) -> Array:
    """Matrix (48, d) that turns a metric of poses into the Euclidean distance."""
    width = frames.shape[1]
    if metric == "mahalanobis":
        covariance = np.cov(frames, rowvar=False)
        # A tiny share of the mean variance limits the weight of components that never vary.
        covariance[np.diag_indices(width)] += 1e-9 * np.trace(covariance) / width
        lower: Array = np.linalg.cholesky(
            np.linalg.inv(covariance)
        )  # any order: an option of evaluations
        return lower
    scale = np.full(width, np.rad2deg(1.0))
    scale[:3] = 100.0
    identity = np.diag(scale)
    return identity[:, JOINTS] if metric == "joints" else identity
