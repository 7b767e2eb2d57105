"""Estimates a hand's size relative to the hand on which the encoders were trained.

The hand in the encoders' training capture is called the trained hand here. The estimate uses three
layouts of five touches: fingers relaxed (natural), closed, and spread wide. A single layout cannot
distinguish a large closed hand from a small open hand. The three layouts are compared with the
middle and the two ends of the range of the trained hand's five-finger layouts. The comparison uses
the logarithms of the ten distances between fingertips; a larger hand adds the same number to all
ten. The result is the most likely size, with the interval that contains 95 % of the likelihood.

The capture may be simulated, and the variation of spreads between people is an assumption
(`HABIT`). The result is therefore mainly the scale at which a person's touches are most similar to
the training data. Encoders need just this scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from encoders.capture import Capture
from encoders.person.natural_layout import NaturalLayout, of_capture
from encoders.regression.trained import builtin_capture
from models.arithmetic import Array
from models.errors import InputError
from models.frames import FINGERS, TouchFrame
from models.person import SIZES

SPREADS = ("natural", "closed", "wide")
"""Spreads that a person makes, in this order."""

RANK = {"closed": 0.05, "natural": 0.5, "wide": 0.95}
"""Rank of each spread among the trained hand's five-finger layouts, sorted by size: 0 is the
smallest layout and 1 the largest."""

WINDOW = 0.05
"""A layout counts as a spread if its rank differs from the spread's rank by at most this much."""

HABIT = {"natural": 0.08, "closed": 0.14, "wide": 0.08}
"""Standard deviation, among people with equal hands, of the logarithm of a spread's size. It is
assumed, not measured. Only the interval and the weights of the spreads depend on it."""

TAILS = 4.0
"""Degrees of freedom of Student's t. Its heavy tails keep one wrongly made spread from deciding the
result alone."""

SHRINKAGE = 0.1
"""Share by which correlations between distances are reduced, since they are estimated from few
independent frames."""

PROPORTION = 0.05
"""Standard deviation of the logarithm of each distance, for the proportions of other hands and the
noise of touches. It is assumed, and added to the trained hand's variation."""

LEAST_GROWTH = 1.1
"""Least ratio of sizes from closed to natural and from natural to wide spread."""
STRANGEST = 60.0
"""Squared Mahalanobis distance from the trained hand's shape (10 numbers) beyond which touches are
not those of a hand."""
WIDEST = 1.4
"""Upper end of the interval divided by its lower end, beyond which the size is undetermined."""

_GRID = np.linspace(np.log(SIZES[0]), np.log(SIZES[1]), 1962)
"""Grid of logarithms of sizes, in steps of 0.0005."""

_I, _J = np.triu_indices(len(FINGERS), 1)


@dataclass(frozen=True)
class HandSize:
    """A hand's size.

    Attributes:
        ratio: Length of the hand relative to the trained hand.
        low, high: Ends of the interval that contains 95 % of the likelihood.
        alone: Length ratio from each spread alone, in the order of `SPREADS`.
    """

    ratio: float
    low: float
    high: float
    alone: tuple[float, ...]


@dataclass(frozen=True)
class _Spread:
    """Logarithms of the ten distances in one spread of the trained hand: mean (10,) and inverse
    covariances."""

    mean: Array
    shape: Array
    """Inverse covariance (10, 10) without the variance of `HABIT`."""
    whole: Array
    """Inverse covariance (10, 10) including the variance of `HABIT`."""


class HandSizes:
    """Estimates sizes of hands relative to a captured hand.

    Args:
        capture: Capture of the hand on which encoders were trained.

    Raises:
        CaptureError: No frame has all five fingers down.
    """

    def __init__(self, capture: Capture) -> None:
        self.layout: NaturalLayout = of_capture(capture)
        logs = _distances(capture.xy[capture.down.all(axis=1)])
        rank = np.argsort(np.argsort(logs.mean(axis=1), kind="stable")) / max(len(logs) - 1, 1)
        self._spreads = {name: _spread(name, logs, rank) for name in SPREADS}

    def estimate(self, layouts: Sequence[ArrayLike]) -> HandSize:
        """Estimates the size of a right hand (mirror a left hand first).

        Args:
            layouts: Three layouts (5, 2) m, the touches of five fingers in a closed, a natural and
                a wide spread. The order of the layouts, and of the touches in a layout, has no
                meaning: layouts are sorted by size.

        Raises:
            InputError: The layouts have wrong shapes, are not those of a hand, or do not determine
                the size.
        """
        arrays = [np.asarray(layout, float) for layout in layouts]
        expected = (len(FINGERS), 2)
        if len(arrays) != len(SPREADS) or any(
            a.shape != expected or not np.isfinite(a).all() for a in arrays
        ):
            raise InputError(
                "the hand's size needs three spreads of five fingers",
                where="calibration",
                got=", ".join(str(a.shape) for a in arrays) or "nothing",
                expected="three finite layouts of shape (5, 2)",
            )
        logs = [_distances(self._by_label(a)[None])[0] for a in arrays]
        logs.sort(key=lambda one: float(one.mean()))
        logs_by_spread = dict(zip(("closed", "natural", "wide"), logs, strict=True))
        self._check_spreads(logs_by_spread)
        alone, total = [], np.zeros(len(_GRID))
        for name in SPREADS:
            likelihood = self._log_likelihood(name, logs_by_spread[name])
            total += likelihood
            alone.append(float(np.exp(_GRID[np.argmax(likelihood)])))
        ratio, low, high = _interval(total)
        size = HandSize(ratio, low, high, tuple(alone))
        if high / low > WIDEST or low <= SIZES[0] * 1.001 or high >= SIZES[1] / 1.001:
            raise InputError(
                "the three spreads do not determine the hand's size",
                where="calibration",
                got=f"{ratio:.2f}, in the interval {low:.2f} to {high:.2f}; from each spread alone "
                + ", ".join(f"{n} {r:.2f}" for n, r in zip(SPREADS, alone, strict=True)),
                expected="spreads that agree on the size",
                remedy="Put the fingers down again: relaxed, then close together, then wide apart",
            )
        return size

    def _by_label(self, xy: Array) -> Array:
        """The touches (5, 2) in the order of the fingers, thumb first."""
        return xy[np.argsort(self.layout.match(xy).labels)]

    def _check_spreads(self, spreads: dict[str, Array]) -> None:
        sizes = {name: float(np.exp(logs.mean())) for name, logs in spreads.items()}
        growth = min(sizes["natural"] / sizes["closed"], sizes["wide"] / sizes["natural"])
        if growth < LEAST_GROWTH:
            raise InputError(
                "the three spreads are hardly different",
                where="calibration",
                got="mean distances of "
                + ", ".join(f"{100 * sizes[n]:.1f}" for n in ("closed", "natural", "wide"))
                + " cm",
                expected=f"each at least {LEAST_GROWTH:g} times the distance before it",
                remedy="Close the fingers more, and spread them wider",
            )
        for name, logs in spreads.items():
            spread = self._spreads[name]
            off = logs - spread.mean
            off = off - (off @ spread.shape).sum() / spread.shape.sum()
            strange = float(off @ spread.shape @ off)
            if strange > STRANGEST:
                raise InputError(
                    "these five touches are not arranged like those of a hand",
                    where=f"{name} spread",
                    got=f"a squared Mahalanobis distance of {strange:.0f} from the shape of the "
                    "hand on which the encoders were trained",
                    expected=f"{STRANGEST:g} or less",
                    remedy="Put down the tips of all five fingers, and nothing else",
                )

    def _log_likelihood(self, name: str, logs: Array) -> Array:
        """Log likelihood of every size on the grid for one spread, up to a constant."""
        spread = self._spreads[name]
        off = (logs - spread.mean) - _GRID[:, None]
        squared = np.einsum("gi,ij,gj->g", off, spread.whole, off)
        return -0.5 * (TAILS + len(logs)) * np.log1p(squared / TAILS)


def _distances(xy: Array) -> Array:
    """Logarithms (n, 10) of the distances between five touches (n, 5, 2)."""
    apart = np.linalg.norm(xy[:, _I] - xy[:, _J], axis=2)
    return np.log(np.maximum(apart, 1e-4))


def _spread(name: str, logs: Array, rank: Array) -> _Spread:
    chosen = logs[np.abs(rank - RANK[name]) <= WINDOW]
    mean = chosen.mean(axis=0)
    off = chosen - mean
    covariance = off.T @ off / len(off)
    own = np.diag(np.diag(covariance))
    shrunk = (1 - SHRINKAGE) * covariance + SHRINKAGE * own + PROPORTION**2 * np.eye(len(mean))
    habit = np.full_like(shrunk, HABIT[name] ** 2)
    return _Spread(mean, np.linalg.inv(shrunk), np.linalg.inv(shrunk + habit))


def _interval(log_likelihood: Array) -> tuple[float, float, float]:
    """Most likely size, and the ends of the interval with 2.5 % of the likelihood beyond each."""
    share = np.exp(log_likelihood - log_likelihood.max())
    below = np.cumsum(share) / share.sum()
    low, high = _GRID[np.searchsorted(below, [0.025, 0.975])]
    best = _GRID[np.argmax(log_likelihood)]
    return float(np.exp(best)), float(np.exp(low)), float(np.exp(high))


@cache
def builtin_sizes() -> HandSizes:
    """Estimator of sizes relative to the hand of the built-in capture."""
    return HandSizes(builtin_capture())


REST = 0.5
"""Time (s) for which all five fingers must rest."""
STILL = 0.004
"""Largest movement (m), along x or y, of a resting finger from its first position."""


class SpreadCollector:
    """Processes touch frames, and stores a layout whenever five fingers rest.

    Between two layouts at least one finger must leave the screen. If a hand slid from one spread to
    the next, it would be unknown when the next spread is reached.

    Attributes:
        layouts: Layouts (5, 2) m: mean positions of the resting fingers, in order of contact id.
        down: Number of contacts on the screen now.
    """

    def __init__(self) -> None:
        self.layouts: list[Array] = []
        self.down = 0
        self._ids: list[int] = []
        self._since = 0.0
        self._seen: list[Array] = []
        self._taken = False

    def step(self, frame: TouchFrame) -> bool:
        """Processes a frame; returns true if it completes a layout."""
        contacts = sorted(frame.contacts, key=lambda c: c.id)
        self.down = len(contacts)
        ids = [c.id for c in contacts]
        if len(contacts) != len(FINGERS):
            self._begin([], frame.time)
            return False
        xy = np.array([(c.x, c.y) for c in contacts])
        if ids != self._ids:
            self._begin(ids, frame.time)
        elif float(np.abs(xy - self._seen[0]).max()) > STILL:
            self._begin(ids, frame.time, self._taken)
        self._seen.append(xy)
        if self._taken or frame.time - self._since < REST - 1e-9:
            return False
        self.layouts.append(np.mean(self._seen, axis=0))
        self._taken = True
        return True

    def _begin(self, ids: list[int], time: float, taken: bool = False) -> None:
        self._ids, self._since, self._seen, self._taken = ids, time, [], taken
