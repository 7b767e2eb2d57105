"""Draws of a person's constants."""

from __future__ import annotations

import numpy as np


def between(rng: np.random.Generator, least: float, greatest: float) -> float:
    """A number, uniform in a range."""
    return float(rng.uniform(least, greatest))


def around(rng: np.random.Generator, value: float, spread: float) -> float:
    """A number near another one, normal in its logarithm."""
    return float(value * np.exp(spread * rng.normal()))
