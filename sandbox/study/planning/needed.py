"""Which effects a number of participants detects, and how many are needed for an effect."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import expm1, inf, log1p

from models.errors import InputError
from models.messages.wording import counted
from sandbox.study.design.balance import whole_cycle
from sandbox.study.design.design import Design
from sandbox.study.design.planned import PlannedTests, family_size, planned_tests
from sandbox.study.design.power import detectable, people_needed
from sandbox.study.planning.pilot import CAUTION, Pilot, Spread
from sandbox.study.record.folder import SIMULATED
from sandbox.study.report.models.quantities import LOG, SHARE

TO_WRITE = "TO BE WRITTEN"
"""Mark in a preregistration of what no design and no pilot says."""
NO_PEOPLE = (
    "no person took part in this pilot: its participants are simulated, and their spread says "
    "nothing about people; a pilot with people is `sandbox study run DESIGN --participant new "
    "--pilot`"
)
"""What is said of a pilot of simulated participants."""
WANTED = 0.8
"""Probability with which an effect is to be detected."""
REPETITIONS = (1, 2, 3, 5, 10, 20)
"""Numbers of repetitions for which the needed participants are told."""


@dataclass(frozen=True)
class Needs:
    """Participants that one outcome and factor need.

    Attributes:
        tests: The comparisons.
        spread: Their spread, or the reason why it is unknown.
        family: Number of all tests of the study.
    """

    tests: PlannedTests
    spread: Spread | str
    family: int

    @property
    def title(self) -> str:
        """Outcome and factor."""
        return f"{self.tests.outcome} by {self.tests.factor.name}"

    def smallest(self, participants: int, cautious: bool = False) -> float:
        """Smallest effect that so many participants detect, on the scale of the outcome: a relative
        change for logarithmic outcomes, otherwise a difference."""
        assert isinstance(self.spread, Spread)
        people, between = self.tests.people_in(participants), self.tests.between
        effect = detectable(people, self.family, between, WANTED).effect
        if effect == inf:
            return inf
        change = effect * self._deviation(self.tests.trials, cautious)
        if self.spread.scale != LOG:
            return change
        # Beyond this, it is a different world.
        return expm1(change) if change < 50.0 else inf

    def participants(
        self, change: float, trials: float | None = None, cautious: bool = False
    ) -> int | None:
        """Participants needed for an effect; None if that many are out of reach.

        Args:
            change: Relative change, or difference of shares.
            trials: Number of trials of each level; default: that of the design.
            cautious: True uses the upper limit of the spread.
        """
        assert isinstance(self.spread, Spread)
        # A change and its opposite have logarithms of different size; the smaller one is planned.
        size = log1p(change) if self.spread.scale == LOG else change
        deviation = self._deviation(self.tests.trials if trials is None else trials, cautious)
        if deviation <= 0.0:
            return None
        people = people_needed(size / deviation, self.family, self.tests.between, WANTED)
        return None if people is None else self.tests.participants_for(people)

    def _deviation(self, trials: float, cautious: bool) -> float:
        assert isinstance(self.spread, Spread)
        return self.spread.deviation(trials) * (self.spread.caution if cautious else 1.0)


def needs(design: Design, pilot: Pilot | None, guess: float) -> list[Needs]:
    """Needs of all planned tests.

    Args:
        design: Design of the study.
        pilot: What is known of its spread; None uses the guess, for completion time only.
        guess: Standard deviation over people of the difference in log completion time.
    """
    tests = planned_tests(design)
    family = family_size(tests)
    if pilot is not None:
        return [Needs(t, pilot.spreads[t.outcome, t.factor.name], family) for t in tests]
    return [
        Needs(t, Spread(LOG, 0, guess**2, 0.0, t.between, 1.0), family)
        if t.outcome == "time_s"
        else Needs(t, "a pilot must tell its spread (--from)", family)
        for t in tests
    ]


def power_lines(
    design: Design,
    participants: int,
    pilot: Pilot | None = None,
    guess: float = 0.3,
    change: float | None = None,
    marked: bool = False,
) -> Iterator[str]:
    """Lines that say what can be detected.

    Args:
        design: Design of the study.
        participants: Number of participants.
        pilot: What is known of the spread; None uses the guess.
        guess: See `needs`.
        change: Wanted effect; None tells no numbers of participants.
        marked: True marks every comparison without power as to be written, as in a preregistration.
    """
    some = needs(design, pilot, guess)
    if not some:
        yield "nothing is tested: no factor has two levels"
        return
    if pilot is not None:
        yield (
            f"from {pilot.name} ({pilot.mode}): {counted(pilot.people, 'person', 'people')}, "
            f"{counted(pilot.trials, 'trial')}, "
            f"{100 * pilot.success:.0f} % with success; its spread and success rates are used, its "
            "effects are not"
        )
        if pilot.mode == SIMULATED:
            yield NO_PEOPLE
        elif pilot.rehearsed:
            yield pilot.rehearsed
        yield (
            f"cautious: with the upper limit of the spread, below which it is with probability "
            f"{CAUTION:g}, as a pilot of few people may show too little"
        )
    yield (
        f"two-sided tests with probability {WANTED:g} of finding the effect, alpha 0.05 over "
        f"{some[0].family} tests: "
        + ", ".join(dict.fromkeys(one.tests.outcome for one in some))
        + ("" if design.primary else " (the design names no primary outcome, so all are tested)")
    )
    for one in some:
        if not isinstance(one.spread, str):
            yield from _lines(design, one, participants, change)
        elif marked:
            yield unknown_power(one)
        else:
            yield f"{one.title}: {one.spread}"


def unknown_power(one: Needs) -> str:
    """Line of a preregistration on a comparison without power, whose spread is a reason."""
    return f"{TO_WRITE}: power of {one.title}, because {one.spread}"


def _lines(design: Design, one: Needs, participants: int, change: float | None) -> Iterator[str]:
    assert isinstance(one.spread, Spread)
    spread, trials = one.spread, one.tests.trials
    known = spread.people > 0
    groups = " in groups" if one.tests.between else ""
    told = f"{spread.deviation(trials):.2g}"
    if spread.scale == LOG:
        told += f" of log {one.tests.outcome}" if known else " of log time, a guess"
    yield (
        f"{one.title}: {participants} participants{groups} detect "
        f"{_said(spread.scale, one.smallest(participants))}"
        + (f", cautious {_said(spread.scale, one.smallest(participants, True))}" if known else "")
        + f"; standard deviation over people {told}"
        + (f" with {trials:g} trials of each level" if spread.single else "")
    )
    if change is None or spread.scale not in (LOG, SHARE):
        return
    yield (
        f"  {_said(spread.scale, change)} needs {_count(design, one.participants(change))}"
        + (f", cautious {_count(design, one.participants(change, None, True))}" if known else "")
    )
    if spread.single:
        each = trials / design.repetitions
        rows = [(n, one.participants(change, n * each)) for n in REPETITIONS]
        yield "  repetitions and participants: " + ", ".join(
            f"{n}: {'more than 10 000' if p is None else p}" for n, p in rows
        )


def _said(scale: str, effect: float) -> str:
    if effect == inf:
        return "no change" if scale == LOG else "no difference"
    if scale == LOG:
        return f"a change of {100 * effect:.0f} %"
    if scale == SHARE:
        return f"a difference of {100 * effect:.0f} points"
    return f"a difference of {effect:.3g}"


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
