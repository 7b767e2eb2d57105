"""Flaws of the number of people: so few that even a large effect is hardly ever found."""

from __future__ import annotations

from collections.abc import Iterator

from models.messages.wording import counted
from sandbox.study.design.design import Design
from sandbox.study.design.planned import family_size, planned_tests
from sandbox.study.design.power import people_needed, power
from sandbox.study.design.told.flaw import Flaw

LARGE = 0.8
"""Standard deviations; a large effect by the convention of Cohen 1988."""
HOPELESS = 1 / 3
"""Probability of finding it, below which a study says next to nothing."""
ALPHA = 0.05


def detection_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of the number of people, by the planned tests of the design: one line."""
    tests = planned_tests(design)
    family = family_size(tests)
    chances = {}
    for test in tests:
        people = test.people_in(design.participants)
        chances[test.factor.name] = power(LARGE, people, ALPHA / family, test.between)
    poor = {name: chance for name, chance in chances.items() if chance < HOPELESS}
    if not poor:
        return
    names, best = " and ".join(poor), max(poor.values())
    first = next(test for test in tests if test.factor.name in poor)
    needed = people_needed(LARGE, family, first.between)
    enough = f"{first.participants_for(needed)}" if needed else "many more"
    yield Flaw(
        ("participants",),
        f"{counted(design.participants, 'person', 'people')} can find even a large effect of "
        f"{names} ({LARGE:g} standard deviations) with probability "
        f"{max(best, 0.01):.2f} at most, in {family} "
        f"{'tests' if family > 1 else 'test'}",
        f"Write participants = {enough} or more"
        + (", or fewer outcomes in [analysis] primary" if family > 1 else "")
        + "; see `plan --power`",
    )
