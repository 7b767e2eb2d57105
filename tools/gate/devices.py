"""Plays one input file per device through the session.

The files in `inputs/` have formats of other programs, or are plain JSON if a device has no file
format. They were made once from hands of simulated users, and do not change:

    tuio        packets of TUIO 1.1, 2Dcur, as a capture
    leapd       frames of a Leap service (v2)
    landmarks   21 landmarks of a hand and the camera
    headset     messages of the page with WebXR's 25 joints
    page        messages of the page with touches: a finger is cancelled and comes back after
                0.25 s, another one is lost for 0.1 s and comes back with another id
    evdev       events of a Linux touch screen, protocol B
"""

from __future__ import annotations

import gzip
import json
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from models.surface import Surface
from sandbox import run_trial
from sandbox.devices.device import Device, HandDevice
from sandbox.devices.evdev.evdev_device import EvdevDevice
from sandbox.devices.evdev.evdev_touch import TURNED, Axis, Matrix, Slots
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.server.protocol import PageHands, PageScreen, PageTouches, decode
from sandbox.server.web import WebDevice
from sandbox.trial.driver import play_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.task import Task
from tools.gate.rows import Observed, outcome

INPUTS = Path(__file__).with_name("inputs")

SEEDS = {"tuio": 2, "leapd": 2, "landmarks": 4, "headset": 2, "page": 2, "evdev": 2}
"""Input -> seed of the trial of box-to-goal for which it was made."""

SCREEN = PageScreen(132.0, 1024.0, 768.0, True)
"""Screen of the page that sent the messages."""

UNITS_PER_MM = 20
"""Resolution (units per mm) of the touch screen that sent the events."""


def play(name: str) -> Observed:
    """Plays an input through a session and returns its row."""
    task, seed = "box-to-goal", SEEDS[name]
    if name in ("page", "evdev"):
        opened = Page if name == "page" else touch_screen
        return outcome(run_trial(task, seed, opened, trajectories=False).result)
    if name == "headset":
        chosen = trial_settings(TrialOptions(task=task, seed=seed, device="webxr-simulated"))
        return outcome(play_trial(chosen, (_headset,)).as_json())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.jsonl"
        path.write_bytes(gzip.decompress((INPUTS / f"{name}.jsonl.gz").read_bytes()))
        return outcome(run_trial(task, seed, str(path), trajectories=False).result)


class Waiting:
    """The remaining lines of an input, each of which is due at its time."""

    def __init__(self, name: str) -> None:
        text = gzip.decompress((INPUTS / f"{name}.jsonl.gz").read_bytes()).decode()
        self.lines = [json.loads(line) for line in text.splitlines()][::-1]

    def due(self, now: float) -> list[dict[str, Any]]:
        """Removes and returns the lines up to the time `now` (s)."""
        found = []
        while self.lines and self.lines[-1]["t"] <= now:
            found.append(self.lines.pop())
        return found


class Page(Device):
    """A device that gets the page's touch messages at the times of the file."""

    name = "page"

    def __init__(self, surface: Surface) -> None:
        self._waiting, self._web = Waiting("page"), WebDevice(surface)

    @property
    def finished(self) -> bool:
        """True once all messages were taken in."""
        return not self._waiting.lines

    def poll(self, now: float = 0.0) -> Sequence[Any]:
        """Frames of the messages that are due."""
        for line in self._waiting.due(now):
            message = decode(line["message"])
            assert isinstance(message, PageTouches)
            self._web.receive(message, SCREEN)
        return self._web.poll(now)

    def close(self) -> None:
        """Closes the page."""
        self._web.close()


class Headset(HandDevice):
    """A device that gets the hand messages of a headset's page at the times of the file."""

    name = "headset"

    def __init__(self) -> None:
        self._waiting, self._page = Waiting("headset"), HeadsetDevice()

    @property
    def finished(self) -> bool:
        """True once all messages were taken in."""
        return not self._waiting.lines

    def poll(self, now: float) -> Sequence[Any]:
        """Frames of the messages that are due."""
        for line in self._waiting.due(now):
            message = decode(line["message"])
            assert isinstance(message, PageHands)
            self._page.receive(message, SCREEN)
        return self._page.poll(now)

    def close(self) -> None:
        """Closes the headset."""
        self._page.close()


def _headset(task: Task, surface: Surface) -> Any:
    return Headset()


class EventNode:
    """A touch screen's node that sends events at the times of the file.

    Args:
        size: (2,) m, size of the screen.
    """

    name = "a touch screen"
    diameter: Axis | None = None
    matrix: Matrix = TURNED[0]
    warning = ""

    def __init__(self, size: ArrayLike) -> None:
        self.waiting, self.now = Waiting("evdev"), 0.0
        units = np.rint(1000.0 * UNITS_PER_MM * np.asarray(size)).astype(int).tolist()
        self.x, self.y = (Axis(0, length, UNITS_PER_MM) for length in units)

    def read(self) -> Iterable[tuple[int, int, int]]:
        """Events that are due."""
        for line in self.waiting.due(self.now):
            yield from map(tuple, line["events"])

    def slots(self) -> Slots:
        """No finger is down at the beginning."""
        return Slots()

    def close(self) -> None:
        """Closes the node."""


class _TouchScreen(EvdevDevice):
    """A device that passes the session's time to its node."""

    def __init__(self, node: EventNode, surface: Surface) -> None:
        super().__init__(node, surface)
        self._events = node

    @property
    def finished(self) -> bool:
        """True once all events were taken in."""
        return not self._events.waiting.lines

    def poll(self, now: float = 0.0) -> Sequence[Any]:
        """Frames of the events that are due."""
        self._events.now = now
        return super().poll(now)


def touch_screen(surface: Surface) -> Device:
    """Opens a touch screen of the surface's size that sends the events of the file."""
    return _TouchScreen(EventNode(surface.size), surface)
