"""Model of censored completion times: a trial without success would have taken longer than it
lasted.

Without such trials, slow conditions would look faster than they are. Here log time is normally
distributed around a mean by condition and practice, and the time of an unsuccessful trial is longer
than its `time_s` (a Tobit or lognormal accelerated failure time model). People are the independent
units: standard errors are computed by the jackknife that leaves one person out, which allows for
any dependence within a person. In R:
`survreg(Surv(time_s, success) ~ 0 + condition + log2_position, dist = "lognormal")`.

The likelihood is concave in the parameters of Olsen 1978, and so has one maximum.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sandbox.study.report.models.comparisons import (
    Difference,
    Pair,
    counts_of,
    pairs_of,
    t_difference,
)
from sandbox.study.report.models.data import StudyData
from sandbox.study.report.models.intervals import has_spread
from sandbox.study.report.models.mixed import FEWEST_PEOPLE, fixed_effects

if TYPE_CHECKING:
    from pandas import DataFrame

TOLERANCE = 1e-9
"""Largest last step of a parameter in units of the residual's standard deviation."""


@dataclass(frozen=True)
class Censored:
    """A fitted model.

    Attributes:
        present: Numbers of its conditions: those with a success.
        names: Names of all coefficients, as in `Mixed`.
        coefficients: Coefficients on the log scale.
        replicates: (people, coefficients) without each person; nan where they cannot be estimated.
        sigma: Standard deviation of log time around its mean, between and within people.
        people, trials, unseen: Numbers of people, of trials, and of trials with a censored time.
        rows: Rows of `data.used` that it was fitted to.
    """

    present: tuple[int, ...]
    names: tuple[str, ...]
    coefficients: np.ndarray
    replicates: np.ndarray
    sigma: float
    people: int
    trials: int
    unseen: int
    rows: DataFrame = field(repr=False, compare=False)

    def weights(self, pair: Pair, conditions: int) -> np.ndarray:
        """Weights of the coefficients in the difference between a pair of levels."""
        weights = np.zeros(len(self.names))
        weights[: len(self.present)] = pair.weights(conditions)[list(self.present)]
        return weights

    def error(self, weights: np.ndarray) -> float:
        """Standard error of a weighted sum of coefficients."""
        values = self.replicates[:, weights != 0] @ weights[weights != 0]
        count = len(values)
        return float(np.sqrt((count - 1) / count * ((values - values.mean()) ** 2).sum()))


def tobit(
    X: np.ndarray, y: np.ndarray, seen: np.ndarray, start: np.ndarray | None = None
) -> np.ndarray | None:
    """Maximum likelihood fit of a normal variable of which some values are only lower bounds.

    Args:
        X: (n, k) design matrix of full rank.
        y: (n,) values or bounds.
        seen: (n,) True for a value, False for a bound.
        start: (k + 1,) start of the iteration, in the form of the result.

    Returns:
        (k + 1,) coefficients divided by the standard deviation, then its inverse; None if there is
        no maximum.
    """
    from scipy.special import log_ndtr

    k = X.shape[1]
    Z = np.column_stack([X, -y])
    bounds = Z[~seen]
    values = Z[seen]
    count = int(seen.sum())
    if start is None:
        start = np.zeros(k + 1)
        spread = float(y.std())
        if not has_spread(spread, *y):
            return None
        start[:k] = np.linalg.lstsq(X, y, rcond=None)[0] / spread
        start[k] = 1.0 / spread
    theta = start.copy()

    def likelihood(p: np.ndarray) -> float:
        if p[k] <= 0.0:
            return -np.inf
        return float(
            count * np.log(p[k]) - 0.5 * ((values @ p) ** 2).sum() + log_ndtr(bounds @ p).sum()
        )

    now = likelihood(theta)
    for _ in range(100):
        at = bounds @ theta
        # Hazard of the normal distribution at -at, computed from logarithms for the far tails.
        hazard = np.exp(-0.5 * at * at - 0.5 * np.log(2 * np.pi) - log_ndtr(at))
        gradient = -values.T @ (values @ theta) + bounds.T @ hazard
        gradient[k] += count / theta[k]
        curvature = values.T @ values + (bounds.T * (hazard * (at + hazard))) @ bounds
        curvature[k, k] += count / theta[k] ** 2
        try:
            step = np.linalg.solve(curvature, gradient)
        except np.linalg.LinAlgError:
            return None
        size = 1.0
        while (then := likelihood(theta + size * step)) < now - 1e-12 and size > 1e-6:
            size /= 2
        theta, now = theta + size * step, max(now, then)
        if np.abs(size * step).max() < TOLERANCE * max(1.0, np.abs(theta).max()):
            return theta
    return None


def fit_censored(data: StudyData) -> Censored | str:
    """Fits the model to all used trials, or returns the reason why it cannot."""
    rows = bounded_rows(data)
    return fit_bounded(data, rows, np.log(rows["time_s"].to_numpy(float)), ~rows["censored"])


def bounded_rows(data: StudyData) -> DataFrame:
    """Rows of `data.used` that the model of completion times is fitted to."""
    rows = data.used[data.used["time_s"] > 0.0]
    succeeded = set(rows.loc[~rows["censored"], "cell"])
    # Without any success, the times of a condition have no upper bound.
    return rows[rows["cell"].isin(succeeded)]


def fit_bounded(
    data: StudyData, rows: DataFrame, y: np.ndarray, seen: Iterable[bool]
) -> Censored | str:
    """Fits the model to a measure, or returns the reason why it cannot.

    If all values were seen, it is least squares with errors by the jackknife.

    Args:
        data: Data of the study.
        rows: Rows of `data.used`.
        y: (rows,) values or lower bounds.
        seen: (rows,) True for a value, False for a bound.
    """
    people = rows["ppid"].nunique()
    if people < FEWEST_PEOPLE:
        return f"at least {FEWEST_PEOPLE} participants are needed, but there are {people}"
    X, names, present = fixed_effects(rows, data.conditions)
    seen = np.asarray(seen, dtype=bool)
    if seen.sum() <= X.shape[1] + 1:
        return f"{int(seen.sum())} successes are too few for {X.shape[1]} coefficients"
    fit = tobit(X, y, seen)
    if fit is None:
        return "the model has no most likely parameters here"
    who = rows["ppid"].to_numpy()
    replicates = np.array([_without(X, y, seen, who != ppid, fit) for ppid in dict.fromkeys(who)])
    return Censored(
        tuple(present),
        tuple(names),
        fit[:-1] / fit[-1],
        replicates,
        float(1.0 / fit[-1]),
        people,
        len(rows),
        int((~seen).sum()),
        rows,
    )


def _without(
    X: np.ndarray, y: np.ndarray, seen: np.ndarray, keep: np.ndarray, start: np.ndarray
) -> np.ndarray:
    """Coefficients from some of the trials; nan for conditions without a success among them."""
    known = (X[keep & seen] != 0.0).any(axis=0)
    # Trials of a condition without success are left out: their mean is not finite.
    mine = keep & (X[:, ~known] == 0.0).all(axis=1)
    out = np.full(X.shape[1], np.nan)
    part = tobit(X[mine][:, known], y[mine], seen[mine], start[np.append(known, True)])
    if part is not None:
        out[known] = part[:-1] / part[-1]
    return out


def censored_differences(data: StudyData, model: Censored) -> list[Difference]:
    """Differences in log time between all pairs of levels, by the model."""
    return [bounded_difference(data, model, pair) for pair in pairs_of(data, model.present)]


def bounded_difference(data: StudyData, model: Censored, pair: Pair) -> Difference:
    """Difference between a pair of levels, by the model."""
    weights = model.weights(pair, len(data.conditions))
    value = float(weights @ model.coefficients)
    return t_difference(pair, value, model.error(weights), counts_of(pair, model.rows))
