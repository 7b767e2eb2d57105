"""A real X server in memory, and a hand on its mouse and keys."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from PIL import ImageGrab

from tests.support.needs import require
from tests.support.processes import PATIENCE

WIDTH, HEIGHT = 1100, 760
"""px of the screen."""


class Screen:
    """An Xvfb of its own.

    Attributes:
        name: Its display, `:99` for example.
    """

    def __init__(self, name: str) -> None:
        self.name = name

    def picture(self) -> np.ndarray:
        """(HEIGHT, WIDTH, 3) what is on the screen, told by the X server."""
        return np.asarray(ImageGrab.grab(xdisplay=self.name).convert("RGB"), float)

    def do(self, pump: Callable[[], object], *command: str | int | float) -> None:
        """Does something with xdotool while a window is pumped, until the window knows of it."""
        hand = subprocess.Popen(
            ["xdotool", *map(str, command)], env={**os.environ, "DISPLAY": self.name}
        )
        end = time.monotonic() + PATIENCE
        while hand.poll() is None:
            pump()
            assert time.monotonic() < end, f"xdotool {command} does not end"
        assert hand.returncode == 0, command
        for _ in range(3):
            pump()


@contextmanager
def screen() -> Iterator[Screen]:
    """Starts an X server on a display that is free, and makes it that of this process."""
    require("screen")
    told, tell = os.pipe()
    server = subprocess.Popen(
        # Without -noreset it begins anew, and is not there meanwhile, once its last window closes.
        f"Xvfb -displayfd {tell} -screen 0 {WIDTH}x{HEIGHT}x24 -nolisten tcp -noreset".split(),
        pass_fds=[tell],
        stderr=subprocess.DEVNULL,
    )
    os.close(tell)
    before = os.environ.get("DISPLAY")
    try:
        with os.fdopen(told) as answer:
            number = answer.readline().strip()
        assert number, "Xvfb does not start"
        os.environ["DISPLAY"] = f":{number}"
        yield Screen(f":{number}")
    finally:
        if before is None:
            os.environ.pop("DISPLAY", None)
        else:
            os.environ["DISPLAY"] = before
        server.terminate()
        server.wait()
