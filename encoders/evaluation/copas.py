"""The Copas test of overfitting: are predictions too extreme on unseen frames?

Captured values are regressed on out-of-sample predictions, y = b0 + b1 yhat. An encoder without
overfitting has b0 = 0 and b1 = 1; with fitted noise, b1 < 1 (Copas 1983, Journal of the Royal
Statistical Society B 45, 311-354). The paper counts overfitted joints over ten folds without
further details, so results are reported for several rules. A degree of freedom counts as overfitted
if b1 < 1 and

- `f_test`: the hypothesis that b0 = 0 and b1 = 1 is rejected at 5 % (F test with 2 and n - 2
  degrees of freedom); this rule gives the headline number;
- `t_test`: the hypothesis that b1 = 1 is rejected at 5 %, one-sided;
- `clustered`: as `t_test`, with a standard error that allows for the dependence between frames of
  one take.

The paper seems to use folds of random frames. Neighbouring frames are nearly equal, so the test
frames of such a fold hardly differ from training frames. Folds that never split a take are more
reliable.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.encoder import Encoder
from encoders.validation import trial_folds
from models.arithmetic import Array
from models.errors import EncoderError

FOLDS = 10
LEVEL = 0.05
RULES = ("f_test", "t_test", "clustered")

_STILL = 1e-9
"""Spread (rad or m) of predictions below which a slope is not computed."""


@dataclass(frozen=True)
class CopasFold:
    """Results of one fold for n outputs.

    Attributes:
        slope: (n,) b1; NaN where the predictions do not vary.
        overfitted: Booleans (n,) by rule.
    """

    slope: Array
    overfitted: dict[str, NDArray[np.bool_]]


@dataclass(frozen=True)
class Copas:
    """Results of all folds."""

    folds: tuple[CopasFold, ...]

    def count(self, rule: str) -> float:
        """Number of overfitted outputs, mean over the folds."""
        return float(np.mean([fold.overfitted[rule].sum() for fold in self.folds]))

    @property
    def median_slope(self) -> float:
        """Median slope over outputs and folds; NaN if no prediction varies."""
        slopes = np.concatenate([fold.slope for fold in self.folds])
        slopes = slopes[np.isfinite(slopes)]
        return float(np.median(slopes)) if len(slopes) else float("nan")


def random_folds(frames: int, folds: int = FOLDS, seed: int = 0) -> NDArray[np.int64]:
    """Fold (frames,) of every frame, drawn at random, in equal sizes."""
    return np.random.default_rng(seed).permutation(np.arange(frames) % folds)


def copas(
    fresh: Callable[[], Encoder],
    U: Array,
    Q: Array,
    trial: NDArray[np.int64],
    blocked: bool,
    folds: int = FOLDS,
    progress: Callable[[float], None] | None = None,
) -> Copas:
    """Computes the Copas test by cross-validation.

    Args:
        fresh: Creates an untrained encoder.
        U: (T, width) inputs.
        Q: (T, n) outputs.
        trial: (T,) take of every frame.
        blocked: True uses folds that never split a take, False folds of random frames.
        folds: Number of folds.
        progress: Called with the share done, 0 to 1.

    Raises:
        EncoderError: There are fewer takes (or frames) than two folds need.
    """
    fold = trial_folds(trial, folds) if blocked else random_folds(len(U), folds)
    names = np.unique(fold)
    if len(names) < 2:
        raise EncoderError("the Copas test needs two folds", expected="2 takes or more")
    verdicts = []
    for done, k in enumerate(names):
        out = fold == k
        encoder = fresh()
        encoder.fit(U[~out], Q[~out])
        verdicts.append(verdict(Q[out], encoder.predict(U[out]), trial[out]))
        if progress:
            progress((done + 1) / len(names))
    return Copas(tuple(verdicts))


def verdict(y: Array, predicted: Array, trial: NDArray[np.int64]) -> CopasFold:
    """Slopes and tests of captured values `y` (n, d) on out-of-sample predictions (n, d).

    `trial` (n,) has the take of every frame.
    """
    from scipy.stats import f, t

    n = len(y)
    centre = predicted.mean(axis=0)
    x = predicted - centre
    sxx = np.sum(x * x, axis=0)
    varies = (np.sqrt(sxx / n) > _STILL) & (n > 2)
    sxx = np.where(varies, sxx, 1.0)
    slope = np.sum(x * (y - y.mean(axis=0)), axis=0) / sxx
    residual = y - y.mean(axis=0) - slope * x
    rest = np.maximum(np.sum(residual**2, axis=0), np.finfo(float).tiny)
    free = max(n - 2, 1)
    ratio = ((np.sum((y - predicted) ** 2, axis=0) - rest) / 2.0) / (rest / free)
    error = np.sqrt(rest / free / sxx)
    low = varies & (slope < 1.0)
    overfitted = {
        "f_test": low & (f.sf(ratio, 2, free) < LEVEL),
        "t_test": low & (t.cdf((slope - 1.0) / error, free) < LEVEL),
    }
    # The scores of a take are summed before squaring, since its frames are not independent.
    _, cluster = np.unique(trial, return_inverse=True)
    clusters = int(cluster.max()) + 1
    scores = np.zeros((clusters, y.shape[1]))
    np.add.at(scores, cluster, x * residual)
    if clusters > 1:
        spread = np.sqrt(np.sum(scores**2, axis=0) * clusters / (clusters - 1)) / sxx
        spread = np.maximum(spread, np.finfo(float).tiny)
        robust = t.cdf((slope - 1.0) / spread, clusters - 1) < LEVEL
    else:
        robust = np.zeros(len(slope), bool)
    overfitted["clustered"] = low & robust
    return CopasFold(np.where(varies, slope, np.nan), overfitted)
