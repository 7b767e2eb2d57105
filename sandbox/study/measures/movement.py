"""Measures of movement: path, efficiency, speed and smoothness of a series of points."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic.arrays import Array

STILL = 0.001
"""m; efficiency and smoothness of a shorter path are meaningless."""

CUTOFF = 10.0
"""Hz; SPARC ignores higher frequencies."""
THRESHOLD = 0.05
"""Share of the largest amplitude at which SPARC cuts the spectrum off."""
PADDING = 4
"""Powers of two by which SPARC pads the speed with zeros. All three values are its authors'."""
FEWEST = 8
"""Smallest number of speeds for SPARC."""


def path_length(points: ArrayLike) -> float:
    """Length of the path through points (n, 3), m."""
    return float(np.linalg.norm(np.diff(np.asarray(points, float), axis=0), axis=1).sum())


def end_distance(points: ArrayLike) -> float:
    """Distance from the first to the last of points (n, 3), m; 0 without points."""
    path = np.asarray(points, float)
    return float(np.linalg.norm(path[-1] - path[0])) if len(path) else 0.0


def efficiency(distance: float, length: float) -> float | None:
    """Distance divided by length of path, 0 to 1; None if the path is shorter than `STILL`."""
    return distance / length if length >= STILL else None


def speeds(points: ArrayLike, period: float) -> Array:
    """Speeds (n - 1,) between points (n, 3) that are `period` seconds apart, m/s."""
    return np.linalg.norm(np.diff(np.asarray(points, float), axis=0), axis=1) / period


def sparc(speed: ArrayLike, period: float) -> float | None:
    """Smoothness of a movement: the spectral arc length of its speed.

    This is the negative length of the amplitude spectrum's curve, from 0 Hz to the last frequency
    at which the amplitude is at least 5 percent of its maximum, and at most 10 Hz; both axes are
    scaled to 1. It does not depend on the size and duration of the movement. A single smooth bell
    gives about -1.4; every halt in between makes the value more negative.

    Balasubramanian, Melendez-Calderon, Roby-Brami and Burdet, "On the analysis of movement
    smoothness", Journal of NeuroEngineering and Rehabilitation 12:112, 2015.

    Args:
        speed: (n,) speeds in any unit, from rest to rest.
        period: Time between two speeds, s.

    Returns:
        The spectral arc length; None for fewer than `FEWEST` speeds or without movement.
    """
    values = np.asarray(speed, float)
    if len(values) < FEWEST or not values.max() > 0.0:
        return None
    size = 2 ** (int(np.ceil(np.log2(len(values)))) + PADDING)
    spectrum = np.abs(np.fft.rfft(values, size))
    frequencies = np.fft.rfftfreq(size, period)
    low = frequencies <= CUTOFF
    amplitudes = spectrum[low] / spectrum[low].max()
    over = np.flatnonzero(amplitudes >= THRESHOLD)
    part = slice(over[0], over[-1] + 1)
    rise, along = np.diff(amplitudes[part]), np.diff(frequencies[low][part])
    if not along.sum() > 0.0:
        return None
    return -float(np.hypot(along / along.sum(), rise).sum())
