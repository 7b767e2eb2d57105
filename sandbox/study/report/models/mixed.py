"""The linear mixed model: a measure by condition and practice, with people as random effects.

    y = condition + practice * log2(trial) + person + person x level of each factor + residual

It is fitted by restricted maximum likelihood; the same in R is
`lmer(y ~ 0 + condition + log2_position + (1 | ppid) + (1 | ppid:factor) + ...)`. Degrees of freedom
are those of a paired t test over the people who did both levels, which is conservative: slightly
where nearly all did, clearly where few did (docs/results.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sandbox.study.report.models.comparisons import (
    Difference,
    counts_of,
    pairs_of,
    t_difference,
)
from sandbox.study.report.models.data import ObservedFactor, StudyData
from sandbox.study.report.models.intervals import has_spread, t_quantile
from sandbox.study.report.models.reml import fit_reml

if TYPE_CHECKING:
    from pandas import DataFrame

FEWEST_PEOPLE = 3
"""Smallest number of people for an estimate of the spread between people."""
PRACTICE = "log2_position"


@dataclass(frozen=True)
class Mixed:
    """A fitted model.

    Attributes:
        present: Numbers of its conditions, in order of its coefficients.
        names: Names of all coefficients: conditions, then practice if it can be estimated.
        coefficients, covariance: Fixed effects and their covariance.
        spreads: Standard deviations: person, person x factor, residual.
        people, trials: Numbers of people and trials.
        left_out: Terms for which the data do not suffice, in words.
        singular: Random effects whose standard deviation is estimated as zero.
        converged: True if the optimiser converged.
    """

    present: tuple[int, ...]
    names: tuple[str, ...]
    coefficients: np.ndarray
    covariance: np.ndarray
    spreads: dict[str, float]
    people: int
    trials: int
    left_out: tuple[str, ...]
    singular: tuple[str, ...]
    converged: bool


def fixed_effects(
    rows: DataFrame, conditions: Sequence[str]
) -> tuple[np.ndarray, list[str], list[int]]:
    """The design matrix of conditions and practice.

    Returns:
        (trials, coefficients) matrix, names, numbers of the conditions present.
    """
    present = sorted(set(rows["cell"]))
    columns = [(rows["cell"] == cell).to_numpy(float) for cell in present]
    names = [conditions[cell] for cell in present]
    practice = np.log2(rows["position"].to_numpy(float))
    # Centred, so that the coefficient of a condition is its mean in the middle of the session.
    columns.append(practice - practice.mean())
    X = np.column_stack(columns)
    if np.linalg.matrix_rank(X) < X.shape[1] or len(X) <= X.shape[1]:
        return X[:, :-1], names, present
    return X, [*names, PRACTICE], present


def random_factors(
    rows: DataFrame, factors: Sequence[ObservedFactor]
) -> tuple[list[ObservedFactor], list[str]]:
    """Factors whose effect may vary from person to person, and reasons why others cannot."""
    usable, lacking = [], []
    for factor in factors:
        if not factor.within or len(factor.levels) < 2:
            continue
        groups = rows.groupby(["ppid", factor.column]).ngroups
        if groups < len(rows) and groups > rows["ppid"].nunique():
            usable.append(factor)
        else:
            lacking.append(f"person x {factor.name}: one trial of each level")
    return usable, lacking


def fit_mixed(data: StudyData, rows: DataFrame, y: np.ndarray) -> Mixed | str:
    """Fits the model, with fewer random effects where the data do not suffice for all.

    Args:
        data: Data of the study.
        rows: MeasureModel rows of `data.used`.
        y: (rows,) measure, on the scale on which effects are additive.

    Returns:
        The model, or the reason why there is none.
    """
    people = rows["ppid"].nunique()
    if people < FEWEST_PEOPLE:
        return f"a mixed model needs at least {FEWEST_PEOPLE} participants, but there are {people}"
    X, names, present = fixed_effects(rows, data.conditions)
    if len(rows) <= X.shape[1] + people:
        return f"{len(rows)} trials are too few for {X.shape[1]} coefficients and {people} people"
    if not has_spread(float(np.ptp(y)), *y):
        return "all values are equal"
    left_out = [] if PRACTICE in names else ["practice: it cannot be separated from conditions"]
    factors, lacking = random_factors(rows, data.factors)
    left_out += lacking
    while True:
        levels = [rows[factor.column].to_numpy() for factor in factors]
        fit = fit_reml(X, y, rows["ppid"].to_numpy(), levels)
        if fit is not None:
            break
        if not factors:
            return "the mixed model cannot be fitted to these data"
        left_out.append(f"person x {factors[-1].name}: it cannot be fitted")
        factors = factors[:-1]
    effects = ["person", *(f"person x {factor.name}" for factor in factors)]
    spreads = dict(zip(effects, map(float, fit.deviations), strict=True))
    return Mixed(
        tuple(present),
        tuple(names),
        fit.coefficients,
        fit.covariance,
        {**spreads, "residual": fit.residual},
        people,
        len(rows),
        tuple(left_out),
        tuple(name for name, spread in spreads.items() if spread == 0.0),
        fit.converged,
    )


def mixed_differences(data: StudyData, rows: DataFrame, model: Mixed) -> list[Difference]:
    """Differences between all pairs of levels, by the model."""
    differences = []
    largest = float(np.abs(model.coefficients[: len(model.present)]).max())
    for pair in pairs_of(data, model.present):
        weights = np.zeros(len(model.names))
        weights[: len(model.present)] = pair.weights(len(data.conditions))[list(model.present)]
        error = float(np.sqrt(weights @ model.covariance @ weights))
        value = float(weights @ model.coefficients)
        differences.append(t_difference(pair, value, error, counts_of(pair, rows), largest))
    return differences


def practice_effect(model: Mixed) -> tuple[float, float, float] | None:
    """Change per doubling of the trials done, with its interval."""
    if PRACTICE not in model.names:
        return None
    i = model.names.index(PRACTICE)
    value, error = float(model.coefficients[i]), float(np.sqrt(model.covariance[i, i]))
    half = error * t_quantile(model.people - 1)
    return value, value - half, value + half
