"""Whether orders of several factors were balanced together in the trials that are used."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from itertools import combinations, product

from sandbox.study.measures.kept import ORDERS
from sandbox.study.report.models.data import ObservedFactor, StudyData


def design_orders(data: StudyData) -> str:
    """How many participants a full cycle of orders takes, by the design; empty if unknown."""
    return data.codebook.get(ORDERS, ("", ""))[1]


def confounded_pairs(data: StudyData) -> list[tuple[str, str]]:
    """Pairs of an outer and an inner factor whose levels were not equally often at every place of
    both, so that the difference between their levels' differences is confounded with practice."""
    several = [f for f in data.factors if len(f.levels) > 1]
    return [
        (outer.name, inner.name)
        for outer, inner in combinations(several, 2)
        if inner.within and not _even(_met(data, outer, inner))
    ]


def _met(data: StudyData, outer: ObservedFactor, inner: ObservedFactor) -> list[Hashable]:
    """(outer level, its place, inner level, its place within) of every round of every person."""
    before = [f.column for f in data.factors[: data.factors.index(outer)]]
    met = [outer.column, outer.place, inner.column, inner.place]
    seen = data.used[["ppid", *before, outer.round, inner.round, *met]].drop_duplicates()
    return list(zip(*(seen[name] for name in met), strict=True))


def _even(met: Sequence[Hashable]) -> bool:
    """True if all values of all parts were combined, equally often."""
    counts = Counter(met)
    parts = [set(part) for part in zip(*counts, strict=True)]
    return len(counts) == len(list(product(*parts))) and len(set(counts.values())) == 1
