"""Films a command in a terminal.

The command runs in a pseudo terminal. The terminal emulator pyte computes the content of the
screen.
"""

from __future__ import annotations

import codecs
import errno
import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from PIL import Image, ImageDraw, ImageFont

COLUMNS, ROWS = 96, 27
FONT_PX = 15
"""Height (px) of the letters."""
MARGIN = 12
"""Distance (px) between the picture's border and the letters."""
BACKGROUND, INK = "#1b1e24", "#e2e4e8"
COLOURS = {
    "black": "#3b4048",
    "red": "#ef6b73",
    "green": "#8fc66f",
    "brown": "#e0b050",
    "blue": "#6aa9ef",
    "magenta": "#c98ae0",
    "cyan": "#5bbcc4",
    "white": INK,
}
"""pyte's names of colours -> colours on the dark background."""
PROMPT = "$ "


@dataclass(frozen=True)
class Moment:
    """Content of the terminal at one time.

    Attributes:
        seconds: Time (s) since the command began.
        picture: The screen.
    """

    seconds: float
    picture: Image.Image


@dataclass(frozen=True)
class TerminalRun:
    """A command that was filmed.

    Attributes:
        moments: Pictures, in order. The last picture shows the end.
        status: Exit status; None if the command was stopped.
    """

    moments: tuple[Moment, ...]
    status: int | None


def film(
    command: str,
    folder: Path,
    shown: str = "",
    longest: float | None = None,
    enough: re.Pattern[str] | None = None,
    every: float = 0.25,
    environment: Mapping[str, str] | None = None,
) -> TerminalRun:
    """Runs a command of the shell in a folder and takes pictures of its terminal.

    Args:
        command: A line for bash.
        folder: Working folder.
        shown: The line after the prompt; the command itself by default.
        longest: Time (s) after which the command is stopped; None waits for its end.
        enough: Text on the screen at which the command is stopped.
        every: Time (s) between pictures.
        environment: Additional environment variables.
    """
    import pyte

    screen = pyte.Screen(COLUMNS, ROWS)
    stream = pyte.Stream(screen)
    stream.feed(PROMPT + (shown or command) + "\r\n")
    main, side = pty.openpty()
    fcntl.ioctl(side, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    process = subprocess.Popen(
        ["bash", "-c", command],
        cwd=folder,
        env={**os.environ, "TERM": "xterm-256color", **(environment or {})},
        stdin=side,
        stdout=side,
        stderr=side,
        start_new_session=True,
    )
    os.close(side)
    decode = codecs.getincrementaldecoder("utf-8")("replace").decode
    began = time.monotonic()
    moments = [Moment(0.0, drawn(screen))]
    stopped = False
    while True:
        ready, _, _ = select.select([main], [], [], every / 2)
        now = time.monotonic() - began
        if ready:
            try:
                data = os.read(main, 65536)
            except OSError as error:
                # On Linux, this error means that the other side of the terminal is closed.
                if error.errno != errno.EIO:
                    raise
                data = b""
            if not data:
                break
            stream.feed(decode(data))
        if now - moments[-1].seconds < every:
            continue
        moments.append(Moment(now, drawn(screen)))
        over = longest is not None and now > longest
        over = over or (enough is not None and bool(enough.search("\n".join(screen.display))))
        if over and not stopped:
            stopped = True
            os.killpg(process.pid, signal.SIGINT)
    os.close(main)
    status = process.wait()
    moments.append(Moment(time.monotonic() - began, drawn(screen)))
    return TerminalRun(tuple(moments), None if stopped else status)


def size() -> tuple[int, int]:
    """Width and height (px) of the pictures."""
    across, down = _letter()
    return COLUMNS * across + 2 * MARGIN, ROWS * down + 2 * MARGIN


def drawn(screen: Any) -> Image.Image:
    """The picture of a screen of pyte."""
    across, down = _letter()
    picture = Image.new("RGB", size(), BACKGROUND)
    pen = ImageDraw.Draw(picture)
    for row in range(ROWS):
        for column in range(COLUMNS):
            cell = screen.buffer[row][column]
            ink, ground = _colour(cell.fg, INK), _colour(cell.bg, BACKGROUND)
            if cell.reverse:
                ink, ground = ground, ink
            left, top = MARGIN + column * across, MARGIN + row * down
            if ground != BACKGROUND:
                pen.rectangle((left, top, left + across - 1, top + down - 1), fill=ground)
            if cell.data.strip():
                pen.text((left, top), cell.data, font=_font(cell.bold), fill=ink)
    return picture


def _colour(name: str, default: str) -> str:
    if name == "default":
        return default
    if name in COLOURS:
        return COLOURS[name]
    plain = name.removeprefix("bright")
    return COLOURS.get(plain, f"#{name}" if len(name) == 6 else default)


@cache
def _font(bold: bool = False) -> ImageFont.FreeTypeFont:
    """A font of the package matplotlib, which contains it on every system."""
    import matplotlib

    name = "DejaVuSansMono-Bold.ttf" if bold else "DejaVuSansMono.ttf"
    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    return ImageFont.truetype(str(folder / name), FONT_PX)


@cache
def _letter() -> tuple[int, int]:
    """Width and height (px) of a letter's cell."""
    return round(_font().getlength("M")), round(1.25 * FONT_PX)
