"""Logs of a live session: its events as JSON lines, and the latencies of its touches.

Events are in order and complete, for scripts that drive a session. Latencies begin when a touch
arrives at this program, and end when a picture is passed to the screen of the window or the page
(see `LatencyLog`). They exclude the delays of the touch screen and of the display.
"""

from __future__ import annotations

import json
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.frames import TouchFrame
from sandbox.devices.device import Device, DeviceWrapper
from sandbox.session.messages import Snapshot

if TYPE_CHECKING:
    from sandbox.trial.assembly import DeviceMaker

MOST_WAITING = 10_000
"""Largest number of events that wait to be written."""
PATIENCE = 5.0
"""Time (s) without a written event after which `close` stops waiting for the pipe's reader."""


class EventLog:
    """Writes one line per event, at once; without a path it writes nothing.

    A separate thread writes, so that a stopped reader of a pipe does not delay the session. A
    failed write does not end the session: `close` reports it.

    Args:
        path: File or named pipe to append to; None writes nothing.

    Raises:
        InputError: The file cannot be opened.
    """

    def __init__(self, path: Path | None) -> None:
        self._path, self._error, self._broken = path, "", False
        self._waiting: SimpleQueue[bytes] = SimpleQueue()
        self._written = 0
        self._lock = threading.Lock()
        try:
            self._file = path.open("ab", buffering=0) if path else None
        except OSError as error:
            raise InputError(
                "the file cannot be written", where=f"--events {path}", got=error.strerror
            ) from None
        self._thread = threading.Thread(target=self._write, name="events", daemon=True)
        if self._file is not None:
            self._thread.start()

    def write(self, kind: str, **data: Any) -> None:
        """Writes an event: `listening`, `trial_start`, `trial_end` or `warning`."""
        if self._file is None or self._error:
            return
        line = json.dumps({"event": kind, **data}).encode() + b"\n"
        # The threads of session, page and window write events.
        with self._lock:
            if self._waiting.qsize() < MOST_WAITING:
                self._waiting.put(line)
            else:
                self._error = f"more than {MOST_WAITING:,} events waited for their reader"

    def close(self) -> None:
        """Writes all waiting events and closes the file; may be called twice.

        Raises:
            InputError: An event could not be written or queued; this event and all later events are
                lost.
        """
        if self._file is not None:
            self._waiting.put(b"")
            before = -1
            while self._thread.is_alive() and self._written != before:
                before = self._written
                self._thread.join(PATIENCE)
            if self._thread.is_alive():
                self._error = self._error or f"the pipe's reader read nothing for {PATIENCE:g} s"
            else:
                self._file.close()
            self._file = None
        error, self._error = self._error, ""
        if error:
            raise InputError(
                "events were lost",
                where=f"--events {self._path}",
                got=error,
                remedy="The trial itself is complete. Make room on the disk, or read the pipe to "
                "its end",
            )

    def _write(self) -> None:
        """Writes events until it gets an empty line. After a failed write it only counts them."""
        file = self._file
        assert file is not None
        while line := self._waiting.get():
            try:
                while line and not self._broken:
                    line = line[file.write(line) :]
            except OSError as error:
                self._error, self._broken = error.strerror or str(error), True
            self._written += 1


class NoticeEvents:
    """Writes every new notice of a session as one `warning` event.

    Args:
        events: Log of events.
        say: Also receives the text of the notice, to show it to the person.
    """

    def __init__(self, events: EventLog, say: Callable[[str], object]) -> None:
        self._events, self._say = events, say
        self._last: frozenset[str] = frozenset()

    def show(self, snapshot: Snapshot) -> None:
        """Writes the new notices of a snapshot. Without a call for every snapshot, notices may be
        missed."""
        for notice in snapshot.notices:
            if notice not in self._last:
                self._events.write("warning", what=notice, time_s=round(snapshot.time, 3))
                self._say(notice)
        self._last = frozenset(snapshot.notices)


KEPT = 100_000
"""Number of newest values of each kind that are used for percentiles: half an hour at 60 Hz."""


@dataclass(frozen=True)
class Percentiles:
    """Percentiles of one kind of latency, ms."""

    n: int
    p50: float
    p95: float
    p99: float
    largest: float


class LatencyLog:
    """Latencies of several kinds in milliseconds; safe to use from all threads.

    `waited`: from the arrival of a touch message to the control step in which it took effect;
        touches that came while simulated time stood still are not counted.
    `stepped`: from this control step until its frame was passed to the network or the window.
    `acknowledged`: from sending a frame until the page acknowledged it.
    `drawn`: from the touch event to the first picture that contains it, by the page's own clock.
    `round_trip`: round trip of a heartbeat between page and server, by the page's clock.
    `window`: from the arrival of a touch until the first picture with it was drawn in the window.
    `picture`: duration of drawing one picture in the window.

    No latency includes the delay of the display itself.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._values: dict[str, list[float]] = {}
        self._of_trial: dict[str, list[float]] = {}
        self._resumed = 0.0

    def resume(self) -> None:
        """Records that simulated time continues after a pause, as before a trial's first touch."""
        self._resumed = time.monotonic()

    def take_in(self, arrived: float, now: float) -> None:
        """Adds the time that a touch waited, unless it came while simulated time stood still.

        Args:
            arrived: When the touch arrived, s (monotonic).
            now: When the control step processed it, s (monotonic).
        """
        if arrived >= self._resumed:
            self.add("waited", 1000.0 * (now - arrived))

    def add(self, kind: str, milliseconds: float) -> None:
        """Adds a value."""
        with self._lock:
            for kept in (self._values, self._of_trial):
                values = kept.setdefault(kind, [])
                values.append(milliseconds)
                if len(values) > 2 * KEPT:
                    del values[:KEPT]

    def begin_trial(self) -> None:
        """Begins another trial; `as_json` has the values of the latest trial only."""
        with self._lock:
            self._of_trial.clear()

    def percentiles(self) -> dict[str, Percentiles]:
        """Percentiles of all trials, by kind of latency."""
        return self._percentiles(self._values)

    def as_json(self) -> dict[str, Any]:
        """Percentiles of this trial as JSON values, for its result and events."""
        return {
            kind: {
                "n": p.n,
                "p50_ms": round(p.p50, 3),
                "p95_ms": round(p.p95, 3),
                "p99_ms": round(p.p99, 3),
                "max_ms": round(p.largest, 3),
            }
            for kind, p in self._percentiles(self._of_trial).items()
        }

    def _percentiles(self, log: dict[str, list[float]]) -> dict[str, Percentiles]:
        with self._lock:
            kinds = {kind: np.array(values[-KEPT:]) for kind, values in log.items()}
        return {kind: _percentiles(v) for kind, v in kinds.items()}


def _percentiles(values: NDArray[np.float64]) -> Percentiles:
    p50, p95, p99 = (
        float(p) for p in np.percentile(values, [50, 95, 99])
    )  # any order: times, not states
    return Percentiles(len(values), p50, p95, p99, float(values.max()))


WAITING = 4096
"""Largest number of touches that wait for their step or picture; beyond it the oldest are
dropped."""


class Timing:
    """Follows touches from a device through the session into a window.

    Args:
        log: Receives `waited`, `stepped` and `window` (see `LatencyLog`).

    Attributes:
        log: As given.
    """

    def __init__(self, log: LatencyLog) -> None:
        self.log = log
        self._lock = threading.Lock()
        self._taken: deque[float] = deque(maxlen=WAITING)
        self._polled, self._newest = 0.0, 0.0
        self._unseen: deque[tuple[int, float]] = deque(maxlen=WAITING)

    def taken_in(self, frames: Sequence[TouchFrame], origin: float) -> None:
        """Records that the session fetched frames.

        Args:
            frames: The frames.
            origin: Zero of the frames' clock, s (monotonic).
        """
        self._polled = time.monotonic()
        # A frame repeated for a lift control keeps its time, and contains no new touch.
        arrived = [t for t in (frame.time + origin for frame in frames) if t > self._newest]
        self._newest = max([self._newest, *arrived])
        for at in arrived:
            self.log.take_in(at, self._polled)
        self._taken.extend(arrived)

    def stepped(self, snapshot: Snapshot) -> None:
        """Records the end of the step in which the fetched touches took effect.

        Must be called in the session's thread.
        """
        if not self._taken:
            return
        self.log.add("stepped", 1000.0 * (time.monotonic() - self._polled))
        with self._lock:
            self._unseen.extend((snapshot.step, arrived) for arrived in self._taken)
        self._taken.clear()

    def drawn(self, snapshot: Snapshot) -> None:
        """Records that a picture of this snapshot has just been passed to the screen."""
        now = time.monotonic()
        with self._lock:
            while self._unseen and self._unseen[0][0] <= snapshot.step:
                self.log.add("window", 1000.0 * (now - self._unseen.popleft()[1]))


class TimedDevice(DeviceWrapper):
    """Wrapper that reports when a live device's touches are fetched.

    Args:
        device: A device whose frames carry their time of arrival, s, on the device's clock. If
            frames carry session time instead, nothing is reported.
        timing: Receives the reports.
    """

    def __init__(self, device: Device, timing: Timing) -> None:
        super().__init__(device)
        self._timing = timing
        self._origin = device.clock_origin

    @property
    def latency(self) -> LatencyLog:
        """The log of the reports, so that a session can report its pauses to it."""
        return self._timing.log

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames, unchanged."""
        frames = super().poll(now)
        if frames and self._origin is not None:
            self._timing.taken_in(frames, self._origin)
        return frames


def timed(make_device: DeviceMaker, timing: Timing) -> DeviceMaker:
    """A maker that wraps the device of another maker in a `TimedDevice`."""
    return lambda task, surface: TimedDevice(make_device(task, surface), timing)
