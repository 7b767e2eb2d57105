"""Named grips, a person's manner of doing them, and the movement between them.

A take is a sequence of keyframes. Each keyframe is a grip with a strength and a manner. The hand
moves from keyframe to keyframe along a monotone cubic spline (Fritsch and Carlson 1980), which
never overshoots a keyframe. No covariance of postures is assumed anywhere.
"""

from __future__ import annotations

import numpy as np

from models.arithmetic import Array
from training.second_subject.configuration import SecondConfiguration
from training.second_subject.hand import FIRST, LAST, ROLL, SECOND, SWING, SecondHand

GESTURES = ("move", "grasp", "pinch", "rotate")
"""The four gestures of section 4 of the paper."""

# Degrees: (swing, first, second, roll) of the thumb; then swing of index, middle, ring and little
# finger, first of these fingers, and second of these fingers.
_GRIPS = {
    "relaxed": ((0, 0, 20, 0), (2, 0, 0, -2), (30, 30, 30, 28), (45, 46, 46, 44)),
    "open": ((0, -22, 8, -4), (9, 2, -4, -12), (20, 18, 18, 18), (30, 28, 30, 32)),
    "fan": ((-2, -28, 4, -8), (15, 4, -7, -17), (26, 24, 24, 26), (20, 18, 20, 24)),
    "flat": ((4, -12, 10, -6), (3, 0, -1, -4), (38, 38, 38, 36), (14, 14, 14, 16)),
    "claw": ((-6, -8, 35, 4), (6, 1, -3, -9), (8, 6, 6, 8), (76, 78, 78, 74)),
    "hook": ((4, 4, 40, 0), (1, 0, 0, -1), (0, 0, 0, 2), (88, 90, 90, 88)),
    "sphere": ((4, -14, 25, 10), (11, 3, -4, -14), (32, 30, 32, 36), (48, 46, 48, 50)),
    "disk": ((2, -6, 20, 6), (7, 2, -3, -9), (46, 44, 44, 44), (26, 26, 28, 30)),
    "tripod": ((6, 10, 30, 12), (-4, 3, 0, -2), (46, 46, 40, 36), (44, 42, 62, 68)),
    "pinch": ((6, 14, 34, 14), (-2, 0, 0, -2), (50, 32, 26, 22), (46, 40, 36, 34)),
    "purse": ((6, 14, 34, 12), (-6, -2, 3, 8), (54, 54, 56, 58), (46, 44, 46, 50)),
    "point": ((6, 10, 38, 6), (2, 0, 0, 0), (24, 44, 48, 48), (28, 66, 70, 68)),
}

_BETWEEN = {
    "move": (("relaxed", "flat", "sphere", "claw", "disk", "point"),) * 2,
    "grasp": (("open", "fan", "flat", "sphere"), ("purse", "claw", "hook", "tripod")),
    "pinch": (("open", "fan", "disk", "flat"), ("pinch", "tripod", "purse", "point")),
    "rotate": (("sphere", "disk", "tripod", "open"), ("sphere", "purse", "claw", "relaxed")),
}
"""Gesture -> possible grips at its two ends. The hand moves to and fro between both ends."""

MANNERS = (
    "knuckles",
    "middle joints",
    "knuckles by finger",
    "middle joints by finger",
    "sweep",
    "spread",
    "thumb first",
    "thumb second",
    "thumb swing",
    "thumb roll",
    "pitch",
    "roll",
    "palm height",
)
"""Parameters that vary in addition to the grip; the last is in m, all others in rad. `sweep` moves
all fingers sideways, so that the hand is rotated against the line of its touches. Parameters `by
finger` bend the index finger less and the little finger more."""

_SIDE = np.array([-1.0, -0.3, 0.4, 1.0])

TILT = {"flat": -4.0, "claw": -8.0, "hook": -10.0, "open": 4.0, "fan": 6.0, "purse": -6.0}
"""Grip -> angle (degrees) by which the front of the palm is raised."""


def grip(name: str) -> Array:
    """`hand.ANGLES` (5, 5) rad of a named grip."""
    thumb, swings, firsts, seconds = _GRIPS[name]
    out = np.zeros((5, 5))
    out[0, [SWING, FIRST, SECOND, ROLL]] = thumb
    out[1:, SWING], out[1:, FIRST], out[1:, SECOND] = swings, firsts, seconds
    return np.deg2rad(out)


def path(times: Array, knots: Array, values: Array) -> Array:
    """Values (n, ...) at times (n,), on a monotone spline through knots (k,), k >= 2."""
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(knots, values, axis=0)(times))


def knots(rng: np.random.Generator, duration: float, pace: tuple[float, float]) -> Array:
    """Times (k,) s of keyframes, from before a take's start to after its end."""
    count = int(duration / pace[0]) + 3
    moments = np.cumsum(rng.uniform(*pace, count)) - rng.uniform(0.5, 1.5) * pace[1]
    return moments[: int(np.searchsorted(moments, duration)) + 2]


def keyframes(
    rng: np.random.Generator, moments: Array, gesture: str, calm: float, c: SecondConfiguration
) -> tuple[Array, Array]:
    """Grips of a take.

    A take has one grip for each end of its gesture. In some keyframes, another grip of this end
    replaces it. The strength of the grip varies between keyframes.

    Args:
        rng: Source of randomness.
        moments: (k,) s, times of the keyframes.
        gesture: One of `GESTURES`.
        calm: Factor on the strength of grips.
        c: Settings.

    Returns:
        (k, 5, 5) angles and (k,) tilt of the palm, rad.
    """
    ends = [str(rng.choice(names)) for names in _BETWEEN[gesture]]
    phase = int(rng.integers(2))
    relaxed = grip("relaxed")
    angles, tilt = np.empty((len(moments), 5, 5)), np.empty(len(moments))
    for k in range(len(moments)):
        end = (k + phase) % 2
        name = str(rng.choice(_BETWEEN[gesture][end])) if rng.random() < c.whim else ends[end]
        bold = rng.random() < c.bold
        share = 1.15 if bold else calm * rng.uniform(*c.strength)
        angles[k] = relaxed + share * (grip(name) - relaxed)
        tilt[k] = share * np.deg2rad(TILT.get(name, 0.0))
    return angles, tilt


def with_manner(angles: Array, manner: Array) -> Array:
    """Angles (n, 5, 5) rad, modified by a manner (n, 13); see `MANNERS`."""
    out = angles.copy()
    m = manner[..., None]
    out[:, 1:, FIRST] += m[:, 0] + m[:, 2] * _SIDE
    out[:, 1:, SECOND] += m[:, 1] + m[:, 3] * _SIDE
    out[:, 1:, LAST] -= 0.3 * m[:, 1]
    out[:, 1:, SWING] += m[:, 4] - m[:, 5] * _SIDE
    out[:, 0, FIRST] += manner[:, 6] + 0.5 * manner[:, 4]
    out[:, 0, SECOND] += manner[:, 7]
    out[:, 0, SWING] += manner[:, 8]
    out[:, 0, ROLL] += manner[:, 9]
    return out


def clamped(angles: Array, hand: SecondHand) -> Array:
    """Angles limited to the hand's ranges."""
    return np.clip(angles, *hand.reach_limits)
