"""Labels by assignment of contacts to expected finger positions: the classical baseline.

Five expected positions, the mean layout of a hand with all fingers down, are aligned with the
contacts, and contacts are assigned to them with the least sum of squared distances (Kuhn 1955, the
Hungarian method). Assignment and alignment alternate until they converge (iterated closest points,
Besl and McKay 1992), from several starts. This labeller uses one mean layout, where the other
labellers use many, and no history.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from encoders.labels.labelling import INDEX, Labelling, arranged
from encoders.regression.trained import TrainedModel
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

Layout = NDArray[np.complex128]

_STARTS = np.deg2rad(np.arange(-90.0, 91.0, 30.0))
"""rad, starting rotations: about the range that a forearm allows on a table, and close enough
together that the alternation finds the best rotation between them."""

_TURN_SPREAD = np.deg2rad(45.0)
"""rad, assumed standard deviation of the hand's rotation. Two or three contacts fit several fingers
under some rotation; smaller rotations are more likely."""

_PLACE_SPREAD = 0.6
"""inches, assumed standard deviation of a fingertip about its aligned position."""

_ROUNDS = 10
"""Maximum number of rounds of assignment and alignment; three or four are usual."""

_BARRED = 1e6
"""Cost of an assignment that a fixed label excludes; above any sum of squared distances on a
tablet."""


class AssignmentLabels:
    """Labels contacts by their assignment to five expected positions.

    The reported probability is always 1. A single contact fits every position and is labelled as
    the index finger.

    Args:
        model: Model whose training frames with five touches give the expected positions.

    Attributes:
        places: (5,) complex, expected positions x + i y of the fingers relative to their middle,
            inches.

    Raises:
        EncoderError: No training frame has five touches.
    """

    remembers = False

    def __init__(self, model: TrainedModel) -> None:
        U = np.asarray(model.training_u, float)
        whole = U[U[:, 2 * len(FINGERS) :].all(axis=1), : 2 * len(FINGERS)]
        if not len(whole):
            raise EncoderError(
                "expected finger positions cannot be learned",
                got="no training frame with five touches",
                expected="at least one",
            )
        self.places = _mean_layout(whole[:, 0::2] + 1j * whole[:, 1::2])

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        """See `encoders.labels.labelling.Labeller.assign`."""
        ids, xy = arranged(contacts, fixed)
        if len(ids) == 1:
            return Labelling({ids[0]: fixed.get(ids[0], INDEX)}, 1.0)
        z = (xy[:, 0] + 1j * xy[:, 1]) / METRES_PER_INCH
        z = z - z.mean()
        barred = np.zeros((len(ids), len(FINGERS)))
        for row, contact in enumerate(ids):
            if contact in fixed:
                barred[row] = _BARRED
                barred[row, fixed[contact]] = 0.0
        # The contacts' middle starts over each expected position in turn: with few contacts the
        # right one is unknown.
        options = [
            self._settled(z, barred, turn, middle) for turn in _STARTS for middle in self.places
        ]
        _, labels = min(options, key=lambda pair: pair[0])
        return Labelling(dict(zip(ids, labels, strict=True)), 1.0)

    def reset(self) -> None:
        """Does nothing: this labeller has no history."""

    def restart(self) -> None:
        """Does nothing, likewise."""

    def _settled(
        self, z: Layout, barred: Array, turn: float, middle: complex
    ) -> tuple[float, list[int]]:
        """Cost and labels after assignment and alignment have converged."""
        previous: list[int] = []
        for _ in range(_ROUNDS):
            laid = (self.places - middle) * np.exp(1j * turn)
            cost = np.abs(z[:, None] - laid[None]) ** 2 + barred
            labels = linear_sum_assignment(cost)[1].tolist()
            if labels == previous:
                break
            previous = labels
            chosen = self.places[labels]
            middle = chosen.mean()
            overlap = np.vdot(chosen - middle, z)
            # The best rotation, shrunk towards 0 where few or close contacts leave it uncertain.
            firm = abs(overlap) / _PLACE_SPREAD**2
            turn = float(np.angle(overlap) * firm / (firm + 1.0 / _TURN_SPREAD**2))
        laid = (self.places[previous] - middle) * np.exp(1j * turn)
        misfit = float(np.sum(np.abs(z - laid) ** 2)) / _PLACE_SPREAD**2
        return misfit + (turn / _TURN_SPREAD) ** 2, previous


def _mean_layout(layouts: Layout) -> Layout:
    """Mean layout (5,) of layouts (T, 5), each rotated onto it; its rotation is the mean of
    theirs."""
    layouts = layouts - layouts.mean(axis=1, keepdims=True)
    mean: Layout = layouts.mean(axis=0)
    for _ in range(5):
        overlap = layouts.conj() @ mean
        mean = (layouts * (overlap / np.abs(overlap))[:, None]).mean(axis=0)
    turns = layouts @ mean.conj()
    upright: Layout = mean * np.exp(1j * np.angle(turns.sum()))
    return upright
