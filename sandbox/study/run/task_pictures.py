"""Pictures of the tasks of a session, which participants see before a new task.

Another process draws the pictures at low priority while the session begins, so that the session
need not wait for them and a window's graphics are not disturbed. Without OpenGL there are no
pictures.

    python -m sandbox.study.run.task_pictures    # settings on stdin, one picture a line on stdout
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time
from base64 import b64encode
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from io import BytesIO

from models.errors import HandSandboxError
from sandbox.devices.device import Closeable
from sandbox.study.run.forms import Poll
from sandbox.trial.settings import Settings, decoded, encoded

SIZE = (960, 540)
"""Width and height (px) of a picture."""
QUALITY = 80
"""JPEG quality of a picture, up to 100."""
LONGEST = 8.0
"""Longest time (s) for which a participant waits for a picture."""
TICK = 0.02
"""Time (s) between two calls of `poll` during this wait."""
NICE = 10
"""Niceness of the process that draws; see `os.nice`."""


class TaskPictures(Closeable):
    """Draws each task of some trials once, in another process.

    Args:
        trials: Settings of the trials, in order.
    """

    def __init__(self, trials: Sequence[Settings]) -> None:
        first = {settings.task: settings for settings in reversed(trials)}
        self._pictures: dict[str, str] = {}
        self._drawn = {task: threading.Event() for task in first}
        self._process = subprocess.Popen(
            [sys.executable, "-m", "sandbox.study.run.task_pictures"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        order = dict.fromkeys(settings.task for settings in trials)
        given = json.dumps([encoded(first[task]) for task in order])
        threading.Thread(target=self._read, args=(given, [*order]), daemon=True).start()

    def of(self, task: str, poll: Poll) -> str:
        """The picture of a task as a data URL; empty if there is none.

        Args:
            task: Name of the task.
            poll: Called repeatedly while this waits for the picture.
        """
        drawn, until = self._drawn.get(task), time.monotonic() + LONGEST
        while drawn is not None and not drawn.wait(TICK) and time.monotonic() < until:
            poll()
        return self._pictures.get(task, "")

    def close(self) -> None:
        """Ends the process that draws."""
        self._process.kill()
        self._process.wait()

    def _read(self, given: str, tasks: Sequence[str]) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(OSError), self._process.stdin as to, self._process.stdout as lines:
            to.write(given)
            to.close()
            for task, line in zip(tasks, lines, strict=False):
                self._pictures[task] = line.strip()
                self._drawn[task].set()
        for drawn in self._drawn.values():
            drawn.set()


def picture_of(settings: Settings) -> str:
    """A picture of the scene of a trial before its first step, as a data URL."""
    from sandbox.trial.driver import open_trial
    from sandbox.views.renderer import Renderer

    # The picture shows the scene before the first touch, so its hands need no device.
    hands = tuple(replace(hand, in_air=None) for hand in settings.hands)
    own = replace(settings, hands=hands, device=Settings().device, second_device=None)
    with open_trial(own, may_overlap=True) as trial:
        session = trial.session
        with Renderer(session.scene, session.whole_surface, SIZE) as renderer:
            picture = renderer.without_texts(session.advance())
    data = BytesIO()
    picture.save(data, "JPEG", quality=QUALITY)
    return f"data:image/jpeg;base64,{b64encode(data.getvalue()).decode()}"


def main() -> None:
    """Draws the trials on stdin, and writes a line with each picture to stdout."""
    with suppress(AttributeError, OSError):  # Windows has no such priority.
        os.nice(NICE)
    # Other output must not mix with the pictures.
    out, sys.stdout = sys.stdout, sys.stderr
    for settings in json.load(sys.stdin):
        picture = ""
        with suppress(HandSandboxError):  # such as a task that only special devices can play
            picture = picture_of(decoded(settings))
        print(picture, file=out, flush=True)


if __name__ == "__main__":
    main()
