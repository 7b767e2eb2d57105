"""Devices whose input comes from a page, and the page of fingers or a mouse among them."""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from typing import Generic, TypeVar

from models.frames import Contact, TouchFrame
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.device import Device
from sandbox.server.protocol import PageHands, PageScreen, PageTouches
from sandbox.trial.latency import LatencyLog

QUEUE_FRAMES = 1024
"""Largest number of frames that wait for the session, 8 s at 120 Hz; beyond it the oldest are
dropped."""

F = TypeVar("F")


class PageDevice(ABC, Generic[F]):
    """A device whose input comes from a page; the server's thread adds frames to its queue, and the
    session's thread takes them.

    Args:
        latency: Log of the time that messages waited for the session.

    Attributes:
        latency: The log as given; a server replaces it with its own.
        frame_ready: Event that is set when a message has arrived.
        applied: Sequence number of the newest message that the session has processed.
    """

    latency: LatencyLog
    frame_ready: threading.Event

    def __init__(self, latency: LatencyLog | None = None) -> None:
        self.latency = latency or LatencyLog()
        self.frame_ready = threading.Event()
        self.applied = 0
        self._lock = threading.Lock()
        self._frames: deque[tuple[F, int, float]] = deque(maxlen=QUEUE_FRAMES)

    @property
    @abstractmethod
    def touched(self) -> bool:
        """True while the person plays: a finger is down, or a hand is seen."""

    @abstractmethod
    def receive(self, message: PageTouches | PageHands, screen: PageScreen) -> bool:
        """Takes in a message, in the server's thread; False if it is none for this device."""

    @abstractmethod
    def cancel_all(self) -> None:
        """The page was closed or fell silent: nothing is touched or seen any more."""

    def begin_page(self) -> None:
        """A page begins to send: its messages are counted anew."""
        with self._lock:
            self._frames = deque(((f, 0, at) for f, _, at in self._frames), maxlen=QUEUE_FRAMES)
            self.applied = 0

    def _take(self) -> list[F]:
        """Every frame since the last call, oldest first; in the session's thread."""
        with self._lock:
            self.frame_ready.clear()
            waiting = list(self._frames)
            self._frames.clear()
            # Under the lock: a page that begins now must not get the number of the one before it.
            self.applied = max([self.applied, *(seq for _, seq, _ in waiting)])
        at = time.monotonic()
        for _, _, arrived in waiting:
            self.latency.take_in(arrived, at)
        return [frame for frame, _, _ in waiting]

    def _put(self, frame: F, seq: int, arrived: float) -> None:
        """Adds a frame; the lock is held."""
        self._frames.append((frame, seq, arrived))
        self.frame_ready.set()


class WebDevice(Device, PageDevice[TouchFrame]):
    """Our page in a browser, on this machine or a tablet: fingers, or a mouse.

    A touch outside the touch rectangle is ignored; a finger that is dragged out stays at the
    border, as at the edge of a tablet.

    Args:
        surface: The touch rectangle.
        latency: See `PageDevice`.
    """

    name = "web"
    lift = True
    latency: LatencyLog
    frame_ready: threading.Event

    def __init__(self, surface: Surface, latency: LatencyLog | None = None) -> None:
        super().__init__(latency)
        self._size, self._scale = surface.size, surface.scale
        self._inside: set[int] = set()
        self._present: frozenset[int] = frozenset()
        self._lift: float | None = None

    @property
    def touched(self) -> bool:
        """True if a finger is down."""
        with self._lock:
            return bool(self._present)

    def receive(self, message: PageTouches | PageHands, screen: PageScreen) -> bool:
        """Takes in touches; called from the server's thread."""
        if not isinstance(message, PageTouches):
            return False
        self.push(message, screen)
        return True

    def push(self, touches: PageTouches, screen: PageScreen) -> None:
        """Adds the touches of a message; called from the server's thread."""
        # Fingers have their true size, also on a scaled table.
        metres = METRES_PER_INCH / screen.px_per_in
        scaled = metres / self._scale
        with self._lock:
            contacts, ids = [], set()
            for i, x_px, y_px, width_px, height_px in touches.contacts:
                x, y = x_px * scaled, y_px * scaled
                inside = 0.0 <= x <= self._size[0] and 0.0 <= y <= self._size[1]
                if i in ids or not (inside or i in self._inside):
                    continue
                ids.add(i)
                x, y = min(max(x, 0.0), self._size[0]), min(max(y, 0.0), self._size[1])
                # A browser that does not know the width reports one pixel, or zero.
                size = width_px * metres if width_px > 1.0 else None
                extent = (
                    (width_px * metres, height_px * metres)
                    if width_px > 1.0 and height_px > 1.0
                    else None
                )
                contacts.append(Contact(i, float(x), float(y), size, extent=extent))
            self._inside = ids
            self._lift = touches.lift if touches.lift is not None else self._lift
            gone = frozenset(touches.cancelled) & (self._present - ids)
            self._put_contacts(tuple(contacts), gone, touches.seq)

    def cancel_all(self) -> None:
        """Cancels all touches of a page that was closed or fell silent."""
        with self._lock:
            if self._present:
                self._inside = set()
                self._put_contacts((), self._present, self.applied)

    def poll(self, now: float = 0.0) -> Sequence[TouchFrame]:
        """Every frame since the last call, oldest first; `now` is ignored."""
        return self._take()

    def _put_contacts(self, contacts: tuple[Contact, ...], gone: frozenset[int], seq: int) -> None:
        now = time.monotonic()
        self._present = frozenset(c.id for c in contacts)
        self._put(TouchFrame(now, contacts, self._lift, gone, "page"), seq, now)
