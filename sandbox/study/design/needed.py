"""Which effects a number of participants detects, and how many are needed for an effect."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import expm1, inf, log1p

from models.errors import InputError
from sandbox.study.design.balance import whole_cycle
from sandbox.study.design.design import Design
from sandbox.study.design.planned import PlannedTests, family_size, planned_tests
from sandbox.study.design.power import SPREAD, detectable, people_needed

WANTED = 0.8
"""Probability with which an effect is to be detected."""


@dataclass(frozen=True)
class Needs:
    """Participants that one outcome and factor need.

    Attributes:
        tests: The comparisons.
        spread: Standard deviation over people of the difference in log time; None if unknown.
        family: Number of all tests of the study.
    """

    tests: PlannedTests
    spread: float | None
    family: int

    @property
    def title(self) -> str:
        """Outcome and factor."""
        return f"{self.tests.outcome} by {self.tests.factor.name}"

    def smallest(self, participants: int) -> float:
        """Smallest relative change of time that so many participants detect."""
        assert self.spread is not None
        people, between = self.tests.people_in(participants), self.tests.between
        effect = detectable(people, self.family, between, WANTED).effect
        if effect == inf:
            return inf
        change = effect * self.spread
        # Beyond this, it is a different world.
        return expm1(change) if change < 50.0 else inf

    def participants(self, change: float) -> int | None:
        """Participants needed for a relative change of time; None if that many are out of reach."""
        assert self.spread is not None
        # A change and its opposite have logarithms of different size; the smaller one is planned.
        size = log1p(change)
        people = people_needed(size / self.spread, self.family, self.tests.between, WANTED)
        return None if people is None else self.tests.participants_for(people)


def needs(design: Design, guess: float = SPREAD) -> list[Needs]:
    """Needs of all planned tests.

    Args:
        design: Design of the study.
        guess: Standard deviation over people of the difference in log completion time.
    """
    tests = planned_tests(design)
    family = family_size(tests)
    return [Needs(t, guess if t.outcome == "time_s" else None, family) for t in tests]


def power_lines(
    design: Design, participants: int, guess: float = SPREAD, change: float | None = None
) -> Iterator[str]:
    """Lines that say what can be detected.

    Args:
        design: Design of the study.
        participants: Number of participants.
        guess: See `needs`.
        change: Wanted effect; None tells no numbers of participants.
    """
    some = needs(design, guess)
    if not some:
        yield "nothing is tested: no factor has two levels"
        return
    yield (
        f"two-sided tests with probability {WANTED:g} of finding the effect, alpha 0.05 over "
        f"{some[0].family} tests: "
        + ", ".join(dict.fromkeys(one.tests.outcome for one in some))
        + ("" if design.primary else " (the design names no primary outcome, so all are tested)")
    )
    for one in some:
        if one.spread is None:
            yield f"{one.title}: its spread between people is unknown, so its power is, too"
        else:
            yield from _lines(design, one, participants, change)


def _lines(design: Design, one: Needs, participants: int, change: float | None) -> Iterator[str]:
    groups = " in groups" if one.tests.between else ""
    yield (
        f"{one.title}: {participants} participants{groups} detect "
        f"{_said(one.smallest(participants))}; standard deviation over people {one.spread:.2g} of "
        "log time, a guess"
    )
    if change is not None:
        yield f"  {_said(change)} needs {_count(design, one.participants(change))}"


def _said(effect: float) -> str:
    return "no change" if effect == inf else f"a change of {100 * effect:.0f} %"


def _count(design: Design, participants: int | None) -> str:
    if participants is None:
        return "more than 10 000 participants"
    cycle = whole_cycle(design)
    whole = -(-participants // cycle) * cycle
    full = "" if whole == participants else f" ({whole} fill the orders)"
    return f"{participants} participants{full}"


def change_of(text: str) -> float:
    """The effect of `--detect`, such as 15% or 0.15.

    Raises:
        InputError: It is not a positive change.
    """
    try:
        value = float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        value = -1.0
    if not 0.0 < value < 10.0:
        raise InputError(
            "not a change that can be planned for",
            where="--detect",
            got=text,
            expected="a positive change, such as 15%",
        )
    return value
