"""What the Linux kernel does between a touch screen and its readers, for tests without hardware.

Like the kernel's input core, it keeps what each slot held, and sends a value only where it differs
from what it holds. A reader that is too slow loses events and is told so by SYN_DROPPED.
"""

from __future__ import annotations

import errno
from collections.abc import Iterable

from sandbox.devices.evdev.evdev_touch import (
    ABS_MT_POSITION_X,
    ABS_MT_POSITION_Y,
    ABS_MT_SLOT,
    ABS_MT_TRACKING_ID,
    EV_ABS,
    EV_SYN,
    SYN_DROPPED,
    SYN_REPORT,
    TURNED,
    Axis,
    Matrix,
    Slots,
)

Place = tuple[int, int]


class KernelSlots:
    """A touch screen of some slots, and the node under which its events are read."""

    def __init__(
        self,
        slots: int = 10,
        x: Axis | None = None,
        y: Axis | None = None,
        diameter: Axis | None = None,
        matrix: Matrix = TURNED[0],
        warning: str = "",
    ) -> None:
        self.name = "a made-up touch screen (/dev/input/event99)"
        self.x, self.y = x or Axis(0, 4000, 20), y or Axis(0, 3000, 20)
        self.diameter, self.matrix, self.warning = diameter, matrix, warning
        self._values: dict[int, dict[int, int]] = {
            n: {ABS_MT_POSITION_X: 0, ABS_MT_POSITION_Y: 0, ABS_MT_TRACKING_ID: -1}
            for n in range(slots)
        }
        self._current = 0
        self._queue: list[tuple[int, int, int]] = []
        self._next_id = 0
        self.fingers: dict[int, int] = {}
        self.gone = False
        self.closed = 0

    def set(self, slot: int, code: int, value: int) -> None:
        if self._values[slot].get(code) == value:
            return
        if self._current != slot:
            self._current = slot
            self._queue.append((EV_ABS, ABS_MT_SLOT, slot))
        self._values[slot][code] = value
        self._queue.append((EV_ABS, code, value))

    def show(self, fingers: dict[int, Place]) -> None:
        """The fingers that are down now, by the tester's own names; one report."""
        for finger in [f for f in self.fingers if f not in fingers]:
            self.set(self.fingers.pop(finger), ABS_MT_TRACKING_ID, -1)
        for finger, (x, y) in fingers.items():
            if finger not in self.fingers:
                free = min(set(self._values) - set(self.fingers.values()))
                self.fingers[finger] = free
                self.set(free, ABS_MT_TRACKING_ID, self._next_id)
                self._next_id = (self._next_id + 1) % 65_536
            self.set(self.fingers[finger], ABS_MT_POSITION_X, x)
            self.set(self.fingers[finger], ABS_MT_POSITION_Y, y)
        self._queue.append((EV_SYN, SYN_REPORT, 0))

    def overflow(self, keep: int) -> None:
        """The reader was too slow: all but the last events are lost."""
        self._queue = [(EV_SYN, SYN_DROPPED, 0), *(self._queue[-keep:] if keep else [])]

    def read(self) -> Iterable[tuple[int, int, int]]:
        if self.gone:
            raise OSError(errno.ENODEV, "No such device")
        events, self._queue = self._queue, []
        return events

    def slots(self) -> Slots:
        return Slots({n: dict(v) for n, v in self._values.items()}, self._current)

    def close(self) -> None:
        self.closed += 1
