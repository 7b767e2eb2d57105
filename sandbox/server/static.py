"""The page's static files. They are read once, and served compressed if the browser accepts it.

Headers forbid the page to load anything from elsewhere.
"""

from __future__ import annotations

import gzip
from base64 import b64encode
from hashlib import sha256
from http import HTTPStatus
from pathlib import Path
from urllib.parse import quote

from websockets.datastructures import Headers
from websockets.http11 import Response

from models.errors import HandSandboxError

STATIC = Path(__file__).resolve().parents[1] / "views" / "static"

TOKEN_PLACE, LANGUAGE_PLACE = b"{{token}}", b"{{language}}"
MANIFEST_PLACE = b"{{manifest}}"
MANIFEST = b'<link rel="manifest" href="manifest.json?token={{token}}">'
"""Makes the page installable; browsers allow this only with TLS. The start address of the installed
page has no token."""
INDEX, HEADSET = "/index.html", "/headset.html"
"""The page for fingers on a screen, and the page for a headset."""
WAY_BACK = "/return.html"
"""Page for requests without a token."""

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".webp": "image/webp",
    ".bin": "application/octet-stream",
    ".glb": "model/gltf-binary",
    ".json": "application/manifest+json",
    ".txt": "text/plain; charset=utf-8",
}


class StaticFiles:
    """Files of a folder, read into memory; nothing outside the folder can be requested.

    Args:
        folder: Folder with the page's files.
        index: Name of the page that is served for the path `/`.

    Raises:
        HandSandboxError: The folder has no page.
    """

    def __init__(self, folder: Path = STATIC, index: str = INDEX) -> None:
        self._index = index
        self._compressed: dict[str, bytes] = {}
        paths = sorted(folder.rglob("*")) if folder.is_dir() else []
        self._files = {
            "/" + p.relative_to(folder).as_posix(): p.read_bytes()
            for p in paths
            if p.is_file() and p.suffix in _TYPES
        }
        if not {index, WAY_BACK} <= set(self._files):
            raise HandSandboxError(
                "the page is missing",
                where=str(folder),
                remedy="Reinstall Hand Sandbox, or build the page: see docs/page.md",
            )

    def way_back(self) -> Response:
        """Returns the response to requests without a token; it is always the same.

        Its page reads the token that is stored in the tab, and loads the real page with it. It may
        run its own script, which the policy allows by its hash, but cannot load or send anything.
        """
        body = self._files[WAY_BACK]
        script = body.partition(b"<script>")[2].partition(b"</script>")[0]
        digest = b64encode(sha256(script).digest()).decode()
        policy = (
            f"default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; "
            "img-src data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
        )
        headers = {"Content-Type": _TYPES[".html"], "Content-Security-Policy": policy}
        return answered(HTTPStatus.OK, headers, body)

    def response(
        self,
        path: str,
        websocket_origin: str,
        token: str = "",
        language: str = "",
        accepted: str = "",
    ) -> Response:
        """Returns the response to a GET request.

        Args:
            path: Path without query.
            websocket_origin: Origin of WebSockets, such as ws://127.0.0.1:8000, which some browsers
                do not treat as 'self'.
            token: Token that is written into the links of the page, since all requests need it.
            language: Language of a study's participant, written into the page; empty: the page
                chooses.
            accepted: The request's `Accept-Encoding`.
        """
        name = self._index if path == "/" else path
        body = self._files.get(name)
        if body is None:
            return plain(HTTPStatus.NOT_FOUND, "Page not found.")
        if name == self._index:
            secure = websocket_origin.startswith("wss:")
            body = body.replace(MANIFEST_PLACE, MANIFEST if secure else b"")
            body = body.replace(TOKEN_PLACE, quote(token).encode())
            body = body.replace(LANGUAGE_PLACE, quote(language).encode())
        headers = {
            "Content-Type": _TYPES[Path(name).suffix],
            "Content-Security-Policy": (
                f"default-src 'self'; connect-src 'self' {websocket_origin}; img-src 'self' data: "
                "blob:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'; base-uri 'none'"
            ),
        }
        if "gzip" in accepted and name != self._index:
            if name not in self._compressed:
                self._compressed[name] = gzip.compress(body, mtime=0)
            body = self._compressed[name]
            headers |= {"Content-Encoding": "gzip", "Vary": "Accept-Encoding"}
        return answered(HTTPStatus.OK, headers, body)


def plain(status: HTTPStatus, text: str) -> Response:
    """Returns a short plain-text response."""
    return answered(status, {"Content-Type": "text/plain; charset=utf-8"}, text.encode() + b"\n")


def answered(status: HTTPStatus, headers: dict[str, str], body: bytes) -> Response:
    """Returns a response with the given headers and those of all responses."""
    everywhere = {
        "Content-Length": str(len(body)),
        "Cache-Control": "no-store",
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "Connection": "close",
    }
    return Response(status.value, status.phrase, Headers({**headers, **everywhere}), body)
