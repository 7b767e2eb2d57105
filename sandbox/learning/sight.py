"""What a policy sees: an observation as numbers that do not depend on where the thing lies."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from models.arithmetic.arrays import Array
from models.scene import CONTROL_PERIOD
from models.surface import Surface

SEEN = ("objects", "goals", "tips", "touches", "solid", "phase", "contact")
"""Parts of an observation that it uses."""
LAGS = (0, 6, 15, 30)
"""Control periods ago at which touches are seen as well; the longest is half a second."""
MEMORY = 90
"""Control periods that an observer has to remember."""
LONGEST_TOUCH, LONGEST_REST = 1.0, 0.8
"""s after which a policy does not tell how long fingers have touched, and have not moved."""
MOVED, WITHIN = 0.004, 5
"""m by which a finger has to move, within so many control periods, to count as moving: trembling is
less."""
NEAR, STRAIGHT = 0.01, np.deg2rad(10.0)
"""m and rad, within which differences from the goal are seen in more detail."""
_QUARTER = np.pi / 2


def places_of(observations: Mapping[str, Array], surface: Surface) -> Array:
    """(T, 2) m on the surface, where the first object is."""
    return surface.to_surface(observations["objects"][:, 0, :3])


def sights(observations: Mapping[str, Array], surface: Surface) -> Array:
    """(T, n) what is seen at each of T moments, from those moments and the ones before.

    Places are relative to the first object, in m times a factor that makes them about 1. A turn is
    the shortest one to a goal that looks the same every quarter turn, as that of a box does.

    Args:
        observations: Name -> (T, ...) parts of observations with one hand.
        surface: The touch surface.
    """
    box = places_of(observations, surface)
    objects, goals = observations["objects"][:, 0], observations["goals"][:, 0]
    w, x, y, z = objects[:, 3:7].T
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    turn = (goals[:, 3] - yaw + _QUARTER / 2) % _QUARTER - _QUARTER / 2
    way = surface.to_surface(goals[:, :3]) - box
    tips = surface.to_surface(observations["tips"]) - box[:, None]
    touches = observations["touches"]
    down, places = touches[:, :, 0], touches[:, :, 1:]
    count = len(box)
    parts = [
        50.0 * way,
        np.tanh(way / NEAR),
        4.0 * turn[:, None],
        np.tanh(turn / STRAIGHT)[:, None],
        np.stack([np.cos(4.0 * yaw), np.sin(4.0 * yaw)], axis=1),
        10.0 * box,
        20.0 * objects[:, 2:3],
        10.0 * objects[:, 7:9],
        20.0 * tips.reshape(count, -1),
        20.0 * observations["tips"][:, :, 2],
        observations["solid"],
        observations["phase"],
        np.log1p(observations["contact"][:, :, 0]),
        2.0 * _clocks(down, places),
    ]
    for lag in LAGS:
        before = np.maximum(np.arange(count) - lag, 0)
        then = down[before]
        apart = then[..., None] * (places[before] - box[:, None])
        parts += [then, 20.0 * apart.reshape(count, -1), 50.0 * (box - box[before])]
    return np.concatenate(parts, axis=1)


def _clocks(down: Array, places: Array) -> Array:
    """(T, 2) s since fingers touched or left, and since they moved; 0 while none touches."""
    count = len(down)
    out = np.zeros((count, 2))
    touching = moving = 0.0
    for t in range(1, count):
        before = max(0, t - WITHIN)
        went = np.abs(places[t] - places[before])[down[t] > 0.5] > MOVED
        touching = 0.0 if (down[t] != down[t - 1]).any() else touching + CONTROL_PERIOD
        still = not (went.any() or (down[t] != down[before]).any())
        moving = moving + CONTROL_PERIOD if still else 0.0
        if (down[t] > 0.5).any():
            out[t] = min(touching, LONGEST_TOUCH), min(moving, LONGEST_REST)
    return out


def recent(history: Mapping[str, list[Array]]) -> dict[str, Array]:
    """The moments that a policy remembers."""
    return {name: np.array(values[-MEMORY:]) for name, values in history.items()}
