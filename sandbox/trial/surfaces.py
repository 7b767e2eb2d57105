"""Places the surfaces of all hands in the world."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arithmetic.arrays import Array
from models.errors import InputError
from models.surface import Surface
from sandbox.trial.settings import RunSettings
from tasks.registry import hands_of
from tasks.task import Task


def place_all(
    placed: Surface, settings: RunSettings, kind: type[Task]
) -> tuple[Surface, tuple[Surface, ...]]:
    """The surface that a task is drawn on, and the surface of every hand.

    The two surfaces of a task for two hands lie side by side (see `sides_of`). In a task
    for one hand they lie over the same place: two people with a screen each at one table.

    Args:
        placed: A single surface as the task wants it.
        settings: Of the run.
        kind: The task.

    Raises:
        InputError: The task needs more hands than there are.
    """
    hands = len(settings.hands)
    if hands < hands_of(kind):
        raise InputError(
            "this task is for two hands, and there is one",
            where=kind.name,
            expected="a device for each, or two hands on one",
            remedy=f"sandbox run {kind.name} --device simulated --device simulated",
        )
    if hands == 1 or hands_of(kind) == 1 or settings.one_surface:
        return placed, (placed,) * hands
    if placed.upright:
        raise InputError("upright surfaces do not stand side by side", where=kind.name)
    width, middle = float(placed.size[0]), placed.to_world(placed.size / 2)
    whole = replace(placed, width_in=2 * placed.width_in).centred_at(middle)
    sides = [
        placed.centred_at(np.add(middle, (0.5 * side * width, 0.0, 0.0)))
        for side in sides_of(settings)
    ]
    return whole, tuple(sides)


def sides_of(settings: RunSettings) -> tuple[int, int]:
    """The sides on which two hands are: 1 is the right. The first one is on the right, unless it is
    a left hand and the second a right one."""
    first, second = (hand.person.left for hand in settings.hands)
    return (-1, 1) if first and not second else (1, -1)


def home(hand: int, settings: RunSettings, surface: Surface) -> Array:
    """(2,) m in the world, the middle of a hand's own part of its surface.

    Args:
        hand: Its index.
        settings: Of the run.
        surface: The hand's.
    """
    if not settings.one_surface or len(settings.hands) == 1:
        return np.asarray(surface.to_world(surface.size / 2)[:2])
    return np.asarray(surface.to_world(homes(settings, surface)[hand])[:2])


def homes(settings: RunSettings, surface: Surface) -> Array:
    """(2, 2) m on a surface that two hands share, the middle of each hand's half."""
    return np.array([surface.size * [0.5 + 0.25 * side, 0.5] for side in sides_of(settings)])
