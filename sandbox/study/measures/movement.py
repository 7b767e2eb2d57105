"""Measures of movement: path, efficiency, speed and smoothness, travel of joints, throughput."""

from __future__ import annotations

from collections.abc import Sequence
from math import log2
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array, total
from models.scene import CONTROL_PERIOD
from sandbox.study.measures.arrays import TrialArrays
from sandbox.study.measures.grasping import first_push, true_intervals

JUMP = 0.05
"""Displacement (m) in one control period above which an object was put back, not moved."""

STILL = 0.001
"""Length of a path (m) below which its efficiency and smoothness are meaningless."""

CUTOFF = 10.0
"""Highest frequency that SPARC uses, Hz."""
THRESHOLD = 0.05
"""Share of the largest amplitude at which SPARC cuts off the spectrum."""
PADDING = 4
"""SPARC pads the speeds with zeros to 2^PADDING times the next power of two of their number.
`CUTOFF`, `THRESHOLD` and `PADDING` have the values of the authors of SPARC."""
FEWEST = 8
"""Smallest number of speeds for SPARC."""


WIDTH = 4.133
"""Ratio of the effective width to the standard deviation of endpoints. 4 percent of a normal
distribution are outside of this width (Welford 1960, ISO 9241-411). sqrt(2 pi e) is 4.1327."""
FEWEST_MOVES = 3
"""Smallest number of movements for a throughput. A standard deviation of two values is too
uncertain."""
NEAR = 0.010
"""Distance (m) of start and goal below which the direction from start to goal is not defined."""


def path_length(points: ArrayLike) -> float:
    """Length of the path through points (n, 3), m."""
    return float(np.linalg.norm(np.diff(np.asarray(points, float), axis=0), axis=1).sum())


def end_distance(points: ArrayLike) -> float:
    """Distance from the first to the last of points (n, 3), m; 0 without points."""
    path = np.asarray(points, float)
    return float(np.linalg.norm(path[-1] - path[0])) if len(path) else 0.0


def efficiency(distance: float, length: float) -> float | None:
    """Distance divided by the length of the path, 0 to 1; None if the path is below `STILL`."""
    return distance / length if length >= STILL else None


def speeds(points: ArrayLike, period: float) -> Array:
    """Speeds (n - 1,) between points (n, 3) that are `period` seconds apart, m/s."""
    return np.linalg.norm(np.diff(np.asarray(points, float), axis=0), axis=1) / period


def sparc(speed: ArrayLike, period: float) -> float | None:
    """Smoothness of a movement: the spectral arc length of its speed.

    This is the negative length of the amplitude spectrum's curve, from 0 Hz to the last frequency
    at which the amplitude is at least 5 percent of its maximum, and at most 10 Hz; both axes are
    scaled to 1. It does not depend on the size and duration of the movement. A movement whose speed
    is one smooth bell curve gives about -1.4; every halt makes the value more negative.

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


def palm(trial: TrialArrays) -> dict[str, Any]:
    """Path and smoothness of the commanded palms of all hands; empty if no hand was down."""
    paths: list[tuple[list[Array], list[Array]]] = []
    for hand in trial.hands:
        parts = [hand.palm[first : last + 1] for first, last in true_intervals(hand.down)]
        if sum(len(part) for part in parts) >= 2:
            paths.append((parts, [speeds(part, CONTROL_PERIOD) for part in parts]))
    if not paths:
        return {}
    joined = [np.concatenate(parts) for parts, _ in paths]
    lengths = [path_length(path) for path in joined]
    longest = max((part for _, speed in paths for part in speed), key=len)
    moves = longest.sum() * CONTROL_PERIOD >= STILL
    return {
        "palm_path_m": total(lengths),
        "palm_efficiency": efficiency(total(map(end_distance, joined)), total(lengths)),
        "palm_sparc": sparc(longest, CONTROL_PERIOD) if moves else None,
    }


def objects(trial: TrialArrays) -> dict[str, Any]:
    """Path, smoothness and placement of the objects with a goal; empty without such objects."""
    items = [(item, item.goal) for item in trial.objects.values() if item.goal is not None]
    if not items:
        return {}
    parts = [_unbroken(item.place) for item, _ in items]
    lengths = [total(path_length(part) for part in some) for some in parts]
    length = total(lengths)
    offs = [abs(item.off[-1]) for item, _ in items if item.off is not None]
    values: dict[str, Any] = {
        "object_path_m": length,
        "object_efficiency": efficiency(
            total(end_distance(part) for some in parts for part in some), length
        ),
        "placement_error_m": float(
            np.mean([np.linalg.norm(item.place[-1] - goal[-1]) for item, goal in items])
        ),
        "placement_error_deg": float(np.rad2deg(np.mean(offs))),
    }
    farthest = int(np.argmax(lengths))
    begin = trial.once(first_push)
    if begin is not None and lengths[farthest] >= STILL and len(parts[farthest]) == 1:
        speed = speeds(parts[farthest][0], CONTROL_PERIOD)
        values["object_sparc"] = sparc(speed[begin:], CONTROL_PERIOD)
    return values


def joints(trial: TrialArrays) -> dict[str, Any]:
    """Travel and efficiency of hinges and slides, over all parts with a goal."""
    values: dict[str, Any] = {}
    goals = [item for item in trial.objects.values() if item.goal is not None]
    of_hinges = [(item.place, np.rad2deg(item.hinge)) for item in goals if item.hinge is not None]
    of_slides = [(item.place, item.slide) for item in goals if item.slide is not None]
    for some, still, travel, straight in (
        (of_hinges, 1.0, "hinge_travel_deg", "hinge_efficiency"),
        (of_slides, STILL, "slide_travel_m", "slide_efficiency"),
    ):
        # The jump of a part that is put back does not count as travel.
        parts = [part for place, joint in some for part in np.split(joint, _put_back(place))]
        if parts:
            length = total(float(np.abs(np.diff(part)).sum()) for part in parts)
            distance = total(abs(float(part[-1] - part[0])) for part in parts)
            values[travel] = length
            values[straight] = distance / length if length >= still else None
    return values


def movement(trial: TrialArrays) -> tuple[float, float] | None:
    """The movement of the object to its goal, for the throughput; see `movement_along`.

    None unless the trial has exactly one object with a goal, and this goal does not move.
    """
    items = [(item, item.goal) for item in trial.objects.values() if item.goal is not None]
    if len(trial) == 0 or len(items) != 1:
        return None
    ((item, goal),) = items
    if np.ptp(goal, axis=0).max() > STILL:
        return None
    return movement_along(item.place[0], goal[-1], item.place[-1])


def _unbroken(places: Array) -> list[Array]:
    """The parts of a path (n, 3) between the moments at which the object was put back."""
    return np.split(places, _put_back(places))


def _put_back(places: Array) -> list[int]:
    """Indices of the points of a path (n, 3) at which the object had just been put back."""
    far = np.linalg.norm(np.diff(places, axis=0), axis=1) > JUMP
    return (np.flatnonzero(far) + 1).tolist()


def movement_along(start: ArrayLike, goal: ArrayLike, end: ArrayLike) -> tuple[float, float] | None:
    """Projects a movement onto the line from its start to its goal.

    Args:
        start, goal, end: (3,) positions, m.

    Returns:
        Distance moved along the line, and signed distance of the end beyond the goal, m. None if
        start and goal are less than `NEAR` apart.
    """
    way = np.asarray(goal, float) - start
    distance = float(np.linalg.norm(way))
    if distance < NEAR:
        return None
    moved = float((np.asarray(end, float) - start) @ way / distance)
    return moved, moved - distance


def throughput(
    amplitudes: Sequence[float], errors: Sequence[float], times: Sequence[float]
) -> float | None:
    """Effective throughput of one person's movements under one condition, bit/s.

    It is the effective index of difficulty, log2(Ae / We + 1), divided by the mean time. Ae is the
    mean amplitude. We is 4.133 times the standard deviation of the endpoints along the line from
    start to goal (ISO 9241-411; Soukoreff and MacKenzie, "Towards a standard for pointing device
    evaluation, perspectives on 27 years of Fitts' law research in HCI", International Journal of
    Human-Computer Studies 61, 2004).

    Args:
        amplitudes: For each movement, the distance moved along the line from start to goal, m.
        errors: For each movement, the signed distance of its end beyond the goal, m.
        times: For each movement, its duration, s.

    Returns:
        The throughput; None for fewer than three movements, or if all errors are equal.
    """
    if len(amplitudes) < FEWEST_MOVES:
        return None
    width = WIDTH * float(np.std(errors, ddof=1))
    mean, time = float(np.mean(amplitudes)), float(np.mean(times))
    if not (width > 0.0 and time > 0.0 and mean > 0.0):
        return None
    return log2(mean / width + 1.0) / time
