"""Devices whose input comes from a page: their base class, and the device for touches."""

from __future__ import annotations

import math
import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from typing import Generic, TypeGuard, TypeVar

from models.frames import Contact, TouchFrame
from models.plausible import ContactSizes
from models.reader_report import ReaderReport
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.device import Device
from sandbox.server.protocol import PageHands, PageScreen, PageTouches

QUEUE_FRAMES = 1024
"""Largest number of frames that wait for the session, 8 s at 120 Hz; if there are more, the oldest
are dropped."""

MOST_TOUCHES = 20
"""Largest number of touches on a page at one moment: the fingers of four hands."""

TOO_MANY = f"touches beyond {MOST_TOUCHES}"

F = TypeVar("F")


class PageDevice(ABC, Generic[F]):
    """Base class of devices whose input comes from a page.

    The server's thread adds frames to a queue, and the session's thread takes them. The time of a
    frame is that of its arrival.

    Attributes:
        frame_ready: Event that is set when a message has arrived.
        applied: Sequence number of the newest message that the session has processed.
    """

    frame_ready: threading.Event

    def __init__(self) -> None:
        self.frame_ready = threading.Event()
        self.applied = 0
        self._lock = threading.Lock()
        self._frames: deque[tuple[F, int]] = deque(maxlen=QUEUE_FRAMES)

    @property
    @abstractmethod
    def touched(self) -> bool:
        """True while the person plays: a finger is down, or a hand is in view."""

    @abstractmethod
    def receive(self, message: PageTouches | PageHands, screen: PageScreen) -> bool:
        """Processes a message, in the server's thread; False if it is not for this device."""

    @abstractmethod
    def cancel_all(self) -> None:
        """Called when the page was closed or has become silent: no touch, no hand in view."""

    def begin_page(self) -> None:
        """Called when a page begins to send: its messages are counted from 1."""
        with self._lock:
            self._frames = deque(((frame, 0) for frame, _ in self._frames), maxlen=QUEUE_FRAMES)
            self.applied = 0

    def _take(self) -> list[F]:
        """Returns all frames since the last call, oldest first; in the session's thread."""
        with self._lock:
            self.frame_ready.clear()
            waiting = list(self._frames)
            self._frames.clear()
            # Inside the lock: after `begin_page`, `applied` must not be set to an old number.
            self.applied = max([self.applied, *(seq for _, seq in waiting)])
        return [frame for frame, _ in waiting]

    def _put(self, frame: F, seq: int) -> None:
        """Adds a frame; the caller holds the lock."""
        self._frames.append((frame, seq))
        self.frame_ready.set()


def _on_screen(position: float | None, length: float) -> TypeGuard[float]:
    """True if a finger on the screen can have this position, relative to the touch rectangle."""
    return position is not None and abs(position) <= 2.0 * length


class WebDevice(Device, PageDevice[TouchFrame]):
    """The program's page in a browser, on this machine or a tablet: fingers, or a mouse.

    A touch that begins outside the touch rectangle is ignored. A finger that is dragged out stays
    at the border, as at the edge of a tablet.

    Args:
        surface: The touch rectangle.
    """

    name = "web"
    lift = True
    frame_ready: threading.Event

    def __init__(self, surface: Surface) -> None:
        super().__init__()
        self._size, self._scale = surface.size, surface.scale
        self._inside: dict[int, tuple[float, float]] = {}
        self._present: frozenset[int] = frozenset()
        self._lift: float | None = None
        self._report = ReaderReport()
        self._sizes = ContactSizes(self._report)

    @property
    def report(self) -> ReaderReport:
        """A copy of the report on touches and sizes that were left out."""
        with self._lock:
            return self._report.copy()

    @property
    def touched(self) -> bool:
        """True if a finger is down."""
        with self._lock:
            return bool(self._present)

    def receive(self, message: PageTouches | PageHands, screen: PageScreen) -> bool:
        """Processes touches; called from the server's thread."""
        if not isinstance(message, PageTouches):
            return False
        # Sizes of fingers are true sizes, even if the table is scaled.
        metres = METRES_PER_INCH / screen.px_per_in
        scaled = metres / self._scale
        width, height = float(self._size[0]), float(self._size[1])
        with self._lock:
            contacts: list[Contact] = []
            labels = dict(message.labels)
            places: dict[int, tuple[float, float]] = {}
            for i, x_px, y_px, width_px, height_px in message.contacts:
                if i in places:
                    continue
                if len(places) >= MOST_TOUCHES:
                    self._report.leave_out(TOO_MANY)
                    continue
                if _on_screen(x_px, screen.width_px) and _on_screen(y_px, screen.height_px):
                    x, y = x_px * scaled, y_px * scaled
                else:
                    self._report.leave_out("positions beyond the screen")
                    x, y = self._inside.get(i, (math.nan, math.nan))
                inside = 0.0 <= x <= width and 0.0 <= y <= height
                if not (inside or i in self._inside):
                    continue
                x, y = places[i] = min(max(x, 0.0), width), min(max(y, 0.0), height)
                # A browser that does not measure the width reports one pixel, or zero.
                size = extent = None
                if width_px is not None and width_px > 1.0:
                    size = width_px * metres
                    if height_px is not None and height_px > 1.0:
                        extent = size, height_px * metres
                size, extent = self._sizes.known(size, extent)
                contacts.append(Contact(i, x, y, size, label=labels.get(i), extent=extent))
            self._inside = places
            if message.lift is not None:
                self._lift = min(max(message.lift, 0.0), 1.0)
            gone = frozenset(message.cancelled) & (self._present - places.keys())
            self._put_contacts(tuple(contacts), gone, message.seq)
        return True

    def cancel_all(self) -> None:
        """Cancels all touches of a page that was closed or has become silent."""
        with self._lock:
            if self._present:
                self._inside = {}
                self._put_contacts((), self._present, self.applied)

    def poll(self, now: float = 0.0) -> Sequence[TouchFrame]:
        """Returns all frames since the last call, oldest first; `now` is ignored."""
        return self._take()

    def _put_contacts(self, contacts: tuple[Contact, ...], gone: frozenset[int], seq: int) -> None:
        self._present = frozenset(c.id for c in contacts)
        self._put(TouchFrame(time.monotonic(), contacts, self._lift, gone, "page"), seq)
