"""Leap devices, live over leapd's WebSocket or from a recording; they produce hand frames.

leapd and the Ultraleap bridge serve `ws://127.0.0.1:6437/v6.json` and send frames without a
request. The bridge reads commands into a buffer of 32 bytes and compares them as exact strings of
up to 31 bytes, so commands must be short and without spaces. Frames are decoded in the
connection's thread, up to 290 a second, independently of polling. Frames that are not polled in
time are dropped, oldest first, and counted.
"""

from __future__ import annotations

import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence

import msgspec
from websockets.sync.client import connect

from models.errors import DeviceError
from models.frames import HandFrame
from models.plausible import LiveUnits
from models.reader_report import ReaderReport
from sandbox.devices.device import FilePlayer, HandDevice
from sandbox.devices.files import show_report
from sandbox.devices.leap import DEFAULT_ADDRESS
from sandbox.devices.leap.leap_file import LeapRecording
from sandbox.devices.leap.leap_json import LEAP_UNITS, LeapDecoder

KEPT = 600
"""Largest number of frames that wait to be fetched: two seconds at the device's highest rate."""

LARGEST_MESSAGE = 1 << 20
"""Size of the largest message, bytes; a frame of two hands in the newest dialect has 11,000."""

SILENCE = 5.0
"""Time (s) without a frame after which `follow` raises an error."""
START_IT = "Start leapd or the Ultraleap bridge, or try `sandbox devices leap fake FILE`"
SILENT = "the Leap service is silent: start leapd or the Ultraleap bridge, and check the cable"

BACKGROUND = '{"background":true}'
"""Command that makes leapd send frames to a client without keyboard focus; 19 bytes."""

GONE = 1.0
"""Time (s) without a frame after which a session reports that the service is silent."""

PATIENCE = 3.0
"""Time (s) within which a live device must send its first frame."""

_LOOK = 0.05
"""Time (s) between two checks for new frames."""
_FIRST_PAUSE, _LONGEST_PAUSE = 0.1, 2.0
"""Time (s) between attempts to connect, doubled after each failure."""


class LeapFileDevice(FilePlayer, HandDevice):
    """Plays a Leap recording; its first frame plays at session time 0.

    Args:
        recording: A recording from `read_leap`.
    """

    name = "leap recording"
    lift = True

    def __init__(self, recording: LeapRecording) -> None:
        super().__init__(recording.frames, recording.damage, recording.report)


class LeapDevice(HandDevice):
    """A running leapd or bridge; reconnects until it is closed.

    Args:
        address: WebSocket URL of the service.

    Raises:
        DeviceError: The address is not a WebSocket URL.
    """

    name = "leap"
    lift = True

    def __init__(self, address: str = DEFAULT_ADDRESS) -> None:
        if not address.startswith(("ws://", "wss://")):
            raise DeviceError(
                "this is not a WebSocket address", where="--leap", got=address, expected="ws://..."
            )
        self.url = address
        self._units = LiveUnits(LEAP_UNITS)
        self._decoder = LeapDecoder("leap", live=self._units)
        self._frames: deque[HandFrame] = deque()
        self._new_frame = threading.Condition()
        self._stop = threading.Event()
        self.connected = threading.Event()
        self.trouble: str | None = None
        self._heard = time.monotonic()
        self._thread = threading.Thread(target=self._run, name="leap", daemon=True)
        self._thread.start()

    @property
    def counts(self) -> Counter[str]:
        """Numbers of messages (used, refused, dropped) and of connections, by kind."""
        with self._new_frame:
            return Counter(self._decoder.counts)

    @property
    def version(self) -> str | None:
        """Version that the service reports; None before its first message."""
        return self._decoder.version

    @property
    def notices(self) -> Sequence[str]:
        """Warnings for the person: the service is silent, sends other units, or may confuse left
        and right hands. Empty without a warning."""
        with self._new_frame:
            silent = time.monotonic() - self._heard
            doubt = self._decoder.side_doubt
        if silent > GONE:
            return (SILENT,)
        return tuple(filter(None, (self._units.notice, doubt)))

    def wait(self, seconds: float) -> bool:
        """Waits until `poll` has a frame; False if none came in time."""
        with self._new_frame:
            return self._new_frame.wait_for(lambda: bool(self._frames), seconds)

    def poll(self, now: float) -> Sequence[HandFrame]:
        """Returns all frames since the last call."""
        with self._new_frame:
            frames = tuple(self._frames)
            self._frames.clear()
        return frames

    @property
    def report(self) -> ReaderReport:
        """Report on unusable messages so far, and on assumed units."""
        with self._new_frame:
            report = self._decoder.report
        report.leave_out("new connections", max(self.counts["connections"] - 1, 0))
        if self._units.notice:
            report.assume(self._units.notice)
        return report

    def follow(
        self, hear: Callable[[], object] = lambda: None, remedy: str = START_IT
    ) -> Iterator[HandFrame]:
        """Yields frames as they arrive, without end.

        Args:
            hear: Called repeatedly between frames; an exception from it ends the iteration.
            remedy: Remedy in the error of a silent service.

        Raises:
            DeviceError: No frame came for `SILENCE`.
        """
        heard = time.monotonic()
        while True:
            hear()
            for frame in self.poll(0.0):
                heard = time.monotonic()
                yield frame
            if not self.wait(_LOOK) and time.monotonic() - heard > SILENCE:
                raise self.silent(SILENCE, remedy)

    def silent(self, seconds: float, remedy: str = START_IT) -> DeviceError:
        """The error for a service that has been silent for a number of seconds."""
        got = self.trouble or f"no frame for {seconds:g} s"
        return DeviceError("the Leap service is silent", where=self.url, got=got, remedy=remedy)

    def close(self) -> None:
        """Ends the connection and its thread."""
        super().close()
        self._stop.set()
        self._thread.join(timeout=5.0)

    def _run(self) -> None:
        pause = _FIRST_PAUSE
        while not self._stop.is_set():
            heard = self._decoder.counts["frames"]
            try:
                self._listen()
            except Exception as error:  # any error: the next connection may succeed
                self.trouble = f"{type(error).__name__}: {error}"[:200]
            finally:
                if self.connected.is_set() and not self._stop.is_set():
                    with self._new_frame:
                        self._decoder.counts["connections lost"] += 1
                self.connected.clear()
            if self._decoder.counts["frames"] > heard:
                pause = _FIRST_PAUSE
            self._stop.wait(pause)
            pause = min(2.0 * pause, _LONGEST_PAUSE)

    def _listen(self) -> None:
        with connect(
            self.url,
            open_timeout=3.0,
            close_timeout=1.0,
            max_size=LARGEST_MESSAGE,
            compression=None,
            proxy=None,
        ) as channel:
            channel.send(BACKGROUND)
            with self._new_frame:
                self._decoder.counts["connections"] += 1
            self.connected.set()
            self.trouble = None
            while not self._stop.is_set():
                try:
                    message = channel.recv(timeout=0.2)
                except TimeoutError:
                    continue
                self._take(message)

    def _take(self, message: str | bytes) -> None:
        try:
            decoded = msgspec.json.decode(message)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            with self._new_frame:
                self._decoder.counts["messages that are not JSON"] += 1
            return
        with self._new_frame:
            frame = self._decoder.feed(decoded)
            if frame is None:
                return
            self._heard = time.monotonic()
            if len(self._frames) == KEPT:
                self._frames.popleft()
                self._decoder.counts["frames nobody fetched"] += 1
            self._frames.append(frame)
            self._new_frame.notify_all()


class ReportingLeapDevice(LeapDevice):
    """A live device that prints a report when it is closed: unusable frames, new connections."""

    def close(self) -> None:
        """Ends the connection, once."""
        closed = self._stop.is_set()
        super().close()
        if not closed:
            show_report(self.report)


def open_leap(address: str = DEFAULT_ADDRESS, tell: bool = False) -> LeapDevice:
    """Connects to a running Leap service and waits for its first frame.

    Args:
        address: WebSocket URL.
        tell: True to print a report when the device is closed (`ReportingLeapDevice`).

    Raises:
        DeviceError: The service sends nothing.
    """
    device = ReportingLeapDevice(address) if tell else LeapDevice(address)
    if not device.wait(PATIENCE):
        device.close()
        raise device.silent(PATIENCE)
    return device
