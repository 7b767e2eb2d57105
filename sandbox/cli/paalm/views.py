"""Pictures of `sandbox paalm show`: in a window, on a page, in a file."""

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
"""Pictures a second on a page; each is drawn and packed."""
_LONGEST_REST = 0.02


def check_picture(path: Path | None) -> None:
    """Refuses, before anything is shown, a file that could not be written at the end.

    Raises:
        InputError: Its folder is missing, or it is not a picture's name.
    """
    if path is None:
        return
    if not path.absolute().parent.is_dir():
        raise InputError("no such folder", where=f"--picture {path}")
    if path.suffix.lower() not in PICTURES:
        raise InputError(
            "this is no picture", where=f"--picture {path}", expected=", ".join(PICTURES)
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
    """Shows frames as pictures until they end, the time is over or the person closes the window.

    Args:
        paalm: Calibrated.
        stream: Frames.
        view: `window` or `web`; `text` only draws the last frame, into a file.
        recorded: Frames of a recording are played at their own pace.
        caption: Where they come from.
        seconds: Of the device's time.
        picture: Where the last picture goes.
        port: Of the page.

    Raises:
        GraphicsError: The machine has no screen or no OpenGL.
    """
    sides = tuple(paalm.calibration)
    shown: Window | Page | File
    if view == "window":
        shown = Window(sides, caption)
    elif view == "web":
        shown = Page(sides, caption, port)
    else:
        shown = File(sides, caption)
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
    shown: Window | Page | File,
    paced: bool,
    seconds: float,
) -> tuple[HandFrame, PaalmFrame] | None:
    """The last frame and what PAALM made of it."""
    begin: float | None = None
    started = time.monotonic()
    last = None
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
        # Of frames that are late already, only the newest is worth a picture.
        if (not paced or time.monotonic() - started < due + 0.1) and not shown.show(*last):
            break
    return last


def _save(picture: Image.Image, path: Path) -> None:
    try:
        picture.save(path)
    except OSError as error:
        raise InputError(
            "it cannot be written", where=f"--picture {path}", got=str(error)
        ) from error


class Window:
    """In a window."""

    def __init__(self, sides: Sequence[str], caption: str) -> None:
        from sandbox.views.paalm.window import PaalmWindow

        self._window = PaalmWindow(sides, caption)
        self.show, self.rest, self.close = self._window.show, self._window.rest, self._window.close

    def drawn(self, frame: HandFrame, result: PaalmFrame) -> Image.Image:
        """The last picture."""
        assert self._window.picture is not None
        return self._window.picture


class File:
    """Nowhere, but for the last frame; remembers fingers that vanish."""

    def __init__(self, sides: Sequence[str], caption: str) -> None:
        from sandbox.views.paalm.picture import PaalmPicture

        self._picture = PaalmPicture(sides, caption=caption)

    def show(self, frame: HandFrame, result: PaalmFrame) -> bool:
        """Takes note."""
        self._picture.look(frame, result)
        return True

    def rest(self) -> bool:
        """Goes on."""
        return True

    def drawn(self, frame: HandFrame, result: PaalmFrame) -> Image.Image:
        """The picture of a frame."""
        return self._picture.draw(frame, result)

    def close(self) -> None:
        """Gives OpenGL back."""
        self._picture.close()


class Page(File):
    """On a page of this machine."""

    def __init__(self, sides: Sequence[str], caption: str, port: int) -> None:
        from sandbox.server.picture_page import PicturePage

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
        """Draws a frame unless it comes too soon."""
        now = time.monotonic()
        if now < self._due:
            return super().show(frame, result)
        self._due = now + 1.0 / _PAGE_RATE
        self._page.show(self.drawn(frame, result))
        return True

    def close(self) -> None:
        """Ends the page."""
        self._page.close()
        super().close()
