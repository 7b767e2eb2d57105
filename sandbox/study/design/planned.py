"""The tests that the report will make of a study, from its design."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from itertools import combinations

from sandbox.study.design.design import END, START, Design, Factor
from sandbox.study.design.plan import session_plan, trials_of


@dataclass(frozen=True)
class PlannedTests:
    """The comparisons of one outcome between the levels of one factor.

    Attributes:
        outcome: A measure, or a questionnaire for its score.
        factor: The factor.
        pairs: Number of compared pairs of levels.
        trials: Number of trials of a participant with each level; 1 for a score.
    """

    outcome: str
    factor: Factor
    pairs: int
    trials: float

    @property
    def between(self) -> bool:
        """True if each participant does one level only."""
        return self.factor.order == "between"

    def people_in(self, participants: int) -> int:
        """Number of participants who do one of two levels, of so many in the study."""
        return 2 * participants // len(self.factor.levels) if self.between else participants

    def participants_for(self, people: int) -> int:
        """Number of participants of whom so many do one of two levels."""
        return -(-people * len(self.factor.levels) // 2) if self.between else people


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
                trials = 1.0 if outcome in forms else trials_each(design, factor)
                found.append(PlannedTests(outcome, factor, pairs, trials))
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


def _pairs(factor: Factor) -> int:
    """Number of pairs of levels that occur together; levels of a nested factor need not."""
    lists = factor.nested.values() if factor.nested else [factor.levels]
    return len(
        {
            frozenset(pair)
            for levels in lists
            for pair in combinations([level.name for level in levels], 2)
        }
    )
