"""Options for touch devices, and functions that open touch devices and files of touches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from cyclopts import Parameter
from rich.console import Console

from models.errors import InputError
from models.surface import parse_surface
from sandbox.devices.device import Device, Place, UnitOptions
from sandbox.devices.evdev import EvdevOptions
from sandbox.devices.registry import (
    DeviceSettings,
    check_device_options,
    find_device,
    given_device_options,
    touch_devices,
)
from sandbox.devices.tuio import STALE_AFTER, TuioOptions, open_tuio
from sandbox.server.page_options import PageOptions
from sandbox.trial.trial_options import COMMON, device_heading

if TYPE_CHECKING:
    from sandbox.devices.files.touch_files import Opened
    from sandbox.devices.tuio.tuio import Tap


@dataclass(frozen=True, kw_only=True)
class LiveTouchOptions(TuioOptions, EvdevOptions):
    """Options for TUIO senders and for touch screens of this machine."""


@dataclass(frozen=True, kw_only=True)
class TouchOptions(UnitOptions, PageOptions, LiveTouchOptions):
    """Source of touches."""

    device: Annotated[str, Parameter(group=COMMON, metavar="DEVICE")] = "tuio"
    """Source of the touches. tuio: senders of TUIO 1.1 and 2.0. web: a page in a browser; add
    --tablet for a tablet in the network. evdev, evdev:NODE: a touch screen or trackpad of this
    Linux machine. FILE: a file written by `sandbox touches record`, a recording of this program, or
    a capture of TUIO packets. FILE.py:CLASS[:ARGUMENT], or a name from an installed package: a
    device of your own. `sandbox touches formats` lists all."""

    surface: Annotated[str | None, Parameter(group=COMMON, metavar="SIZE")] = None
    """Size of the touch area: 7.76x5.82in, 197x148mm, or a preset (ipad2, ipad-11, ipad-13,
    ipad-mini). TUIO does not transmit the size, so without this option the size is a guess. The
    size of a browser page is measured on the page, and most touch screens report theirs."""

    stale_after: Annotated[float, Parameter(group=device_heading("tuio"))] = STALE_AFTER
    """Seconds without a packet after which the touches of a TUIO sender are lifted."""

    @property
    def settings(self) -> DeviceSettings:
        """The device and its options.

        Raises:
            InputError: An option of another device is given.
        """
        given = given_device_options(self)
        check_device_options(given, [self.device])
        return DeviceSettings.of(self.device, given)

    @property
    def is_page(self) -> bool:
        """True if the touches come from the page: --device web, --tablet or --lan."""
        return self.device == "web" or self.tablet or self.lan is not None


def refuse_unit(options: TouchOptions) -> None:
    """Refuses --unit for a device that does not play a file.

    Raises:
        InputError: --unit is given.
    """
    if options.unit:
        raise InputError(
            "units can be chosen only for a file",
            where="--unit",
            got=f"--device {options.device}",
            expected="--device FILE",
            remedy="Leave out --unit",
        )


def open_touches(options: TouchOptions, tap: Tap | None = None) -> Opened:
    """Opens a live device or a file, but not the page.

    Raises:
        InputError: The device or file is missing or cannot be opened.
    """
    # Commands that open no touches also import this module: import the readers late.
    from sandbox.devices.files.touch_files import Opened, guessed_surface, open_file

    given = parse_surface(options.surface) if options.surface else None
    named, settings = find_device(options.device), options.settings
    if named is None or named.argument == options.device:
        return open_file(Path(options.device), given, options.stale_after, options.unit)
    refuse_unit(options)
    if named.entry.kind.in_scene:
        raise InputError(
            "this device needs a scene",
            where="--device",
            got=options.device,
            expected=f"{', '.join(touch_devices())}, a device of your own, or a file",
            remedy=f"`sandbox play --device {options.device}` plays it in a scene",
        )
    settings.check()
    guess = replace(guessed_surface(), calibrated=not named.entry.kind.guessed_size)
    size = given or named.surface(given_device_options(options)) or guess
    if options.device == "tuio":
        place = Place(size)
        return Opened(open_tuio(settings.options, place, tap, options.stale_after), size)
    return Opened(cast(Device, settings.open(Place(size))), size)


def open_touches_or_page(options: TouchOptions, seconds: float, tap: Any = None) -> Opened | None:
    """Opens the device; returns None if no browser has opened the page in time."""
    if not options.is_page:
        return open_touches(options, tap)
    refuse_unit(options)
    # These imports load the whole program, which only the page needs.
    from sandbox.devices.files.touch_files import Opened
    from sandbox.play.page_touches import open_page_touches

    page = open_page_touches(options, Console(stderr=True), seconds)
    return None if page is None else Opened(page, page.surface)
