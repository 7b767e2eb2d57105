"""Evidence of a single frame about the labels of its touches, without history."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple
from math import fsum, log

import numpy as np

from encoders.labels.finger_order import ORDERED_COUNTS, in_order
from encoders.labels.layout_density import (
    KernelShape,
    LayoutDensity,
    Layouts,
    finger_sets,
    set_of_labelling,
)
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.frames import FINGERS

LONE_FINGER = (0.15, 0.40, 0.25, 0.10, 0.10)
"""Probability that a single contact is this finger. An assumption, not learned: captures have no
single contacts. People point with the index finger, or with the middle one."""

THUMB_AND_NEXT = 1.3
"""Prior odds of the thumb with the fingers next to it, relative to any other set of as many
fingers, for layouts like the captured ones. An assumption, not learned: a scripted capture gives
every set equal time. In a grasp, people set the thumb against the index, then index and middle, and
so on (the precision grasps in the taxonomy of Feix and others, 2016); people who try out all sets
do so less often."""

STRANGER_SHARE = 0.04
"""Probability of a layout that the captured hand would not show: another person's, or one on an
object wider than any gesture of the capture. An assumption that costs the captured hand a little
accuracy."""

STRANGER_THUMB_AND_NEXT = 60.0
"""As `THUMB_AND_NEXT`, for such layouts: they come from grasping objects, and far from all captured
layouts the usual finger sets are the only evidence. An assumption."""

STRANGER = KernelShape(width=0.4, turn=0.3, size=0.3)
"""Kernel shape for such layouts: 1 cm per finger, 17 degrees, a third in size. An assumption."""

_THINNED = 4
"""Every layout of this step gets a kernel for other people; wide kernels may be sparser."""

ASSUMED = {
    "stranger": [STRANGER_SHARE, STRANGER_THUMB_AND_NEXT, _THINNED, *astuple(STRANGER)],
}
"""The constants that affect labels in addition to a belief's own numbers, for digests."""


def natural_prior(thumb_and_next: float = THUMB_AND_NEXT) -> dict[int, Array]:
    """Assumed probabilities (S,) of all `finger_sets`, by number of contacts.

    Args:
        thumb_and_next: Odds of the thumb with the fingers next to it, relative to any other set.
    """
    prior = {1: np.array(LONE_FINGER)}
    for count in range(2, len(FINGERS) + 1):
        weights = np.ones(len(finger_sets(count)))
        weights[0] = thumb_and_next
        prior[count] = weights / weights.sum()
    return prior


def even_prior() -> dict[int, Array]:
    """Probabilities (S,) in which all sets of one size are equally likely, by number of
    contacts."""
    return {
        count: np.full(len(finger_sets(count)), 1.0 / len(finger_sets(count)))
        for count in range(1, len(FINGERS) + 1)
    }


class LabelEvidence:
    """Probabilities of the labellings of contacts at one moment, by Bayes' rule.

    The density mixes the captured hand's layouts with wider ones of other people: far from all
    captured layouts, the narrow kernels alone would be certain but wrong.

    Args:
        layouts: Training layouts by number of contacts, 2 to 5.
        shapes: Shapes of the captured hand's kernels by number of contacts, 2 to 5.
        order: Probability that touches are in the fingers' order, by number of contacts, 3 to 5.
        prior: Positive probabilities (S,) of the captured hand's finger sets, by number of
            contacts, 1 to 5. For other people they follow from `STRANGER_THUMB_AND_NEXT`.

    Raises:
        EncoderError: A probability is invalid.
    """

    with_density = True

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

    def width(self, count: int) -> float:
        """inches, width of the captured hand's kernels for so many contacts."""
        return self.shapes[count].width

    def log_posterior(self, xy: Array) -> Array:
        """Log probabilities (P,) of the labellings of `hypotheses(k)` given contacts (k, 2) in
        m."""
        return normalised(self.log_joint(xy))

    def log_joint(self, xy: Array) -> Array:
        """Log (P,) of prior times density of every labelling, for contacts (k, 2) in m.

        The density is that of the layout, per square inch to the power k - 1. So the joint density
        of all contacts divided by that of some is the density of the others given those.
        """
        count = len(xy)
        if count == 1:
            return self._log_prior[1]
        captured = self._captured.log_density(xy) + self._log_prior[count]
        stranger = self._stranger.log_density(xy) + self._stranger_prior[count]
        if count in self.order:
            share = self.order[count]
            stranger = stranger + np.where(in_order(xy), log(share), log(1.0 - share))
        return functions.log_sum_exp(
            log(1.0 - STRANGER_SHARE) + captured, log(STRANGER_SHARE) + stranger
        )


def _of_labellings(prior: Mapping[int, Array]) -> dict[int, Array]:
    """Prior log probabilities (P,) of the labellings, by number of contacts."""
    return {k: normalised(functions.log(p)[set_of_labelling(k)]) for k, p in prior.items()}


def _check(order: Mapping[int, float], prior: Mapping[int, Array]) -> None:
    for count in ORDERED_COUNTS:
        if not 0.0 < order[count] < 1.0:
            raise EncoderError(
                "not a probability of order",
                where=f"{count} contacts",
                got=order[count],
                expected="between 0 and 1",
            )
    for count in range(1, len(FINGERS) + 1):
        share, sets = prior[count], len(finger_sets(count))
        if share.shape != (sets,) or not (share > 0).all() or abs(share.sum() - 1.0) > 1e-6:
            raise EncoderError(
                "not a prior over finger sets",
                where=f"{count} contacts",
                got=share,
                expected=f"{sets} positive numbers that add up to 1",
            )


def normalised(log_weights: Array) -> Array:
    """Normalises logarithms of weights (P,) to logarithms of probabilities that sum to 1."""
    shifted = log_weights - log_weights.max()
    return shifted - log(fsum(functions.exp(shifted).tolist()))
