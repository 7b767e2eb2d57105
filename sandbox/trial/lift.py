"""A lift control for tasks that need one."""

from __future__ import annotations

from functools import partial

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.wrappers.lift_keys import LiftKeys
from sandbox.session.device import Device
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from tasks.task import Task


def with_lift(makers: DeviceMakers, keys: bool) -> DeviceMakers:
    """Sees to it that a task which needs a lift control gets one.

    Args:
        makers: Open the devices themselves.
        keys: There is a window whose keys can lift.

    Raises:
        InputError: By what is returned: the task needs a lift control, and there is none.
    """

    led: list[LiftKeys] = []

    def lifted(maker: DeviceMaker, task: Task, surface: Surface) -> Device:
        device = maker(task, surface)
        if task.lift_range <= 0 or device.has_lift:
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

    return (first, *(partial(lifted, maker) for maker in makers[1:]))
