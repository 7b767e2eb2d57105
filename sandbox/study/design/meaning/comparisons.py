"""Flaws of what is compared: levels, their orders, and the groups that meet them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import combinations

from sandbox.study.design.balance import confounded, nearest_cycles
from sandbox.study.design.design import Design, Factor, Level
from sandbox.study.design.plan import session_plan, trials_of
from sandbox.study.design.told.flaw import Flaw

FEWEST = 2
"""People in a group of which a spread can be told."""
UNEVEN = 0.5
"""Share by which a level may be more or less often at a place than on average, by chance."""
MOST_PEOPLE = 200
"""People whose random orders are counted; by chance, those of more are even enough."""


def comparison_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of all factors."""
    for i, factor in enumerate(design.factors):
        yield from _levels(design, i, factor)
        if len(factor.levels) > 1:
            yield from _order(design, i, factor)
    yield from _set_twice(design)
    missing = confounded(design, design.participants)
    if missing:
        yield Flaw(
            ("participants",),
            f"{design.participants} people are no full cycle, so this is confounded: "
            + "; ".join(missing),
            f"Write {nearest_cycles(design, design.participants)}",
        )


def _levels(design: Design, i: int, factor: Factor) -> Iterator[Flaw]:
    path = ("factors", i, "levels")
    if len(factor.levels) == 1:
        yield Flaw(
            path,
            f"{factor.name} has one level, {factor.levels[0].name}, so nothing is compared",
            "Add a level, or move the setting to [settings]",
        )
        return
    pairs = [(a, b, _differences(design, a, b)) for a, b in combinations(factor.levels, 2)]
    for a, b, differences in pairs:
        if not differences:
            yield Flaw(
                path,
                f"{a.name} and {b.name} are the same: they set the same values",
                "Change one of them, or remove it",
            )
    mixed = [(a, b, d) for a, b, d in pairs if len(d) > 1]
    if len(mixed) == len(pairs):
        a, b, differences = mixed[0]
        yield Flaw(
            path,
            f"levels of {factor.name} differ in several settings at once ({a.name} and {b.name} in "
            f"{' and '.join(differences)}), so it cannot be told which of them makes a difference",
            "Make a factor of each setting, unless they are compared as wholes",
        )


def _differences(design: Design, a: Level, b: Level) -> list[str]:
    """Settings in which two levels differ."""
    names = dict.fromkeys((*a.settings, *b.settings))
    one, other = ({**design.settings, **level.settings} for level in (a, b))
    return [name for name in names if one.get(name) != other.get(name)]


def _order(design: Design, i: int, factor: Factor) -> Iterator[Flaw]:
    path = ("factors", i, "order")
    if factor.order == "blocked":
        what = "the session in which it comes" if factor.one_a_session else "practice"
        yield Flaw(
            path,
            f"everybody has the levels of {factor.name} in the same order, so its effect "
            f"cannot be told from {what}",
            "Write latin or random, unless you do not compare these levels",
        )
    elif factor.order == "between" and design.participants < FEWEST * len(factor.levels):
        yield Flaw(
            path,
            f"{design.participants} people in {len(factor.levels)} groups: what a level of "
            f"{factor.name} does cannot be told from who met it",
            f"Write participants = {FEWEST * len(factor.levels)} or many more, or order latin",
        )
    elif factor.order == "random" and design.participants <= MOST_PEOPLE:
        uneven = _by_chance(design, factor)
        if uneven:
            yield Flaw(
                path,
                f"by chance, with this seed, {uneven}, so that {factor.name} is confounded with "
                "practice",
                "Write latin, or let more people take part",
            )


def _by_chance(design: Design, factor: Factor) -> str:
    """Unevenness of the random orders of a factor, in words; empty if they are even enough."""
    outer = [f.name for f in design.factors[: design.factors.index(factor)]]
    firsts: Counter[str] = Counter()
    total = 0
    for number in range(design.participants):
        seen: dict[tuple[str, ...], str] = {}
        for trial in trials_of(session_plan(design, number)):
            if not trial.practice:
                block = tuple(trial.levels[name] for name in outer)
                seen.setdefault(block, trial.levels[factor.name])
        firsts.update(seen.values())
        total += len(seen)
    if factor.nested is not None or total < len(factor.levels):
        return ""
    expected = total / len(factor.levels)
    for level in factor.levels:
        if abs(firsts[level.name] - expected) >= UNEVEN * expected:
            return f"{level.name} comes first in {firsts[level.name]} of {total} orders"
    return ""


def _set_twice(design: Design) -> Iterator[Flaw]:
    """Settings that two factors set: the inner one wins, and the outer one does nothing."""
    for (_, outer), (i, inner) in combinations(enumerate(design.factors), 2):
        both = {n for x in outer.levels for n in x.settings} & {
            n for x in inner.levels for n in x.settings
        }
        for name in sorted(both):
            yield Flaw(
                ("factors", i, "levels"),
                f"{name} is set by {outer.name}, too, and the inner factor wins: {outer.name} does "
                "not do what its levels say",
                f"Set {name} in one of the two",
                error=all(set(level.settings) == {name} for level in outer.levels),
            )
