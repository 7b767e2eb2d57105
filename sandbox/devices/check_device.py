"""Checks a device for its author: everything that a device must keep to.

    from sandbox import check_device

    def test_my_pad():
        check_device(MyPad)

A session does not do this: it polls, and stops with one line where the device's own code fails.
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
"""Number of polls with touches, as a session makes them."""

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
    """Checks that a device keeps to the rules for devices; for its author, as Gymnasium's
    `check_env`.

    The device is opened twice, polled as a session does, and closed.

    Args:
        open_device: A class, which is called with the surface and an empty argument; or a function
            that opens the device on a surface; or an entry, which opens it with the defaults of its
            options; or how it is named on the command line.
        make_touches: Called with the device and the number of the poll, 0 to 59, before each; it
            makes fingers do something. None lets the device act by itself.
        surface: The touch surface.

    Raises:
        DeviceError: The first rule that the device breaks: it fails, waits in `poll`, returns
            something else than frames, or frames twice, or frames whose time runs backwards, or
            that are off the surface; it uses the id of a lifted finger again; it is not finished
            once closed, or has frames afterwards; it cannot be closed twice or opened again.
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
    """Checks that a device's frames keep to the rules.

    Args:
        frames: All polled frames, in order.
        surface: Surface of the device.
        where: The device, for messages.
        whole: They begin with the device's first frame, so that no finger was down before.

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
                expected="the time of a clock that does not go back",
            )
        last = frame.time
        if isinstance(frame, TouchFrame):
            _check_contacts(frame, surface, at)
            ids = frozenset(contact.id for contact in frame.contacts)
            _check_cancelled(frame, ids, present, at)
            present = ids


def _check_contacts(frame: TouchFrame, surface: Surface, where: str) -> None:
    """Raises an error for a contact that is off the surface, or larger than it.

    Raises:
        DeviceError: There is one.
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
                remedy="A finger that is dragged over the border stays at it",
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
    """Raises an error for cancelled ids that are still down, or that never were.

    Args:
        frame: The frame.
        ids: Ids of its contacts.
        present: Ids of the contacts of the previous frame; None if they are unknown.
        where: The frame, for messages.

    Raises:
        DeviceError: There is one.
    """
    if both := frame.cancelled & ids:
        raise DeviceError(
            "an id is cancelled and among the contacts", where=where, got=str(sorted(both))
        )
    if present is not None and (unknown := frame.cancelled - present):
        raise DeviceError(
            "an id is cancelled that was no contact before", where=where, got=str(sorted(unknown))
        )


def _check_ids(frames: Sequence[Frame], where: str) -> None:
    """Raises an error for the id of a lifted finger that comes again.

    Raises:
        DeviceError: There is one.
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
    """Checks that the device has a name and reports whether it has finished.

    Raises:
        DeviceError: It has no name, or `finished` is neither true nor false.
    """
    name: object = device.name
    if not (isinstance(name, str) and name and name.isprintable()):
        raise DeviceError("the device has no name", where=where, got=repr(name)[:60])
    finished: object = device.finished
    if not isinstance(finished, bool):
        raise DeviceError(
            "`finished` is neither true nor false", where=where, got=repr(finished)[:60]
        )


def _watch(
    device: AnyDevice, where: str, make_touches: Callable[[Any, int], None] | None
) -> list[Frame]:
    """Polls a device as a session does, and returns its frames.

    Raises:
        DeviceError: It fails or hangs, returns something else than a sequence, a frame twice, or a
            frame after it had finished.
    """
    frames: list[Frame] = []
    for step in range(STEPS + 1):
        if make_touches is not None and step < STEPS:
            make_touches(device, step)
        over = device.finished
        got = _poll(device, where, step * PERIOD)
        if over and got:
            raise DeviceError(
                "a frame comes after the device had finished", where=where, got=repr(got[0])[:80]
            )
        if twice := [frame for frame in got if any(frame is old for old in frames)]:
            raise DeviceError("a frame comes twice", where=where, got=repr(twice[0])[:80])
        frames += got
    return frames


def _check_closed(device: AnyDevice, where: str, surface: Surface) -> None:
    """Checks a device that was closed: it may be closed again, is empty, and has finished.

    Raises:
        DeviceError: It fails, still has frames, or does not report that it has finished.
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
        DeviceError: It waits, so that a session would fall behind.
    """
    times = [n * PERIOD for n in range(STEPS + 1, 11 * STEPS)]
    waits = _call(lambda: sorted(_wait(device, now) for now in times), where, "poll")
    # The middle one, since on a busy machine some take long.
    middle = waits[len(waits) // 2]
    if middle >= LONGEST_WAIT:
        raise DeviceError(
            "`poll` waits, so that sessions fall behind",
            where=where,
            got=f"{1000 * middle:.1f} ms",
            expected=f"less than {1000 * LONGEST_WAIT:g} ms",
            remedy="Read in a thread of the device what may block",
        )


def _wait(device: AnyDevice, now: float) -> float:
    """Time (s) that a poll waits: its duration minus the computing time of its thread."""
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
    """A device that was opened now, and its place for messages."""
    where = open_device if isinstance(open_device, str) else "the device"

    def opened() -> Any:
        if isinstance(open_device, DeviceEntry):
            return open_device.open(open_device.options(), Place(surface))
        if isinstance(open_device, str):
            if find_device(open_device) is None:
                raise DeviceError("no such device", got=open_device)
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
