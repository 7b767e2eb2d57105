"""A population of simulated people, on whom the shipped models are trained, chosen and judged.

Every person has their own hand, resting posture, habits and sensors. They come from three sources:
both generators of simulated subjects, with configurations drawn at random, and random postures by
kinematics alone. All of them are simulated; nothing made from them is real data.
"""

from training.population.population import (
    GROUPS,
    SOURCES,
    Population,
    load_population,
    save_population,
    simulate_population,
)

__all__ = [
    "GROUPS",
    "SOURCES",
    "Population",
    "load_population",
    "save_population",
    "simulate_population",
]
