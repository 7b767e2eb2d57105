"""Pictures of `sandbox paalm show`, in a window, on a page or in a file."""

from __future__ import annotations

import io
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Literal

from PIL import Image
from rich.console import Console
from rich.text import Text

from encoders.paalm import Paalm, PaalmFrame
from models.errors import DeviceError, InputError
from models.frames import HandFrame
from sandbox.devices.device import Closeable

_BOUNDARY = "picture"
_HOSTS = ("127.0.0.1", "localhost")
_QUALITY = 85

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width">
<style>html,body{{margin:0;height:100%;background:#20252a;color:#f2f5f7;font:16px sans-serif}}
body{{display:grid;place-items:center}}img{{max-width:100%;max-height:100vh}}</style></head>
<body><img src="/pictures" alt="{title}"></body></html>
"""


class PicturePage(Closeable):
    """Serves the newest picture to every browser on this machine.

    Args:
        title: Title of the page.
        port: TCP port; 0 uses a free one.

    Raises:
        DeviceError: The port is not available.
    """

    def __init__(self, title: str, port: int = 0) -> None:
        self._news = threading.Condition()
        self._jpeg, self._number, self._over = b"", 0, False
        try:
            self._server = ThreadingHTTPServer((_HOSTS[0], port), _handler(self, title))
        except (OSError, OverflowError) as error:
            raise DeviceError(
                "the page cannot be served",
                where="--port",
                got=str(error),
                remedy="Choose another --port; 0 takes a free one",
            ) from None
        self._server.daemon_threads = True
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()
        self.url = f"http://{_HOSTS[0]}:{self._server.server_address[1]}/"

    def show(self, picture: Image.Image) -> None:
        """Replaces the served picture."""
        data = io.BytesIO()
        picture.save(data, "JPEG", quality=_QUALITY)
        with self._news:
            self._jpeg, self._number = data.getvalue(), self._number + 1
            self._news.notify_all()

    def next(self, seen: int) -> tuple[int, bytes] | None:
        """Waits for a picture newer than number `seen`.

        Returns the picture's number and JPEG data; None after `close`.
        """
        with self._news:
            self._news.wait_for(lambda: self._over or self._number > seen)
            return None if self._over else (self._number, self._jpeg)

    def close(self) -> None:
        """Ends the service; may be called twice."""
        with self._news:
            self._over = True
            self._news.notify_all()
        self._server.shutdown()
        self._server.server_close()


def _handler(page: PicturePage, title: str) -> Callable[..., BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            host = self.headers.get("Host", "").rpartition(":")[0] or self.headers.get("Host", "")
            if host not in _HOSTS:
                self.send_error(403, "only this machine")
            elif self.path == "/":
                self._answer("text/html; charset=utf-8", _PAGE.format(title=title).encode())
            elif self.path == "/pictures":
                self._pictures()
            else:
                self.send_error(404)

        def log_message(self, format: str, *args: object) -> None:
            pass  # requests are not logged to stderr

        def _answer(self, kind: str, body: bytes) -> None:
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            self.wfile.write(body)

        def _pictures(self) -> None:
            self.send_response(200)
            kind = f"multipart/x-mixed-replace; boundary={_BOUNDARY}"
            self.send_header("Content-Type", kind)
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            seen = 0
            try:
                while (picture := page.next(seen)) is not None:
                    seen, jpeg = picture
                    head = f"--{_BOUNDARY}\r\nContent-Type: image/jpeg\r\n"
                    head += f"Content-Length: {len(jpeg)}\r\n\r\n"
                    self.wfile.write(head.encode() + jpeg + b"\r\n")
            except OSError:
                return  # the browser closed the connection

    return Handler


ViewName = Literal["text", "window", "web"]
PICTURES = (".png", ".jpg", ".webp")
_PAGE_RATE = 20.0
"""Largest number of pictures per second on a page."""
_LONGEST_REST = 0.02


def check_picture(path: Path | None) -> None:
    """Checks, before anything is shown, that the picture can be written.

    Raises:
        InputError: The folder is missing, or the suffix is not that of a picture.
    """
    if path is None:
        return
    if not path.absolute().parent.is_dir():
        raise InputError(
            "no such folder", where=f"--picture {path}", remedy="Create it, or name another"
        )
    if path.suffix.lower() not in PICTURES:
        raise InputError(
            "a picture cannot be written in this format",
            where=f"--picture {path}",
            got=path.suffix,
            expected=", ".join(PICTURES),
        )


def show_pictures(
    paalm: Paalm,
    stream: Iterator[HandFrame],
    view: ViewName,
    *,
    recorded: bool,
    caption: str,
    seconds: float,
    picture: Path | None,
    port: int,
) -> None:
    """Shows frames as pictures until they end, the time is over or the window is closed.

    Args:
        paalm: Calibrated reconstruction.
        stream: Hand frames.
        view: `window` or `web`; with `text`, only the last frame is drawn, into a file.
        recorded: True for a recording, which is played at its own speed.
        caption: Description of the source.
        seconds: Time limit by the times of the frames, s.
        picture: File for the last picture; None writes none.
        port: TCP port of the page.

    Raises:
        GraphicsError: The machine has no screen or no OpenGL.
    """
    sides = tuple(paalm.calibration)
    shown: WindowPictures | PagePictures | FilePictures
    if view == "window":
        shown = WindowPictures(sides, caption)
    elif view == "web":
        shown = PagePictures(sides, caption, port)
    else:
        shown = FilePictures(sides, caption)
    try:
        last = _play(paalm, stream, shown, recorded and view != "text", seconds)
        if picture is not None and last is not None:
            _save(shown.drawn(*last), picture)
            Console().print(Text(f"picture: {picture}"))
    finally:
        shown.close()


def _play(
    paalm: Paalm,
    stream: Iterator[HandFrame],
    shown: WindowPictures | PagePictures | FilePictures,
    paced: bool,
    seconds: float,
) -> tuple[HandFrame, PaalmFrame] | None:
    """Shows the frames; returns the last one and its reconstruction."""
    begin: float | None = None
    started = time.monotonic()
    last, late = None, False
    for frame in stream:
        begin = frame.time if begin is None else begin
        due = frame.time - begin
        if due > seconds:
            break
        while paced and time.monotonic() - started < due:
            if not shown.rest():
                return last
            time.sleep(min(_LONGEST_REST, max(0.0, due - (time.monotonic() - started))))
        last = frame, paalm.step(frame)
        # Do not draw late frames, except the last frame.
        late = paced and time.monotonic() - started >= due + 0.1
        if not late and not shown.show(*last):
            break
    if last is not None and late:
        shown.show(*last)
    return last


def _save(picture: Image.Image, path: Path) -> None:
    try:
        picture.save(path)
    except OSError as error:
        raise InputError(
            "the picture cannot be written",
            where=f"--picture {path}",
            got=str(error),
            remedy="Name another file",
        ) from error


class WindowPictures:
    """Shows pictures in a window."""

    def __init__(self, sides: Sequence[str], caption: str) -> None:
        from sandbox.views.paalm.picture_window import PaalmWindow

        self._window = PaalmWindow(sides, caption)
        self.show, self.rest, self.close = self._window.show, self._window.rest, self._window.close

    def drawn(self, frame: HandFrame, result: PaalmFrame) -> Image.Image:
        """Returns the last picture."""
        assert self._window.picture is not None
        return self._window.picture


class FilePictures:
    """Draws only the last frame, with the last positions of fingers that have vanished."""

    def __init__(self, sides: Sequence[str], caption: str) -> None:
        from sandbox.views.paalm.picture import PaalmPicture

        self._picture = PaalmPicture(sides, caption=caption)

    def show(self, frame: HandFrame, result: PaalmFrame) -> bool:
        """Processes a frame without drawing it."""
        self._picture.update(frame, result)
        return True

    def rest(self) -> bool:
        """Returns True: without a window, nothing can be closed."""
        return True

    def drawn(self, frame: HandFrame, result: PaalmFrame) -> Image.Image:
        """Draws a frame."""
        return self._picture.draw(frame, result)

    def close(self) -> None:
        """Frees the OpenGL context."""
        self._picture.close()


class PagePictures(FilePictures):
    """Shows pictures on a page of this machine."""

    def __init__(self, sides: Sequence[str], caption: str, port: int) -> None:

        super().__init__(sides, caption)
        try:
            self._page = PicturePage("PAALM: finger vectors, palm and hand", port)
        except BaseException:
            super().close()
            raise
        self._due = 0.0
        text = Text(f"open {self._page.url} in a browser on this machine; Ctrl-C ends")
        Console(stderr=True).print(text, soft_wrap=True)

    def show(self, frame: HandFrame, result: PaalmFrame) -> bool:
        """Draws a frame unless the last picture is too recent."""
        now = time.monotonic()
        if now < self._due:
            return super().show(frame, result)
        self._due = now + 1.0 / _PAGE_RATE
        self._page.show(self.drawn(frame, result))
        return True

    def close(self) -> None:
        """Stops the page."""
        self._page.close()
        super().close()
