"""The live camera: a page in a browser on this machine finds hands and sends their landmarks."""

from __future__ import annotations

import asyncio
import contextlib
import json
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlsplit

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from models.errors import FrameError, InputError
from models.frames import LandmarkFrame
from models.plausible import STEP, LiveUnits
from models.reader_report import ReaderReport
from sandbox.devices.device import LandmarkDevice
from sandbox.devices.webcam.landmarks import (
    LANDMARK_UNITS,
    UNREADABLE,
    PictureMessage,
    PossibleHands,
    frame_of,
    in_units,
    left_hands,
    picture_message,
    quantities,
)
from sandbox.server.page_options import LOOPBACK
from sandbox.server.server_thread import ServerThread, cannot_serve
from sandbox.server.static import TOKEN_PLACE, answered, plain

STATIC = Path(__file__).resolve().parent / "static"
ENGINE = "/engine/"
"""Path at which the page finds the engine and its model."""
LARGEST_MESSAGE = 1 << 16
"""Size of the largest message, bytes; a message with three hands has about 4,000."""
PATIENCE = 20
"""A page is disconnected after more damaged messages than this: it is not this program's page."""
REPLACED = "Another page has taken the camera's place. This one can be closed."
ENDED = "The session is over: the camera is off. This page can be closed."

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".wasm": "application/wasm",
    ".task": "application/octet-stream",
}


class LandmarkServer(ServerThread):
    """Serves the page and the engine on 127.0.0.1, in a thread of its own.

    Args:
        engine: Folder with the engine and its model (`sandbox.devices.webcam.engine`).
        wanted: Values of the first message to the page, such as the sides of the hands.
        take: Called in the server's thread with every message of the page.
        gone: Called in the server's thread when the page has disconnected.
        port: TCP port; 0 uses a free one.

    Raises:
        DeviceError: The port is not available.
    """

    def __init__(
        self,
        engine: Path,
        wanted: dict[str, Any],
        take: Callable[[PictureMessage], None],
        gone: Callable[[], None],
        port: int = 0,
    ) -> None:
        super().__init__(LARGEST_MESSAGE)
        self._files = _page_files(engine)
        self._wanted, self._take, self._gone = wanted, take, gone
        self._page: ServerConnection | None = None
        error = self._start("camera page", LOOPBACK, port)
        if error is not None:
            raise cannot_serve("the camera's page", LOOPBACK, port, error)

    async def _part(self) -> None:
        if self._page is not None:
            await _send_away(self._page, ENDED)

    def _process(self, connection: ServerConnection, request: Request) -> Response | None:
        """Accepts or refuses a request; returns the response, or None to open a WebSocket."""
        wants_socket = request.headers.get("Upgrade", "").lower() == "websocket"
        reason = self._refusal(request, wants_socket)
        if reason:
            self.counters.add(f"wrong {reason}")
            return plain(HTTPStatus.FORBIDDEN, "This link is not valid: open the one shown last.")
        if not self._limits.authenticate(connection):
            self.counters.add("too many clients")
            return plain(HTTPStatus.SERVICE_UNAVAILABLE, "Too many pages are open.")
        if wants_socket:
            return None
        path = urlsplit(request.path).path
        return self._file("/index.html" if path == "/" else path, request.headers["Host"])

    def _file(self, name: str, host: str) -> Response:
        path = self._files.get(name)
        if path is None:
            return plain(HTTPStatus.NOT_FOUND, "Page not found.")
        try:
            body = path.read_bytes()
        except OSError:
            return plain(
                HTTPStatus.NOT_FOUND, "The engine is missing: run sandbox devices webcam install"
            )
        if name == "/index.html":
            body = body.replace(TOKEN_PLACE, quote(self.access.token).encode())
        policy = (
            "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
            f"connect-src 'self' ws://{host}; img-src data:; media-src 'self' blob:; "
            "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
        )
        headers = {"Content-Type": _TYPES[path.suffix], "Content-Security-Policy": policy}
        return answered(HTTPStatus.OK, headers, body)

    async def _handle(self, page: ServerConnection) -> None:
        """Processes the messages of a page; a new page replaces the previous one."""
        before, self._page = self._page, page
        if before is not None:
            await _send_away(before, REPLACED)
        refused = 0
        with contextlib.suppress(ConnectionClosed):
            await page.send(json.dumps({"what": "wanted", **self._wanted}))
            async for text in page:
                try:
                    self._take(picture_message(text))
                except InputError:
                    self.counters.add("malformed message")
                    refused += 1
                    if refused > PATIENCE:
                        await page.close(4004, "not our page")
        if self._page is page:
            self._page = None
            self._gone()


async def _send_away(page: ServerConnection, why: str) -> None:
    with contextlib.suppress(ConnectionClosed, asyncio.TimeoutError):
        await asyncio.wait_for(page.send(json.dumps({"what": "bye", "why": why})), 1.0)
        await asyncio.wait_for(page.close(), 2.0)


def _page_files(engine: Path) -> dict[str, Path]:
    """Returns path -> file for all files that a page may request; others are not served."""
    ours = {f"/{p.name}": p for p in STATIC.iterdir() if p.suffix in _TYPES}
    return ours | {ENGINE + name: engine / name for name in served_names(engine)}


def served_names(engine: Path) -> Sequence[str]:
    """Returns the paths, in the engine's folder, of the files that a page may request."""
    files = sorted(p for p in engine.rglob("*") if p.suffix in _TYPES)
    return [p.relative_to(engine).as_posix() for p in files]


BACK = 1.0
"""A step back in time by more than this (s) shows that another page has replaced the page."""


class PageClock:
    """Shifts the times of later pages, so that they continue from those of the first page.

    Times of the first page are not changed.
    """

    def __init__(self) -> None:
        self._offset = 0.0
        self._last: LandmarkFrame | None = None
        self._arrived = 0.0
        self._anew = False

    def begin_anew(self) -> None:
        """Called when the page has disconnected: the next frame is of another page."""
        self._anew = True

    def moved(self, frame: LandmarkFrame, arrived: float) -> LandmarkFrame:
        """Returns the frame with times that continue from those of earlier pages.

        Args:
            frame: A frame with the times of its page.
            arrived: Time of its arrival, s, on a clock of this machine that never runs backwards.
        """
        last = self._last
        if last and (self._anew or frame.time + self._offset < last.time - BACK):
            gone = arrived - self._arrived
            # No picture may seem to be older than the last picture of the previous page.
            self._offset = max(last.time + gone - frame.time, last.taken - frame.taken)
        self._anew, self._arrived = False, arrived
        if self._offset:
            frame = replace(frame, time=frame.time + self._offset, taken=frame.taken + self._offset)
        self._last = frame
        return frame


KEPT = 600
"""Largest number of frames that wait for `poll`: 20 s of pictures."""
HANDS = 3
"""Largest number of hands that the engine detects: three, to notice a second person."""

NOTICES = {
    "absent": "no camera: see its page in the browser",
    "in use": "another program uses the camera: see its page in the browser",
    "refused": "the browser does not let the page see the camera: see the page",
    "engine": "the detection of hands does not run: see the camera's page in the browser",
    "hidden": "the camera's page is hidden: move its window beside this one",
}
"""Reason that the page reports -> message for the person at the session."""
CLOSED = "the camera's page is closed: open its link again"
WAITING = "open the camera's page in a browser of this machine"


class WebcamDevice(LandmarkDevice):
    """A camera, by its page; pages may come and go until the device is closed.

    Args:
        engine: Folder of the engine (`sandbox.devices.webcam.engine`).
        sides: Sides of the hands that the session follows.
        mirrored: True if the camera's picture is mirrored; the page then mirrors it again.
        port: TCP port of the page; 0 uses a free one.
        marks: True if the page lets the person mark the corners of a surface.

    Raises:
        DeviceError: The port is not available.

    Attributes:
        server: The page's server.
        counts: Number of pictures, and numbers of unusable data and of reported problems, by kind.
        corners: (4, 2) px in the unmirrored picture, the surface's corners as the person marked
            them last: top left, top right, bottom right, bottom left; empty before.
    """

    name = "webcam"
    lift = True

    def __init__(
        self,
        engine: Path,
        sides: Sequence[str] = ("right",),
        mirrored: bool = False,
        port: int = 0,
        marks: bool = False,
    ) -> None:
        self.counts: Counter[str] = Counter()
        self.corners: tuple[tuple[float, float], ...] = ()
        self._frames: deque[LandmarkFrame] = deque()
        self._lock = threading.Lock()
        self._came = threading.Condition(self._lock)
        self._notice = WAITING
        self._clock = PageClock()
        self._units = LiveUnits(LANDMARK_UNITS)
        self._possible = PossibleHands()
        self._before: float | None = None
        wanted = {
            "sides": list(sides),
            "most": 2,
            "hands": HANDS,
            "mirrored": mirrored,
            "marks": marks,
        }
        self.server = LandmarkServer(engine, wanted, self._take, self._gone, port)

    @property
    def address(self) -> str:
        """The link of the camera's page."""
        return self.server.url

    @property
    def title(self) -> str:
        """Name of the device and link of its page."""
        return f"{self.name} at {self.address}"

    @property
    def notices(self) -> Sequence[str]:
        """Reason for missing pictures; without one, assumptions about the pictures."""
        with self._lock:
            notices = (self._notice,) if self._notice else self._assumed
        return tuple(filter(None, notices))

    @property
    def _assumed(self) -> Sequence[str]:
        return self._units.notice, self._possible.side.sentence

    @property
    def report(self) -> ReaderReport:
        """Report on unusable input so far, by reason, and on assumptions."""
        report = ReaderReport()
        with self._lock:
            report.add_counts({k: n for k, n in self.counts.items() if k != "pictures"})
        for sentence in filter(None, self._assumed):
            report.assume(sentence)
        return report

    def wait(self, seconds: float) -> bool:
        """Waits until `poll` has a frame; False if none came in time."""
        with self._came:
            return self._came.wait_for(lambda: bool(self._frames), seconds)

    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        """Returns all frames since the last call."""
        with self._lock:
            frames = tuple(self._frames)
            self._frames.clear()
        return frames

    def close(self) -> None:
        """Ends the service and the page's use of the camera; may be called twice."""
        super().close()
        self.server.close()

    def _take(self, message: PictureMessage) -> None:
        """Processes a message; called in the server's thread."""
        if message.corners is not None:
            with self._lock:
                self.corners = message.corners
            return
        if message.trouble is not None:
            with self._lock:
                self._notice = NOTICES[message.trouble]
                self.counts[f"trouble: {message.trouble}"] += 1
            return
        if message.seen and not self._units.decided:
            self._measure(message)
        left_out: Counter[str] = Counter()
        try:
            frame = frame_of(in_units(message, self._units.units))
            left_out[UNREADABLE] = left_hands(message, frame)
            frame = self._clock.moved(frame, time.monotonic())
            if self._units.decided:
                frame = self._possible.only(frame, left_out)
        except FrameError:
            with self._lock:
                self.counts["pictures that are not valid"] += 1
            if message.unread:
                # The page is this program's; its engine gave an invalid position of a hand.
                return
            raise
        with self._came:
            self._notice = ""
            self.counts["pictures"] += 1
            self.counts += left_out
            if len(self._frames) == KEPT:
                self._frames.popleft()
                self.counts["pictures nobody fetched"] += 1
            self._frames.append(frame)
            self._came.notify_all()

    def _measure(self, message: PictureMessage) -> None:
        seen = quantities(message)
        if self._before is not None and message.time is not None and message.time > self._before:
            seen[STEP] = message.time - self._before
        self._before = message.time
        self._units.look(seen)

    def _gone(self) -> None:
        """Called in the server's thread when the page has disconnected."""
        with self._lock:
            self._notice = CLOSED
            self.counts["pages closed"] += 1
            self._clock.begin_anew()
