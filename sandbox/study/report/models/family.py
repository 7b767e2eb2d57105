"""What a study tests, and p values adjusted for all of it (Holm 1979).

If the design names primary outcomes, only these are tested, and everything else is exploratory:
estimates with intervals. Otherwise completion time, success, the measures asked for, and one score
of every questionnaire are tested. All tests of the study are one family.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan

from sandbox.study.report.models.comparisons import Pair
from sandbox.study.report.models.data import SESSION
from sandbox.study.report.models.fitted import Fitted
from sandbox.study.report.models.intervals import holm

ALPHA = 0.05
"""Probability of any false finding in a study without differences, at most."""
CONFIRMATORY, EXPLORATORY = "confirmatory", "exploratory"


@dataclass(frozen=True)
class Tested:
    """A test of the study.

    Attributes:
        outcome: Name of the measure, or of the questionnaire.
        pair: The compared levels.
        p: P value of this test alone; nan where it cannot be computed.
        p_holm: P value adjusted for all tests of the study whose p value can be computed.
    """

    outcome: str
    pair: Pair
    p: float
    p_holm: float

    @property
    def found(self) -> bool:
        """True if the difference is a finding."""
        return self.p_holm < ALPHA


@dataclass(frozen=True)
class Family:
    """All tests of a study.

    Attributes:
        primary: Primary outcomes of the design; empty if it names none.
        tests: The tests.
    """

    primary: tuple[str, ...]
    tests: tuple[Tested, ...]

    @property
    def adjusted_for(self) -> int:
        """Number of tests that p values are adjusted for: those whose p value can be computed."""
        return sum(isfinite(test.p) for test in self.tests)

    @property
    def findings(self) -> list[Tested]:
        """The tests that found a difference."""
        return [test for test in self.tests if test.found]

    @property
    def missing(self) -> list[str]:
        """Primary outcomes that these data cannot compare."""
        tested = {test.outcome for test in self.tests}
        return [name for name in self.primary if name not in tested]

    def test(self, outcome: str, pair: Pair) -> Tested | None:
        """The test of a pair of levels; None if it is exploratory."""
        key = (outcome, *_names(pair))
        return next((t for t in self.tests if (t.outcome, *_names(t.pair)) == key), None)

    def p_values(self, outcome: str, pair: Pair) -> tuple[float, float]:
        """P value and adjusted p value of a pair of levels; nan if it is exploratory."""
        test = self.test(outcome, pair)
        return (test.p, test.p_holm) if test else (nan, nan)

    def role(self, outcome: str) -> str:
        """`CONFIRMATORY` for a tested outcome, `EXPLORATORY` for all others."""
        tested = any(test.outcome == outcome for test in self.tests)
        return CONFIRMATORY if tested else EXPLORATORY


def family_of(fitted: Fitted, primary: Sequence[str]) -> Family:
    """Tests the primary outcomes.

    Args:
        fitted: Models of the study.
        primary: Primary outcomes of the design; if it names none, all outcomes are tested.
    """
    # What changes from session to session is practice, which the design does not compare.
    unplanned = SESSION if fitted.data.by_session else ""
    pairs = [
        (outcome, one)
        for outcome in primary or fitted.outcomes
        for one in fitted.pairs(outcome)
        if one.pair.factor.name != unplanned
    ]
    adjusted = holm([one.p for _, one in pairs])
    tests = (
        Tested(outcome, one.pair, one.p, p)
        for (outcome, one), p in zip(pairs, adjusted, strict=True)
    )
    return Family(tuple(primary), tuple(tests))


def _names(pair: Pair) -> tuple[str, str, str]:
    return pair.factor.name, pair.first, pair.second
