"""Flaws of what is compared: levels, their orders, and the groups that meet them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from itertools import combinations
from typing import Any, NamedTuple

from models.errors import HandSandboxError
from models.messages.wording import counted
from sandbox.study.design.balance import confounded, nearest_cycles
from sandbox.study.design.conditions import PARTNER, differences, run_settings, values_of
from sandbox.study.design.conditions import combinations as combinations_of
from sandbox.study.design.design import Design, Factor, Level
from sandbox.study.design.meaning.groups import assigned_traits
from sandbox.study.design.meaning.teaching import carry_over
from sandbox.study.design.plan import session_plan, trials_of
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.toml_lines import Path

DEVICES = ("device", "second_device", "webcam", "leap_at")
"""Settings of the real devices, which settings of a trial do not tell apart."""
OF_TOUCHES = {"encoder", "labels"}
"""Settings of how touches become a hand; one that a device sees in the air needs neither."""
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
            f"{counted(design.participants, 'person', 'people')} make no full cycle, so this is "
            "confounded: " + "; ".join(missing),
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
    pairs = {}
    explained = factor in assigned_traits(design) or any(
        factor is other for other, _, _ in carry_over(design)
    )
    unread = _unread(design, factor)
    if unread:
        yield unread
    for a, b in combinations(factor.levels, 2):
        given = differences(design, a, b)
        effects = _effects(design, factor, a, b, given)
        effective = [n for n in given if any(n in found for _, found in effects)]
        pairs[a.name, b.name] = effective
        if not given and not explained and not _told_apart(design, factor, a, b):
            yield Flaw(
                path,
                f"{a.name} and {b.name} are the same: they set the same values",
                "Change one of them, or remove it",
            )
        elif given and not effective and not unread:
            yield Flaw(
                path,
                f"{a.name} and {b.name} are the same: of {' and '.join(given)}, one sets what is "
                "so by default, or what does nothing here",
                "Change one of them, or remove it",
            )
        elif effective and not unread:
            for where in _without_effect(design, factor, effects):
                yield Flaw(
                    path,
                    f"{a.name} and {b.name} are the same where {where.outer} is {where.level}: "
                    f"what they set ({', '.join(given)}) does nothing there",
                    f'Write {factor.name} after {where.outer}, with inside = "{where.outer}" and '
                    f"one of these levels alone for {where.level}, or compare something else",
                )
    alone = _mixed(pairs)
    if alone is not None:
        a_name, b_name, given = alone
        yield Flaw(
            path,
            f"levels of {factor.name} differ in several settings at once ({a_name} and {b_name} in "
            f"{' and '.join(given)}), so it cannot be told which of them makes a difference",
            "Make a factor of each setting, unless they are compared as wholes",
        )
    yield from _apart(design, path, factor)


def _mixed(pairs: dict[tuple[str, str], list[str]]) -> tuple[str, str, list[str]] | None:
    """A level that differs from each other one in several settings, and the one nearest to it."""
    names = dict.fromkeys(name for pair in pairs for name in pair)
    for name in names:
        own = {pair: given for pair, given in pairs.items() if name in pair}
        if all(len(given) > 1 for given in own.values()):
            (a, b), given = min(own.items(), key=lambda one: len(one[1]))
            return a, b, given
    return None


def _told_apart(design: Design, factor: Factor, a: Level, b: Level) -> bool:
    """True if people are told other things before two levels: then words are what is compared."""
    texts = {
        name: [t.text for t in design.instructions if t.at == factor.name and t.level == name]
        for name in (a.name, b.name)
    }
    return texts[a.name] != texts[b.name]


Effects = list[tuple[dict[str, Level], list[str]]]
"""Combinations with one of two levels, each with the settings that change its trials."""


def _effects(design: Design, factor: Factor, a: Level, b: Level, given: list[str]) -> Effects:
    """Which of the settings that differ between two levels change a trial, by combination.

    A setting changes nothing if one level sets what is so by default.
    """
    every = [c for c in combinations_of(design) if c[factor.name].name == a.name]
    if not every or factor.nested is not None:
        return [({}, given)]
    return [(c, _effective(design, factor, a, b, given, c)) for c in every]


def _effective(
    design: Design, factor: Factor, a: Level, b: Level, given: list[str], one: dict[str, Level]
) -> list[str]:
    """Those of the settings that change a trial of one combination."""
    outside = values_of(design, {n: level for n, level in one.items() if n != factor.name})
    try:
        whole = run_settings(outside | b.settings, design.seed % 1000)
        return [
            name
            for name in given
            if name in DEVICES
            or run_settings(_with(outside, a, b, name), design.seed % 1000) != whole
        ]
    except HandSandboxError:
        return given


class _Where(NamedTuple):
    outer: str
    level: str


def _without_effect(design: Design, factor: Factor, effects: Effects) -> list[_Where]:
    """Levels of other factors with which two levels of a factor are always the same."""
    found = []
    for other in design.factors:
        if other is factor:
            continue
        for level in other.levels:
            those = [some for c, some in effects if other.name in c and c[other.name] == level]
            if those and not any(those):
                found.append(_Where(other.name, level.name))
    return found


def _unread(design: Design, factor: Factor) -> Flaw | None:
    """Levels that set how touches are read, with hands in the air, which have none."""
    given = {name for level in factor.levels for name in level.settings}
    if not given <= OF_TOUCHES:
        return None
    devices: dict[bool, set[str]] = {True: set(), False: set()}
    for levels in combinations_of(design):
        values = values_of(design, levels)
        used = [values.get("device", "touch"), values.get("second_device", PARTNER)]
        real = [device for device in used if device != PARTNER]
        devices["touch" in real].update(real)
    if not devices[False]:
        return None
    in_air = " and ".join(sorted(devices[False]))
    return Flaw(
        ("factors", design.factors.index(factor), "levels"),
        f"the levels of {factor.name} are the same with device {in_air}: only touches are read by "
        + " and ".join(sorted(given)),
        'Write device = "touch", or compare something else'
        if not devices[True]
        else "Compare them by touch alone",
    )


def _with(outside: dict[str, Any], a: Level, b: Level, name: str) -> dict[str, Any]:
    """Settings of a trial with level `b`, of which one setting is that of level `a`."""
    values = {n: v for n, v in (outside | b.settings).items() if n != name}
    given = (outside | a.settings).get(name)
    return values if given is None else {**values, name: given}


def _apart(design: Design, path: Path, factor: Factor) -> Iterator[Flaw]:
    """Levels of a nested factor that never occur in the same level of the outer one."""
    if factor.nested is None or len(factor.levels) < 2:
        return
    lists = [[level.name for level in levels] for levels in factor.nested.values()]
    if all(len(names) == 1 for names in lists):
        yield Flaw(
            path,
            f"{factor.name} has one level in each level of {factor.outer}, so that the two cannot "
            "be told apart",
            f"Give every level of {factor.outer} the same levels",
        )
        return
    together = {frozenset(pair) for names in lists for pair in combinations(names, 2)}
    shared = any(sum(level.name in names for names in lists) > 1 for level in factor.levels)
    title = f" {_spaced(design.name)} {_spaced(design.title)} "
    for a, b in combinations([level.name for level in factor.levels], 2):
        named = all(f" {_spaced(name)} " in title for name in (a, b))
        if frozenset((a, b)) not in together and (shared or named):
            yield Flaw(
                path,
                f"{a} and {b} never occur in the same level of {factor.outer}, so that their "
                f"difference cannot be told from that of {factor.outer}",
                f"Give every level of {factor.outer} the same levels, or do not compare these",
            )
            return


def _spaced(text: str) -> str:
    return re.sub(r"[^\w]+", " ", plain(text)).strip()


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
            f"{counted(design.participants, 'person', 'people')} in {len(factor.levels)} groups: "
            f"what a level of {factor.name} does cannot be told from who met it",
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
