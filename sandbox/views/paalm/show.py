"""Pictures of `sandbox paalm show`, in a window, on a page or in a file."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Literal

from PIL import Image
from rich.console import Console
from rich.text import Text

from encoders.paalm import Paalm, PaalmFrame
from models.errors import InputError
from models.frames import HandFrame

ViewName = Literal["text", "window", "web"]
PICTURES = (".png", ".jpg", ".webp")
_PAGE_RATE = 20.0
"""Pictures per second on a page; each is drawn and compressed."""
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
            "no such folder", where=f"--picture {path}", remedy="Make it, or name another"
        )
    if path.suffix.lower() not in PICTURES:
        raise InputError(
            "this is not a picture's name", where=f"--picture {path}", expected=", ".join(PICTURES)
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
        view: `window` or `web`; `text` only draws the last frame, into a file.
        recorded: True for a recording, which is played in its own time.
        caption: Description of the source.
        seconds: Time limit by the device's clock, s.
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
        # Late frames are not drawn, except the last one.
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
            "it cannot be written", where=f"--picture {path}", got=str(error)
        ) from error


class WindowPictures:
    """Shows pictures in a window."""

    def __init__(self, sides: Sequence[str], caption: str) -> None:
        from sandbox.views.paalm.window import PaalmWindow

        self._window = PaalmWindow(sides, caption)
        self.show, self.rest, self.close = self._window.show, self._window.rest, self._window.close

    def drawn(self, frame: HandFrame, result: PaalmFrame) -> Image.Image:
        """The last picture."""
        assert self._window.picture is not None
        return self._window.picture


class FilePictures:
    """Draws only the last frame; remembers fingers that vanish."""

    def __init__(self, sides: Sequence[str], caption: str) -> None:
        from sandbox.views.paalm.picture import PaalmPicture

        self._picture = PaalmPicture(sides, caption=caption)

    def show(self, frame: HandFrame, result: PaalmFrame) -> bool:
        """Takes a frame without drawing it."""
        self._picture.update(frame, result)
        return True

    def rest(self) -> bool:
        """Returns True: without a window, nobody can close it."""
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
        from sandbox.views.paalm.picture_page import PicturePage

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
