"""A lift control for tasks that need one."""

from __future__ import annotations

from functools import partial

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.wrappers.playing import LiftKeys
from sandbox.trial.open_devices import DeviceMaker, DeviceMakers
from sandbox.trial.settings import Settings
from tasks.registry import find_task
from tasks.task import Task


def lifts(settings: Settings) -> bool:
    """True if a trial needs a lift control: its task lifts, and a hand touches a surface."""
    return find_task(settings.task).lift_range > 0 and not settings.in_air


def with_lift(makers: DeviceMakers, keys: bool) -> DeviceMakers:
    """Makers that add a lift control to devices without one, if the task needs it.

    The returned makers raise `InputError` if the task needs a lift control and none is available.

    Args:
        makers: Functions that open the devices.
        keys: A window's keys can serve as a lift control.
    """

    controls: list[LiftKeys] = []

    def lifted(maker: DeviceMaker, task: Task, surface: Surface) -> Device:
        device = maker(task, surface)
        if task.lift_range <= 0 or device.lift:
            return device
        if keys:
            controls.append(LiftKeys(device, controls[0] if controls else None))
            return controls[-1]
        device.close()
        raise InputError(
            "this task needs a lift control, and this device has none",
            where=task.name,
            got=device.name,
            expected="a device with a lift control: simulated, web or a recording",
            remedy=f"`sandbox play {task.name}` lifts with the keys up and down, with any device",
        )

    def first(task: Task, surface: Surface) -> Device:
        controls.clear()
        return lifted(makers[0], task, surface)

    return (first, *(partial(lifted, maker) for maker in makers[1:]))
