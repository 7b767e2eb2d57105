"""Serves a page that shows a stream of pictures to browsers on this machine.

Pictures are JPEG in one endless answer (`multipart/x-mixed-replace`), which every browser shows in
an `<img>` without a script. Only requests from this machine to one of its names are answered.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from PIL import Image

from models.errors import DeviceError
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
    """Serves the newest picture to every browser that asks.

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
            raise DeviceError("the page cannot be served", where="--port", got=str(error)) from None
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
        """Waits for a picture newer than number `seen`; its number and JPEG, or None at the end."""
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
