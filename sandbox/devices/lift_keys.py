"""Two keys as a lift control, for devices that have none of their own."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from models.errors import InputError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.around import Around
from sandbox.devices.device import Device
from sandbox.two_hands import DeviceMaker, PerHand, makers_of
from tasks.task import Task

SPEED = 0.45
"""Of the whole lift per second, while a key is held."""


class LiftKeys(Around):
    """A device with a lift control beside it. Safe to use from two threads.

    Args:
        device: Where the touches come from.
        leader: Whose lift this one's is: of two hands, the same keys lift both.

    Attributes:
        has_lift: It has a lift control, by name as in other devices.
    """

    has_lift = True

    def __init__(self, device: Device, leader: LiftKeys | None = None) -> None:
        super().__init__(device)
        self._leader = leader
        self._lock = threading.Lock()
        self._direction = 0.0
        self._tapped = 0.0
        self._lift = 0.0
        self._now = 0.0
        self._last = TouchFrame(0.0)

    def hold(self, direction: float) -> None:
        """A key goes down: 1 lifts, -1 lowers; 0: no key is held any more."""
        with self._lock:
            self._direction = direction
            # A key that is tapped between two polls does something all the same.
            self._tapped = direction or self._tapped

    def follow(self, lift: float) -> None:
        """Another control has moved the hand; the keys go on from there. Tells no frame."""
        with self._lock:
            self._lift = lift

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames with the lift in them, and one more where only the lift changed."""
        with self._lock:
            direction, self._tapped = self._direction or self._tapped, 0.0
        passed, self._now = max(now - self._now, 0.0), now
        before = self._lift
        self._lift = min(max(before + direction * SPEED * passed, 0.0), 1.0)
        if self._leader is not None:
            self._lift = self._leader._lift
        frames = [replace(frame, lift=self._lift) for frame in self.device.poll(now)]
        if not frames and self._lift != before:
            frames = [replace(self._last, lift=self._lift, cancelled=frozenset())]
        if frames:
            self._last = frames[-1]
        return frames


def with_lift(make_device: DeviceMaker, keys: bool) -> DeviceMaker:
    """Sees to it that a task which needs a lift control gets one.

    Args:
        make_device: Opens the device itself.
        keys: There is a window whose keys can lift.

    Raises:
        InputError: By what is returned: the task needs a lift control, and there is none.
    """

    led: list[LiftKeys] = []

    def lifted(maker: DeviceMaker, task: Task, surface: Surface) -> Device:
        device = maker(task, surface)
        if task.lift_range <= 0 or getattr(device, "has_lift", False):
            return device
        if keys:
            led.append(LiftKeys(device, led[0] if led else None))
            return led[-1]
        device.close()
        raise InputError(
            "this task needs a lift control, and this device has none",
            where=task.name,
            got=device.name,
            expected="a device with a lift control, as the simulated user, the page or a recording",
            remedy=f"`sandbox play {task.name}` lifts with the keys up and down, whatever touches",
        )

    def first(task: Task, surface: Surface) -> Device:
        led.clear()
        return lifted(makers[0], task, surface)

    makers = makers_of(make_device)
    if len(makers) == 1:
        return first
    others = [partial(lifted, maker) for maker in makers[1:]]
    return PerHand((first, *others))
