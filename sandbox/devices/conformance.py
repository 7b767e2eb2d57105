"""Conformance tests, which every touch device must pass.

    from sandbox.devices.conformance import DeviceConformance

    class TestMyPad(DeviceConformance):
        def open(self, surface):
            return MyPad(surface, "")

        def stir(self, device, step):      # optional: produces touches
            device.pretend_touch(step)

pytest finds the tests of the class. This module itself does not need pytest.
"""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import TypeVar

from models.frames import TouchFrame
from models.surface import Surface
from sandbox.session.device import Device

T = TypeVar("T")

STEPS = 60
"""Number of polls in one test, as a session makes them."""

PERIOD = 1.0 / 60.0
"""s of session time between two polls."""

PATIENCE = 20.0
"""s after which a `poll` or `close` that has not returned counts as hanging."""

LONGEST_WAIT = 0.008
"""s that `poll` may wait: half a control period."""

SLACK = 1e-6
"""m that a contact may lie beyond the surface."""


class DeviceConformance(ABC):
    """Tests of the rules for touch devices; a subclass has to define `open`.

    Attributes:
        surface: The touch surface on which the device is opened.
    """

    surface = Surface(10.0, 5.0)

    @abstractmethod
    def open(self, surface: Surface) -> Device:
        """Opens a new device."""

    def stir(self, device: Device, step: int) -> None:  # noqa: B027  (overriding is optional)
        """Produces touches before a poll; does nothing by default."""

    def test_it_has_a_name_and_says_whether_it_has_ended(self) -> None:
        device = self._opened()
        try:
            assert isinstance(device.name, str) and device.name.isprintable() and device.name
            assert isinstance(device.finished, bool)
        finally:
            device.close()

    def test_poll_comes_back_at_once_also_when_nothing_happens(self) -> None:
        device = self._opened()
        try:
            waits = in_time(lambda: [_wait(device, n * PERIOD) for n in range(10 * STEPS)], "poll")
        finally:
            device.close()
        # The middle one, since on a busy machine some take long.
        assert sorted(waits)[len(waits) // 2] < LONGEST_WAIT, "poll waits: sessions fall behind"

    def test_its_frames_are_sound(self) -> None:
        device = self._opened()
        try:
            frames = self._watched(device)
        finally:
            device.close()
        check_frames(frames, self.surface)

    def test_what_was_polled_does_not_come_again(self) -> None:
        device = self._opened()
        try:
            frames = self._watched(device)
            again = in_time(lambda: list(device.poll(STEPS * PERIOD)), "poll")
        finally:
            device.close()
        assert not {id(frame) for frame in again} & {id(frame) for frame in frames}

    def test_it_may_be_closed_twice_and_polled_afterwards(self) -> None:
        device = self._opened()
        self._watched(device)
        in_time(device.close, "close")
        in_time(device.close, "the second close")
        rest = in_time(lambda: list(device.poll(STEPS * PERIOD)), "poll after close")
        check_frames(rest, self.surface, whole=False)
        after = in_time(lambda: list(device.poll(STEPS * PERIOD)), "poll after close")
        assert not after, "a device that is closed has no frames: poll must return an empty list"
        assert isinstance(device.finished, bool)

    def test_it_can_be_opened_again_after_it_was_closed(self) -> None:
        for _ in range(2):
            device = self._opened()
            self._watched(device)
            device.close()

    def _opened(self) -> Device:
        return in_time(lambda: self.open(self.surface), "open")

    def _watched(self, device: Device) -> list[TouchFrame]:
        frames: list[TouchFrame] = []
        for step in range(STEPS):
            self.stir(device, step)
            now = step * PERIOD
            got = in_time(lambda now=now: device.poll(now), "poll")  # type: ignore[misc]
            assert isinstance(got, Sequence), "poll must return a sequence of frames"
            frames += got
        return frames


def check_frames(frames: Sequence[TouchFrame], surface: Surface, whole: bool = True) -> None:
    """Checks that a device's frames keep to the rules.

    Args:
        frames: All polled frames, in order.
        surface: Surface of the device.
        whole: They begin with the device's first frame, so that no finger was down before.

    Raises:
        AssertionError: A frame breaks a rule; the message says which.
    """
    width, height = (float(length) for length in surface.size)
    last = None
    present: frozenset[int] = frozenset()
    for n, frame in enumerate(frames):
        kind = type(frame).__name__
        assert isinstance(frame, TouchFrame), f"frame {n}: {kind} is not a TouchFrame"
        where = f"frame {n} at {frame.time} s"
        assert last is None or frame.time >= last, f"{where}: time runs backwards, from {last}"
        ids = frozenset(c.id for c in frame.contacts)
        for c in frame.contacts:
            assert isinstance(c.id, int), f"{where}: the id {c.id!r} is not an integer"
            inside = -SLACK <= c.x <= width + SLACK and -SLACK <= c.y <= height + SLACK
            assert inside, f"{where}: contact {c.id} is off the surface, at {c.x}, {c.y} m"
            sound = c.size is None or 0.0 < c.size < max(width, height)
            assert sound, f"{where}: contact {c.id} has a size of {c.size} m"
        both = frame.cancelled & ids
        assert not both, f"{where}: {sorted(both)} cancelled, but among the contacts"
        if n or whole:
            unknown = frame.cancelled - present
            assert not unknown, f"{where}: {sorted(unknown)} cancelled, but was not a contact"
        last, present = frame.time, ids


def _wait(device: Device, now: float) -> float:
    """s that a poll waits: the time that it takes without that in which its thread computes."""
    began, busy = time.perf_counter(), time.thread_time()
    device.poll(now)
    return (time.perf_counter() - began) - (time.thread_time() - busy)


def in_time(call: Callable[[], T], what: str) -> T:
    """Returns the result of a call, or raises its error.

    Raises:
        AssertionError: The call has not returned after `PATIENCE`.
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
    assert not thread.is_alive(), f"{what} has not returned after {PATIENCE:.0f} s"
    if raised:
        raise raised[0]
    return done[0]
