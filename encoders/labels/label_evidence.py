"""What one look at the touches says about their labels, before any history."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from encoders.labels.finger_order import ORDERED_COUNTS, in_order
from encoders.labels.layout_density import (
    KernelShape,
    LayoutDensity,
    Layouts,
    finger_sets,
    set_of_labelling,
)
from models.errors import EncoderError
from models.frames import FINGERS

Array = NDArray[np.float64]

LONE_FINGER = (0.15, 0.40, 0.25, 0.10, 0.10)
"""Probability that a lone contact is this finger. An assumption, not learned: captures hold no lone
contacts. People point with the index finger, or with the middle one."""

THUMB_AND_NEXT = 1.3
"""How much likelier than any other set of as many fingers the thumb with the fingers next to it is
in what was captured. An assumption, not learned: a capture by script gives every set equal time.
Whoever grasps sets the thumb against the index, then index and middle, and so on (the precision
grasps in the taxonomy of Feix and others, 2016); whoever plays with all sets does so less often."""

STRANGER_SHARE = 0.04
"""Probability that a layout is none that the captured hand would show: another person's, or one on
an object wider than any gesture of the capture. An assumption that costs the captured hand a
little."""

STRANGER_THUMB_AND_NEXT = 60.0
"""As `THUMB_AND_NEXT`, for such layouts: they come from grasping things, and far from everything
that was captured, habit is all there is to go by. An assumption."""

STRANGER = KernelShape(width=0.4, turn=0.3, size=0.3)
"""Kernels of such layouts: a centimetre a finger, 17 degrees, a third in size. An assumption."""

_THINNED = 4
"""Every so manieth layout has a stranger's kernel; wide kernels need not stand as dense."""

ASSUMED = {
    "stranger": [STRANGER_SHARE, STRANGER_THUMB_AND_NEXT, _THINNED, *astuple(STRANGER)],
}
"""What decides labels beside a belief's own numbers, for digests."""


def natural_prior(thumb_and_next: float = THUMB_AND_NEXT) -> dict[int, Array]:
    """Number of contacts -> (S,) assumed probability of every set of `finger_sets`.

    Args:
        thumb_and_next: How much likelier than any other the thumb with the fingers next to it is.
    """
    prior = {1: np.array(LONE_FINGER)}
    for count in range(2, len(FINGERS) + 1):
        weights = np.ones(len(finger_sets(count)))
        weights[0] = thumb_and_next
        prior[count] = weights / weights.sum()
    return prior


def even_prior() -> dict[int, Array]:
    """The same with all sets of one size equally likely."""
    return {
        count: np.full(len(finger_sets(count)), 1.0 / len(finger_sets(count)))
        for count in range(1, len(FINGERS) + 1)
    }


class LabelEvidence:
    """Probabilities of the labellings of contacts at one moment, by Bayes' rule.

    Most layouts are taken for the captured hand's, some for a stranger's: far from everything that
    was captured, the narrow kernels would be as sure as they are wrong.

    Args:
        layouts: Number of contacts, 2 to 5 -> training layouts.
        shapes: Of the captured hand's kernels, likewise.
        order: Number of contacts, 3 to 5 -> probability that touches are in the fingers' order.
        prior: Number of contacts, 1 to 5 -> (S,) positive probability of every finger set that the
            captured hand sets down. A stranger's is `STRANGER_THUMB_AND_NEXT`'s.

    Raises:
        EncoderError: A probability is none.
    """

    def __init__(
        self,
        layouts: Mapping[int, Layouts],
        shapes: Mapping[int, KernelShape],
        order: Mapping[int, float],
        prior: Mapping[int, Array],
    ) -> None:
        _check(order, prior)
        self.layouts, self.shapes = dict(layouts), dict(shapes)
        self.order, self.prior = dict(order), dict(prior)
        self._captured = LayoutDensity(layouts, shapes)
        self._stranger = LayoutDensity(
            {k: z[:, ::_THINNED] for k, z in layouts.items()}, dict.fromkeys(layouts, STRANGER)
        )
        self._log_prior = _of_labellings(self.prior)
        self._stranger_prior = _of_labellings(natural_prior(STRANGER_THUMB_AND_NEXT))

    def log_posterior(self, xy: Array) -> Array:
        """(P,) log probability of every labelling of `hypotheses(k)` given contacts (k, 2) in m."""
        return normalised(self.log_joint(xy))

    def log_joint(self, xy: Array) -> Array:
        """(P,) log of prior times density, of every labelling and contacts (k, 2) in m together.

        The density is that of the layout, per square inch to the k - 1, so that of the joints of
        all contacts and of some, the quotient is the density of the others.
        """
        count = len(xy)
        if count == 1:
            return self._log_prior[1]
        captured = self._captured.log_density(xy) + self._log_prior[count]
        stranger = self._stranger.log_density(xy) + self._stranger_prior[count]
        if count in self.order:
            share = self.order[count]
            stranger = stranger + np.where(in_order(xy), np.log(share), np.log(1.0 - share))
        return np.asarray(
            np.logaddexp(np.log(1.0 - STRANGER_SHARE) + captured, np.log(STRANGER_SHARE) + stranger)
        )


def _of_labellings(prior: Mapping[int, Array]) -> dict[int, Array]:
    """Number of contacts -> (P,) log probability of every labelling, before any layout is seen."""
    return {k: normalised(np.log(p)[set_of_labelling(k)]) for k, p in prior.items()}


def _check(order: Mapping[int, float], prior: Mapping[int, Array]) -> None:
    for count in ORDERED_COUNTS:
        if not 0.0 < order[count] < 1.0:
            raise EncoderError(
                "this is no probability of order",
                where=f"{count} contacts",
                got=order[count],
                expected="between 0 and 1",
            )
    for count in range(1, len(FINGERS) + 1):
        share, sets = prior[count], len(finger_sets(count))
        if share.shape != (sets,) or not (share > 0).all() or abs(share.sum() - 1.0) > 1e-6:
            raise EncoderError(
                "this is no prior over finger sets",
                where=f"{count} contacts",
                got=share,
                expected=f"{sets} positive numbers that add up to 1",
            )


def normalised(log_weights: Array) -> Array:
    """Logarithms of probabilities that sum to 1, from logarithms of weights (P,)."""
    shifted = log_weights - log_weights.max()
    result: Array = shifted - np.log(np.exp(shifted).sum())
    return result
