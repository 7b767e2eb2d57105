"""Random draws of a person's constants."""

from __future__ import annotations

import numpy as np


def between(rng: np.random.Generator, least: float, greatest: float) -> float:
    """A random number, uniform in a range."""
    return float(rng.uniform(least, greatest))


def around(rng: np.random.Generator, value: float, spread: float) -> float:
    """A random number near `value`; its logarithm has a normal distribution with a standard
    deviation of `spread`."""
    return float(value * np.exp(spread * rng.normal()))
