"""External devices: from installed packages by entry point, from a file, or from a module.

A package offers its devices under a name:

    [project.entry-points."hand_sandbox.devices"]
    my-lab-pad = "my_lab.pad:Pad"

and `--device my-lab-pad` or `--device my-lab-pad:ARGUMENT` opens it. The offered class or function
is called with the touch surface and the argument (an empty text without one), and returns a device
(see `sandbox.session.device`). An error in it is reported only when the device is opened.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import EntryPoint
from inspect import signature
from typing import Any

from models.errors import DeviceError
from models.frames import TouchFrame
from models.outside import OutsideKind, place_in
from models.surface import Surface
from sandbox.devices.wrappers.checked import CheckedDevice
from sandbox.session.device import Device

OUTSIDE = OutsideKind("device", "hand_sandbox.devices", DeviceError, loaded="opened")

OWN_DEVICE = "FILE.py:CLASS[:ARGUMENT]"
"""Form of a device in a file, for error messages."""

Maker = Callable[[Surface], Device]

_CALLED = ("poll", "close")
_TAKEN_OVER = (
    "name",
    "has_lift",
    "show",
    "switches",
    "wait",
    "address",
    "title",
    "plays_file",
    "latency",
)
"""Members whose values are copied when a device is adapted; see `sandbox.session.device`. The other
members are read on every access, because they may change."""


def offered_devices() -> dict[str, list[EntryPoint]]:
    """Entry points of the devices that installed packages offer, by name; loads none of them."""
    return OUTSIDE.offered()


def find_device(text: str) -> Maker | None:
    """A function that opens an external device; None if the text does not name one.

    Args:
        text: `NAME[:ARGUMENT]` of an installed package, `FILE.py:CLASS[:ARGUMENT]` or
            `MODULE:CLASS[:ARGUMENT]`.

    Raises:
        DeviceError: The device exists, but cannot be used.
    """
    name, _, argument = text.partition(":")
    loaded = OUTSIDE.load_offered(name)
    if loaded:
        return _opener(loaded.thing, argument, loaded.where)
    place = place_in(text)
    # A class begins with a capital letter, unlike what may follow a built-in device's name.
    if place is None or not place.member or not (place.in_file or "A" <= place.member[0] <= "Z"):
        return None
    device_class, where = OUTSIDE.load_place(place)
    if not callable(device_class):
        raise DeviceError("the module has no device of this name", where=where, got=place.member)
    return _opener(device_class, place.argument or "", where)


class AdaptedDevice(Device):
    """Adapter for a touch device that was written without the base class `Device`.

    The device needs `name`, `poll`, `finished` and `close`; missing members have their defaults.

    Args:
        outside: The external device.
    """

    name: str

    def __init__(self, outside: Any) -> None:
        self._outside = outside
        for member in _TAKEN_OVER:
            if hasattr(outside, member):
                setattr(self, member, getattr(outside, member))

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames."""
        frames: Sequence[TouchFrame] = self._outside.poll(now)
        return frames

    @property
    def finished(self) -> bool:
        """The device's."""
        return bool(self._outside.finished)

    def close(self) -> None:
        """Closes the device."""
        self._outside.close()

    @property
    def notice(self) -> str:
        """The device's; empty if it has none."""
        return str(getattr(self._outside, "notice", ""))

    @property
    def looks(self) -> bool:
        """True if the device has `show`."""
        return hasattr(self._outside, "show")

    @property
    def damage(self) -> Exception | None:
        """The device's, which may find it out as it plays; None if it has none."""
        damage: Exception | None = getattr(self._outside, "damage", None)
        return damage

    @property
    def clock_origin(self) -> float | None:
        """The device's, which may know it from its first frame on; 0 if it has none."""
        origin: float | None = getattr(self._outside, "clock_origin", 0.0)
        return origin

    @property
    def truth(self) -> Mapping[int, int]:
        """The device's, which may come to know it with the touches; empty if it has none."""
        truth: Mapping[int, int] = getattr(self._outside, "truth", {})
        return truth

    @property
    def news(self) -> threading.Event | None:
        """The device's; setting it gives the device another event."""
        news: threading.Event | None = getattr(self._outside, "news", None)
        return news

    @news.setter
    def news(self, news: threading.Event | None) -> None:
        self._outside.news = news


def adapted(outside: Any, where: str) -> Device:
    """The device with all members of the contract, in an adapter if necessary.

    Args:
        outside: Object that external code returned as a device.
        where: Place of that code, for error messages.

    Raises:
        DeviceError: A required member is missing.
    """
    if isinstance(outside, Device):
        return outside
    lacking = [part for part in _CALLED if not callable(getattr(outside, part, None))]
    lacking += [part for part in ("name", "finished") if not hasattr(outside, part)]
    if lacking:
        raise DeviceError(
            "the object is not a device",
            where=where,
            got=f"without {', '.join(lacking)}",
            expected="name, poll, finished and close",
            remedy="docs/write-a-device.md shows a device of 30 lines",
        )
    return AdaptedDevice(outside)


def _opener(device_class: Any, argument: str, where: str) -> Maker:
    def make(surface: Surface) -> Device:
        if mismatch := _mismatch(device_class, surface, argument):
            raise DeviceError(
                "this device cannot be opened with a surface and a text",
                where=where,
                got=mismatch,
                expected="`__init__(self, surface, argument)`",
            )
        with OUTSIDE.guarded(where):
            device = device_class(surface, argument)
        return CheckedDevice(adapted(device, where), surface, where)

    return make


def _mismatch(device_class: Any, *given: object) -> str:
    """Why a class does not take some arguments; empty if it does, or has no signature that says."""
    try:
        signature(device_class).bind(*given)
    except TypeError as error:
        return str(error)
    except ValueError:
        return ""
    return ""
