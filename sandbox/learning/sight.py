"""What a policy sees: an observation as numbers that do not depend on where the thing lies."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
from models.scene import CONTROL_PERIOD
from models.surface import Surface

SEEN = ("objects", "goals", "things", "tips", "touches", "names", "solid", "phase", "contact")
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
NEAR, STRAIGHT = (0.01, 0.0025), np.deg2rad([10.0, 2.5])
"""m and rad, within which differences from the goal are seen in more detail: people let go of a
thing that is within 2 mm of its goal, after they have moved it by 80."""
SQUARE = 0.01
"""Share by which two edges of a square thing differ at most."""


def places_of(observations: Mapping[str, Array], surface: Surface) -> Array:
    """(T, 2) m on the surface, where the first object is."""
    return surface.to_surface(observations["objects"][:, 0, :3])


def references(observations: Mapping[str, Array], surface: Surface) -> Array:
    """(T, 5, 2) m on the surface, from where the next places of touches are told.

    It is where a touch is, and where the first object is for a finger that does not touch.
    """
    touches = observations["touches"]
    down = touches[:, :, :1] > 0.5
    return np.where(down, touches[:, :, 1:], places_of(observations, surface)[:, None])


def sights(observations: Mapping[str, Array], surface: Surface) -> Array:
    """(T, n) what is seen at each of T moments, from those moments and the ones before.

    Places are relative to the first object, in m times a factor that makes them about 1. A turn is
    the shortest one to a goal that looks the same every quarter turn, if the thing is as long as
    wide, and else every half turn. Of a longer thing it is also seen how far it is from its goal
    along the goal and across it, as for what has to be lined up with a slot. Of the hand, a touch
    shows the finger that follows it, by whatever name.

    Args:
        observations: Name -> (T, ...) parts of observations with one hand.
        surface: The touch surface.
    """
    box = places_of(observations, surface)
    objects, goals = observations["objects"][:, 0], observations["goals"][:, 0]
    w, x, y, z = objects[:, 3:7].T
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    equal = _equal_turns(observations["things"][:, 0, 1:3])
    apart = 2.0 * np.pi / equal
    turn = (goals[:, 3] - yaw + apart / 2) % apart - apart / 2
    way = surface.to_surface(goals[:, :3]) - box
    touches = observations["touches"]
    down, places = touches[:, :, 0], touches[:, :, 1:]
    count = len(box)
    named, tips, solid, force = _fingers_of_touches(observations)
    flat = surface.to_surface(tips)
    beside = named[..., None] * (flat - places)
    held = named[..., None] * (flat - box[:, None])
    left = _ways_of_touches(places - box[:, None], way, turn) * (down > 0.5)[..., None]
    parts = [
        50.0 * left.reshape(count, -1),
        50.0 * way,
        *(np.tanh(left / near).reshape(count, -1) for near in NEAR),
        *(np.tanh(way / near) for near in NEAR),
        4.0 * turn[:, None],
        np.tanh(turn[:, None] / STRAIGHT),
        np.stack([np.cos(equal * yaw), np.sin(equal * yaw)], axis=1),
        10.0 * box,
        20.0 * objects[:, 2:3],
        10.0 * objects[:, 7:9],
        named,
        50.0 * beside.reshape(count, -1),
        20.0 * held.reshape(count, -1),
        20.0 * named * tips[:, :, 2],
        solid,
        observations["phase"],
        np.log1p(force),
        2.0 * _clocks(down, places),
    ]
    if (equal < 4.0).all():
        lined = _along(goals, objects)
        parts += [50.0 * lined, *(np.tanh(lined / near) for near in NEAR)]
    for lag in LAGS:
        before = np.maximum(np.arange(count) - lag, 0)
        then = down[before]
        apart = then[..., None] * (places[before] - box[:, None])
        parts += [then, 20.0 * apart.reshape(count, -1), 50.0 * (box - box[before])]
    return np.concatenate(parts, axis=1)


def _equal_turns(half: Array) -> Array:
    """(T,) number of turns in which a thing looks the same from above, by half its edges (T, 2)
    m."""
    low, high = half.min(axis=1), half.max(axis=1)
    return np.where(high - low <= SQUARE * high, 4.0, 2.0)


def _along(goals: Array, objects: Array) -> Array:
    """(T, 2) m from a thing to its goal, along the goal's first axis and across it."""
    x, y = (goals[:, :2] - objects[:, :2]).T
    c, s = np.cos(goals[:, 3]), np.sin(goals[:, 3])
    return np.stack([c * x + s * y, c * y - s * x], axis=1)


def _fingers_of_touches(
    observations: Mapping[str, Array],
) -> tuple[Array, Array, Array, Array]:
    """The finger that follows each touch, whatever it was named.

    Returns:
        (T, 5) 1 where the touch has a name; (T, 5, 3) m where that finger's tip is; (T, 5) 1 where
        it is solid; (T, 5) N its force. All are 0 without a name.
    """
    names = observations["names"].astype(int)
    named = (names >= 0).astype(float) * (observations["touches"][:, :, 0] > 0.5)
    finger = np.maximum(names, 0)
    tips = np.take_along_axis(observations["tips"], finger[:, :, None], axis=1)
    solid = np.take_along_axis(observations["solid"], finger, axis=1)
    force = np.take_along_axis(observations["contact"][:, :, 0], finger, axis=1)
    return named, named[:, :, None] * tips, named * solid, named * force


def in_first_slots(
    observations: Mapping[str, Array], actions: Array
) -> tuple[dict[str, Array], Array]:
    """A demonstration whose touches have the first slots, in the order of their fingers.

    Fingers are named as the program found them, which differs between trials in which people did
    the same. From the first touch to a moment without touches, the fingers that touch take the
    slots 0, 1, 2 ... in their order.

    Args:
        observations: Name -> (T + 1, ...) parts of observations with one hand.
        actions: (T, 15) the touches of each control period.
    """
    rows = actions.reshape(len(actions), -1, 3)
    order = _orders(rows[:, :, 0] > 0.5)
    rows = np.take_along_axis(rows, order[:, :, None], axis=1)
    order = np.concatenate([order[:1], order])
    touches = np.take_along_axis(observations["touches"], order[:, :, None], axis=1)
    names = np.take_along_axis(observations["names"], order, axis=1)
    return {**observations, "touches": touches, "names": names}, rows.reshape(actions.shape)


def _orders(down: NDArray[np.bool_]) -> NDArray[np.intp]:
    """(T, 5) old slot of each new slot, the same from a first touch to the end of the last one."""
    order = np.tile(np.arange(down.shape[1]), (len(down), 1))
    any_down = np.concatenate([[False], down.any(axis=1), [False]])
    edges = np.flatnonzero(np.diff(any_down.astype(int)))
    for begin, end in edges.reshape(-1, 2):
        used = down[begin:end].any(axis=0)
        # An observation shows the touches of the step before, so the order holds one step longer.
        order[begin : end + 1] = np.concatenate([np.flatnonzero(used), np.flatnonzero(~used)])
    return order


def _ways_of_touches(grip: Array, way: Array, turn: Array) -> Array:
    """(T, 5, 2) m from where touches are to where they would be with the thing at its goal.

    Args:
        grip: (T, 5, 2) m from the thing to the touches.
        way: (T, 2) m from the thing to its goal.
        turn: (T,) rad by which the thing has yet to be turned about the upward vertical; the
            surface's second axis points towards the person, so it is the other way round there.
    """
    c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
    x, y = grip[..., 0], grip[..., 1]
    turned = np.stack([c * x + s * y, c * y - s * x], axis=-1)
    return way[:, None] + turned - grip


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
