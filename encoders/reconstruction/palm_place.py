"""Where palms lie beside fingers: what a contact's place among the others tells of it.

A hand that touches with its fingertips rests its heel well below them; the thumb's tip is nearer to
the others and higher. The odds are those of a logistic regression on how far the contact is from
the others and in which directions, with all products of two. It was fitted to fingertips and heels
of simulated people: `python -m benchmarks.palms --fit` writes the file of its weights.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from models.arithmetic.products import distance

Place = tuple[float, float]

FILE = Path(__file__).parents[1] / "data" / "palm_places.json"
"""Weights of `place_terms`, a list of numbers."""

UNIT = 0.1
"""m, unit of the regression's lengths."""

LARGEST = 4.0
"""Bound on the log-odds: beyond it, simulated people prove nothing about real ones."""


@cache
def weights() -> tuple[float, ...]:
    """The weights that ship."""
    return tuple(json.loads(FILE.read_text()))


def place_terms(place: Place, others: Sequence[Place]) -> list[float]:
    """The regression's inputs (171,), products included, 1 first.

    Args:
        place: (x, y) m on the surface, y down, as a right hand from below would touch.
        others: Places of the other contacts, one or more.
    """
    x, y = place
    order = sorted(others, key=lambda other: (distance(place, other), other))
    nearest, second, farthest = order[0], order[min(1, len(order) - 1)], order[-1]
    count = len(order)
    middle = sum(other[0] for other in order) / count, sum(other[1] for other in order) / count
    lengths = [
        distance(place, nearest),
        distance(place, second),
        distance(place, farthest),
        max(other[1] for other in order) - y,
        min(other[1] for other in order) - y,
    ]
    for right, down in (middle, nearest, second, farthest, min(order), max(order)):
        lengths += [right - x, down - y]
    terms = [1.0, *(length / UNIT for length in lengths)]
    return [a * b for i, a in enumerate(terms) for b in terms[i:]]


def place_odds(place: Place, others: Sequence[Place]) -> float:
    """Log-odds of a palm against a fingertip by its place alone; 0 without other contacts."""
    if not others:
        return 0.0
    odds = 0.0
    for weight, term in zip(weights(), place_terms(place, others), strict=True):
        odds += weight * term
    return min(max(odds, -LARGEST), LARGEST)
