"""The tests that the report makes of a study, and their power.

The power says which difference a number of people can find, and how many people are needed to find
a difference. Differences are in units of a standard deviation (SD) over people. If each person does
both levels, this is the SD of the difference between the levels. If each person does one level, it
is the SD of the person's value. The tests are two-sided t tests at the level of Holm's first step:
0.05 divided by the number of tests of the study.
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
"""Largest probability that a study without any real difference has a false finding."""
WANTED = 0.8
"""Probability with which a difference should be found."""
MOST = 50.0
"""Upper limit of the search for a difference, in standard deviations."""
PRECISION = 1e-9
"""Precision of a difference, in standard deviations."""
MOST_PEOPLE = 10_000
"""Upper limit of the search for a number of people."""


@dataclass(frozen=True)
class PlannedTests:
    """The comparisons of one outcome between the levels of one factor.

    Attributes:
        outcome: Name of a measure, or of a questionnaire, whose score is compared.
        factor: The factor.
        pairs: Number of compared pairs of levels.
        share: Share of the participants who do at least one level of a compared pair; the smallest
            share if there are several pairs.
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
        """Number of people in one comparison, if the study has so many participants."""
        return int(participants * self.share)

    def participants_for(self, people: int) -> int:
        """Number of participants that the study needs for so many people in one comparison."""
        return ceil(people / self.share)


def planned_tests(design: Design) -> list[PlannedTests]:
    """All tests, by outcome and factor.

    Tested are the primary outcomes of the design, or all outcomes if it names none.
    """
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
    """Number of tests of the study, for which the p values are adjusted."""
    return sum(test.pairs for test in tests)


def _pairs(factor: Factor) -> dict[frozenset[str], list[int]]:
    """Pairs of levels that occur in the same list, with the lengths of all lists with the pair.

    A nested factor has several lists, and two of its levels need not be in the same list.
    """
    found: dict[frozenset[str], list[int]] = {}
    for levels in factor.lists:
        for pair in combinations([level.name for level in levels], 2):
            found.setdefault(frozenset(pair), []).append(len(levels))
    return found


def _share(design: Design, factor: Factor) -> Fraction:
    """Share of the participants who do at least one level of a pair; the smallest over all pairs.

    If the outer factor is between participants, only groups whose levels have the pair count.
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
    """Probability that a two-sided t test finds a difference, with its true direction.

    Args:
        effect: The difference, in standard deviations.
        n: Number of people; between participants, half of them are in each group.
        alpha: Significance level of the test.
        between: True for two groups instead of pairs.
    """
    # `scipy.stats` takes half a second to load, so it is loaded only if `nctdtr` gives NaN.
    from scipy.special import nctdtr, stdtrit

    freedom = n - 2 if between else n - 1
    if freedom < 1:
        return 0.0
    limit = stdtrit(freedom, 1.0 - alpha / 2)
    # The tail of the wrong direction is left out: SciPy cannot compute it where it is tiny.
    shift = effect * sqrt(n / 4 if between else n)
    missed = float(nctdtr(freedom, shift, limit))
    if isnan(missed):
        from scipy import stats

        return float(stats.nct.sf(limit, freedom, shift))
    return 1.0 - missed


def detectable(n: int, tests: int = 1, between: bool = False) -> float:
    """The smallest difference that n people find, in standard deviations.

    It is infinite if they do not find a difference of `MOST`.

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
    """The smallest number of people who find a difference; None if it is above `MOST_PEOPLE`.

    For two groups, the number is even.

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
    """Lines on the tests of a study, and on the differences that they can find for each factor.

    Args:
        design: Design of the study.
        participants: Number of participants; the lines also describe twice as many.
        effect: A difference in standard deviations; if given, the lines have the number of
            participants that is needed to find it.
    """
    tests = planned_tests(design)
    family = family_size(tests)
    if not tests:
        yield "nothing is tested: no factor has two levels"
        return
    outcomes = ", ".join(dict.fromkeys(test.outcome for test in tests))
    yield (
        f"outcomes tested: {outcomes}"
        + ("" if design.primary else " (all, since [analysis] has no primary)")
        + f"; {family} {'tests' if family > 1 else 'test'}; Holm's first step needs "
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
            f"{name}: {people} detect a difference {kind} of {first} with probability {WANTED:g}; "
            f"{2 * participants} detect {second}"
        )
        if effect is not None:
            needed = people_needed(effect, family, test.between)
            yield f"  to find {effect:g} SD takes {_count(design, test, needed)}"
    yield (
        "SD: standard deviation over people, of the difference between the levels; between groups, "
        "of each person's value"
    )


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
