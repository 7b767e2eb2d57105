"""External devices, written by users: opening, defaults of missing members, and error handling.

A package offers a device under a name by an entry point:

    [project.entry-points."hand_sandbox.devices"]
    my-lab-pad = "my_lab.pad:Pad"

`--device my-lab-pad[:ARGUMENT]` opens it. Without an entry point, a device is opened by
`FILE.py:CLASS[:ARGUMENT]` or `MODULE:CLASS[:ARGUMENT]`. A class is called with the touch surface
and the argument. Instead of a class, there may be a `DeviceEntry`; its options are then options of
the command line. An error in the code is reported when the device is opened.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, fields, is_dataclass, replace
from inspect import getdoc, signature
from typing import Any

import msgspec

from models.arithmetic import length
from models.errors import DeviceError, InputError
from models.frames import Contact, HandFrame, LandmarkFrame, TouchFrame
from models.plausible import JUMPED, ContactSizes, HandJumps
from models.plugins import failure
from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.devices.device import (
    AnyDevice,
    Device,
    DeviceEntry,
    DeviceWrapper,
    NoOptions,
    Place,
    PlayedOptions,
    Sees,
)
from sandbox.devices.registry import DEVICE_PLUGINS
from sandbox.devices.webcam.landmarks import PossibleHands

_REQUIRED_METHODS = ("poll", "close")
_FRAMES: dict[Sees, type[Any]] = {
    Sees.TOUCHES: TouchFrame,
    Sees.LEAP: HandFrame,
    Sees.HEADSET: HandFrame,
    Sees.CAMERA: LandmarkFrame,
}
"""Kind of input of a device -> class of its frames."""


def own_entry(text: str) -> tuple[DeviceEntry[PlayedOptions], str] | None:
    """Returns the entry and the argument of an external device; None if the text names none.

    Args:
        text: `NAME[:ARGUMENT]` of an installed package, `FILE.py:CLASS[:ARGUMENT]` or
            `MODULE:CLASS[:ARGUMENT]`.

    Raises:
        DeviceError: The device exists, but cannot be used.
    """
    plugin = DEVICE_PLUGINS.find(text)
    if plugin is None:
        return None
    found, where, argument = plugin
    if isinstance(found, DeviceEntry):
        return _declared(found, where), argument
    if not callable(found):
        raise DeviceError(
            "this is not a device",
            where=where,
            got=repr(found)[:80],
            expected="a class, called with surface and argument, or a DeviceEntry",
        )

    def open_class(options: PlayedOptions, place: Place) -> AnyDevice:
        if mismatch := _mismatch(found, place.surface, place.argument):
            raise DeviceError(
                "this device cannot be opened with a surface and an argument (text)",
                where=where,
                got=mismatch,
                expected="`__init__(self, surface, argument)`",
            )
        with DEVICE_PLUGINS.guarded(where):
            device = found(place.surface, place.argument)
        return GuardedDevice(adapted(device, where), place.surface, where)

    about = (getdoc(found) or "").partition("\n")[0]
    entry = DeviceEntry(
        about, open_class, PlayedOptions, argument="ARGUMENT", command_options=NoOptions
    )
    return entry, argument


def _declared(entry: DeviceEntry[Any], where: str) -> DeviceEntry[PlayedOptions]:
    """Wraps an external entry, so that its options are decoded and its device is guarded.

    Raises:
        DeviceError: The options are not a frozen dataclass with defaults.
    """
    for kind in (entry.options, entry.on_command_line):
        sound = is_dataclass(kind) and kind.__dataclass_params__.frozen  # type: ignore[attr-defined]
        if not sound or any(
            each.default is MISSING and each.default_factory is MISSING for each in fields(kind)
        ):
            raise DeviceError(
                "the options of this device cannot be used",
                where=where,
                got=getattr(kind, "__name__", repr(kind)[:60]),
                expected="a class with @dataclass(frozen=True), whose fields have defaults",
            )

    def decoded(options: PlayedOptions) -> Any:
        try:
            return msgspec.convert(dict(options.own), entry.options, strict=False)
        except (msgspec.ValidationError, InputError) as error:
            raise DeviceError(
                "an option of the device cannot be used", where=where, got=str(error)
            ) from None

    def open_declared(options: PlayedOptions, place: Place) -> AnyDevice:
        given = decoded(options)
        with DEVICE_PLUGINS.guarded(where):
            device = entry.open(given, place)
        frames = _FRAMES[entry.kind.sees]
        return GuardedDevice(adapted(device, where), place.surface, where, frames)

    def check(options: PlayedOptions, argument: str) -> None:
        given = decoded(options)
        with DEVICE_PLUGINS.guarded(where):
            entry.check(given, argument)

    return replace(entry, open=open_declared, check=check)


def _mismatch(device_class: Any, *given: object) -> str:
    """Returns why a class does not accept the arguments; empty if it does or has no signature."""
    try:
        signature(device_class).bind(*given)
    except TypeError as error:
        return str(error)
    except ValueError:
        return ""
    return ""


class AdaptedDevice(Device):
    """Adapter for a device that is not an `AnyDevice`: supplies defaults of missing members.

    The device needs `name`, `poll`, `finished` and `close`. Each of its members is read from it at
    every access. A missing member has the default of `AnyDevice`.

    Args:
        device: The external device.
    """

    def __init__(self, device: Any) -> None:
        self.__dict__["_device"] = device

    def __getattribute__(self, member: str) -> Any:
        if not member.startswith("_"):
            device = object.__getattribute__(self, "_device")
            if hasattr(device, member):
                return getattr(device, member)
            if member == "takes_snapshots":
                return hasattr(device, "show")
        return super().__getattribute__(member)

    def __setattr__(self, member: str, value: Any) -> None:
        setattr(self._device, member, value)

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames."""
        frames: Sequence[TouchFrame] = self._device.poll(now)
        return frames


def adapted(device: Any, where: str) -> AnyDevice:
    """Returns the device itself if it is an `AnyDevice`, else an `AdaptedDevice` around it.

    Args:
        device: Object that external code returned as a device.
        where: Name of that code, for error messages.

    Raises:
        DeviceError: A required member is missing.
    """
    if isinstance(device, AnyDevice):
        return device
    missing = [part for part in _REQUIRED_METHODS if not callable(getattr(device, part, None))]
    missing += [part for part in ("name", "finished") if not hasattr(device, part)]
    if missing:
        raise DeviceError(
            "the object is not a device",
            where=where,
            got=f"without {', '.join(missing)}",
            expected="name, poll, finished and close",
            remedy="docs/write-a-device.md shows a device of 30 lines",
        )
    return AdaptedDevice(device)


class GuardedDevice(DeviceWrapper):
    """Checks the frames of an external device, and converts exceptions in its `poll` to one error.

    Frames check their own values when they are made (`models.frames`). This class checks more: A
    contact far off the surface is an error, because its unit must be wrong. An impossible size of a
    contact becomes an unknown size. A hand that jumps is left out. All other rules for devices are
    checked by `check_device`, which the device's author runs.

    Args:
        device: The device.
        surface: The touch surface.
        where: Name of the device's code, for error messages.
        frames: Class of the device's frames.
    """

    def __init__(
        self, device: AnyDevice, surface: Surface, where: str, frames: type[Any] = TouchFrame
    ) -> None:
        super().__init__(device)
        self._surface, self._where, self._frames = surface, where, frames
        self._report = ReaderReport()
        self._sizes = ContactSizes(self._report)
        self._jumps, self._pictures = HandJumps(), PossibleHands()

    @property
    def report(self) -> ReaderReport:
        """Report of the wrapped device; if it has none, data left out by this class."""
        return self.device.report or self._report

    def poll(self, now: float) -> Sequence[Any]:
        """Returns the wrapped device's frames, without impossible parts.

        Raises:
            DeviceError: The device raises an exception or returns anything other than frames of its
                kind, or a contact is far off the surface.
        """
        try:
            frames = self.device.poll(now)
            sound = all(isinstance(frame, self._frames) for frame in frames)
        except DeviceError:
            raise
        except (Exception, SystemExit) as error:
            raise DeviceError(
                "`poll` of this device fails", where=self._where, got=failure(error)
            ) from error
        if not sound:
            raise DeviceError(
                "`poll` returned something else than frames",
                where=self._where,
                got=repr(frames)[:60],
                expected=f"a list of {self._frames.__name__}, empty if there is nothing new",
            )
        for frame in frames:
            for contact in frame.contacts if isinstance(frame, TouchFrame) else ():
                if is_far_off(contact, self._surface):
                    raise far_off(contact, self._surface, self._where)
        return [self._possible(frame) for frame in frames]

    def _possible(self, frame: Any) -> Any:
        """Returns the frame without impossible sizes, jumps and hands."""
        if isinstance(frame, TouchFrame):
            return self._sized(frame)
        if isinstance(frame, HandFrame):
            jumped = self._jumps.find(frame.time, {hand.id: hand.palm for hand in frame.hands})
            if jumped:
                self._report.leave_out(JUMPED, len(jumped))
                return replace(frame, hands=tuple(h for h in frame.hands if h.id not in jumped))
        elif isinstance(frame, LandmarkFrame):
            return self._pictures.only(frame, self._report.left_out)
        return frame

    def _sized(self, frame: TouchFrame) -> TouchFrame:
        """Returns the frame with impossible sizes of contacts as unknown sizes."""
        contacts = []
        for contact in frame.contacts:
            size = contact.size, contact.extent
            known = size if size == (None, None) else self._sizes.known(*size)
            contacts.append(
                contact if known == size else replace(contact, size=known[0], extent=known[1])
            )
        same = all(a is b for a, b in zip(contacts, frame.contacts, strict=True))
        return frame if same else replace(frame, contacts=tuple(contacts))


def is_far_off(contact: Contact, surface: Surface) -> bool:
    """True if a contact is farther outside the surface than the length of its diagonal."""
    width, height = surface.size
    x, y = contact.x, contact.y
    return bool(max(-x, x - width, -y, y - height) > length(surface.size))


def far_off(contact: Contact, surface: Surface, where: str) -> DeviceError:
    """Returns the error for a contact that is far off, because its unit is not metres."""
    width, height = surface.size
    return DeviceError(
        "a contact is far off the surface",
        where=where,
        got=f"({contact.x:g}, {contact.y:g}) m",
        expected=f"metres, on a surface of {width:g} x {height:g} m",
    )
