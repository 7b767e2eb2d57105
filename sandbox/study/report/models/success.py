"""Success: shares of trials, their differences between levels, and odds.

Differences are computed from the shares of single people, which are the independent values. Their
limits come from Wilson's intervals for clustered trials, so that they have a width even if all
trials succeeded. P values come from exact or random permutations of the signs of people's
differences, or of people's groups. Odds ratios come from generalised estimating equations; they
need successes and failures in every condition.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import nan

import numpy as np

from sandbox.study.report.models.comparisons import (
    Difference,
    Pair,
    counts_of,
    pairs_of,
    t_difference,
)
from sandbox.study.report.models.data import StudyData, to_numbers
from sandbox.study.report.models.intervals import (
    Estimate,
    Share,
    correlation_of,
    design_effect,
    difference,
    has_spread,
    share,
)
from sandbox.study.report.models.mixed import FEWEST_PEOPLE, fixed_effects

EXACT = 12
"""Largest number of people for which all combinations of signs are used."""
DRAWS = 10_000
"""Number of random permutations for more people."""


@dataclass(frozen=True)
class ShareDifference:
    """Difference in success between a pair of levels.

    Attributes:
        pair: The levels.
        first, second: Shares over the conditions in which both occur.
        estimate: Second minus first.
        p: P value of the permutation test; nan with fewer than two people.
        people: Number of people who did both levels; between people, either level.
        spread: Standard deviation over people of the difference; of two groups, that within them.
    """

    pair: Pair
    first: Share
    second: Share
    estimate: Estimate
    p: float
    people: int
    spread: float

    @property
    def size(self) -> float:
        """Standardised effect: dz within people, Cohen's d between groups; nan if unknown."""
        return self.estimate.value / self.spread if has_spread(self.spread) else nan


def rates(data: StudyData, name: str = "success") -> tuple[list[str], np.ndarray, np.ndarray]:
    """Share of success of every person in every condition.

    Args:
        data: Data of the study.
        name: Name of the measure, whose values are 0 and 1.

    Returns:
        Pseudonyms; shares (people, conditions), nan without a trial; numbers of trials.
    """
    people = data.ppids
    row = {ppid: i for i, ppid in enumerate(people)}
    done = np.zeros((len(people), len(data.conditions)))
    won = np.zeros_like(done)
    values = to_numbers(data.used[name])
    used = data.used[values.notna()]
    where = (used["ppid"].map(row).to_numpy(int), used["cell"].to_numpy(int))
    np.add.at(done, where, 1.0)
    np.add.at(won, where, values[values.notna()].to_numpy(float))
    return people, np.divide(won, done, out=np.full_like(done, nan), where=done > 0), done


def success_differences(
    data: StudyData, name: str = "success", pairs: Sequence[Pair] | None = None
) -> list[ShareDifference]:
    """Differences of pairs of levels in success or another measure of 0 and 1; default: all."""
    if not len(data.used):
        return []
    _, own, done = rates(data, name)
    usual = design_effect(*_overall(own, done))
    wanted = pairs_of(data) if pairs is None else pairs
    return [_compare(pair, own, done, usual) for pair in wanted]


def _overall(own: np.ndarray, done: np.ndarray) -> tuple[list[float], list[int]]:
    who = done.any(axis=1)
    return list(np.nanmean(own[who], axis=1)), [int(n) for n in done[who].sum(axis=1)]


def _compare(pair: Pair, own: np.ndarray, done: np.ndarray, usual: float) -> ShareDifference:
    first, second = (np.array(side) for side in zip(*pair.cells, strict=True))
    a, b, n, m = own[:, first], own[:, second], done[:, first], done[:, second]
    if pair.factor.within:
        both = np.isfinite(a) & np.isfinite(b)
        who = both.any(axis=1)
        a, b = (np.nanmean(np.where(both, x, nan)[who], axis=1) for x in (a, b))
        n, m = (np.where(both, x, 0.0)[who].sum(axis=1) for x in (n, m))
        tied = correlation_of(a, b)
        p, people, spread = sign_test(b - a), len(a), _deviation(b - a)
    else:
        one, two = np.isfinite(a).any(axis=1), np.isfinite(b).any(axis=1)
        a, b = np.nanmean(a[one], axis=1), np.nanmean(b[two], axis=1)
        n, m = n[one].sum(axis=1), m[two].sum(axis=1)
        tied, p, people = 0.0, group_test(a, b), len(a) + len(b)
        spread = _deviation(np.concatenate([a - a.mean(), b - b.mean()]), 2)
    low, high = (share(list(x), [int(i) for i in k], usual) for x, k in ((a, n), (b, m)))
    if people < 2:
        return ShareDifference(
            pair, low, high, Estimate(high.value - low.value, nan, nan), nan, people, nan
        )
    return ShareDifference(pair, low, high, difference(high, low, tied), p, people, spread)


def _deviation(values: np.ndarray, groups: int = 1) -> float:
    """Standard deviation, for means of so many groups; nan with too few values, 0 of equal ones."""
    if len(values) <= groups:
        return nan
    spread = float(values.std(ddof=groups))
    return spread if has_spread(spread) else 0.0


def sign_test(differences: np.ndarray) -> float:
    """P value of the hypothesis that differences are symmetric about 0, by permutation of signs."""
    d = differences[differences != 0.0]
    if len(differences) < 2:
        return nan
    if not len(d):
        return 1.0
    if len(d) <= EXACT:
        signs = np.array(list(product((-1.0, 1.0), repeat=len(d))))
        extra = 0
    else:
        signs = np.random.default_rng(len(d)).choice((-1.0, 1.0), (DRAWS, len(d)))
        extra = 1
    as_extreme = np.abs(signs @ d) >= abs(d.sum()) - 1e-9
    return float((as_extreme.sum() + extra) / (len(as_extreme) + extra))


def group_test(a: np.ndarray, b: np.ndarray) -> float:
    """P value of the hypothesis that two groups are equal, by permutation of groups."""
    if len(a) < 2 or len(b) < 2:
        return nan
    x = np.concatenate([a, b])
    rng = np.random.default_rng(len(x))
    drawn = rng.permuted(np.tile(x, (DRAWS, 1)), axis=1)
    gaps = np.abs(drawn[:, : len(a)].mean(axis=1) - drawn[:, len(a) :].mean(axis=1))
    return float(((gaps >= abs(a.mean() - b.mean()) - 1e-9).sum() + 1) / (DRAWS + 1))


def odds(data: StudyData) -> list[Difference] | str:
    """Log odds ratios of success of all pairs of levels, or why there are none.

    By generalised estimating equations.

    Trials of a person are exchangeable; errors are those of Mancl and DeRouen 2001 for few people.
    """
    from statsmodels.genmod.cov_struct import Exchangeable
    from statsmodels.genmod.families import Binomial
    from statsmodels.genmod.generalized_estimating_equations import GEE

    used = data.used
    if used["ppid"].nunique() < FEWEST_PEOPLE:
        return f"odds ratios need at least {FEWEST_PEOPLE} participants"
    shares = used.groupby("condition")["success"].mean()
    flat = [name for name in data.conditions if shares[name] in (0.0, 1.0)]
    if flat:
        return "odds are not finite, since all or no trials succeeded in: " + "; ".join(flat[:6])
    X, names, present = fixed_effects(used, data.conditions)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            fit = GEE(
                used["success"].to_numpy(),
                X,
                groups=used["ppid"].to_numpy(),
                family=Binomial(),
                cov_struct=Exchangeable(),
            ).fit(cov_type="bias_reduced")
        except (np.linalg.LinAlgError, ValueError) as wrong:
            return f"the equations cannot be solved here: {wrong}"
    values, covariance = np.asarray(fit.params), np.asarray(fit.cov_params())
    if not (np.isfinite(values).all() and np.isfinite(covariance).all()):
        return "the equations have no finite solution here"
    differences = []
    for pair in pairs_of(data, present):
        weights = np.zeros(len(names))
        weights[: len(present)] = pair.weights(len(data.conditions))[present]
        error = float(np.sqrt(weights @ covariance @ weights))
        differences.append(
            t_difference(pair, float(weights @ values), error, counts_of(pair, used))
        )
    return differences
