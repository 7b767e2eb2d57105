"""Restricted maximum likelihood of the variances of random effects, as lme4 has it.

Variances are relative to that of the residual and 0 or larger, so that one at its boundary is
exactly 0; the residual's variance and the fixed effects follow from them (Bates, Maechler, Bolker
and Walker 2015, Journal of Statistical Software 67). People are independent, and those with
equally many trials are computed together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

AT_BOUNDARY = 1e-8
"""Relative variance that counts as 0; lme4 has 1e-4 for relative standard deviations."""


@dataclass(frozen=True)
class Reml:
    """A fit.

    Attributes:
        deviations: Standard deviations of the random effects.
        residual: That of the residual.
        coefficients, covariance: Fixed effects and their covariance.
        converged: True if the optimiser converged.
    """

    deviations: np.ndarray
    residual: float
    coefficients: np.ndarray
    covariance: np.ndarray
    converged: bool


_Solved = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Of a batch: inverse of the covariance; its products with X and with y."""


@dataclass(frozen=True)
class _Batch:
    """People with equally many trials.

    Attributes:
        X: (people, trials, coefficients).
        y: (people, trials).
        alike: (effects, people, trials, trials) 1 where two trials share a random effect.
    """

    X: np.ndarray
    y: np.ndarray
    alike: np.ndarray


def fit_reml(
    X: np.ndarray, y: np.ndarray, who: np.ndarray, levels: Sequence[np.ndarray]
) -> Reml | None:
    """Fits random effects of person, and of person x level of each factor.

    Args:
        X: (trials, coefficients) matrix of full rank.
        y: (trials,) values.
        who: (trials,) person of each trial.
        levels: For each factor, (trials,) level of each trial.

    Returns:
        The fit, whose deviations are of person, then of each factor; None if there is none.
    """
    from scipy.optimize import minimize

    likelihood = _Likelihood(X, y, _batches(X, y, who, levels))
    try:
        found = minimize(
            likelihood.of,
            np.full(len(levels) + 1, 0.5),
            jac=True,
            method="L-BFGS-B",
            bounds=[(0.0, None)] * (len(levels) + 1),
            options={"ftol": 1e-12, "gtol": 1e-6},
        )
        ratios = np.where(found.x < AT_BOUNDARY, 0.0, found.x)
        coefficients, information, square = likelihood.solve(ratios)[:3]
    except np.linalg.LinAlgError:
        return None
    variance = square / likelihood.freedom
    if not (np.isfinite(ratios).all() and np.isfinite(variance) and variance > 0.0):
        return None
    # The line search cannot go on where the criterion no longer changes in its last digits.
    flat = np.abs(np.where(ratios > 0.0, found.jac, np.minimum(found.jac, 0.0))).max() < 1e-3
    return Reml(
        np.sqrt(ratios * variance),
        float(np.sqrt(variance)),
        coefficients,
        variance * np.linalg.inv(information),
        bool(found.success or flat),
    )


class _Likelihood:
    """Minus twice the restricted log likelihood, without its constant, of relative variances."""

    def __init__(self, X: np.ndarray, y: np.ndarray, batches: list[_Batch]) -> None:
        self.freedom = len(y) - X.shape[1]
        self._count, self._batches = X.shape[1], batches

    def of(self, ratios: np.ndarray) -> tuple[float, np.ndarray]:
        """The criterion and its gradient."""
        values, information, square, size, solved = self.solve(ratios)
        size += float(np.linalg.slogdet(information)[1])
        covariance = np.linalg.inv(information)
        gradient = np.zeros(len(ratios))
        for batch, (inverse, VX, Vy) in zip(self._batches, solved, strict=True):
            rest = Vy - VX @ values
            # For symmetric matrices, the trace of a product is a sum over elements.
            gradient += np.einsum("pij,kpij->k", inverse, batch.alike, optimize=True)
            outer = np.einsum("pia,ab,pjb->pij", VX, covariance, VX, optimize=True)
            outer += self.freedom / square * rest[:, :, None] * rest[:, None, :]
            gradient -= np.einsum("pij,kpij->k", outer, batch.alike, optimize=True)
        return self.freedom * float(np.log(square)) + size, gradient

    def solve(
        self, ratios: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float, float, list[_Solved]]:
        """Fixed effects, their information, weighted residual sum of squares, log determinant of
        the covariance, and what each batch contributes."""
        information = np.zeros((self._count, self._count))
        score = np.zeros(self._count)
        square = size = 0.0
        solved = []
        for batch in self._batches:
            V = np.eye(batch.y.shape[1]) + np.tensordot(ratios, batch.alike, 1)
            inverse = np.linalg.inv(V)
            VX, Vy = inverse @ batch.X, (inverse @ batch.y[:, :, None])[:, :, 0]
            information += np.einsum("pia,pib->ab", batch.X, VX)
            score += np.einsum("pia,pi->a", batch.X, Vy)
            square += float(np.einsum("pi,pi->", batch.y, Vy))
            size += float(np.linalg.slogdet(V)[1].sum())
            solved.append((inverse, VX, Vy))
        values: np.ndarray = np.linalg.solve(information, score)
        return values, information, max(square - float(score @ values), 0.0), size, solved


def _batches(
    X: np.ndarray, y: np.ndarray, who: np.ndarray, levels: Sequence[np.ndarray]
) -> list[_Batch]:
    people: dict[int, list[np.ndarray]] = {}
    for person in dict.fromkeys(who):
        mine = np.flatnonzero(who == person)
        people.setdefault(len(mine), []).append(mine)
    batches = []
    for some in people.values():
        trials = np.stack(some)
        same = [level[trials][:, :, None] == level[trials][:, None, :] for level in levels]
        alike = np.stack([np.ones_like(trials[:, :, None] * trials[:, None, :]), *same])
        batches.append(_Batch(X[trials], y[trials], alike.astype(float)))
    return batches
