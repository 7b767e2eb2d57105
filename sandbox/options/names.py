"""Names on a command line, checked before anything is opened or shown for them."""

from __future__ import annotations

from typing import Protocol

from encoders.regression.model_registry import check_model_name
from sandbox.devices.registry import named_device
from tasks.registry import find_task


class NamedOptions(Protocol):
    """The options that name something; for each see `OneHandOptions`."""

    @property
    def task(self) -> str: ...

    @property
    def device(self) -> str: ...

    @property
    def second_device(self) -> str | None: ...

    @property
    def encoder(self) -> str: ...

    @property
    def robot(self) -> str: ...


def check_names(options: NamedOptions) -> None:
    """Checks the names of task, devices, encoder and robot.

    Raises:
        InputError: There is nothing of a name.
    """
    find_task(options.task)
    check_device_name(options.device)
    if options.second_device is not None:
        check_device_name(options.second_device, "--second-device")
    check_model_name(options.encoder)
    if options.robot:
        # This import reads mappings, which hands of people do without.
        from models.robot.known import find_robot

        find_robot(options.robot)


def check_device_name(name: str, option: str = "--device") -> None:
    """Checks that a name is that of a device, or that there is such a file.

    Raises:
        InputError: There is neither.
    """
    named_device(name, option)
