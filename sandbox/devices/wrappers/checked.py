"""Checks of frames from devices that were written elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from operator import index

from models.arithmetic.products import length
from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.session.device import Device


class CheckedDevice(DeviceWrapper):
    """Refuses what a device of somebody else's cannot have meant, with one clear error.

    `poll` must return frames, and contacts must be on the surface or near it: a contact that is
    further beyond the border than the surface's diagonal is in another unit than metres. Numbers
    of NumPy and the like become Python's, as recordings hold nothing else. A size that is not a
    number above 0, as hardware says that does not measure it, becomes None.

    Args:
        device: The device.
        surface: The touch surface.
        where: Place of its code, for error messages.
    """

    def __init__(self, device: Device, surface: Surface, where: str) -> None:
        super().__init__(device)
        self._size, self._where = surface.size, where

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The wrapped device's frames.

        Raises:
            DeviceError: They are not frames, hold something else than numbers, or a contact is far
                off the surface.
        """
        frames = self.device.poll(now)
        if not isinstance(frames, Sequence) or not all(isinstance(f, TouchFrame) for f in frames):
            raise DeviceError(
                "`poll` returned something else than frames",
                where=self._where,
                got=repr(frames)[:60],
                expected="a list of TouchFrame, empty if there is nothing new",
            )
        frames = [self._in_plain_numbers(frame) for frame in frames]
        width, height = self._size
        far = length(self._size)
        for frame in frames:
            for contact in frame.contacts:
                x, y = contact.x, contact.y
                if max(-x, x - width, -y, y - height) > far:
                    raise DeviceError(
                        "a contact is far off the surface",
                        where=self._where,
                        got=f"({x:g}, {y:g}) m",
                        expected=f"metres, on a surface of {width:g} x {height:g} m",
                    )
        return frames

    def _in_plain_numbers(self, frame: TouchFrame) -> TouchFrame:
        try:
            return TouchFrame(
                float(frame.time),
                tuple(map(_plain, frame.contacts)),
                None if frame.lift is None else float(frame.lift),
                frozenset(map(index, frame.cancelled)),
                frame.source,
            )
        except (TypeError, ValueError) as error:
            raise DeviceError(
                "a frame holds something else than numbers",
                where=self._where,
                got=str(error),
                expected="ids and labels that are integers, and lengths and times that are numbers",
            ) from None


def _plain(contact: Contact) -> Contact:
    """A contact whose numbers are Python's own.

    Raises:
        ValueError: Its id does not fit into 64 bits.
    """
    if not -(2**63) <= index(contact.id) < 2**63:
        raise ValueError(f"the id {contact.id} has more than 64 bits")
    label, extent = contact.label, contact.extent
    size = None if contact.size is None else float(contact.size)
    return Contact(
        index(contact.id),
        float(contact.x),
        float(contact.y),
        size if size is not None and 0.0 < size < inf else None,
        None if label is None else index(label),
        None if extent is None else (float(extent[0]), float(extent[1])),
    )
