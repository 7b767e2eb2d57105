"""Where palms lie beside fingers: what a contact's place among the others tells of it.

A hand that touches with its fingertips rests its heel well below them; the thumb's tip is nearer to
the others and higher. The odds are those of a small network, a layer of rectifiers, whose inputs
are how many others there are, how far and in which directions the nearest four and the outermost
two lie, and how far they spread. It was trained on fingertips and heels of simulated people;
`python -m training palm_places` in a checkout makes the file of its weights.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import distance, matrix_vector, small_product

Place = tuple[float, float]

FILE = Path(__file__).parents[1] / "data" / "palm_places.json"
"""Weights of the network, lists of numbers by name."""

UNIT = 0.1
"""m, unit of the network's lengths."""

NEAREST = 4
"""Others that the network looks at one by one."""

LARGEST = 4.0
"""Bound on the log-odds: beyond it, simulated people prove nothing about real ones."""


@cache
def weights() -> dict[str, Array]:
    """The weights that ship: `first` (hidden, inputs), `bias` (hidden,), `second` (hidden,) and
    `constant` (1,)."""
    return {name: np.array(values) for name, values in json.loads(FILE.read_text()).items()}


def place_inputs(place: Place, others: Sequence[Place]) -> list[float]:
    """The network's inputs (23,).

    Args:
        place: (x, y) m on the surface, y down, as a right hand from below would touch.
        others: Places of the other contacts, one or more.
    """
    x, y = place
    order = sorted(others, key=lambda other: (distance(place, other), other))
    inputs = [len(order) / NEAREST]
    for i in range(NEAREST):
        if i < len(order):
            right, down = order[i]
            away = distance(place, order[i]) / UNIT
            inputs += [1.0, (x - right) / UNIT, (y - down) / UNIT, away]
        else:
            inputs += [0.0, 0.0, 0.0, 0.0]
    for right, down in (min(order), max(order)):
        inputs += [(x - right) / UNIT, (y - down) / UNIT]
    for axis in (0, 1):
        along = [other[axis] for other in order]
        inputs.append((max(along) - min(along)) / UNIT)
    return inputs


def place_odds(place: Place, others: Sequence[Place]) -> float:
    """Log-odds of a palm against a fingertip by its place alone; 0 without other contacts."""
    if not others:
        return 0.0
    w = weights()
    hidden = matrix_vector(w["first"], np.array(place_inputs(place, others))) + w["bias"]
    odds = float(small_product(w["second"], np.maximum(hidden, 0.0)) + w["constant"][0])
    return min(max(odds, -LARGEST), LARGEST)
