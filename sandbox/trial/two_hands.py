"""What a second hand changes: where surfaces are, and that there is a device for every hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.wrappers.shared import MergedTouches, SharedSurface
from sandbox.session.device import Device
from sandbox.trial.settings import RunSettings
from tasks.registry import hands_of
from tasks.task import Task

Array = NDArray[np.float64]

DeviceMaker = Callable[[Task, Surface], Device]
"""Opens a device for a drawn task on a placed surface."""


@dataclass(frozen=True)
class PerHand:
    """One maker for every hand; used like a single one, it opens the first hand's device.

    Attributes:
        makers: In the order of the hands.
    """

    makers: tuple[DeviceMaker, ...]

    def __call__(self, task: Task, surface: Surface) -> Device:
        """Opens the first hand's device."""
        return self.makers[0](task, surface)


def makers_of(make_device: DeviceMaker) -> tuple[DeviceMaker, ...]:
    """The makers of all hands' devices."""
    return make_device.makers if isinstance(make_device, PerHand) else (make_device,)


def with_each(
    make_device: DeviceMaker, change: Callable[[DeviceMaker], DeviceMaker]
) -> DeviceMaker:
    """The same with every hand's maker changed."""
    if isinstance(make_device, PerHand):
        return PerHand(tuple(change(maker) for maker in make_device.makers))
    return change(make_device)


def with_first(
    make_device: DeviceMaker, change: Callable[[DeviceMaker], DeviceMaker]
) -> DeviceMaker:
    """The same with the first hand's maker changed."""
    first, *others = makers_of(make_device)
    return PerHand((change(first), *others)) if others else change(first)


def place_all(
    placed: Surface, settings: RunSettings, kind: type[Task]
) -> tuple[Surface, tuple[Surface, ...]]:
    """Where a task is drawn, and the surface of every hand.

    The two surfaces of a task for two hands lie side by side (see `sides_of`). In a task
    for one hand they lie over the same place: two people with a screen each at one table.

    Args:
        placed: A single surface as the task wants it.
        settings: Of the run.
        kind: The task.

    Raises:
        InputError: The task needs more hands than there are.
    """
    if settings.second is None:
        if hands_of(kind) > 1:
            raise InputError(
                "this task is for two hands, and there is one",
                where=kind.name,
                expected="a device for each, or two hands on one",
                remedy=f"sandbox run {kind.name} --device simulated --device simulated",
            )
        return placed, (placed,)
    if hands_of(kind) == 1 or settings.second.shared:
        return placed, (placed, placed)
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
    """On which side each hand is: 1 is the right. The first one is, unless it is a left hand and
    the second a right one."""
    first, second = settings.persons
    return (-1, 1) if first.left and not second.left else (1, -1)


def home(hand: int, settings: RunSettings, surface: Surface) -> Array:
    """(2,) m in the world, the middle of a hand's own part of its surface.

    Args:
        hand: Which.
        settings: Of the run.
        surface: The hand's.
    """
    if settings.second is None or not settings.second.shared:
        return np.asarray(surface.to_world(surface.size / 2)[:2])
    return np.asarray(surface.to_world(homes(settings, surface)[hand])[:2])


def homes(settings: RunSettings, surface: Surface) -> Array:
    """(2, 2) m on a surface that two hands share, the middle of each hand's half."""
    return np.array([surface.size * [0.5 + 0.25 * side, 0.5] for side in sides_of(settings)])


def sharing(make_device: DeviceMaker, settings: RunSettings) -> PerHand:
    """Opens a device once, for two hands that share its surface.

    Args:
        make_device: Opens it.
        settings: Of the run.
    """
    parts: list[Device] = []

    def first(task: Task, surface: Surface) -> Device:
        parts[:] = SharedSurface(make_device(task, surface), homes(settings, surface)).parts
        return parts[0]

    def second(task: Task, surface: Surface) -> Device:
        return parts[1]

    return PerHand((first, second))


def merging(makers: PerHand) -> DeviceMaker:
    """Opens both hands' devices on one surface, as one that feels the touches of both."""

    def make(task: Task, surface: Surface) -> Device:
        first, second = (maker(task, surface) for maker in makers.makers)
        return MergedTouches((first, second))

    return make


def checked(makers: Sequence[DeviceMaker], hands: int, task: str) -> Sequence[DeviceMaker]:
    """The makers, as many as there are hands.

    Raises:
        InputError: There are more or fewer.
    """
    if len(makers) != hands:
        raise InputError("every hand needs a device of its own, or its share of one", where=task,
                         got=f"{len(makers)} for {hands} hands")  # fmt: skip
    return makers
