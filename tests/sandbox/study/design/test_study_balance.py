"""Orders of several factors are balanced together, over a full cycle and as far as they have come;
what a shorter one confounds is told."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from itertools import groupby, pairwise, product
from math import prod
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from sandbox.study.design.balance import confounded, cycle_of, rows_of, whole_cycle
from sandbox.study.design.design import Design
from sandbox.study.design.design_file import parse_design
from sandbox.study.design.fields import ORDERS
from sandbox.study.design.session_plan import session_plan, trials_of

NAMES = ("contact", "servo", "task")
Rule = tuple[str, int]


def crossed(*rules: Rule, more: str = "") -> Design:
    """A design of factors with these orders and numbers of levels."""
    text = f"name = 'n'\nsessions = 3\nparticipants = 1\n{more}"
    for name, (rule, count) in zip(NAMES, rules, strict=False):
        told = ", ".join(f'{{name = "{i}", encoder = "linear"}}' for i in range(count))
        text += f"[[factors]]\nname = '{name}'\norder = '{rule}'\nlevels = [{told}]\n"
    return parse_design(text, Path("design.toml"), try_out=False)


def met(design: Design, number: int, session: int) -> list[tuple[str, tuple[str, ...]]]:
    """The outer levels that a participant meets, each with the order of the inner ones."""
    orders: dict[str, list[str]] = {}
    for trial in trials_of(session_plan(design, number, session)):
        orders.setdefault(trial.levels["contact"], []).append(trial.levels["servo"])
    return [(level, tuple(order)) for level, order in orders.items()]


def even(counts: Mapping[Any, int], cells: int, within: int = 0) -> bool:
    """True if counts of so many cells differ by no more than `within`."""
    values = [*counts.values(), *[0] * (cells - len(counts))]
    return len(values) == cells and max(values) - min(values) <= within


FIXED = st.sampled_from(
    [("latin", 1), ("latin", 2), ("latin", 3), ("latin", 4), ("factorial", 2), ("factorial", 3)]
)
GROUPS = st.tuples(st.just("between"), st.integers(2, 4))


@given(outer=FIXED, inner=FIXED, people=st.integers(1, 80), session=st.integers(1, 3))
@settings(max_examples=30, deadline=None)
def test_whoever_came_so_far_used_all_orders_within_one_of_equally_often(
    outer: Rule, inner: Rule, people: int, session: int
) -> None:
    design = crossed(outer, inner)
    wholes, levels, places, orders = (Counter[object]() for _ in range(4))
    n, (a, b) = outer[1], map(cycle_of, design.factors)
    for number in range(1, people + 1):
        blocks = met(design, number, session)
        whole = tuple(level for level, _ in blocks)
        wholes[whole] += 1
        for place, (level, order) in enumerate(blocks):
            levels[level, order] += 1
            places[place, order] += 1
            orders[whole, place, order] += 1
    assert even(wholes, a, 1) and even(orders, a * n * b, 1)
    for one in wholes:
        assert even(Counter({k: v for k, v in orders.items() if k[0] == one}), n * b, 1)  # type: ignore[index]
    for i in range(n):
        assert even(Counter({k: v for k, v in levels.items() if k[0] == str(i)}), b, 1)  # type: ignore[index]
        assert even(Counter({k: v for k, v in places.items() if k[0] == i}), b, 1)  # type: ignore[index]


@given(st.lists(FIXED | GROUPS, min_size=1, max_size=3), st.integers(0, 500))
def test_rows_of_any_number_of_factors_are_combined_equally_often(
    rules: list[Rule], people: int
) -> None:
    design = crossed(*rules)
    rows = [rows_of(design, number) for number in range(people)]
    counts = [cycle_of(factor) for factor in design.factors]
    assert even(Counter(rows), whole_cycle(design), 1)
    for i, count in enumerate(counts):
        assert even(Counter(row[i] for row in rows), count, 1)
    every = [rows_of(design, people + i) for i in range(whole_cycle(design))]
    assert sorted(every) == list(product(*map(range, counts)))


ANY = st.tuples(st.sampled_from(sorted(ORDERS)), st.integers(1, 5))


@example([("latin", 5)])
@example([("latin", 6)])
@given(st.lists(ANY, min_size=1, max_size=3))
@settings(max_examples=40, deadline=None)
def test_over_a_full_cycle_each_level_is_equally_often_at_each_place_and_after_each_other(
    rules: list[Rule],
) -> None:
    design = crossed(*rules)
    assume(whole_cycle(design) * prod(count for _, count in rules) <= 2000)
    places, follows, groups = (Counter[tuple[object, ...]]() for _ in range(3))
    for number in range(1, whole_cycle(design) + 1):
        trials = trials_of(session_plan(design, number))
        for i, (name, (rule, _)) in enumerate(zip(NAMES, rules, strict=False)):
            blocks = groupby(trials, key=lambda t: [t.levels[n] for n in NAMES[:i]])
            for _, block in blocks:
                order = [level for level, _ in groupby(t.levels[name] for t in block)]
                if rule == "between":
                    groups[name, order[0]] += 1
                elif rule in ("latin", "factorial"):
                    places.update((name, level, place) for place, level in enumerate(order))
                    follows.update((name, *pair) for pair in pairwise(order))
    for name, (rule, count) in zip(NAMES, rules, strict=False):
        place, follow, group = (
            Counter({key: n for key, n in some.items() if key[0] == name})
            for some in (places, follows, groups)
        )
        if rule == "between":
            assert even(group, count)
        elif rule in ("latin", "factorial") and count > 1:
            assert even(place, count**2) and even(follow, count * (count - 1))


def test_orders_of_nested_factors_of_several_lengths_are_balanced_in_each_of_them() -> None:
    text = (
        "name = 'n'\n[[factors]]\nname = 'contact'\norder = 'latin'\nlevels = ['hard', 'soft']\n"
        "[[factors]]\nname = 'task'\norder = 'latin'\ninside = 'contact'\n"
        "levels = {hard = ['box-to-goal', 'stack'], "
        "soft = ['stack', 'wrench-turn', 'wrench-slide']}\n"
    )
    design = parse_design(text, Path("design.toml"), try_out=False)
    assert whole_cycle(design) == 12
    orders: dict[str, Counter[object]] = {"hard": Counter(), "soft": Counter()}
    for number in range(1, 13):
        tasks: dict[str, list[str]] = {}
        for trial in trials_of(session_plan(design, number)):
            tasks.setdefault(trial.levels["contact"], []).append(trial.levels["task"])
        first = next(iter(tasks))
        for level, order in tasks.items():
            orders[level][first, tuple(order)] += 1
    assert even(orders["hard"], 2 * 2) and even(orders["soft"], 2 * 6)
    assert confounded(design, 12) == [] and confounded(design, 6)


@pytest.mark.parametrize(
    ("rules", "people", "told"),
    [
        ([("latin", 2)], 3, ["contact with practice"]),
        ([("latin", 3)], 3, ["contact with what came before"]),
        ([("latin", 3)], 4, ["contact with practice"]),
        ([("between", 2)], 5, ["contact: its groups differ in size"]),
        ([("latin", 2), ("latin", 2)], 2, ["the interaction of contact x servo with practice"]),
        ([("latin", 2), ("latin", 2)], 3, ["contact with practice", "servo with practice"]),
        ([("latin", 3), ("latin", 2)], 6, ["the interaction of contact x servo with practice"]),
        ([("latin", 2)] * 3, 4, ["the interaction of contact x task with practice"]),
        ([("latin", 2), ("latin", 2)], 4, []),
        ([("latin", 3), ("random", 3)], 6, []),
    ],
)
def test_what_a_shorter_cycle_confounds_is_told(
    rules: list[Rule], people: int, told: list[str]
) -> None:
    found = confounded(crossed(*rules), people)
    assert len(found) == len(told), found
    for line, start in zip(found, told, strict=True):
        assert line.startswith(start)
