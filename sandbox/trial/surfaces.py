"""Placement of the surfaces of all hands in the world."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arithmetic.arrays import Array
from models.errors import InputError
from models.surface import Surface
from sandbox.trial.settings import Settings
from tasks.registry import hands_of
from tasks.task import Task


def place_all(
    placed: Surface, settings: Settings, kind: type[Task]
) -> tuple[Surface, tuple[Surface, ...]]:
    """Places the surface that a task is drawn on, and the surface of every hand.

    The two surfaces of a task for two hands lie side by side (see `sides_of`). In a task for one
    hand they coincide: two people, each with a screen, at one table.

    Args:
        placed: A single surface, placed for the task.
        settings: Settings of the run.
        kind: Class of the task.

    Raises:
        InputError: The task needs more hands than there are, or two upright surfaces.
    """
    hands = len(settings.hands)
    if hands < hands_of(kind):
        raise InputError(
            "this task needs two hands, and there is one",
            where=kind.name,
            expected="a device for each hand, or two hands on one device",
            remedy=f"sandbox run {kind.name} --device simulated --device simulated",
        )
    if hands == 1 or hands_of(kind) == 1 or settings.surface.shared:
        return placed, (placed,) * hands
    if placed.upright:
        raise InputError("two upright surfaces are not supported", where=kind.name)
    width, middle = float(placed.size[0]), placed.to_world(placed.size / 2)
    whole = replace(placed, width_in=2 * placed.width_in).centred_at(middle)
    sides = [
        placed.centred_at(np.add(middle, (0.5 * side * width, 0.0, 0.0)))
        for side in sides_of(settings)
    ]
    return whole, tuple(sides)


def sides_of(settings: Settings) -> tuple[int, int]:
    """Sides of the two hands: 1 is right, -1 left.

    The first hand is on the right, unless it is a left hand and the second a right hand.
    """
    first, second = (hand.person.left for hand in settings.hands)
    return (-1, 1) if first and not second else (1, -1)


def home(hand: int, settings: Settings, surface: Surface) -> Array:
    """(2,) m in the world, centre of a hand's part of its surface.

    Args:
        hand: Index of the hand.
        settings: Settings of the run.
        surface: Surface of the hand.
    """
    if not settings.surface.shared or len(settings.hands) == 1:
        return np.asarray(surface.to_world(surface.size / 2)[:2])
    return np.asarray(surface.to_world(homes(settings, surface)[hand])[:2])


def homes(settings: Settings, surface: Surface) -> Array:
    """(2, 2) m on a surface that two hands share, centre of each hand's half."""
    return np.array([surface.size * [0.5 + 0.25 * side, 0.5] for side in sides_of(settings)])
