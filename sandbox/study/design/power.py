"""The tests that the report will make of a study, and their power: which differences a number of
people can find, and how many people a difference takes.

Differences are in standard deviations: of the difference between two levels over people, if each
person does both; of people, if each does one. The tests are two-sided t tests at the level of
Holm's first step: 0.05 divided by the number of tests of the study.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, groupby
from math import ceil, inf, isnan, sqrt

from models.message import counted
from sandbox.study.design.balance import whole_cycle
from sandbox.study.design.design import Design, Factor
from sandbox.study.design.fields import END, START

ALPHA = 0.05
"""Probability of any false finding in a study without differences, at most."""
WANTED = 0.8
"""Probability with which a difference is to be found."""
MOST = 50.0
"""Largest difference that is looked for, in standard deviations."""
PRECISION = 1e-9
"""Precision of a difference, in standard deviations."""
MOST_PEOPLE = 10_000
"""Largest number of people that is looked for."""


@dataclass(frozen=True)
class PlannedTests:
    """The comparisons of one outcome between the levels of one factor.

    Attributes:
        outcome: A measure, or a questionnaire for its score.
        factor: The factor.
        pairs: Number of compared pairs of levels.
        share: Share of the participants who do one of two compared levels; of several pairs the
            least.
    """

    outcome: str
    factor: Factor
    pairs: int
    share: Fraction

    @property
    def between(self) -> bool:
        """True if each participant does one level only."""
        return self.factor.order == "between"

    def people_in(self, participants: int) -> int:
        """Number of participants who do one of two levels, of so many in the study."""
        return int(participants * self.share)

    def participants_for(self, people: int) -> int:
        """Number of participants of whom so many do one of two levels."""
        return ceil(people / self.share)


def planned_tests(design: Design) -> list[PlannedTests]:
    """All tests, by outcome and factor: of primary outcomes, or of all if the design names none."""
    forms = {f.name: f for f in design.questionnaires if f.scales and f.at not in (START, END)}
    outcomes = design.primary or ("time_s", "success", *forms)
    found = []
    for outcome in outcomes:
        for factor in design.factors:
            if outcome in forms and forms[outcome].at != factor.name:
                continue
            pairs = _pairs(factor)
            if pairs:
                found.append(PlannedTests(outcome, factor, len(pairs), _share(design, factor)))
    return found


def family_size(tests: list[PlannedTests]) -> int:
    """Number of tests of the study, which its p values are adjusted for."""
    return sum(test.pairs for test in tests)


def _pairs(factor: Factor) -> dict[frozenset[str], list[int]]:
    """Pairs of levels that occur together, as those of a nested factor need not; of each, the
    numbers of levels of the lists that it is in."""
    lists = factor.nested.values() if factor.nested else [factor.levels]
    found: dict[frozenset[str], list[int]] = {}
    for levels in lists:
        for pair in combinations([level.name for level in levels], 2):
            found.setdefault(frozenset(pair), []).append(len(levels))
    return found


def _share(design: Design, factor: Factor) -> Fraction:
    """Share of the participants who do one of two levels; of several pairs the least.

    Of a factor inside of one that is between participants, only those of the groups that have the
    pair do it.
    """
    outer = next((f for f in design.factors if f.name == factor.outer), None)
    groups = len(outer.levels) if outer is not None and outer.order == "between" else None
    shares = []
    for sizes in _pairs(factor).values():
        each = [Fraction(2, n) if factor.order == "between" else Fraction(1) for n in sizes]
        # any order: fractions are exact
        shares.append(sum(each, Fraction(0)) / (groups or len(each)))
    return min(shares)


def power(effect: float, n: int, alpha: float = ALPHA, between: bool = False) -> float:
    """Probability of finding a difference with a two-sided t test, in the direction that it has.

    Args:
        effect: The difference, in standard deviations.
        n: Number of people; between participants, half of them are in each group.
        alpha: Significance level of the test.
        between: True for two groups instead of pairs.
    """
    # Not `scipy.stats`, which takes half a second to load, where that knows the number.
    from scipy.special import nctdtr, stdtrit

    freedom = n - 2 if between else n - 1
    if freedom < 1:
        return 0.0
    limit = stdtrit(freedom, 1.0 - alpha / 2)
    # The tail of the wrong direction is left out: SciPy has no number for it where it is tiny.
    shift = effect * sqrt(n / 4 if between else n)
    missed = float(nctdtr(freedom, shift, limit))
    if isnan(missed):
        from scipy import stats

        return float(stats.nct.sf(limit, freedom, shift))
    return 1.0 - missed


def detectable(n: int, tests: int = 1, between: bool = False) -> float:
    """The smallest difference that n people find, in standard deviations; infinite if none up to
    `MOST` is.

    Args:
        n: Number of people.
        tests: Number of tests of the study.
        between: True for two groups instead of pairs.
    """
    low, high = 0.0, 1.0
    while power(high, n, ALPHA / tests, between) < WANTED:
        if high >= MOST:
            return inf
        low, high = high, min(2.0 * high, MOST)
    while high - low > PRECISION:
        middle = (low + high) / 2.0
        if power(middle, n, ALPHA / tests, between) < WANTED:
            low = middle
        else:
            high = middle
    return high


def people_needed(effect: float, tests: int = 1, between: bool = False) -> int | None:
    """The smallest number of people who find a difference; even for two groups, and None if it is
    above `MOST_PEOPLE`.

    Args:
        effect: The difference, in standard deviations.
        tests, between: As for `detectable`.
    """
    step = 2 if between else 1
    low, high = 2 // step, MOST_PEOPLE // step + 1
    while high - low > 1:
        middle = (low + high) // 2
        enough = power(effect, middle * step, ALPHA / tests, between) >= WANTED
        low, high = (low, middle) if enough else (middle, high)
    return high * step if high * step <= MOST_PEOPLE else None


def power_lines(design: Design, participants: int, effect: float | None = None) -> Iterator[str]:
    """Lines that say what can be found, one for each factor.

    Args:
        design: Design of the study.
        participants: Number of participants; twice as many are shown beside it.
        effect: A difference in standard deviations, for the number of participants that it takes.
    """
    tests = planned_tests(design)
    family = family_size(tests)
    if not tests:
        yield "nothing is tested: no factor has two levels"
        return
    outcomes = ", ".join(dict.fromkeys(test.outcome for test in tests))
    yield (
        f"tested are {outcomes}"
        + ("" if design.primary else " (no [analysis] primary names fewer)")
        + f": {family} {'tests' if family > 1 else 'test'}, of which Holm's first step needs "
        f"p < {ALPHA / family:.3g}"
    )
    by_factor = groupby(
        sorted(tests, key=lambda t: design.factors.index(t.factor)), lambda t: t.factor.name
    )
    for name, some in by_factor:
        test = next(some)
        kind = "between groups" if test.between else "between two levels"
        first, second = (_smallest(test, n, family) for n in (participants, 2 * participants))
        people = counted(participants, "participant")
        yield (
            f"{name}: {people} find a difference {kind} of {first} with probability {WANTED:g}; "
            f"{2 * participants} find {second}"
        )
        if effect is not None:
            needed = people_needed(effect, family, test.between)
            yield f"  {effect:g} SD takes {_count(design, test, needed)}"
    yield "SD: standard deviation over people, of their differences or, of groups, of people"


def _smallest(test: PlannedTests, participants: int, family: int) -> str:
    found = detectable(test.people_in(participants), family, test.between)
    return "no size" if found == inf else f"{found:.2f} SD"


def _count(design: Design, test: PlannedTests, people: int | None) -> str:
    if people is None:
        return f"more than {MOST_PEOPLE} participants"
    participants, cycle = test.participants_for(people), whole_cycle(design)
    whole = -(-participants // cycle) * cycle
    full = "" if whole == participants else f" ({whole} fill the orders)"
    return f"{participants} participants{full}"
