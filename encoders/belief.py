"""Labels with history: a belief over the labellings of the contacts that are down.

A single look at two or three touches often fits several labellings. But fingers come and go one or
two at a time, and what was learned while four were down still holds when two of them have left. So
a probability is kept for every labelling of the living contacts.

- The same contacts later: the belief stays, as frames of one grasp say the same over and over.
- Contacts leave: the belief is summed over their labels.
- Contacts come: the labels of the old ones are believed as before, and the new ones are judged
  given those, by p(all | layout) / p(old | layout). Where the old ones have moved since they were
  last looked at, they are judged again.

Early mistakes are thus kept as doubts, not as decisions, and a third finger can still undo them.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.label_evidence import normalised
from encoders.labelling import Labelling, allowed, arranged, hypotheses
from encoders.trained_belief import TrainedBelief, load_belief
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

Array = NDArray[np.float64]

_LEAST = 1e-12
"""Probability below which no labelling falls, so that no mistake is ever final."""


@cache
def _rows(count: int, places: tuple[int, ...]) -> NDArray[np.intp]:
    """(P,) for labellings of `count` contacts: the row in `hypotheses(len(places))` that gives the
    contacts at these places the same labels."""
    weights = len(FINGERS) ** np.arange(len(places))
    row_of = np.full(int(weights[-1]) * len(FINGERS), -1, np.intp)
    row_of[hypotheses(len(places)) @ weights] = np.arange(len(hypotheses(len(places))))
    return row_of[hypotheses(count)[:, list(places)] @ weights]


class BeliefLabels:
    """Labels contacts by a belief that is carried from one set of contacts to the next.

    Args:
        trained: What it has learned; may be shared, the belief itself is this object's own.
    """

    def __init__(self, trained: TrainedBelief) -> None:
        self.trained = trained
        self.evidence = trained.evidence
        self.reset()

    @classmethod
    def train(cls, capture: Capture) -> BeliefLabels:
        """A belief trained on a capture; see `encoders.belief_training.train_belief`."""
        from encoders.belief_training import train_belief

        return cls(train_belief(capture)[0])

    def reset(self) -> None:
        """Forgets all contacts."""
        self._ids: tuple[int, ...] = ()
        self._belief: Array = np.zeros(1)
        self._seen: dict[int, Array] = {}

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        """See `Labeller.assign`.

        Fixed labels narrow down the answer, not the belief: what the touches say is remembered
        even where it may not be followed at the moment. The probability is the belief's own.
        """
        ids, xy = arranged(contacts, fixed)
        self._belief = self._updated(ids, xy)
        self._ids = ids
        candidates = self._belief
        if fixed:
            candidates = np.where(allowed(ids, fixed), self._belief, -np.inf)
        best = int(np.argmax(candidates))
        labels = hypotheses(len(ids))[best].tolist()
        return Labelling(dict(zip(ids, labels, strict=True)), float(np.exp(self._belief[best])))

    def marginals(self) -> dict[int, Array]:
        """Contact id -> (5,) probability of each finger, after the last `assign`."""
        probability = np.exp(self._belief)
        labels = hypotheses(len(self._ids)) if self._ids else np.empty((0, 0), np.int64)
        return {
            contact: np.bincount(labels[:, place], probability, len(FINGERS)).astype(float)
            for place, contact in enumerate(self._ids)
        }

    def log_probability(self, labels: Mapping[int, int]) -> float:
        """Log probability of labels for all contacts of the last `assign`.

        Raises:
            EncoderError: The ids are not those of the last `assign`, or a finger occurs twice.
        """
        if set(labels) != set(self._ids) or not self._ids:
            raise EncoderError(
                "the belief is about other contacts", got=sorted(labels), expected=str(self._ids)
            )
        rows = np.flatnonzero(allowed(self._ids, labels))
        if not len(rows):
            raise EncoderError(
                "no labelling has these labels", got=dict(labels), expected="different fingers"
            )
        return float(self._belief[rows[0]])

    def _updated(self, ids: tuple[int, ...], xy: Array) -> Array:
        kept = [place for place, contact in enumerate(ids) if contact in self._ids]
        before = self._summed(tuple(ids[place] for place in kept)) if kept else None
        if before is not None and len(kept) == len(ids):
            return before
        look = self.evidence.log_posterior(xy)
        if before is not None:
            again = self._freshness([ids[place] for place in kept], xy[kept])
            carried = before - (1.0 - again) * self.evidence.log_posterior(xy[kept])
            look = look + carried[_rows(len(ids), tuple(kept))]
        self._seen = dict(zip(ids, xy, strict=True))
        return _bounded(look)

    def _freshness(self, ids: list[int], xy: Array) -> float:
        """Share with which a look at contacts counts that were looked at before.

        What has hardly moved says nothing new: fingers that land shortly one after the other must
        not make the first ones count twice.
        """
        moved = xy - np.array([self._seen[i] for i in ids])
        moved = (moved - moved.mean(axis=0)) / METRES_PER_INCH
        squared = float(np.mean(np.sum(moved**2, axis=1))) / self.evidence.shape.width**2
        return self.trained.eta * -float(np.expm1(-0.5 * squared))

    def _summed(self, ids: tuple[int, ...]) -> Array:
        """The belief about some of the known contacts, summed over the labels of the others."""
        if ids == self._ids:
            return self._belief
        rows = _rows(len(self._ids), tuple(self._ids.index(i) for i in ids))
        summed = np.bincount(rows, np.exp(self._belief), len(hypotheses(len(ids))))
        return _bounded(np.log(np.maximum(summed, _LEAST)))


def _bounded(log_weights: Array) -> Array:
    """Log probabilities of which none is below the least."""
    return normalised(np.maximum(normalised(log_weights), np.log(_LEAST)))


@cache
def _builtin() -> TrainedBelief:
    return load_belief(Path(str(files("encoders") / "data" / "belief.npz")))


def builtin_belief() -> BeliefLabels:
    """The belief trained on the built-in capture, with no contact yet.

    `python -m encoders.belief_training` makes it anew.
    """
    return BeliefLabels(_builtin())
