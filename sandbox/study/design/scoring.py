"""Scores of questionnaires, computed from answers by the rules of their scales.

If an answer is missing, the score has no value, only the number of missing answers. Missing answers
are not imputed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Scale:
    """A scale: the rule that computes one number from answers.

    Attributes:
        name: Name in tables.
        rule: One of `fields.RULES`.
        items: Names of the items, whose answers are numbers.
        bounds: Lowest and highest answer of each item.
        reverse: Items that are reversed: low + high - answer is used.
        from_zero: True subtracts the lowest possible answer of an item from each answer.
        factor: Factor by which the result is multiplied.
        pairs: For `weighted`: names of the comparisons, whose answers are names of `items`.
    """

    name: str
    rule: str
    items: tuple[str, ...]
    bounds: tuple[tuple[float, float], ...]
    reverse: frozenset[str] = frozenset()
    from_zero: bool = False
    factor: float = 1.0
    pairs: tuple[str, ...] = ()

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest possible score."""
        from models.arithmetic import total

        lows = [0.0 if self.from_zero else low for low, _ in self.bounds]
        highs = [high - (low if self.from_zero else 0.0) for low, high in self.bounds]
        if self.rule == "sum":
            ends = (total(lows), total(highs))
        elif self.rule == "mean":
            ends = (total(lows) / len(lows), total(highs) / len(highs))
        else:
            ends = (min(lows), max(highs))
        low, high = sorted((ends[0] * self.factor, ends[1] * self.factor))
        return low, high


@dataclass(frozen=True)
class ScaleScore:
    """Score of a scale.

    Attributes:
        value: The score; None if answers are missing.
        missing: Number of missing answers.
    """

    value: float | None
    missing: int


def score(scale: Scale, answers: Mapping[str, Any]) -> ScaleScore:
    """Computes a score from answers, by item. An answer that is absent or None is missing."""
    from models.arithmetic import total

    used = (*scale.items, *scale.pairs)
    missing = sum(answers.get(name) is None for name in used)
    if missing:
        return ScaleScore(None, missing)
    values = [
        _counted(scale, name, float(answers[name]), bounds)
        for name, bounds in zip(scale.items, scale.bounds, strict=True)
    ]
    if scale.rule == "weighted":
        weights = tally(scale, answers)
        products = (v * weights[name] for v, name in zip(values, scale.items, strict=True))
        value = total(products) / total(weights.values())
    else:
        value = total(values) / (len(values) if scale.rule == "mean" else 1)
    return ScaleScore(value * scale.factor, 0)


def tally(scale: Scale, answers: Mapping[str, Any]) -> dict[str, int]:
    """How often each item of a weighted scale was chosen in the comparisons of the scale."""
    chosen = [answers.get(name) for name in scale.pairs]
    return {name: chosen.count(name) for name in scale.items}


def _counted(scale: Scale, name: str, value: float, bounds: tuple[float, float]) -> float:
    low, high = bounds
    value = low + high - value if name in scale.reverse else value
    return value - low if scale.from_zero else value
