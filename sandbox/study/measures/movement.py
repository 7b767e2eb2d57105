"""Measures of movement: path, efficiency, speed and smoothness, as functions of points in time."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic.arrays import Array

STILL = 0.001
"""m; of a path that is shorter than this, neither efficiency nor smoothness mean anything."""

CUTOFF = 10.0
"""Hz, above which SPARC looks at nothing."""
THRESHOLD = 0.05
"""Share of the largest amplitude below which SPARC takes a spectrum to have ended."""
PADDING = 4
"""Powers of two by which SPARC pads with zeros. These three are its authors' values."""
FEWEST = 8
"""Speeds of which SPARC makes no number yet."""


def path_length(points: ArrayLike) -> float:
    """m along points (n, 3), which are joined by straight lines."""
    return float(np.linalg.norm(np.diff(np.asarray(points, float), axis=0), axis=1).sum())


def end_distance(points: ArrayLike) -> float:
    """m between the first and the last of points (n, 3); 0 of none."""
    found = np.asarray(points, float)
    return float(np.linalg.norm(found[-1] - found[0])) if len(found) else 0.0


def efficiency(distance: float, length: float) -> float | None:
    """0 to 1, distance over length of path; None for a path that is hardly one."""
    return distance / length if length >= STILL else None


def speeds(points: ArrayLike, period: float) -> Array:
    """(n - 1,) m/s between points (n, 3) that are `period` seconds apart."""
    return np.linalg.norm(np.diff(np.asarray(points, float), axis=0), axis=1) / period


def sparc(speed: ArrayLike, period: float) -> float | None:
    """Smoothness of a movement: the spectral arc length of its speed.

    The length of the curve that the amplitude spectrum of the speed makes, from 0 Hz to where it
    has sunk to a twentieth of its largest, at 10 Hz at the latest; both axes are scaled to 1, and
    the sign is negative. Scale and duration do not matter; about -1.4 is a single smooth bell, and
    every halt in between makes it longer, that is, more negative.

    Balasubramanian, Melendez-Calderon, Roby-Brami and Burdet, "On the analysis of movement
    smoothness", Journal of NeuroEngineering and Rehabilitation 12:112, 2015.

    Args:
        speed: (n,) of any unit, from rest to rest.
        period: s between two of them.

    Returns:
        None where there is too little of it, or nothing moves.
    """
    values = np.asarray(speed, float)
    if len(values) < FEWEST or not values.max() > 0.0:
        return None
    size = 2 ** (int(np.ceil(np.log2(len(values)))) + PADDING)
    spectrum = np.abs(np.fft.rfft(values, size))
    frequencies = np.fft.rfftfreq(size, period)
    looked_at = frequencies <= CUTOFF
    amplitudes = spectrum[looked_at] / spectrum[looked_at].max()
    over = np.flatnonzero(amplitudes >= THRESHOLD)
    part = slice(over[0], over[-1] + 1)
    rise, along = np.diff(amplitudes[part]), np.diff(frequencies[looked_at][part])
    if not along.sum() > 0.0:
        return None
    return -float(np.hypot(along / along.sum(), rise).sum())
