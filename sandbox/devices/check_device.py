"""Checks that a device follows the rules for devices; its author runs the check.

    from sandbox import check_device

    def test_my_pad():
        check_device(MyPad)

Sessions do not run this check. They poll the device, and stop with one line if its code fails.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from models.errors import DeviceError
from models.frames import Frame, HandFrame, LandmarkFrame, TouchFrame
from models.plugins import failure
from models.surface import Surface
from sandbox.devices.device import AnyDevice, DeviceEntry, Place
from sandbox.devices.own_device import adapted, far_off, is_far_off
from sandbox.devices.registry import DeviceSettings, find_device

T = TypeVar("T")

SIZE = Surface(10.0, 5.0)
"""Surface on which a device is opened, unless another is given."""

STEPS = 60
"""Number of polls before each of which `make_touches` is called."""

PERIOD = 1.0 / 60.0
"""Session time between two polls (s)."""

PATIENCE = 20.0
"""Time (s) after which a call that has not returned counts as hanging."""

LONGEST_WAIT = 0.008
"""Longest time (s) that `poll` may wait: half a control period."""

SLACK = 1e-6
"""Largest distance (m) of a contact beyond the surface."""

_FRAMES = (TouchFrame, HandFrame, LandmarkFrame)


def check_device(
    open_device: Callable[[Surface], Any] | type[Any] | DeviceEntry[Any] | str,
    make_touches: Callable[[Any, int], None] | None = None,
    surface: Surface = SIZE,
) -> None:
    """Checks that a device follows the rules for devices, as Gymnasium's `check_env` does.

    The device is opened twice, polled as in a session, and closed.

    Args:
        open_device: A class, which is called with the surface and an empty argument; a function
            that opens the device on a surface; an entry, opened with the defaults of its options;
            or the device's name on the command line.
        make_touches: Called with the device and the number of the poll, 0 to 59, before each poll,
            to make touches. With None, the device acts by itself.
        surface: The touch surface.

    Raises:
        DeviceError: The device breaks a rule; the error is about the first one. The device raises
            an exception, or waits in `poll`. It returns anything other than frames, a frame twice,
            frames whose time runs backwards, or contacts off the surface. It uses the id of a
            lifted finger again. It has not finished when closed, or still has frames then. It
            cannot be closed twice, or opened again.
    """
    device, where = _open(open_device, surface)
    try:
        _check_words(device, where)
        frames = _watch(device, where, make_touches)
    finally:
        _call(device.close, where, "close")
    check_frames(frames, surface, where)
    _check_ids(frames, where)
    _check_closed(device, where, surface)
    again, where = _open(open_device, surface)
    try:
        _watch(again, where, make_touches)
        _check_waits(again, where)
    finally:
        _call(again.close, where, "close")


def check_frames(
    frames: Sequence[Frame], surface: Surface, where: str = "the device", whole: bool = True
) -> None:
    """Checks that a device's frames follow the rules.

    Args:
        frames: All polled frames, in order.
        surface: Surface of the device.
        where: The device, for messages.
        whole: True if the first frame is the device's first, so that no finger was down before.

    Raises:
        DeviceError: A frame breaks a rule, which the message names.
    """
    last = None
    present: frozenset[int] | None = frozenset() if whole else None
    for n, frame in enumerate(frames):
        if not isinstance(frame, _FRAMES):
            raise DeviceError(
                "`poll` returned something else than frames",
                where=f"{where}, frame {n}",
                got=repr(frame)[:60],
                expected="TouchFrame",
            )
        at = f"{where}, frame {n} at {frame.time:g} s"
        if last is not None and frame.time < last:
            raise DeviceError(
                "time runs backwards",
                where=at,
                got=f"after a frame at {last:g} s",
                expected="times that never decrease",
            )
        last = frame.time
        if isinstance(frame, TouchFrame):
            _check_contacts(frame, surface, at)
            ids = frozenset(contact.id for contact in frame.contacts)
            _check_cancelled(frame, ids, present, at)
            present = ids


def _check_contacts(frame: TouchFrame, surface: Surface, where: str) -> None:
    """Checks that contacts are on the surface and not larger than it.

    Raises:
        DeviceError: A contact is off the surface or larger than it.
    """
    width, height = (float(size) for size in surface.size)
    for contact in frame.contacts:
        x, y = contact.x, contact.y
        if is_far_off(contact, surface):
            raise far_off(contact, surface, f"{where}, contact {contact.id}")
        if max(-x, x - width, -y, y - height) > SLACK:
            raise DeviceError(
                "a contact is off the surface",
                where=f"{where}, contact {contact.id}",
                got=f"({x:g}, {y:g}) m",
                expected=f"0 to {width:g} and 0 to {height:g} m",
                remedy="Move the contact of a finger that leaves the surface to its border",
            )
        if contact.size is not None and contact.size >= max(width, height):
            raise DeviceError(
                "a contact is larger than the surface",
                where=f"{where}, contact {contact.id}",
                got=f"{contact.size:g} m",
                expected="its diameter in m",
            )


def _check_cancelled(
    frame: TouchFrame, ids: frozenset[int], present: frozenset[int] | None, where: str
) -> None:
    """Checks that cancelled ids were contacts in the previous frame and no longer are.

    Args:
        frame: The frame.
        ids: Ids of its contacts.
        present: Ids of the contacts of the previous frame; None if they are unknown.
        where: The frame, for messages.

    Raises:
        DeviceError: A cancelled id is still a contact, or was none before.
    """
    if both := frame.cancelled & ids:
        raise DeviceError(
            "an id is cancelled and among the contacts",
            where=where,
            got=str(sorted(both)),
            remedy="Leave cancelled touches out of `contacts`",
        )
    if present is not None and (unknown := frame.cancelled - present):
        raise DeviceError(
            "an id is cancelled that was no contact before",
            where=where,
            got=str(sorted(unknown)),
            expected="ids of contacts of the previous frame",
        )


def _check_ids(frames: Sequence[Frame], where: str) -> None:
    """Checks that no id of a lifted finger is used again.

    Raises:
        DeviceError: An id is used again.
    """
    down: set[int] = set()
    lifted: set[int] = set()
    for frame in frames:
        if not isinstance(frame, TouchFrame):
            continue
        ids = {contact.id for contact in frame.contacts}
        lifted |= down - ids
        down = ids
        if again := ids & lifted:
            raise DeviceError(
                "the id of a lifted finger comes again",
                where=f"{where}, at {frame.time:g} s",
                got=str(sorted(again)),
                expected="a new id for every finger that comes down",
            )


def _check_words(device: AnyDevice, where: str) -> None:
    """Checks the members `name` and `finished`.

    Raises:
        DeviceError: `name` is not a printable text, or `finished` is neither true nor false.
    """
    name: object = device.name
    if not (isinstance(name, str) and name and name.isprintable()):
        raise DeviceError(
            "the device has no name",
            where=where,
            got=repr(name)[:60],
            expected="`name`, a text that can be printed",
        )
    finished: object = device.finished
    if not isinstance(finished, bool):
        raise DeviceError(
            "`finished` is neither true nor false",
            where=where,
            got=repr(finished)[:60],
            expected="True or False",
        )


def _watch(
    device: AnyDevice, where: str, make_touches: Callable[[Any, int], None] | None
) -> list[Frame]:
    """Polls a device as a session does, and returns its frames.

    Raises:
        DeviceError: `poll` fails or hangs, or returns anything other than a sequence, a frame
            twice, or a frame after the device had finished.
    """
    frames: list[Frame] = []
    for step in range(STEPS + 1):
        if make_touches is not None and step < STEPS:
            make_touches(device, step)
        over = device.finished
        got = _poll(device, where, step * PERIOD)
        if over and got:
            raise DeviceError(
                "a frame comes after the device had finished",
                where=where,
                got=repr(got[0])[:80],
                remedy="`finished` becomes true only after `poll` has returned the last frame",
            )
        if twice := [frame for frame in got if any(frame is old for old in frames)]:
            raise DeviceError(
                "a frame comes twice",
                where=where,
                got=repr(twice[0])[:80],
                remedy="`poll` returns only frames since the last call",
            )
        frames += got
    return frames


def _check_closed(device: AnyDevice, where: str, surface: Surface) -> None:
    """Checks a closed device: it can be closed again, has no more frames, and has finished.

    Raises:
        DeviceError: Closing it again fails, it still has frames, or it has not finished.
    """
    _call(device.close, where, "the second close")
    check_frames(_poll(device, where, STEPS * PERIOD), surface, where, whole=False)
    if rest := _poll(device, where, STEPS * PERIOD):
        raise DeviceError(
            "a closed device still has frames",
            where=where,
            got=repr(rest[0])[:80],
            expected="an empty list from `poll`",
        )
    if device.finished is not True:
        raise DeviceError(
            "a closed device has not finished",
            where=where,
            got=repr(device.finished)[:60],
            expected="`finished` is true",
            remedy="`close` calls `super().close()`, or sets `self.finished = True`",
        )


def _check_waits(device: AnyDevice, where: str) -> None:
    """Checks that `poll` returns at once, also when nothing happens.

    Raises:
        DeviceError: `poll` waits, so that a session would fall behind.
    """
    times = [n * PERIOD for n in range(STEPS + 1, 11 * STEPS)]
    waits = _call(lambda: sorted(_wait(device, now) for now in times), where, "poll")
    # The median, since some polls take long on a busy machine.
    middle = waits[len(waits) // 2]
    if middle >= LONGEST_WAIT:
        raise DeviceError(
            "`poll` waits, so that sessions fall behind",
            where=where,
            got=f"{1000 * middle:.1f} ms",
            expected=f"less than {1000 * LONGEST_WAIT:g} ms",
            remedy="Move reads that may block to a thread of the device",
        )


def _wait(device: AnyDevice, now: float) -> float:
    """Polls a device; returns the time (s) of waiting: duration minus computing time."""
    began, busy = time.perf_counter(), time.thread_time()
    device.poll(now)
    return (time.perf_counter() - began) - (time.thread_time() - busy)


def _poll(device: AnyDevice, where: str, now: float) -> list[Frame]:
    frames: object = _call(lambda: device.poll(now), where, "poll")
    if not isinstance(frames, Sequence):
        raise DeviceError(
            "`poll` returned something else than frames",
            where=where,
            got=repr(frames)[:60],
            expected="a list of TouchFrame, empty if there is nothing new",
        )
    return list(frames)


def _open(
    open_device: Callable[[Surface], Any] | type[Any] | DeviceEntry[Any] | str, surface: Surface
) -> tuple[AnyDevice, str]:
    """Opens the device; returns it, and its name for messages."""
    where = open_device if isinstance(open_device, str) else "the device"

    def opened() -> Any:
        if isinstance(open_device, DeviceEntry):
            return open_device.open(open_device.options(), Place(surface))
        if isinstance(open_device, str):
            if find_device(open_device) is None:
                raise DeviceError(
                    "no such device",
                    got=open_device,
                    expected="a name, FILE.py:CLASS or MODULE:CLASS, as for --device",
                )
            return DeviceSettings.of(open_device).open(Place(surface))
        return open_device(surface, "") if isinstance(open_device, type) else open_device(surface)

    device = _call(opened, where, "opening")
    if not isinstance(open_device, str):
        where = type(device).__qualname__
    return device if isinstance(device, AnyDevice) else adapted(device, where), where


def _call(call: Callable[[], T], where: str, name: str) -> T:
    """Returns the result of a call.

    Raises:
        DeviceError: The call fails, or has not returned after `PATIENCE`.
    """
    done: list[T] = []
    raised: list[BaseException] = []

    def run() -> None:
        try:
            done.append(call())
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    if thread.is_alive():
        raise DeviceError(f"{name} has not returned after {PATIENCE:g} s", where=where)
    if raised and isinstance(raised[0], DeviceError):
        raise raised[0]
    if raised:
        raise DeviceError(f"{name} fails", where=where, got=failure(raised[0])) from raised[0]
    return done[0]
