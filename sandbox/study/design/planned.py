"""The tests that the report will make of a study, from its design."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from math import ceil

from sandbox.study.design.design import END, START, Design, Factor
from sandbox.study.design.plan import session_plan, trials_of


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


def trials_each(design: Design, factor: Factor) -> float:
    """Mean number of trials of a participant with a level of a factor, without practice."""
    counted = Counter(
        trial.levels[factor.name]
        for session in range(1, design.sessions + 1)
        for trial in trials_of(session_plan(design, 0, session))
        if not trial.practice
    )
    return sum(counted.values()) / len(counted)


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
