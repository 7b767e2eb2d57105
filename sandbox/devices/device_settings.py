"""Settings of a device: its name, and options that the named device declares."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import msgspec

from models.errors import InputError, RecordingError, unknown_name
from sandbox.devices.registry import device_options
from sandbox.devices.simulated.options import SimulatedOptions
from tasks.user import UserConfiguration


@dataclass(frozen=True)
class DeviceSettings:
    """A device and how it is opened."""

    name: str = "simulated"
    """Built-in device (`sandbox.devices.registry`), the name or place of somebody's own, or a file
    that is played."""

    options: Any = field(default_factory=SimulatedOptions)
    """Options of the device, of the class that its registry entry names."""

    @classmethod
    def of(cls, name: str, given: Mapping[str, Any] | None = None) -> DeviceSettings:
        """Settings of a device by its name.

        Args:
            name: As in `name`.
            given: Values of options by name; those of other devices are left out.
        """
        kind = device_options(name)
        known = {each.name for each in fields(kind)}
        return cls(name, kind(**{k: v for k, v in (given or {}).items() if k in known}))

    @property
    def user(self) -> UserConfiguration | None:
        """The simulated user who drives the device, or drove the recording; None for a person."""
        user: UserConfiguration | None = getattr(self.options, "user", None)
        return user

    def decoded(self) -> DeviceSettings:
        """The same with options of the named device's class, where they are still JSON.

        Missing ones have their defaults: an anonymous copy has no addresses, and no replay depends
        on them.

        Raises:
            RecordingError: The device has no such option, or a value has the wrong type.
        """
        kind = device_options(self.name)
        if isinstance(self.options, kind):
            return self
        where = f"settings.device {self.name}"
        values = self.options if isinstance(self.options, Mapping) else {}
        known = [each.name for each in fields(kind)]
        for option in values:
            if option not in known:
                what = "this device has no such option"
                raise unknown_name(what, option, known, where=where, kind=RecordingError)
        try:
            return replace(self, options=msgspec.convert(values, kind))
        except (msgspec.ValidationError, InputError) as error:
            raise RecordingError(
                "an option of the device cannot be read", where=where, got=str(error)
            ) from None
